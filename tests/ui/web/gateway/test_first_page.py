"""The first page of a participant: its text comes with the first answer, and all that it loads is small."""

import asyncio
import gzip
import re
from collections.abc import Iterator
from pathlib import Path

from tests.support.programs.browser_client import BrowserClient
from tests.support.studies.served_games import scenario
from tests.support.studies.served_study import served
from thbridge.files.language_texts import shipped_texts
from ui.model.kiosk import GameNews, GameToJoin, ResearcherMessage
from ui.web.gateway.browser_window import BrowserWindow

MOST_BYTES = 200_000
STUDY = """\
title: First page
base: {map: practice, templates: practice, robots: 1, rate: 10, server.port: 0}
quota: 1
consent_elsewhere: People agreed before.
steps:
  - {step: instructions, text: welcome.txt}
"""
LOADED = re.compile(r'(?:src|href|from|import\()[ =]?"(?P<address>[^"]+\.(?:js|css|svg))"')
ONE_MOMENT = "<h1>One moment</h1>"


async def got(port: int, path: str) -> tuple[int, str, str]:
    """Return the bytes of an answer as it was sent, its headers in lower case, and its body as text."""
    inside, outside = await asyncio.open_connection("127.0.0.1", port)
    outside.write(f"GET {path} HTTP/1.1\r\nHost: x\r\nAccept-Encoding: gzip\r\nConnection: close\r\n\r\n".encode())
    answer = await inside.read()
    outside.close()
    head, _, body = answer.partition(b"\r\n\r\n")
    headers = head.decode().lower()
    assert headers.startswith("http/1.1 200"), path
    return len(answer), headers, gzip.decompress(body).decode() if "encoding: gzip" in headers else body.decode()


def loaded(text: str, beside: str) -> Iterator[str]:
    """Yield the addresses of the files that a page or a script loads; `beside` is the folder of the script."""
    for found in LOADED.finditer(text):
        address = found["address"]
        yield f"{beside}{address.removeprefix('.')}" if address.startswith("./") else address


def test_the_first_page_and_all_its_files_take_less_than_200_kb(tmp_path: Path) -> None:
    async def measure(port: int) -> None:
        size, headers, page = await got(port, "/")
        assert "cache-control: no-store" in headers
        wanted, sizes = [*loaded(page, "")], {"/": size}
        while wanted:
            path = wanted.pop()
            assert path.startswith("/static/"), "nothing comes from another host"
            if path not in sizes:
                sizes[path], headers, text = await got(port, path)
                assert "immutable" in headers
                wanted += loaded(text, path.rpartition("/")[0])
        assert {name.rpartition("/")[2] for name in sizes} >= {"main.js", "dom.js", "study.js", "game.js", "map.js"}
        browser = await BrowserClient.arrived(port)
        await browser.until(lambda: browser.shown.get("button"))
        await browser.close()
        assert sum(sizes.values()) + sum(len(text.encode()) for text in browser.texts) < MOST_BYTES, sizes

    scenario(tmp_path, measure)


def test_the_first_answer_is_enough_to_read_the_first_page(tmp_path: Path) -> None:
    async def look(port: int) -> None:
        _, _, page = await got(port, "/")
        main = page.partition("<main")[2].partition("</main>")[0]
        browser = await BrowserClient.arrived(port)
        await browser.until(lambda: browser.shown.get("button"))
        assert browser.shown["html"] in main
        assert f"<h1>{browser.shown['heading']}</h1>" in main
        # No style sheet or script delays it.
        assert 'rel="stylesheet"' not in page
        assert all(re.search(r"defer|module", script) for script in re.findall(r"<script[^>]*>", page))
        await browser.close()

    scenario(tmp_path, look)


def test_the_page_of_a_game_is_found_behind_its_news() -> None:
    async def look() -> None:
        window = BrowserWindow(shipped_texts())
        for message in (GameToJoin(3, "", 0, "", False), GameNews(3, 30), ResearcherMessage("Hello")):
            await window.send(message)
        assert (window.page_of() or {})["t"] == "game"

    asyncio.run(look())


def test_a_page_that_is_loaded_again_begins_with_the_text_that_its_person_sees(tmp_path: Path) -> None:
    (tmp_path / "welcome.txt").write_text("Read **this**.\n")
    (tmp_path / "experiment.yaml").write_text(STUDY)

    async def run() -> None:
        async with served(tmp_path) as (port, _):
            first = BrowserClient(port)
            assert "You will go through this study page by page." in await asyncio.to_thread(first.load)
            await first.open()
            await first.press_button()
            await first.until(lambda: "Read" in first.shown["html"])
            assert first.shown["html"] in await asyncio.to_thread(BrowserClient(port, first.cookie).load)
            # All places are taken, so a newcomer waits, and the first text promises nothing.
            assert ONE_MOMENT in await asyncio.to_thread(BrowserClient(port).load)
            await first.press_button()
            await first.press_button()
            assert "The study is complete" in await asyncio.to_thread(BrowserClient(port).load)
            await first.close()
        async with served(tmp_path) as (port, _):
            # The server has been started again: it sends the text of the person's step when they connect.
            assert ONE_MOMENT in await asyncio.to_thread(BrowserClient(port, first.cookie).load)

    asyncio.run(asyncio.wait_for(run(), 120))
