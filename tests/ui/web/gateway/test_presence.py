"""Presence of people in browsers: absences are logged, and after the grace period the study's rule applies."""

import asyncio
import time
from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace

import pytest

from tests.support.programs.browser_client import BrowserClient
from tests.support.studies.served_study import served
from tests.support.studies.study_events import data_of
from thbridge.experiment.conductor import Conductor
from thbridge.experiment.store.events import EventKind, RunState
from ui.web.gateway import presence

STUDY = """\
title: Here and away
base: {map: practice, templates: practice, robots: 1, rate: 10, server.port: 0}
quota: 1
presence: {grace: 60, page_grace: 600, then: end}
recruiting: {endings: {timed_out: AWAY-CODE}}
steps:
  - {step: instructions, text: welcome.txt}
  - {step: trial, name: game, max_seconds: 3600}
"""


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    (tmp_path / "welcome.txt").write_text("This study waits for you.\n")
    (tmp_path / "experiment.yaml").write_text(STUDY)
    return tmp_path


@pytest.fixture
def pass_time(monkeypatch: pytest.MonkeyPatch) -> Callable[[float], None]:
    """Return a function that sets the watch's clock this many seconds forward."""
    ahead = [0.0]
    monkeypatch.setattr(presence, "time", SimpleNamespace(monotonic=lambda: time.monotonic() + ahead[0]))
    monkeypatch.setattr(presence, "LOOK_PERIOD", 0.05)

    def pass_time(seconds: float) -> None:
        ahead[0] = seconds

    return pass_time


def kinds(conductor: Conductor) -> list[str]:
    """Return a list that grows with each event of the log."""
    seen: list[str] = []
    conductor.listeners.append(lambda logged: seen.append(logged.event.kind))
    return seen


def test_a_hidden_page_and_a_lost_connection_are_absences_with_times(
    folder: Path, pass_time: Callable[[float], None]
) -> None:
    async def run() -> None:
        async with served(folder) as (port, conductor):
            seen = kinds(conductor)
            browser = await BrowserClient.arrived(port)
            await browser.press_button()
            await browser.until(lambda: EventKind.CONNECTION_MEASURED in seen)
            browser.visible = False
            await browser.until(lambda: EventKind.ABSENT in seen)
            browser.visible = True
            await browser.until(lambda: EventKind.PRESENT in seen)
            await browser.close()
            pass_time(300.0)
            await browser.until(lambda: seen.count(EventKind.ABSENT) == 2)
            pass_time(0.0)
            back = await BrowserClient.arrived(port, cookie=browser.cookie)
            await back.until(lambda: seen.count(EventKind.PRESENT) == 2)
            await back.until(lambda: "waits for you" in back.shown["html"])
            await back.close()

    asyncio.run(asyncio.wait_for(run(), 120))
    assert [each["connected"] for each in data_of(folder, EventKind.ABSENT)] == [True, False]
    for event in (*data_of(folder, EventKind.ABSENT), *data_of(folder, EventKind.PRESENT)):
        assert float(str(event["seconds"])) > 0.0 and event["round_trip_ms"] is not None
    measured, *_ = data_of(folder, EventKind.CONNECTION_MEASURED)
    assert float(str(measured["greatest_round_trip_ms"])) > 0.0


def test_a_person_who_stays_away_from_a_game_loses_the_place_and_reads_why(
    folder: Path, pass_time: Callable[[float], None]
) -> None:
    async def run() -> Conductor:
        async with served(folder) as (port, conductor):
            seen = kinds(conductor)
            browser = await BrowserClient.arrived(port)
            await browser.press_button()
            await browser.press_button()
            await browser.until(lambda: browser.tree.get("phase") == "playing")
            await browser.close()
            pass_time(20.0)
            await browser.until(lambda: EventKind.ABSENT in seen)
            assert EventKind.RUN_ENDED not in seen
            pass_time(70.0)
            await browser.until(lambda: EventKind.RUN_ENDED in seen)
            pass_time(0.0)
            other = await BrowserClient.arrived(port)
            await other.until(lambda: other.shown["heading"] == "Welcome", 60.0)
            back = await BrowserClient.arrived(port, cookie=browser.cookie)
            await back.until(lambda: back.shown.get("ending"))
            assert back.shown["ending"]["code"] == "AWAY-CODE"
            assert "You were away" in back.shown["html"] and "is saved" in back.shown["html"]
            await asyncio.gather(other.close(), back.close())
        return conductor

    conductor = asyncio.run(asyncio.wait_for(run(), 200))
    (one,) = conductor.progress.runs.values()
    assert (one.state, one.reason, one.absent) == (RunState.LEFT, "absent for more than 60 s", True)


def test_a_person_who_never_comes_back_after_a_restart_loses_the_place_too(
    folder: Path, pass_time: Callable[[float], None]
) -> None:
    async def run() -> None:
        async with served(folder) as (port, conductor):
            browser = await BrowserClient.arrived(port)
            await browser.press_button()
            await browser.until(lambda: conductor.progress.runs)
            await browser.close()
        async with served(folder) as (port, conductor):
            pass_time(601.0)
            await browser.until(lambda: [run.state for run in conductor.progress.runs.values()] == [RunState.LEFT])

    asyncio.run(asyncio.wait_for(run(), 120))


def test_with_the_rule_wait_a_person_may_stay_away(folder: Path, pass_time: Callable[[float], None]) -> None:
    text = (folder / "experiment.yaml").read_text()
    (folder / "experiment.yaml").write_text(text.replace("then: end", "then: wait"))

    async def run() -> None:
        async with served(folder) as (port, conductor):
            seen = kinds(conductor)
            browser = await BrowserClient.arrived(port)
            await browser.press_button()
            await browser.until(lambda: conductor.progress.runs)
            await browser.close()
            pass_time(1e6)
            await browser.until(lambda: EventKind.ABSENT in seen)
            pass_time(0.0)
            back = await BrowserClient.arrived(port, cookie=browser.cookie)
            await back.until(lambda: EventKind.PRESENT in seen)
            assert [run.state for run in conductor.progress.runs.values()] == [RunState.UNDER_WAY]
            await back.close()

    asyncio.run(asyncio.wait_for(run(), 120))
