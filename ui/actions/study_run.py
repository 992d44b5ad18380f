"""`thbridge study run`: the kiosk of one study."""

import asyncio
import secrets
from pathlib import Path

from thbridge.experiment.conductor import Conductor
from thbridge.experiment.folder import ExperimentFolder
from thbridge.experiment.store.event_log import ExperimentLog
from ui.hosting.kiosk.games import StudyGames
from ui.hosting.kiosk.host import KioskHost, StudyClock
from ui.hosting.window_process import THBRIDGE, WindowProcess
from ui.model.kiosk import KIOSK
from ui.terminal import FAILED, bad_input, command, fail, note


def run_study(folder: Path, window_options: tuple[str, ...]) -> None:
    """Take people through a study until the window is closed, or the program stopped.

    Args:
        folder: of the study.
        window_options: options of the window's command line.
    """
    with bad_input():
        place, clock = ExperimentFolder(folder), StudyClock()
        design = place.read()
        place.log.parent.mkdir(exist_ok=True)
        log = ExperimentLog(place.log)
    window = WindowProcess((*THBRIDGE, "study", "run", ".", "--hosted", *window_options), KIOSK)
    with log, bad_input(FAILED):
        conductor = Conductor(design, log, clock, secrets.randbelow)
        host = KioskHost(design, conductor, window, StudyGames(place, design), clock)
        asyncio.run(host.run())
    if window.given_up:
        fail(FAILED, "The window crashes whenever it is opened. What was answered is kept.")
    note(f"The study goes on by `{command('study', 'run', folder)}`.")
