"""Games in browsers: real sockets, real worker processes, and programs in place of browsers."""

import asyncio
from pathlib import Path

from tests.support.programs.browser_client import BrowserClient
from tests.support.studies.served_games import scenario


async def in_game(port: int) -> BrowserClient:
    """Return a browser that has begun a game."""
    browser = BrowserClient(port)
    await asyncio.to_thread(browser.load)
    await browser.open()
    await browser.until(lambda: browser.study and browser.study[-1]["t"] == "text")
    await browser.send({"type": "WentOn", "page": browser.study[-1]["page"]})
    await browser.until(lambda: browser.tree.get("phase") == "playing" and browser.tree["tiles"])
    return browser


def test_a_visitor_plays_a_game_reloads_and_is_back_where_they_were(tmp_path: Path) -> None:
    async def play(port: int) -> None:
        browser = await in_game(port)
        await asyncio.sleep(0.4)
        await browser.act(browser.tree["tiles"][0]["choose"]["act"])
        await browser.until(lambda: browser.tree["dialogue"] and browser.tree["dialogue"]["choices"])
        said = browser.tree["dialogue"]["sentences"]
        await browser.close()
        again = BrowserClient(port, browser.cookie)
        await asyncio.to_thread(again.load)
        assert again.cookie == browser.cookie
        await again.open()
        await again.until(lambda: again.tree and again.tree["dialogue"])
        assert again.tree["dialogue"]["sentences"][: len(said)] == said
        await asyncio.sleep(0.4)
        await again.press("Enter")
        await again.until(lambda: len(again.tree["history"]) > len(said))
        await again.close()

    scenario(tmp_path, play)
    assert len(list(tmp_path.glob("*.inputs"))) == 1


def test_a_second_tab_takes_over_a_game_and_the_first_one_is_informed(tmp_path: Path) -> None:
    async def play(port: int) -> None:
        first = await in_game(port)
        second = BrowserClient(port, first.cookie)
        await second.open()
        await second.until(lambda: second.shown["t"] == "elsewhere")
        await second.send({"t": "take over"})
        await second.until(lambda: second.tree.get("tiles"))
        await first.until(lambda: first.shown["t"] == "elsewhere")
        await first.press("E")
        await second.press("F1")
        await second.until(lambda: second.tree["question"] or second.tree["help"])
        assert not second.tree["question"], "the first tab no longer acts"
        await asyncio.gather(first.close(), second.close())

    scenario(tmp_path, play)


def test_a_browser_receives_no_treasure_before_it_is_found(tmp_path: Path) -> None:
    async def play(port: int) -> None:
        browser = await in_game(port)
        await asyncio.sleep(1.0)
        received = " ".join(browser.texts).lower()
        for name in ("green bottle", "green can", "green_bottle", "green_can"):
            assert name not in received
        await browser.close()

    scenario(tmp_path, play)
