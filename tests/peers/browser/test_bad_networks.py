"""Games over bad networks: slow and lossy, cut, and with another address. Nothing is lost or done twice."""

import asyncio
import json
import re
import subprocess
import time
from collections import Counter
from collections.abc import Awaitable, Callable, Iterator
from contextlib import suppress
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

import pytest
from websockets.exceptions import ConnectionClosed

from tests.support.programs.bad_cable import HERE, BadCable, bad_cable
from tests.support.programs.browser_client import BrowserClient
from tests.support.programs.processes import Program, until
from tests.support.programs.selenium_scripts import NEEDS_SELENIUM, SELENIUM
from thbridge.experiment.folder import ExperimentFolder
from thbridge.experiment.store.events import EventKind

STUDY = """\
title: Far away
base: {map: practice, templates: practice, robots: 1, rate: 2, server.port: 0, dialogue.condition: collaborator}
quota: 9
consent_elsewhere: People agreed before.
steps:
  - {step: trial, name: game, max_seconds: 2000}
"""
ACTS = 6

pytestmark = pytest.mark.slow


@dataclass
class FarStudy:
    """Study that is served to the other end of a cable.

    Attributes:
        folder: its folder.
        cable: the cable.
        port: port of the server.
    """

    folder: Path
    cable: BadCable
    port: int


@pytest.fixture
def study(tmp_path: Path) -> Iterator[FarStudy]:
    folder = tmp_path / "study"
    folder.mkdir()
    (folder / "experiment.yaml").write_text(STUDY)
    with bad_cable() as cable:
        options = ("--host", HERE, "--port", "0", "--open-to", "10.9.0.0/24")
        server = Program(tmp_path, "serve", "study", *options, by=cable.here_by)
        try:
            until("the server", lambda: "Open http" in server.text or server.process.poll() is not None, [server])
            found = re.search(rf"Open http://{HERE}:(\d+)/", server.text)
            assert found is not None, server.text
            yield FarStudy(folder, cable, int(found[1]))
            server.stop()
        finally:
            server.close()


@dataclass
class Reader:
    """Person at the far end who opens and closes the rules. An act that is lost or done twice leaves them as they were.

    Attributes:
        browser: their browser, which connects again like the page.
        acts: number of these acts.
    """

    browser: BrowserClient
    acts: int = 0

    async def act(self) -> None:
        """Open or close the rules; do not wait for the effect."""
        self.acts += 1
        with suppress(ConnectionClosed):  # Then the page sends the act when it is connected again.
            await self.browser.press("F1")

    async def see(self) -> None:
        """Wait for the effect of all acts."""
        await self.browser.until(self.has_seen, 120)

    def has_seen(self) -> bool:
        """Return True if the page shows the effect of all acts."""
        return bool(self.browser.tree["rules"]) == (self.acts % 2 == 1)


async def arrived(study: FarStudy, *, far: bool, cookie: str = "") -> BrowserClient:
    """Return a browser in the game, at one of the ends of the cable; with the cookie of another one, it takes over."""
    browser = BrowserClient(study.port, cookie, host=HERE, dial=partial(study.cable.dial, study.port, far=far))
    await asyncio.to_thread(browser.load)
    await browser.open()
    while not browser.tree.get("tiles"):
        if browser.shown.get("button"):
            await browser.press_button()
        await browser.received()
    return browser


async def end(study: FarStudy, cookie: str) -> dict[str, Any]:
    """Take over in a browser at the near end, and end the game; return the page that it has shown before."""
    other = await arrived(study, far=False, cookie=cookie)
    seen = other.tree
    await other.end_game()
    await other.until(lambda: other.shown["t"] == "text")
    await other.close()
    return seen


def check_acts(study: FarStudy, acts: int) -> None:
    """The log has each act once."""
    events = [entry.event for entry in ExperimentFolder(study.folder).entries()]
    kinds = Counter(event.data["act"] for event in events if event.kind == EventKind.ACTED)
    assert kinds["ShowHelp"] == acts
    assert kinds["SelectRoomAct"] <= 1


def scenario(study: FarStudy, suffer: Callable[[Reader], Awaitable[None]]) -> None:
    """Let a person at the far end act, suffer from the network, and act again; check the page and the log."""

    async def play() -> int:
        reader = Reader(await arrived(study, far=True))
        connecting = asyncio.create_task(reader.browser.keep_connected())
        await asyncio.sleep(0.5)
        await reader.browser.act(reader.browser.tree["tiles"][0]["choose"]["act"])
        await reader.browser.until(lambda: reader.browser.tree["history"])
        await suffer(reader)
        study.cable.set()
        # The rules are closed in the end.
        for _ in range(2 - reader.acts % 2):
            await reader.act()
            await reader.see()
        connecting.cancel()
        page = reader.browser.tree
        await reader.browser.close()
        other = await end(study, reader.browser.cookie)
        for part in ("history", "score", "queue", "cards", "rules"):
            assert other[part] == page[part], part
        return reader.acts

    check_acts(study, asyncio.run(asyncio.wait_for(play(), 280)))


def test_a_slow_and_lossy_network_loses_nothing_and_does_nothing_twice(study: FarStudy) -> None:
    async def suffer(reader: Reader) -> None:
        study.cable.set(0.3, 0.05)
        for _ in range(ACTS):
            await reader.act()
            await reader.see()

    scenario(study, suffer)


def test_after_a_minute_without_a_network_the_person_is_back_with_what_they_have_done(study: FarStudy) -> None:
    async def suffer(reader: Reader) -> None:
        study.cable.set(cut=True)
        await reader.act()  # The page does not know yet that the network is gone.
        await asyncio.sleep(60.0)
        assert not reader.has_seen()
        study.cable.set()
        await reader.see()

    scenario(study, suffer)


def test_with_another_address_the_person_is_back_with_what_they_have_done(study: FarStudy) -> None:
    async def suffer(reader: Reader) -> None:
        for number in (3, 4):
            study.cable.change_address(f"10.9.0.{number}")
            await reader.act()
            await reader.see()

    scenario(study, suffer)


class FarChromium:
    """Chromium at the far end of the cable."""

    def __init__(self, study: FarStudy) -> None:
        script = Path(__file__).with_name("far_chromium.py")
        self._process = subprocess.Popen(
            [*study.cable.there_by, SELENIUM, script, f"http://{HERE}:{study.port}/"],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
        )

    def ask(self, line: str) -> dict[str, Any]:
        """Let the person do something; return what the page shows then."""
        assert self._process.stdin is not None
        assert self._process.stdout is not None
        print(line, file=self._process.stdin, flush=True)
        return json.loads(self._process.stdout.readline())

    def shows(self, *, rules: bool) -> None:
        """Wait until the page is connected, and shows the rules or not."""
        until("the page", lambda: (page := self.ask("state"))["rules"] == rules and not page["lost"], [])

    def close(self) -> None:
        """End the program."""
        with suppress(BrokenPipeError):
            self._process.communicate("quit\n", 60)


@NEEDS_SELENIUM
def test_chromium_is_back_after_a_minute_without_a_network_and_with_another_address(study: FarStudy) -> None:
    chromium = FarChromium(study)
    try:
        chromium.ask("begin")
        chromium.ask("rules")
        chromium.shows(rules=True)
        study.cable.set(cut=True)
        chromium.ask("rules")
        time.sleep(60.0)
        assert chromium.ask("state")["lost"]
        study.cable.set()
        chromium.shows(rules=False)
        for number, rules in ((3, True), (4, False)):
            study.cable.change_address(f"10.9.0.{number}")
            chromium.ask("rules")
            chromium.shows(rules=rules)
        page = chromium.ask("state")
    finally:
        chromium.close()
    assert asyncio.run(asyncio.wait_for(end(study, page["cookie"]), 60))["rules"] == []
    check_acts(study, 4)
