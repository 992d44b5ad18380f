"""`thbridge study run`: the kiosk of one study."""

import asyncio
import secrets
from contextlib import suppress
from pathlib import Path

from thbridge.experiment.conductor import Conductor
from thbridge.experiment.folder import ExperimentFolder
from thbridge.experiment.markers import MarkerStream
from thbridge.experiment.store.event_log import ExperimentLog
from ui.display import why_no_window
from ui.hosting.desk import Desk
from ui.hosting.kiosk.games import StudyGames
from ui.hosting.kiosk.host import KioskHost, StudyClock
from ui.hosting.window_process import THBRIDGE, WindowProcess
from ui.model.kiosk import KIOSK
from ui.terminal import BAD_INPUT, FAILED, bad_input, command, fail, note


def run_study(folder: Path, look: str, *, windowed: bool, desk: bool) -> None:
    """Take people through a study until the window is closed, or the program stopped.

    Args:
        folder: of the study.
        look: colours of the windows.
        windowed: True for a window that leaves the rest of the screen free.
        desk: True to open the researcher's desk, too.
    """
    with bad_input():
        place, clock = ExperimentFolder(folder), StudyClock()
        design = place.read()
        why = why_no_window()
        if why is not None:
            fail(BAD_INPUT, why)
        place.log.parent.mkdir(exist_ok=True)
        log = ExperimentLog(place.log)
    options = ("--hosted", "--look", look, *(["--windowed"] if windowed else []))
    window = WindowProcess((*THBRIDGE, "study", "run", str(folder), *options), KIOSK)
    with log, MarkerStream(design.file.title, wanted=design.file.markers) as markers, bad_input(FAILED):
        conductor = Conductor(design, log, markers.stamping(clock), secrets.randbelow)
        conductor.listeners.append(markers.push)
        for trouble in markers.troubles:
            note(trouble)
        host = KioskHost(design, conductor, window, StudyGames(place, design), clock)
        beside = Desk(host, place, ("--look", look), lambda: markers.troubles) if desk else None
        with suppress(KeyboardInterrupt):
            asyncio.run(_run(host, beside))
    if window.given_up:
        fail(FAILED, "The window crashes whenever it is opened. What was answered is kept.")
    note(f"The study goes on by `{command('study', 'run', folder)}`.")


async def _run(host: KioskHost, desk: Desk | None) -> None:
    """Run the kiosk to its end, whatever becomes of the desk."""
    if desk is None:
        await host.run()
        return
    beside = asyncio.create_task(desk.run())
    try:
        await host.run()
    finally:
        beside.cancel()
        await asyncio.gather(beside, return_exceptions=True)
