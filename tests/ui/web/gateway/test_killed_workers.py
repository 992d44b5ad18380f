"""Workers that are killed: their sleeping copies continue the games, and nothing is lost or done twice."""

import asyncio
import os
import re
import signal
from collections.abc import Iterable
from pathlib import Path

from tests.support.programs.browser_client import BrowserClient
from tests.support.programs.desk_client import DeskClient
from tests.support.programs.processes import run_thbridge
from tests.support.studies.served_study import served
from thbridge.experiment.folder import ExperimentFolder
from thbridge.experiment.store.events import EventKind, LoggedEvent
from thbridge.recording.journal import journal_path, read_journal
from thbridge.recording.recordings import journal_of
from thbridge.sockets.keys import SingleKey
from ui.web.pool.running_games import RunningGames, WorkerAddress

KEY = "a key that nobody can guess"
STUDY = """\
title: Killed workers
seed: 3
base: {map: practice, templates: practice, robots: 1, rate: 10, server.port: 0, recording.format: mcap}
quota: 4
consent_elsewhere: People agreed before.
steps:
  - {step: trial, name: game, max_seconds: 3000}
"""


def lines(browser: BrowserClient) -> list[str]:
    """Return the lines of the history."""
    return [each["text"] for each in browser.tree["history"]]


def clock(browser: BrowserClient) -> str:
    """Return the time in the game, minutes and seconds."""
    (found,) = re.findall(r"\d+:\d\d", browser.tree["progress"])
    return found.rjust(6)


def copies(worker: WorkerAddress) -> list[int]:
    """Return the sleeping copies of a worker."""
    children = Path(f"/proc/{worker.process}/task/{worker.process}/children")
    return [*map(int, children.read_text().split())] if children.exists() else []


async def back(browser: BrowserClient, processes: Iterable[int]) -> None:
    """Kill processes of a game, and wait until the browser receives a complete page."""
    before = browser.whole_pages
    for process in processes:
        os.kill(process, signal.SIGKILL)
    await browser.until(lambda: browser.whole_pages > before)


async def talking(browser: BrowserClient) -> None:
    """Begin the game, and ask a robot to go to a room."""
    await browser.press_button()
    await browser.until(lambda: browser.tree.get("phase") == "playing" and browser.tree["tiles"])
    await asyncio.sleep(0.4)
    await browser.act(browser.tree["tiles"][0]["choose"]["act"])
    await browser.until(lambda: browser.tree.get("dialogue") and browser.tree["dialogue"]["choices"])


def test_a_sleeping_copy_continues_the_game_of_a_killed_worker(tmp_path: Path) -> None:
    (tmp_path / "experiment.yaml").write_text(STUDY)
    running = RunningGames.of(tmp_path)

    async def run() -> None:
        async with served(tmp_path, running) as (port, _):
            browser = await BrowserClient.arrived(port)
            await browser.press_button()
            await browser.until(lambda: browser.tree.get("phase") == "playing" and browser.tree["tiles"])
            (key,) = running
            worker = running.address(key)
            assert worker is not None
            await browser.until(lambda: copies(worker))
            # What is done now is not in the copy, but in the log of inputs.
            await asyncio.sleep(0.4)
            await browser.act(browser.tree["tiles"][0]["choose"]["act"])
            await browser.until(lambda: browser.tree.get("dialogue") and browser.tree["dialogue"]["choices"])
            said, history = browser.tree["dialogue"]["sentences"][-1], lines(browser)
            for _ in range(2):
                # A copy that has woken has a copy of its own at once.
                await browser.until(lambda each=worker: copies(each))
                await back(browser, [worker.process])
                await browser.until(lambda: browser.tree.get("dialogue") and browser.tree["dialogue"]["choices"])
                assert browser.tree["dialogue"]["sentences"][-1] == said
                assert lines(browser) == history
                woken = running.address(key)
                assert woken is not None
                assert woken.process != worker.process
                assert woken.token == worker.token, "another worker, not a copy, has resumed the game"
                worker = woken
            await asyncio.sleep(0.4)
            await browser.act(browser.tree["dialogue"]["aside"]["act"])
            await browser.until(lambda: browser.tree["dialogue"] is None)
            await browser.end_game()
            await browser.until(lambda: browser.shown.get("button") == "Finish")
            await browser.close()

    asyncio.run(asyncio.wait_for(run(), 280))
    entries = ExperimentFolder(tmp_path).entries()
    events = [entry.event for entry in entries if isinstance(entry, LoggedEvent)]
    kinds = [event.kind for event in events]
    assert kinds.count(EventKind.GAME_PLAYED) == 1
    assert EventKind.RECORDING_CUT_OFF not in kinds
    (bag,) = (tmp_path / "recordings").rglob("*.mcap")
    # The checksums of a journal are chained, so a repeated or missing event would be an error.
    assert read_journal(journal_path(journal_of(bag), 1)).state.ended is not None
    assert run_thbridge(tmp_path, "replay", str(bag)).returncode == 0


def test_history_and_clock_go_on_when_another_worker_resumes_the_game(tmp_path: Path) -> None:
    (tmp_path / "experiment.yaml").write_text(STUDY)
    running = RunningGames.of(tmp_path)

    async def run() -> None:
        async with served(tmp_path, running) as (port, _):
            browser = await BrowserClient.arrived(port)
            await talking(browser)
            await asyncio.sleep(0.4)
            await browser.act(browser.tree["dialogue"]["choices"][0]["act"])
            await browser.until(lambda: any("Something was found" in line for line in lines(browser)))
            history, time = lines(browser), clock(browser)
            (key,) = running
            worker = running.address(key)
            assert worker is not None
            await back(browser, [*copies(worker), worker.process])
            await browser.until(lambda: browser.tree.get("treasure"))
            resumed = running.address(key)
            assert resumed is not None
            assert resumed.token != worker.token, "a copy has continued the game"
            assert lines(browser) == history
            await browser.until(lambda: clock(browser) >= time)
            await browser.close()
            os.kill(resumed.process, signal.SIGKILL)

    asyncio.run(asyncio.wait_for(run(), 280))


def test_a_watched_game_goes_on_and_can_be_watched_again(tmp_path: Path) -> None:
    (tmp_path / "experiment.yaml").write_text(STUDY)
    running = RunningGames.of(tmp_path)

    async def run() -> None:
        async with served(tmp_path, running, keys=SingleKey(KEY)) as (port, conductor):
            browser = await BrowserClient.arrived(port)
            await talking(browser)
            (one,), (key,) = conductor.progress.runs, running
            worker = running.address(key)
            assert worker is not None
            desk = await DeskClient.opened(port, KEY)
            await desk.until(lambda: desk.page and "Watch game" in desk.actions(one))
            await desk.send(desk.actions(one)["Watch game"]["request"])

            async def watched() -> asyncio.StreamReader:
                await desk.until(lambda: desk.page["tables"][0]["rows"][0]["command"])
                command = desk.page["tables"][0]["rows"][0]["command"]
                inside, outside = await asyncio.open_connection("127.0.0.1", int(command.rpartition(":")[2]))
                opened.append(outside)
                assert await inside.read(2**16)
                return inside

            opened: list[asyncio.StreamWriter] = []
            first = await watched()
            # A copy that is made from now on has the connection of the watcher.
            before = copies(worker)
            await browser.until(lambda: copies(worker) != before and copies(worker))
            await back(browser, [worker.process])
            woken = running.address(key)
            assert woken is not None
            assert woken.process != worker.process
            assert woken.token == worker.token, "another worker, not a copy, has resumed the game"
            while await first.read(2**16):  # The watcher finds out that the connection has ended.
                pass
            await watched()
            for each in opened:
                each.close()
            await browser.close()
            os.kill(woken.process, signal.SIGKILL)

    asyncio.run(asyncio.wait_for(run(), 280))
