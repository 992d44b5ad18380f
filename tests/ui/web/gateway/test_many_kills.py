"""Server and workers that are killed again and again while people play."""

import asyncio
import os
import signal
from collections.abc import Callable
from pathlib import Path

import pytest

from tests.support.programs.browser_client import BrowserClient
from tests.support.programs.processes import run_thbridge
from tests.support.studies.served_program import ServedProgram, begun, playing, write_study
from thbridge.experiment.folder import ExperimentFolder
from thbridge.experiment.store.events import EventKind, LoggedEvent, RunState
from thbridge.recording.journal import journal_path, read_journal
from thbridge.recording.recordings import journal_of

KILLS = 20


async def talks(browser: BrowserClient) -> None:
    """Ask the robot to go somewhere, and put the dialogue aside."""
    await asyncio.sleep(0.45)  # Answers right after a change of the page are not accepted.
    if browser.tree["dialogue"] is None:
        await browser.act(browser.tree["tiles"][0]["choose"]["act"])
        await browser.until(lambda: browser.tree["dialogue"])
    else:
        await browser.act(browser.tree["dialogue"]["aside"]["act"])
        await browser.until(lambda: browser.tree["dialogue"] is None)


def killed(process: int) -> None:
    os.kill(process, signal.SIGKILL)


@pytest.mark.slow
def test_the_log_is_whole_after_twenty_kills_of_the_server_and_of_workers(tmp_path: Path) -> None:
    study = write_study(tmp_path / "study", seconds=3600)

    async def run(served: ServedProgram) -> None:
        browsers = await asyncio.gather(*(BrowserClient.arrived(served.port) for _ in range(2)))
        await asyncio.gather(*map(begun, browsers))
        workers = served.workers

        async def survive(kill: Callable[[], None]) -> None:
            await asyncio.gather(*map(talks, browsers))
            kill()
            await asyncio.gather(*(browser.come_back(served.port) for browser in browsers))
            await asyncio.gather(*map(playing, browsers))

        for _ in range(KILLS):
            await survive(lambda: killed(served.child))
            assert served.workers == workers, "a game has another worker"
        for kill in range(KILLS):
            await survive(lambda chosen=kill % 2: killed([*served.workers.values()][chosen]))
            assert served.workers.keys() == workers.keys()
        for browser in browsers:
            await asyncio.sleep(0.45)
            if browser.tree["dialogue"] is not None:
                await talks(browser)
        await asyncio.gather(*(browser.end_game() for browser in browsers))
        await asyncio.gather(
            *(browser.until(lambda b=browser: b.shown.get("button") == "Finish") for browser in browsers)
        )
        await asyncio.gather(*(browser.close() for browser in browsers))

    with ServedProgram(study, "--games", "2") as served:
        asyncio.run(run(served))
    place = ExperimentFolder(study)
    events = [entry.event for entry in place.entries() if isinstance(entry, LoggedEvent)]
    kinds = [event.kind for event in events]
    assert [kinds.count(kind) for kind in (EventKind.RUN_BEGUN, EventKind.GAME_PLAYED)] == [2, 2]
    assert EventKind.GAME_BROKEN_OFF not in kinds
    assert [event.data["outcome"] for event in events if event.kind == EventKind.RUN_ENDED] == 2 * [RunState.COMPLETE]
    for event in events:
        if event.kind == EventKind.GAME_PLAYED:
            bag = study / str(event.data["bag"])
            assert read_journal(journal_path(journal_of(bag), 1)).state.ended is not None
            assert run_thbridge(tmp_path, "replay", str(bag)).returncode == 0
