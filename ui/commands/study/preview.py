"""`thbridge study preview`: pages of a study as participants see them, without the steps before them."""

import asyncio
import secrets
from contextlib import suppress
from pathlib import Path
from tempfile import TemporaryDirectory

from thbridge.experiment.conductor import Conductor
from thbridge.experiment.folder import ExperimentFolder
from thbridge.experiment.preview import PARTICIPANT, NoSuchStep, arrive, place_of
from thbridge.experiment.store.event_log import ExperimentLog
from thbridge.files.disk.synced import make_folder
from ui.command_line.terminal import BAD_INPUT, FAILED, THBRIDGE, bad_input, fail
from ui.hosting.kiosk.game_steps import StudyClock
from ui.hosting.kiosk.games import StudyGames
from ui.hosting.kiosk.host import KioskHost
from ui.hosting.window_process import WindowProcess
from ui.model.kiosk import KIOSK, FromKiosk, ToKiosk
from ui.windows.display import why_no_window


def preview_step(folder: Path, step: str, condition: str, group: str, look: str) -> None:
    """Show one step, or all steps if no step is named. Nothing is recorded.

    Args:
        folder: folder of the study.
        step: name or number of the step; if empty, all steps.
        condition: level of the within-people factor; if empty, the first.
        group: level of the between-people factor; if empty, the first.
        look: colors of the window.
    """
    with bad_input():
        design = ExperimentFolder(folder).read(with_files=True)
        try:
            place, planned = place_of(design, step, condition, group)
        except NoSuchStep as reason:
            fail(BAD_INPUT, f"{folder}: {reason}.")
    if (why := why_no_window()) is not None:
        fail(BAD_INPUT, why)
    hosted = (*THBRIDGE, "study", "preview", str(folder), "--hosted", "--look", look)
    window: WindowProcess[ToKiosk, FromKiosk] = WindowProcess(hosted, KIOSK)
    clock = StudyClock()
    with TemporaryDirectory(prefix="thbridge-preview-") as scratch, bad_input(FAILED):
        kept = ExperimentFolder(Path(scratch))
        make_folder(kept.log.parent)
        with ExperimentLog(kept.log, synced=False) as log, suppress(KeyboardInterrupt):
            arrive(design, log, place, planned, clock())
            conductor = Conductor(design, log, clock, secrets.randbelow)
            host = KioskHost(design, conductor, window, StudyGames(kept, design), clock)
            last = planned.number if step else len(conductor.progress.runs[PARTICIPANT].plan)
            asyncio.run(host.preview(PARTICIPANT, last))
    if window.given_up:
        fail(FAILED, "The window crashes each time it is opened.")
