"""Keys and focus of the page in Chromium: each key of the windows reaches the game under its name."""

import json
import time
from collections.abc import Iterator
from dataclasses import replace

import pytest

from tests.support.programs.chromium import CHROMIUM, Chromium
from tests.support.programs.shown_pages import PageState, StateServer, shown_game
from tests.support.windows import sample_screens
from thbridge.files.language_texts import shipped_texts
from ui.model.kiosk import GameToJoin, InstructionsSoFar, InstructionText, StudyProgress
from ui.web.page.game_page import KEYS

pytestmark = pytest.mark.skipif(not CHROMIUM.exists(), reason="Chromium is not installed (make peers, as root)")

DOM = {"Esc": "Escape", "Space": " ", "Up": "ArrowUp", "Down": "ArrowDown"}
"""Names of keys in the DOM that differ from the project's names."""
GAME = "document.querySelector('.playing:not([hidden]) .tile') !== null"


@pytest.fixture(scope="module")
def server() -> Iterator[StateServer]:
    with StateServer(shipped_texts()).running() as running:
        yield running


@pytest.fixture(scope="module")
def browser() -> Iterator[Chromium]:
    with Chromium() as running:
        running.resize(1280, 800)
        yield running


def show(server: StateServer, browser: Chromium, name: str, *, keys: tuple[str, ...] | None = None) -> None:
    """Show a sample state; `keys` replaces the keys that have an act."""
    texts = shipped_texts()
    game = shown_game(texts, sample_screens.states()[name], (), sample_screens.floor_plan())
    if keys is not None:
        game = replace(game, page=replace(game.page, keys=keys))
    instructions = InstructionsSoFar((InstructionText("Send the robots."),))
    joined = GameToJoin(1, "", 0, "", False, progress=StudyProgress(2, 3))
    server.state = PageState(name, (instructions, joined), game)
    browser.open(server.address)
    browser.until(GAME)


def press(browser: Chromium, key: str) -> None:
    """Press a key by the project's name for it."""
    *held, last = [key] if len(key) == 1 else key.split("+")
    named = DOM.get(last, last)
    browser.press(
        named.lower() if "Ctrl" in held else named, ctrl="Ctrl" in held, shift="Shift" in held or named == "?"
    )


def sent(server: StateServer, browser: Chromium, last: str) -> list[str]:
    """Return the keys that the gateway has received when it has received the last one."""
    end = time.monotonic() + 60
    while True:
        messages = [json.loads(text) for text in server.received]
        keys = [message["key"] for message in messages if message["t"] == "key"]
        if last in keys or time.monotonic() > end:
            return keys
        browser.evaluate("new Promise(requestAnimationFrame)")


def test_each_key_of_the_windows_reaches_the_game(server: StateServer, browser: Chromium) -> None:
    show(server, browser, "playing", keys=KEYS)
    server.received.clear()
    wanted = [key for key in KEYS if key != "Ctrl+,"]
    for key in wanted:
        press(browser, key)
    assert sent(server, browser, wanted[-1]) == wanted


def test_a_key_without_an_act_stays_with_the_browser(server: StateServer, browser: Chromium) -> None:
    show(server, browser, "playing", keys=("F1",))
    server.received.clear()
    for key in ("D", "X", "F1"):
        press(browser, key)
    assert sent(server, browser, "F1") == ["F1"]


def test_f6_visits_all_regions_and_comes_back(server: StateServer, browser: Chromium) -> None:
    show(server, browser, "dialogue")
    visited = []
    for _ in range(8):
        browser.press("F6")
        visited.append(browser.evaluate("document.activeElement.closest('[aria-label]').ariaLabel"))
    assert len(set(visited[:7])) == 7
    assert visited[7] == visited[0]


def test_arrow_keys_lead_into_the_answers(server: StateServer, browser: Chromium) -> None:
    show(server, browser, "dialogue")
    browser.press("ArrowDown")
    assert browser.evaluate("document.activeElement.querySelector('.label').textContent") == "Continue"
    browser.press("ArrowDown")
    assert browser.evaluate("document.activeElement.querySelector('.label').textContent") == "Stop"


@pytest.mark.parametrize("opened", ["Ctrl+,", "read again", "stop"])
def test_a_closed_dialog_returns_the_focus(server: StateServer, browser: Chromium, opened: str) -> None:
    show(server, browser, "playing")
    browser.evaluate("document.querySelector('.face').focus()")
    if opened == "Ctrl+,":
        browser.press(",", ctrl=True)
    else:
        button = f"[...document.querySelectorAll('#strip .acts button')].at({0 if opened == 'read again' else -1})"
        browser.evaluate(f"{button}.focus()")
        browser.evaluate(f"{button}.click()")
    before = browser.evaluate("document.querySelector('dialog[open]') !== null")
    assert before
    browser.press("Escape")
    browser.until("document.querySelector('dialog[open]') === null")
    focused = browser.evaluate("document.activeElement.className + document.activeElement.textContent")
    assert focused.startswith("face") if opened == "Ctrl+," else "quiet" in focused


def test_the_focus_is_visible(server: StateServer, browser: Chromium) -> None:
    show(server, browser, "playing", keys=())
    browser.press("Tab")
    assert browser.evaluate("getComputedStyle(document.activeElement).outlineStyle") == "solid"
