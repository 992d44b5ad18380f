"""A served study with a window on the server's machine: people at the window and in browsers take part in one study."""

import asyncio
import os
import signal
from pathlib import Path

import pytest

from tests.support.programs.browser_client import BrowserClient
from tests.support.programs.commands import refusal
from tests.support.programs.processes import run_thbridge
from tests.support.studies.joining_window import JoiningWindow
from tests.support.studies.kiosk_without_screen import TEXTS, Person, ShownWindow, headings
from tests.support.studies.served_study import served
from tests.support.studies.study_events import data_of
from tests.support.studies.team_at_browsers import go_on, playing
from thbridge.experiment.conductor import Conductor
from thbridge.experiment.store.events import EventKind, RunState
from thbridge.recording.journal import journal_path, read_journal
from thbridge.recording.recordings import journal_of
from ui.model.kiosk import TurnToAwait
from ui.web.pool.running_games import RunningGames

STUDY = """\
title: At a window and in browsers
seed: 3
base: {map: practice, templates: practice, robots: 1, rate: 10, server.port: 0}
quota: 4
steps:
  - {step: consent, text: consent.txt}
  - {step: trial, name: game, max_seconds: 300}
"""
TEAM = """\
title: Three at a window and in browsers
seed: 3
base:
  map: practice
  templates: practice
  robots: 2
  rate: 10
  seats:
    - {name: north, label: the north, robots: [1], names_treasures: false}
    - {name: south, label: the south, robots: [2], sees_map: false}
    - {name: judge, label: the judge}
  team: {agreement: {end: one}}
quota: 6
consent_elsewhere: People agreed before.
steps:
  - {step: trial, name: game, max_seconds: 300}
"""


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    (tmp_path / "consent.txt").write_text("This is the text of the consent.\n")
    (tmp_path / "experiment.yaml").write_text(STUDY)
    return tmp_path


@pytest.mark.parametrize(
    ("options", "said"),
    [
        (("study.yaml", "--kiosk"), "--kiosk needs a study with people. Name its folder, or use `thbridge play`"),
        ((".", "--kiosk", "--games", "0", "--scheduler", "tls://10.0.0.1:8786"), "Write at least 1."),
        ((".", "--windowed"), "--windowed belongs to --kiosk. Give both, or neither."),
        ((".", "--kiosk"), "No display is available"),
    ],
)
def test_a_kiosk_that_cannot_open_is_refused_before_anything_starts(
    folder: Path, monkeypatch: pytest.MonkeyPatch, options: tuple[str, ...], said: str
) -> None:
    monkeypatch.chdir(folder)
    for name in ("DISPLAY", "WAYLAND_DISPLAY", "QT_QPA_PLATFORM"):
        monkeypatch.delenv(name, raising=False)
    assert said in " ".join(refusal("serve", *options).split())


def test_the_kiosk_alone_refuses_games_of_several_people_and_names_the_command_for_them(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("experiment.yaml").write_text(TEAM)
    assert "thbridge serve . --kiosk" in " ".join(refusal("study", "run", ".").split())


async def in_browser(port: int, playing: asyncio.Event) -> None:
    """Go through the study in a browser; set `playing` when the game has begun."""
    browser = await BrowserClient.arrived(port)
    await browser.press_button()
    await browser.until(lambda: browser.shown["t"] == "consent")
    await asyncio.sleep(0.45)
    await browser.send({"type": "ConsentReply", "page": browser.shown["page"], "agrees": True, "window_ns": 1})
    await browser.until(lambda: browser.tree.get("phase") == "playing" and browser.tree["tiles"], 120)
    playing.set()
    await browser.end_game()
    await browser.until(lambda: browser.shown["heading"] == TEXTS.text("kiosk.thank_you"))
    await browser.close()


async def at_window(conductor: Conductor) -> None:
    """Wait until the person at the window has read the last page."""
    async with asyncio.timeout(120):
        while not any(run.farewell_read for run in conductor.progress.runs.values()):
            await asyncio.sleep(0.05)


def test_people_at_the_window_and_in_browsers_take_part_at_the_same_time(folder: Path) -> None:
    person = Person()

    async def run() -> tuple[Conductor, JoiningWindow]:
        both_play = asyncio.Event()
        window = JoiningWindow(person, 1, both_play)
        async with served(folder, window=window) as (port, conductor):
            await in_browser(port, both_play)
            await at_window(conductor)
        return conductor, window

    conductor, window = asyncio.run(asyncio.wait_for(run(), 280))
    runs = {run.front_end: run for run in conductor.progress.runs.values()}
    assert {*runs} == {"window", "browser"}
    assert [run.state for run in runs.values()] == [RunState.COMPLETE, RunState.COMPLETE]
    (joined,) = window.joined
    assert (joined.seat, joined.agreed_at) == ("", runs["window"].agreed_at) and joined.agreed_at
    played = data_of(folder, EventKind.GAME_PLAYED)
    assert len(played) == 2 and all((folder / str(each["bag"])).is_file() for each in played)
    assert TEXTS.text("kiosk.thank_you") in headings(person)


async def beginning(port: int) -> BrowserClient:
    """Return a browser whose person has begun the study, and waits for others or plays."""
    browser = await BrowserClient.arrived(port)
    await browser.press_button()
    await browser.until(lambda: browser.shown["t"] in {"turn", "game"})
    return browser


@pytest.mark.slow
def test_a_person_at_the_window_and_people_in_browsers_play_one_game_that_survives_a_kill(
    tmp_path: Path,
) -> None:
    (tmp_path / "experiment.yaml").write_text(TEAM)
    person = Person()

    async def run() -> tuple[Conductor, JoiningWindow]:
        may_end, running = asyncio.Event(), RunningGames.of(tmp_path)
        window = JoiningWindow(person, 1, may_end)
        async with served(tmp_path, running, window) as (port, conductor):
            async with asyncio.timeout(60):
                while not any(isinstance(page, TurnToAwait) for page in person.seen):
                    await asyncio.sleep(0.05)
            browsers = [await beginning(port), await beginning(port)]
            await asyncio.gather(*map(playing, browsers))
            before = [browser.whole_pages for browser in browsers]
            (key,) = running
            worker = running.address(key)
            assert worker is not None
            os.kill(worker.process, signal.SIGKILL)
            for browser, pages in zip(browsers, before, strict=True):
                await browser.until(lambda browser=browser, pages=pages: browser.whole_pages > pages)
                await playing(browser)
            may_end.set()  # The person at the window ends the game for all.
            await asyncio.gather(*map(go_on, browsers), at_window(conductor))
            for browser in browsers:
                await browser.close()
        return conductor, window

    conductor, window = asyncio.run(asyncio.wait_for(run(), 280))
    runs = [*conductor.progress.runs.values()]
    assert [run.front_end for run in runs] == ["window", "browser", "browser"]
    assert {run.state for run in runs} == {RunState.COMPLETE}
    (group,) = conductor.progress.groups.values()
    assert group.people == dict(zip(("north", "south", "judge"), (run.participant for run in runs), strict=True))
    assert {game.seat for game in window.joined} == {"north"}
    assert len(window.joined) == 2, "the window joins the process that continues the game"
    (bag,) = (tmp_path / "recordings").rglob("*.bag")
    assert {str(each["bag"]) for each in data_of(tmp_path, EventKind.GAME_PLAYED)} == {str(bag.relative_to(tmp_path))}
    assert read_journal(journal_path(journal_of(bag), 1)).state.ended is not None
    assert run_thbridge(tmp_path, "replay", str(bag)).returncode == 0


def test_the_researcher_reads_that_the_window_was_closed_and_browsers_go_on(folder: Path) -> None:
    reported: list[str] = []

    async def run() -> None:
        async with served(folder, window=ShownWindow(Person(), 0), reported=reported) as (port, _):
            async with asyncio.timeout(60):
                while not reported:
                    await asyncio.sleep(0.05)
            browser = await BrowserClient.arrived(port)
            await browser.press_button()
            await browser.until(lambda: browser.shown["t"] == "consent")
            await browser.close()

    asyncio.run(asyncio.wait_for(run(), 120))
    (sentence,) = reported
    assert sentence.startswith("The window of the study is closed.")
