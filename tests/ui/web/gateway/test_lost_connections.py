"""Messages of a page whose connection breaks: none is lost, and none is processed twice."""

import asyncio
from contextlib import suppress
from pathlib import Path

import pytest
from websockets.exceptions import ConnectionClosed

from tests.support.programs.browser_client import BrowserClient
from tests.support.studies.served_study import served
from thbridge.experiment.store.events import EventKind, LoggedEvent
from ui.web.gateway.inbox import Inbox

FILES = {
    "experiment.yaml": """\
title: Broken connections
base: {map: practice, templates: practice, robots: 1, rate: 10, server.port: 0}
quota: 4
consent_elsewhere: People agreed before.
steps:
  - {step: form, form: why.yaml, name: why}
  - {step: trial, name: game, max_seconds: 400}
""",
    "why.yaml": "title: Why?\nitems: [{id: why, text: Why?, scale: text, required: false}]\n",
}


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    for name, content in FILES.items():
        (tmp_path / name).write_text(content)
    return tmp_path


def test_messages_on_broken_connections_arrive_once(folder: Path) -> None:
    pasted: list[object] = []

    def note(entry: LoggedEvent) -> None:
        if entry.event.kind == EventKind.TEXT_PASTED:
            pasted.append(entry.event.data["characters"])

    async def run() -> None:
        async with served(folder) as (port, conductor):
            conductor.listeners.append(note)
            browser = await BrowserClient.arrived(port)
            await browser.press_button()
            await browser.until(lambda: browser.shown["t"] == "form")
            news = {"type": "ItemNews", "page": browser.shown["page"], "item": "why", "what": "pasted", "window_ns": 1}
            for number in range(6):
                with suppress(ConnectionClosed):
                    await browser.send({**news, "characters": number})
                if number == 1:
                    # The server has processed these messages, but has not confirmed them.
                    await browser.until(lambda: len(pasted) == 2)
                    browser.abort()
            await browser.open()
            await browser.until(lambda: len(pasted) == 6)
            await browser.press_button()
            await browser.until(lambda: browser.tree.get("tiles"))
            await asyncio.sleep(0.4)  # The page ignores earlier acts.
            browser.abort()
            with suppress(ConnectionClosed):
                await browser.act(browser.tree["tiles"][0]["choose"]["act"])
            await browser.open()
            await browser.until(lambda: browser.tree["dialogue"])
            await browser.close()

    asyncio.run(asyncio.wait_for(run(), 120))
    assert pasted == [0, 1, 2, 3, 4, 5]


def test_an_inbox_counts_the_messages_of_one_tab() -> None:
    inbox = Inbox()
    assert not inbox.connect("a", 0)
    inbox.note(0)
    inbox.note(1)
    assert inbox.connect("a", 1), "the tab sends its second message again"
    assert [inbox.is_new(number) for number in (1, 2)] == [False, True]
    assert not inbox.connect("b", 5)
    assert inbox.is_new(5)
    assert not inbox.connect("", 0), "messages of a tab without a name have no numbers"
    inbox.note(0)
    assert not inbox.connect("", 0)
    assert inbox.is_new(0)
