"""The researcher's page of a served study: it shows everyone, and messages, exclusions and admission take effect."""

import asyncio
from collections.abc import Awaitable, Callable
from pathlib import Path

import pytest

from tests.support.programs.browser_client import BrowserClient
from tests.support.programs.desk_client import DeskClient
from tests.support.studies.served_study import served
from thbridge.credentials import Right
from thbridge.experiment.conductor import Conductor
from thbridge.experiment.folder import ExperimentFolder
from thbridge.experiment.store.events import EventKind, LoggedEvent, RunState
from thbridge.files.keys.certificate import certificate_of
from thbridge.files.keys.key_ring import KeyRing
from thbridge.sockets.keys import RingKeys, SingleKey
from thbridge.sockets.tls import server_context
from thbridge.timing.wall_clock import utc_now
from thbridge.watching.wire import BagStreamReader, SessionMessage
from ui.web.gateway import desk as desk_module

KEY = "a key that nobody can guess"
STUDY = """\
title: Two <b>people</b>
seed: 3
base: {map: practice, templates: practice, robots: 1, server.port: 0}
quota: 3
steps:
  - {step: instructions, text: welcome.txt, name: welcome}
  - {step: instructions, text: welcome.txt, name: more}
"""


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setattr(desk_module, "STATE_SECONDS", 0.0)
    monkeypatch.setattr(desk_module, "LOOK_SECONDS", 0.05)
    monkeypatch.setattr(desk_module, "WRONG_KEY_SECONDS", 0.0)
    (tmp_path / "welcome.txt").write_text("Welcome.\n")
    (tmp_path / "experiment.yaml").write_text(STUDY)
    return tmp_path


def scenario(folder: Path, play: Callable[[int, Conductor], Awaitable[None]], **changes: object) -> list[LoggedEvent]:
    """Serve the study, and return the events of its log."""

    async def run() -> None:
        async with served(folder, **{"keys": SingleKey(KEY), **changes}) as (port, conductor):
            await play(port, conductor)

    asyncio.run(asyncio.wait_for(run(), 120))
    return [entry for entry in ExperimentFolder(folder).entries() if isinstance(entry, LoggedEvent)]


async def begun(port: int, conductor: Conductor) -> tuple[BrowserClient, str]:
    """Return a person who has begun, and their id."""
    before = set(conductor.progress.runs)
    browser = await BrowserClient.arrived(port)
    await browser.until(lambda: browser.study and browser.study[-1].get("button"))
    await browser.send({"type": "WentOn", "page": browser.study[-1]["page"]})
    await browser.until(lambda: len(conductor.progress.runs) > len(before))
    (participant,) = set(conductor.progress.runs) - before
    await browser.until(lambda: "Welcome." in browser.study[-1].get("html", ""))
    return browser, participant


def test_the_researcher_sees_both_messages_one_and_excludes_the_other(folder: Path) -> None:
    ids: list[str] = []

    async def play(port: int, conductor: Conductor) -> None:
        (first, one), (second, other) = await begun(port, conductor), await begun(port, conductor)
        ids.extend((one, other))
        desk = await DeskClient.opened(port, KEY)
        await desk.until(lambda: desk.rows().keys() == {one, other})
        assert desk.page["title"] == "Desk: Two <b>people</b>"
        assert desk.rows()[one][1:3] == ["in progress", "1 of 2: welcome"]
        assert desk.rows()[one][5] == "present"
        assert list(desk.actions(one)) == ["Message", "Stop run", "Exclude"]

        await desk.send({**desk.actions(one)["Message"]["request"], "text": "Please <i>hurry</i>."})
        await desk.until(lambda: one in desk.page["told"])
        await first.until(lambda: first.study[-1]["t"] == "message")
        assert first.study[-1]["text"] == "Please <i>hurry</i>."
        assert not [message for message in second.study if message["t"] == "message"]
        await first.send({"type": "MessageClosed"})
        await desk.until(lambda: any(row[4] == "Read" for row in desk.rows(2).values()))

        await desk.send({**desk.actions(other)["Exclude"]["request"], "reason": f"like {one}"})
        await desk.until(lambda: "Do not name" in desk.page["told"])
        await desk.send({**desk.actions(other)["Exclude"]["request"], "reason": "asked a friend"})
        await desk.until(lambda: desk.rows()[other][1:3] == ["excluded", "asked a friend"])
        await second.until(lambda: second.study[-1]["heading"] == "The study ends here")
        assert "Welcome." in [message for message in first.study if message["t"] == "text"][-1]["html"]

        await second.close()
        await first.close()
        await desk.until(lambda: desk.rows()[one][5] == "not connected")

    events = {event.event.kind: event.event for event in scenario(folder, play)}
    message, excluded = events[EventKind.MESSAGE_SENT], events[EventKind.RUN_EXCLUDED]
    assert (message.participant, message.data) == (ids[0], {"text": "Please <i>hurry</i>.", "author": "researcher"})
    assert events[EventKind.MESSAGE_CLOSED].participant == ids[0]
    assert (excluded.participant, excluded.actor) == (ids[1], "experimenter")


def test_a_message_to_all_reaches_people_who_come_back_and_a_run_can_be_stopped(folder: Path) -> None:
    async def play(port: int, conductor: Conductor) -> None:
        browser, one = await begun(port, conductor)
        await browser.close()
        desk = await DeskClient.opened(port, KEY)
        await desk.until(lambda: desk.page)
        await desk.send({**desk.page["actions"][0]["request"], "text": "We go on at noon."})
        await desk.until(lambda: desk.page["told"])
        browser.study.clear()
        await browser.open()
        await browser.until(lambda: "message" in [message["t"] for message in browser.study])
        await desk.send({**desk.actions(one)["Stop run"]["request"], "reason": "a fire alarm"})
        await desk.until(lambda: desk.rows()[one][1] == "left")
        await browser.until(lambda: browser.study[-1]["heading"] == "Thank you")
        assert conductor.progress.runs[one].state is RunState.LEFT

    scenario(folder, play)


def test_a_message_is_shown_after_a_restart_until_it_is_closed(folder: Path) -> None:
    people: list[tuple[BrowserClient, str]] = []

    async def begin(port: int, conductor: Conductor) -> None:
        people.append(await begun(port, conductor))
        desk = await DeskClient.opened(port, KEY)
        await desk.until(lambda: desk.page)
        await desk.send({"type": "MessagePeople", "text": "We go on at noon.", "participant": people[0][1]})
        await desk.until(lambda: desk.page["told"])

    async def come_back(port: int, _conductor: Conductor) -> None:
        browser = await BrowserClient.arrived(port, cookie=people[0][0].cookie)
        await browser.until(lambda: any(each.get("text") == "We go on at noon." for each in browser.study))
        await browser.send({"type": "MessageClosed"})
        browser.study.clear()
        await browser.close()
        await browser.open()
        await browser.until(lambda: browser.study and browser.study[-1]["t"] == "text")
        assert not [each for each in browser.study if each["t"] == "message"]

    scenario(folder, begin)
    scenario(folder, come_back)


def test_closed_admission_lets_no_one_begin_until_it_is_open_again(folder: Path) -> None:
    async def play(port: int, conductor: Conductor) -> None:
        desk = await DeskClient.opened(port, KEY)
        await desk.until(lambda: desk.page)
        await desk.send(desk.page["actions"][1]["request"])
        await desk.until(lambda: desk.page["actions"][1]["label"] == "Open admission")
        browser = await BrowserClient.arrived(port)
        await browser.until(lambda: browser.study and browser.study[-1].get("heading") == "Please wait for a place")
        await desk.send(desk.page["actions"][1]["request"])
        await browser.until(lambda: browser.study[-1].get("heading") != "Please wait for a place")
        assert not conductor.progress.runs
        await browser.close()

    events = [event.event.kind for event in scenario(folder, play)]
    assert events == [EventKind.ADMISSION_CLOSED, EventKind.ADMISSION_OPENED]


def test_wrong_keys_and_malformed_requests_get_nothing(folder: Path) -> None:
    async def play(port: int, conductor: Conductor) -> None:
        for number in range(35):
            desk = await DeskClient.opened(port, "x" * number)
            await desk.until(lambda desk=desk: desk.refused)
            await desk.socket.wait_closed()
            assert desk.socket.close_code == 4401
            assert not desk.page
        assert "too many" in desk.refused.lower()

    scenario(folder, play)


def test_a_key_that_may_only_watch_changes_nothing_and_ends_when_it_is_revoked(folder: Path, tmp_path: Path) -> None:
    ring = KeyRing(tmp_path / "keys", utc_now)
    ring.add("dora", [Right.WATCH], "dora-0123456789abcdef", None)
    ring.add("cleo", [Right.PARTICIPANT], "cleo-0123456789abcdef", None)
    ring.add("lab", [Right.INTERVENE], "lab-0123456789abcdef", None)
    keys = RingKeys(ring, server_context(certificate_of(tmp_path / "keys", utc_now())))

    async def play(port: int, conductor: Conductor) -> None:
        _, one = await begun(port, conductor)
        participant = await DeskClient.opened(port, "cleo-0123456789abcdef")
        await participant.until(lambda: participant.refused)
        lab = await DeskClient.opened(port, "lab-0123456789abcdef")
        await lab.until(lambda: lab.page)
        await lab.send({"type": "MessagePeople", "text": "Hello.", "participant": one})
        await lab.until(lambda: lab.rows(2) and next(iter(lab.rows(2).values()))[2] == "lab")
        desk = await DeskClient.opened(port, "dora-0123456789abcdef")
        await desk.until(lambda: desk.page)
        assert not desk.page["actions"] and not desk.actions(one)
        await desk.send({"type": "ExcludeRun", "participant": one, "reason": "no"})
        await desk.until(lambda: "viewing only" in desk.page["told"])
        assert conductor.progress.runs[one].state is RunState.UNDER_WAY
        ring.revoke("dora")
        await desk.socket.wait_closed()
        assert desk.socket.close_code == 4401

    scenario(folder, play, keys=keys)


def test_a_game_can_be_watched_on_request(folder: Path) -> None:
    (folder / "experiment.yaml").write_text(
        "title: Watched\nbase: {map: practice, templates: practice, robots: 1, server.port: 0}\nquota: 1\n"
        "consent_elsewhere: Participants agreed on paper.\nsteps:\n  - {step: trial, name: game, max_seconds: 600}\n"
    )

    async def play(port: int, conductor: Conductor) -> None:
        browser = await BrowserClient.arrived(port)
        await browser.until(lambda: browser.study and browser.study[-1].get("button"))
        await browser.send({"type": "WentOn", "page": browser.study[-1]["page"]})
        await browser.until(lambda: browser.tree.get("phase") == "playing")
        (one,) = conductor.progress.runs
        desk = await DeskClient.opened(port, KEY)
        await desk.until(lambda: desk.page and "Watch game" in desk.actions(one))
        assert desk.page["sentences"][1] == "Games running: 1. Games that can still start: 1."
        await desk.send(desk.actions(one)["Watch game"]["request"])
        await desk.until(lambda: desk.page["tables"][0]["rows"][0]["command"])
        command = desk.page["tables"][0]["rows"][0]["command"]
        assert command.startswith("thbridge watch 127.0.0.1:")
        inside, outside = await asyncio.open_connection("127.0.0.1", int(command.rpartition(":")[2]))
        stream, topics = BagStreamReader(), set[str]()
        while "/map" not in topics:
            messages = stream.feed(await inside.read(2**16))
            topics |= {message.topic for message in messages if isinstance(message, SessionMessage)}
        outside.close()
        await browser.close()

    scenario(folder, play)
