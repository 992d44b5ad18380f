"""A whole study in browsers: two people at once, each with their own steps, answers and recorded game."""

import asyncio
import os
import signal
from collections.abc import Awaitable, Callable
from pathlib import Path

import pytest

from tests.support.programs.browser_client import BrowserClient
from tests.support.studies.served_study import served
from tests.support.studies.study_events import data_of
from thbridge.experiment.conductor import Conductor
from thbridge.experiment.store.events import EventKind, RunState
from ui.web.pool.running_games import RunningGames

STUDY = """\
title: In browsers
seed: 3
base: {map: practice, templates: practice, robots: 1, rate: 10, server.port: 0}
quota: 4
steps:
  - {step: instructions, text: welcome.txt}
  - {step: consent, text: consent.txt}
  - {step: trial, name: game, max_seconds: 40}
  - {step: form, form: after.yaml, name: after}
"""
FORM = """\
title: After the game
items:
  - {id: again, text: Would you play again?, scale: choice, options: ['yes', 'no']}
  - {id: why, text: Why?, scale: text, required: false}
"""


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    for name in ("welcome", "consent"):
        (tmp_path / f"{name}.txt").write_text(f"This is the text of {name}.\n")
    (tmp_path / "after.yaml").write_text(FORM)
    (tmp_path / "experiment.yaml").write_text(STUDY)
    return tmp_path


async def person(port: int, answer: str, first_game: Callable[[BrowserClient], Awaitable[None]] | None = None) -> None:
    """Go through the whole study, and end the game at once; `first_game` is called when the game begins."""
    browser = BrowserClient(port)
    await asyncio.to_thread(browser.load)
    await browser.open()
    for number in range(100):
        await browser.until(lambda wanted=number: len(browser.study) > wanted, 120)
        message = browser.study[number]
        page = message.get("page")
        match message["t"]:
            case "text" if not message["button"]:
                await browser.close()
                return
            case "text" | "recorded":
                await asyncio.sleep(0.45)
                await browser.send({"type": "WentOn", "page": page})
            case "consent":
                await asyncio.sleep(0.45)
                await browser.send({"type": "ConsentReply", "page": page, "agrees": True, "window_ns": 1})
            case "game" if first_game is not None:
                # The game's worker dies; another message of this kind follows.
                await first_game(browser)
                first_game = None
            case "game":
                await end_game(browser)
            case "form":
                news = {"type": "ItemNews", "page": page, "item": "again", "window_ns": 2, "answer": answer}
                await browser.send({**news, "what": "changed"})
                await browser.send({**news, "what": "given"})
                await browser.send({"type": "WentOn", "page": page})
            case _:
                pass


async def end_game(browser: BrowserClient) -> None:
    """End a game that has just begun, and continue."""
    await browser.until(lambda: browser.tree.get("phase") == "playing" and browser.tree["tiles"])
    await asyncio.sleep(0.4)
    await browser.press("E")
    await browser.until(lambda: browser.tree["question"])
    await asyncio.sleep(0.4)
    await browser.act(browser.tree["question"]["buttons"][0]["act"])
    await browser.until(lambda: browser.tree["ending"])
    await asyncio.sleep(0.4)
    await browser.act(browser.tree["ending"]["buttons"][0]["act"])


def test_two_people_go_through_the_study_at_the_same_time(folder: Path) -> None:
    async def run() -> Conductor:
        async with served(folder) as (port, conductor):
            await asyncio.gather(person(port, "yes"), person(port, "no"))
        return conductor

    conductor = asyncio.run(asyncio.wait_for(run(), 280))
    runs = list(conductor.progress.runs.values())
    assert [each.state for each in runs] == [RunState.COMPLETE, RunState.COMPLETE]
    assert sorted(str(each.answers["after.again"]) for each in runs) == ["no", "yes"]
    assert len(data_of(folder, EventKind.GAME_PLAYED)) == 2
    acts = data_of(folder, EventKind.ACTED)
    # The game may end before the act of continuing arrives.
    assert sorted(str(each["act"]) for each in acts if each["act"] != "GoOnFromGame") == sorted(
        2 * ["EndGameAct", "Confirm"]
    )
    assert all(float(str(each["view_age_ms"])) > 0.0 for each in acts)
    assert len(list((folder / "recordings").rglob("*.bag"))) == 2


def test_a_game_whose_worker_is_killed_is_resumed_where_it_was(folder: Path) -> None:
    times: list[str] = []
    running = RunningGames.of(folder)

    async def kill(browser: BrowserClient) -> None:
        await browser.until(lambda: browser.tree.get("phase") == "playing" and browser.tree["tiles"])
        await asyncio.sleep(0.4)
        await browser.act(browser.tree["tiles"][0]["choose"]["act"])
        await browser.until(lambda: browser.tree["dialogue"] and browser.tree["dialogue"]["choices"])
        times.append(browser.tree["dialogue"]["title"])
        (key,) = running
        killed = running.address(key)
        assert killed is not None
        before = browser.whole_pages
        os.kill(killed.process, signal.SIGKILL)
        await browser.until(lambda: browser.whole_pages > before)
        await browser.until(lambda: browser.tree.get("dialogue") and browser.tree["dialogue"]["choices"])
        times.append(browser.tree["dialogue"]["title"])

    async def run() -> Conductor:
        async with served(folder, running) as (port, conductor):
            await person(port, "yes", kill)
        return conductor

    conductor = asyncio.run(asyncio.wait_for(run(), 280))
    (one,) = conductor.progress.runs.values()
    assert one.state is RunState.COMPLETE
    assert times[0] == times[1]
