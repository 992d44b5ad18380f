"""Several tabs of one person: one is live, the others are informed and may take over."""

import asyncio
from pathlib import Path

import pytest

from tests.support.programs.browser_client import BrowserClient
from tests.support.studies.served_study import served
from ui.web.gateway import app

STUDY = """\
title: Two tabs
base: {map: practice, templates: practice, robots: 1, rate: 10, server.port: 0}
quota: 2
steps:
  - {step: instructions, text: welcome.txt}
  - {step: trial, name: game, max_seconds: 40}
"""


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    (tmp_path / "welcome.txt").write_text("This study has two tabs.\n")
    (tmp_path / "experiment.yaml").write_text(STUDY)
    return tmp_path


def test_a_second_tab_is_informed_and_takes_over_only_if_the_person_says_so(folder: Path) -> None:
    async def run() -> None:
        async with served(folder) as (port, _):
            first = await BrowserClient.arrived(port)
            await first.until(lambda: first.shown["heading"] == "Welcome")
            second = await BrowserClient.arrived(port, cookie=first.cookie)
            await second.until(lambda: second.shown["t"] == "elsewhere")
            assert [message["t"] for message in second.study] == ["elsewhere"], "nothing of the study is shown twice"
            await first.press_button()
            await first.until(lambda: "two tabs" in first.shown["html"])

            await second.send({"t": "take over"})
            await second.until(lambda: "two tabs" in second.shown["html"])
            await first.until(lambda: first.shown["t"] == "elsewhere")
            await second.close()
            await first.until(lambda: "two tabs" in first.shown["html"])
            await first.close()

    asyncio.run(asyncio.wait_for(run(), 120))


def test_a_page_that_is_loaded_again_or_connects_again_is_not_asked(folder: Path) -> None:
    async def run() -> None:
        async with served(folder) as (port, _):
            first = await BrowserClient.arrived(port)
            await first.until(lambda: first.shown["heading"] == "Welcome")
            # The page connects from another network address; its earlier connection is still open.
            again = BrowserClient(port, first.cookie, tab=first.tab)
            await again.open()
            await again.until(lambda: again.shown["heading"] == "Welcome")
            # The page is loaded again; the earlier connection closes after the new one is open.
            loaded = await BrowserClient.arrived(port, cookie=first.cookie)
            await again.close()
            await loaded.until(lambda: loaded.shown["heading"] == "Welcome")
            assert "elsewhere" not in [message["t"] for browser in (again, loaded) for message in browser.study]
            await asyncio.gather(first.close(), loaded.close())

    asyncio.run(asyncio.wait_for(run(), 120))


def test_a_tab_takes_over_from_one_whose_connection_is_lost(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(app, "SILENCE", 3.0)

    async def run() -> None:
        async with served(folder) as (port, _):
            first = await BrowserClient.arrived(port)
            await first.until(lambda: first.shown["heading"] == "Welcome")
            first.answers = False
            second = await BrowserClient.arrived(port, cookie=first.cookie)
            await second.until(lambda: second.shown["heading"] == "Welcome")
            await asyncio.gather(first.close(), second.close())

    asyncio.run(asyncio.wait_for(run(), 120))
