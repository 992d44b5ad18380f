"""`thbridge serve --kiosk` with the real window: it takes part next to browsers, and comes back after a crash."""

import asyncio
import os
import signal
from pathlib import Path

import pytest

from tests.support.programs.browser_client import BrowserClient
from tests.support.studies.served_program import STUDY, ServedProgram, begun
from tests.support.studies.study_events import data_of
from tests.support.windows.desktop import Desktop, needs_desktop
from thbridge.experiment.folder import ExperimentFolder
from thbridge.experiment.progress import Progress, Run
from thbridge.experiment.store.events import EventKind
from thbridge.files.language_texts import shipped_texts

pytestmark = [needs_desktop, pytest.mark.slow]
TEXTS = shipped_texts()


def runs(study: Path) -> dict[str, Run]:
    folder = ExperimentFolder(study)
    found = Progress(folder.read()).after(folder.entries()).runs.values()
    return {run.front_end: run for run in found}


def pressing(screen: Desktop, key: str, until: str) -> None:
    """Press a key until something is there: a page that has just come accepts no key yet."""

    def there() -> bool:
        if screen.find(until) is None:
            screen.press(key)
        return screen.find(until) is not None

    screen.wait(until, there)


def test_a_killed_server_brings_the_person_at_the_window_back_to_their_game(tmp_path: Path, screen: Desktop) -> None:
    study = tmp_path / "study"
    study.mkdir()
    (study / "welcome.txt").write_text("You play one game.\n")
    (study / "experiment.yaml").write_text(STUDY.format(quota=4, seconds=1200))

    async def in_browser(port: int) -> None:
        browser = await BrowserClient.arrived(port)
        await begun(browser)
        await browser.close()

    with ServedProgram(study, "--kiosk", environment=screen.environment) as served:
        asyncio.run(in_browser(served.port))
        screen.focus_window("Study")
        pressing(screen, "Return", "You play one game.")
        pressing(screen, "Return", "Robot 1")
        at_window = runs(study)["window"]
        os.kill(served.child, signal.SIGKILL)
        screen.found(TEXTS.text("kiosk.restarted"))
        assert {*runs(study)} == {"browser", "window"}, "no one else has begun"
        screen.focus_window("Study")
        pressing(screen, "Return", "Robot 1")
        again = runs(study)["window"]
        assert (again.participant, again.step) == (at_window.participant, at_window.step)
        assert data_of(study, EventKind.STEP_RESUMED)
        served.program.process.send_signal(signal.SIGTERM)
        screen.found(TEXTS.text("kiosk.pauses"))
        served.program.process.wait(60)
        screen.press("ctrl+alt+shift+q")
        screen.wait("the window to close", lambda: screen.find(TEXTS.text("kiosk.pauses")) is None)
