"""Study with people: at the experimenter's desk, and in the editor."""

import itertools
import os
import random
import shutil
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path

from pictured.shot import Shot, Story
from pictured.study import shot
from thbridge.experiment.conductor import Conductor
from thbridge.experiment.folder import EXAMPLE, ExperimentFolder
from thbridge.experiment.progress import Progress
from thbridge.experiment.rehearsal.clock import RehearsalClock
from thbridge.experiment.rehearsal.people import SimulatedPeople
from thbridge.experiment.rehearsal.rehearsal import Rehearsal
from thbridge.experiment.store.event_log import ExperimentLog, read_log
from thbridge.experiment.store.events import Clocks, EventKind, LoggedEvent
from ui.model.desk.state import ToldToDesk, desk_state
from ui.windows.desk.questions import ReasonBox
from ui.windows.desk.window import DeskWindow
from ui.windows.study import study_window

SIZE = (1240, 860)
SECONDS = 4
"""Seconds between two events of the rehearsal."""


def at_the_desk() -> Iterator[Shot]:
    """Yield the desk while a participant fills in a form, and the question before a run is excluded."""
    os.environ["TZ"] = "UTC"
    time.tzset()
    with tempfile.TemporaryDirectory() as scratch:
        folder = _rehearsed(Path(scratch) / "arguing")
        design, entries = folder.read(), [e for e in read_log(folder.log) if isinstance(e, LoggedEvent)]
    shown = max(e.sequence for e in entries if e.event.kind == EventKind.ITEM_SHOWN)
    entries = entries[:shown]
    progress, last = Progress(design).after(entries), entries[-1].event
    window = DeskWindow()
    window.resize(*SIZE)
    window.show()
    form = f"{last.participant}: {progress.runs[last.participant].plan[last.step - 1].name}, page 1 of 1"
    troubles = ("Another window at the kiosk receives keys and clicks. Click into the kiosk's window.",)
    from_host = ToldToDesk(last.clocks.wall, ("texts/welcome.txt was changed",), form, troubles, last.participant)
    window.receive(desk_state(design, progress, entries, from_host))
    yield Shot("desk", window)
    words = (
        f"Exclude the run of {last.participant}? The recorded data remain, but the run no longer counts. "
        "Its place is then open for another participant. You cannot undo this."
    )
    box = ReasonBox(window, "Exclude a run", words, f"Exclude {last.participant}")
    box.reason.setText("knew the study")
    box.open()
    yield Shot("desk-reason", window, over=box)
    box.close()
    window.leave()


def as_a_form() -> Iterator[Shot]:
    """Yield the example in the editor: its factors, and its steps."""
    # The window shows the folder's path, so use the same folder each time.
    folder = Path(tempfile.gettempdir()) / "arguing"
    shutil.rmtree(folder, ignore_errors=True)
    shutil.copytree(EXAMPLE, folder)
    window = study_window(folder / "experiment.yaml")
    window.resize(*SIZE)
    window.show()
    window.open_section("within")
    yield shot("experiment-factors", window)
    window.open_section("steps")
    window.fields.finish()
    yield shot("experiment-steps", window)
    window.close()
    shutil.rmtree(folder)


def _rehearsed(root: Path) -> ExperimentFolder:
    shutil.copytree(EXAMPLE, root)
    folder = ExperimentFolder(root)
    text = folder.file.read_text(encoding="utf-8")
    folder.file.write_text(
        text.replace("quota: 24", "quota: 6").replace("between: {}", "between: {noise.preset: [none, bad wheels]}"),
        encoding="utf-8",
    )
    design, seconds = folder.read(), itertools.count(0, SECONDS)
    folder.log.parent.mkdir()

    def now() -> Clocks:
        at = next(seconds)
        return Clocks(f"2026-11-{2 + at // 28800:02}T{9 + at // 3600 % 8:02}:{at // 60 % 60:02}:{at % 60:02}Z", at)

    with ExperimentLog(folder.log) as log:
        conductor = Conductor(design, log, now, random.Random(1).randrange)
        conductor.note("The heating is off; people keep their coats on.")
        Rehearsal(design, SimulatedPeople(plays=False), 1, RehearsalClock(), folder.bag, root).run(conductor)
    return folder


STORIES = (
    Story(
        "The experimenter: a study with people",
        {
            "desk": "Progress of the participants, missing runs, and problems",
            "desk-reason": "Excluding a run requires a reason",
        },
        at_the_desk,
    ),
    Story(
        "The experimenter: the file of a study",
        {
            "experiment-factors": "Factors of a study with people",
            "experiment-steps": "Steps of the study, in their order",
        },
        as_a_form,
    ),
)
