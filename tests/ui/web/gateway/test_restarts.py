"""Servers that are killed, started again, or ended after their games: no game is lost, and none is played twice."""

import asyncio
import os
import signal
from pathlib import Path

from tests.support.programs.browser_client import BrowserClient
from tests.support.programs.processes import run_thbridge
from tests.support.studies.served_program import ServedProgram, begun, playing, write_study
from thbridge.experiment.folder import ExperimentFolder
from thbridge.experiment.store.events import EventKind, LoggedEvent


def kinds_of(study: Path) -> list[str]:
    """Return the kinds of all events in the log."""
    return [str(entry.event.kind) for entry in ExperimentFolder(study).entries() if isinstance(entry, LoggedEvent)]


async def in_dialogue(browser: BrowserClient) -> str:
    """Begin a dialogue with the robot; return its title."""
    await asyncio.sleep(0.4)
    await browser.act(browser.tree["tiles"][0]["choose"]["act"])
    await browser.until(lambda: browser.tree["dialogue"] and browser.tree["dialogue"]["choices"])
    return str(browser.tree["dialogue"]["title"])


def test_games_outlive_a_server_that_is_killed_and_started_again(tmp_path: Path) -> None:
    study = write_study(tmp_path / "study")

    async def run(served: ServedProgram) -> None:
        browsers = await asyncio.gather(*(BrowserClient.arrived(served.port) for _ in range(2)))
        await asyncio.gather(*map(begun, browsers))
        talked = [await in_dialogue(browser) for browser in browsers]
        workers = served.workers
        assert len(workers) == 2

        # The child is replaced by its parent, which keeps the port open.
        killed = served.child
        os.kill(killed, signal.SIGKILL)
        await asyncio.gather(*(browser.come_back(served.port) for browser in browsers))
        await asyncio.gather(*map(playing, browsers))
        assert served.child != killed
        assert [browser.tree["dialogue"]["title"] for browser in browsers] == talked
        assert served.workers == workers

        # The parent dies, too, and the command is started again.
        served.program.kill()
        served.again()
        await asyncio.gather(*(browser.come_back(served.port) for browser in browsers))
        await asyncio.gather(*map(playing, browsers))
        assert [browser.tree["dialogue"]["title"] for browser in browsers] == talked
        assert served.workers == workers
        await asyncio.gather(*(browser.close() for browser in browsers))

    with ServedProgram(study, "--games", "2") as served:
        asyncio.run(asyncio.wait_for(run(served), 280))
    kinds = kinds_of(study)
    assert kinds.count(EventKind.STEP_RESUMED) == 4
    assert kinds.count(EventKind.RUN_BEGUN) == 2
    assert not {EventKind.GAME_BROKEN_OFF, EventKind.RECORDING_CUT_OFF} & {*kinds}
    assert len(list((study / "recordings").rglob("*.inputs"))) == 2


def test_ctrl_c_ends_the_server_and_says_how_long_its_games_go_on(tmp_path: Path) -> None:
    study = write_study(tmp_path / "study")

    async def run(served: ServedProgram) -> None:
        browser = await BrowserClient.arrived(served.port)
        await begun(browser)
        workers = served.workers
        # A terminal sends the signal to all processes in the foreground.
        os.killpg(served.program.process.pid, signal.SIGINT)
        await asyncio.to_thread(served.program.process.wait, 60)
        assert "1 game goes on for 60 s: start the same command again within this time" in served.program.text
        assert "Traceback" not in served.program.text
        served.again()
        await browser.come_back(served.port)
        await playing(browser)
        assert served.workers == workers
        await browser.close()

    with ServedProgram(study, "--games", "1") as served:
        asyncio.run(asyncio.wait_for(run(served), 280))


def test_a_drained_server_starts_nothing_ends_after_its_games_and_is_the_only_one(tmp_path: Path) -> None:
    study = write_study(tmp_path / "study")

    async def run(served: ServedProgram) -> None:
        port = served.port
        first = await BrowserClient.arrived(port)
        await begun(first)

        second = await asyncio.to_thread(run_thbridge, tmp_path, "serve", str(study), "--port", "0")
        assert second.returncode == 2
        assert "another server serves this folder" in second.stderr

        waiting = await BrowserClient.arrived(port)
        await waiting.press_button()
        await waiting.press_button()
        await waiting.until(lambda: waiting.shown["t"] == "turn")
        assert waiting.shown["waited"].startswith("You have waited")

        drained = asyncio.create_task(asyncio.to_thread(run_thbridge, tmp_path, "serve", str(study), "--drain"))
        await waiting.until(lambda: waiting.study[-1]["t"] == "stopped")
        newcomer = await BrowserClient.arrived(port)
        await newcomer.until(lambda: newcomer.study and newcomer.study[-1]["t"] == "stopped")
        assert first.tree["phase"] == "playing"
        await first.end_game()
        answer = await drained
        assert answer.returncode == 0
        assert "Still playing: P-" in answer.stderr
        assert served.program.process.wait(90) == 0
        await asyncio.gather(first.close(), waiting.close(), newcomer.close())

    with ServedProgram(study, "--games", "1") as served:
        asyncio.run(asyncio.wait_for(run(served), 280))
    assert run_thbridge(tmp_path, "serve", str(study), "--drain").returncode == 2
    assert kinds_of(study).count(EventKind.GAME_PLAYED) == 1
