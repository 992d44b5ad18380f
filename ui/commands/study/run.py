"""`thbridge study run`: the kiosk of a study."""

import asyncio
import os
import secrets
from contextlib import suppress
from itertools import chain
from pathlib import Path

import typer

from thbridge.experiment.check import read_for_people
from thbridge.experiment.conductor import Conductor
from thbridge.experiment.folder import ExperimentFolder
from thbridge.experiment.sockets.markers import MarkerStream
from thbridge.experiment.store.event_log import ExperimentLog
from thbridge.files.disk.synced import make_folder
from thbridge.files.errors import BadFile
from ui.command_line.networks import check_doors
from ui.command_line.terminal import BAD_INPUT, FAILED, THBRIDGE, bad_input, command, fail, note
from ui.commands.study.unfinished import finish_begun_withdrawals
from ui.commands.study.withdrawal import withdraw_during
from ui.first_start.compiling import compile_ahead
from ui.hosting.desk import Desk, DeskFailed
from ui.hosting.kiosk.game_steps import StudyClock
from ui.hosting.kiosk.games import StudyGames
from ui.hosting.kiosk.host import KioskHost
from ui.hosting.window_process import WindowProcess
from ui.model.kiosk import KIOSK, FromKiosk, ToKiosk
from ui.windows.display import why_no_window

STAYS_OPEN = "A participant is in the middle of the study. The window stays open; close it with Ctrl+Alt+Shift+Q."
"""Sentence about a window that outlives its program."""


def run_study(folder: Path, look: str, *, windowed: bool, desk: bool, program: tuple[str, ...] = ()) -> None:
    """Run the kiosk of a study until the window is closed or the program is stopped.

    Args:
        folder: folder of the study.
        look: colors of the windows.
        windowed: True for a window instead of the full screen.
        desk: True to open also the desk, the researcher's window.
        program: command of another window that uses the messages of `ui.model.kiosk`; if empty, use our own window.
    """
    finish_begun_withdrawals(folder)
    with bad_input():
        place, clock = ExperimentFolder(folder), StudyClock()
        design = read_for_people(place)
        if design.has_groups:
            problem = "the kiosk is for one person at a time, but games of this study have several people"
            remedy = f"Add people in browsers: {command('serve', folder, '--kiosk')}"
            raise BadFile(design.path, problem, remedy, key="base.seats")
        for study in chain.from_iterable(cell.studies for cell in design.cells):
            check_doors(study)
        why = None if program else why_no_window()
        if why is not None:
            fail(BAD_INPUT, why)
    # Compile before participants come, and before the log is open.
    compile_ahead(whole_hunt=True, look=None if program else look)
    with bad_input():
        make_folder(place.log.parent)
        log = ExperimentLog(place.log)
    window, code = kiosk_process(folder, look, program, windowed=windowed), 0
    try:
        with (
            suppress(KeyboardInterrupt),
            log,
            MarkerStream(design.file.title, wanted=design.file.markers) as markers,
            bad_input(FAILED),
        ):
            conductor = Conductor(design, log, markers.stamping(clock), secrets.randbelow)
            conductor.listeners.append(markers.push)
            for trouble in markers.troubles:
                note(trouble)
            host = KioskHost(design, conductor, window, StudyGames(place, design), clock)
            beside = (
                Desk(
                    host.study,
                    place,
                    ("--look", look),
                    lambda: markers.troubles,
                    withdraw=lambda participant: withdraw_during(place, conductor, log, participant),
                )
                if desk
                else None
            )
            asyncio.run(_run(host, beside, folder))
        if window.given_up:
            fail(FAILED, "The window crashes each time it is opened. All answers are saved.")
    except typer.Exit as failed:
        code = failed.exit_code
    with suppress(OSError):  # The terminal may be gone.
        if window.left_open:
            note(STAYS_OPEN)
        note(f"Resume the study with `{command('study', 'run', folder)}`.")
    if window.left_open:
        os._exit(code)
    raise typer.Exit(code)


def kiosk_process(
    folder: Path, look: str, program: tuple[str, ...] = (), *, windowed: bool
) -> WindowProcess[ToKiosk, FromKiosk]:
    """Return the process of the kiosk's window, which is not open yet; see `run_study`."""
    options = ("--hosted", "--look", look, *(["--windowed"] if windowed else []))
    return WindowProcess(program or (*THBRIDGE, "study", "run", str(folder), *options), KIOSK)


async def _run(host: KioskHost, desk: Desk | None, folder: Path) -> None:
    """Run the kiosk to its end, even if the desk fails."""
    if desk is None:
        await host.run()
        return
    beside = asyncio.create_task(_keep_desk(desk, folder))
    try:
        await host.run()
    finally:
        beside.cancel()
        await asyncio.gather(beside, return_exceptions=True)


async def _keep_desk(desk: Desk, folder: Path) -> None:
    """Keep the desk open. If the desk fails, report this at once, and continue the study without the desk."""
    try:
        await desk.run()
    except (DeskFailed, BadFile, OSError) as error:
        watch = command("study", "watch", folder)
        note(f"The desk has failed: {error}. The study continues without it. Watch the study with `{watch}`.")
