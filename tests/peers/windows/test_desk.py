"""The desk on a real screen, by keys alone and as a screen reader sees it."""

import json
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

from tests.support.programs.processes import THBRIDGE
from tests.support.studies.rehearsed_studies import clocks, rehearsed_study
from tests.support.windows.desktop import PATIENCE, Desktop, desktop, needs_desktop
from thbridge.experiment.conductor import Conductor
from thbridge.experiment.store.event_log import ExperimentLog
from thbridge.experiment.store.events import RunState
from ui.windows.desk.program import READ_ONLY

pytestmark = needs_desktop

HOST = """
import asyncio, json, sys
from pathlib import Path
from thbridge.experiment.folder import ExperimentFolder
from ui.hosting.desk import Desk

class Study:
    changed, kiosk, troubles = None, "the first page", ("The kiosk is on fire.",)
    def said(self, *words):
        print(json.dumps(words), flush=True)
        self.troubles = ()
    def admit_next(self): self.said("next")
    def note(self, text, participant): self.said("note", text, participant)
    def exclude(self, participant, reason): self.said("exclude", participant, reason)
    def end_run(self, participant, reason): self.said("end", participant, reason)

asyncio.run(Desk(Study(), ExperimentFolder(Path(sys.argv[1]))).run())
print(json.dumps(["closed"]), flush=True)
"""


@contextmanager
def program(screen: Desktop, *command: object) -> Iterator["subprocess.Popen[str]"]:
    started = subprocess.Popen(
        list(map(str, command)), env=screen.environment, stdout=subprocess.PIPE, text=True, start_new_session=True
    )
    try:
        yield started
    finally:
        started.terminate()
        started.wait(PATIENCE)


@pytest.mark.slow
def test_a_folder_is_watched(tmp_path: Path) -> None:
    study = rehearsed_study(tmp_path)
    with desktop() as screen, program(screen, *THBRIDGE, "study", "watch", tmp_path):
        screen.focus_window("Robots that argue")
        off = screen.found("Next participant", "push button")
        assert not off.enabled
        assert off.description == READ_ONLY
        tables = {seen.name for seen in screen.look() if seen.role == "table"}
        assert {"Cells and quotas", "Runs", "Events of the selected run", "Notes"} <= tables
        screen.found("knows the study", "table cell")
        with ExperimentLog(study.folder.log) as log:
            Conductor(study.design, log, lambda: clocks(20_000), lambda most: most - 1).note("it rains")
        screen.found("it rains", "table cell")


@pytest.mark.slow
def test_the_study_is_run_by_keys_alone(tmp_path: Path) -> None:
    study = rehearsed_study(tmp_path)
    with ExperimentLog(study.folder.log) as log:
        conductor = Conductor(study.design, log, lambda: clocks(20_000), lambda most: most - 1)
        complete = [run for run in conductor.progress.runs.values() if run.state is RunState.COMPLETE]
        conductor.exclude(complete[0].participant, "so that there is a place")
        person = complete[-1].participant
    with desktop() as screen, program(screen, sys.executable, "-c", HOST, tmp_path) as host:

        def said() -> list[str]:
            assert host.stdout is not None
            return json.loads(host.stdout.readline())

        title = screen.focus_window("Robots that argue")
        screen.found("⚠ The kiosk is on fire.", "label")
        screen.found(f"{person}: ", "label")
        screen.press("ctrl+m")
        screen.wait("the field", lambda: (seen := screen.find("Note", "text")) is not None and seen.focused)
        screen.do("type", "it rains")
        screen.press("Return")
        assert said() == ["note", "it rains", ""]
        screen.press("ctrl+n")
        screen.focus_window("Next participant")
        screen.wait("Cancel", lambda: (seen := screen.find("Cancel", "push button")) is not None and seen.focused)
        screen.press("Tab")
        screen.wait("the button", lambda: (seen := screen.find("Start", "push button")) is not None and seen.focused)
        screen.press("space")
        assert said() == ["next"]
        screen.focus_window("Robots that argue")
        screen.press("ctrl+d")
        screen.focus_window("Exclude a run")
        screen.wait("the field", lambda: (seen := screen.find("Reason", "text")) is not None and seen.focused)
        screen.do("type", "knew the study")
        screen.press("Return")
        yes = f"Exclude {person}"
        screen.wait("the button", lambda: (seen := screen.find(yes, "push button")) is not None and seen.focused)
        screen.press("Return")
        assert said() == ["exclude", person, "knew the study"]
        screen.ask_to_close(title)
        screen.focus_window("Close the desk")
        close = screen.found("Close", "push button")
        screen.click(close)
        assert said() == ["closed"]
