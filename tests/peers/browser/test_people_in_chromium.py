"""Panel of the people of a game in Chromium: writing, reading, and keys."""

import json
import time
from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import pytest

from tests.support.programs.chromium import CHROMIUM, Chromium
from tests.support.programs.shown_pages import PageState, StateServer, shown_game
from tests.support.windows import sample_screens
from thbridge.files.language_texts import shipped_texts
from ui.model.kiosk import GameToJoin, TurnToAwait
from ui.model.playing.screen import Action, DialoguePopup, RaiseObjectionAct, ShowNext

pytestmark = pytest.mark.skipif(not CHROMIUM.exists(), reason="Chromium is not installed (make peers, as root)")

IN_ANOTHER_TAB = """
document.hasFocus = () => false;
WebSocket = class extends WebSocket { constructor(...given) { super(...given); window.socket = this; } };
"""
"""JavaScript after which the page does not have the focus, and its socket can be used."""
FIELD = "document.querySelector('.people textarea')"


@pytest.fixture(scope="module")
def server() -> Iterator[StateServer]:
    with StateServer(shipped_texts()).running() as running:
        yield running


@pytest.fixture(scope="module")
def browser() -> Iterator[Chromium]:
    with Chromium() as running:
        yield running


def show(
    server: StateServer,
    browser: Chromium,
    *,
    width: int = 1440,
    name: str = "people",
    popup: DialoguePopup | None = None,
) -> None:
    screen = sample_screens.states()[name]
    screen = screen if popup is None else replace(screen, popup=popup)
    game = shown_game(shipped_texts(), screen, (), sample_screens.floor_plan())
    game = replace(game, page=replace(game.page, keys=("T", "X", "O", "Enter")))
    server.state = PageState(name, (GameToJoin(1, "", 0, "", False),), game)
    browser.resize(width, 800, touch=width < 500)
    server.received.clear()
    browser.open(server.address)
    browser.until("document.querySelector('.playing:not([hidden]) .tile') !== null")


def sent(server: StateServer, browser: Chromium, kind: str) -> list[dict[str, Any]]:
    """Return the acts and keys that the gateway has received, up to the last one of this kind."""
    end = time.monotonic() + 60
    while True:
        messages = [json.loads(text) for text in server.received]
        done = [each.get("act") or {"act": each["key"]} for each in messages if each["t"] in ("act", "key")]
        # The page may report meanwhile that a line was read.
        while done and done[-1]["act"] != kind:
            del done[-1]
        if done or time.monotonic() > end:
            return done
        browser.evaluate("new Promise(requestAnimationFrame)")


def test_the_title_calls_back_a_person_who_waits_in_another_tab(server: StateServer, browser: Chromium) -> None:
    server.state = PageState("turn", (TurnToAwait(1, "Please wait", "The others come."),))
    browser.open(server.address, IN_ANOTHER_TAB)
    browser.until("document.querySelector('.waiting-page') !== null")
    title = browser.evaluate("document.title")
    ready = json.dumps({"t": "wait", "page": 2, "heading": "One moment", "text": "", "step": "", "share": 0})
    browser.evaluate(f"socket.dispatchEvent(new MessageEvent('message', {{data: {json.dumps(ready)}}}))")
    browser.until(f"document.title === {json.dumps(f'● {title}')}")
    browser.evaluate("window.dispatchEvent(new Event('focus'))")
    assert browser.evaluate("document.title") == title


def test_a_game_of_one_participant_has_no_panel(server: StateServer, browser: Chromium) -> None:
    show(server, browser, name="playing")
    shown = "['.people', '.people-switch'].some((each) => document.querySelector(each).offsetParent)"
    assert browser.evaluate(shown) is False


def test_keys_write_a_text_and_enter_sends_it(server: StateServer, browser: Chromium) -> None:
    show(server, browser)
    assert browser.evaluate(f"{FIELD}.value") == "1 2 3"
    browser.press("t")
    browser.until(f"document.activeElement === {FIELD}")
    browser.evaluate(f"{FIELD}.value = ''")
    for key in "xt":
        browser.press(key)
    browser.press("Enter")
    done = [act for act in sent(server, browser, "SayToPeopleAct") if act["act"] != "MarkReadAct"]
    assert done == [
        {"act": "WriteText", "text": "x"},
        {"act": "WriteText", "text": "xt"},
        {"act": "SayToPeopleAct", "to": "", "text": "xt"},
    ]
    assert browser.evaluate(f"{FIELD}.value") == ""
    browser.press("Escape")
    browser.press("x")
    assert sent(server, browser, "X")[-1] == {"act": "X"}


def test_the_key_and_the_button_object_with_the_words_of_the_field(server: StateServer, browser: Chromium) -> None:
    objection = "The scout objects: That room is too far."
    popup = DialoguePopup(
        0,
        "Robot 1: room 3",
        (("robot", "Shall I go?"), ("objection", objection)),
        (),
        Action(ShowNext(), "Close", "Esc"),
        partner="the driver",
        objects=Action(RaiseObjectionAct(), "Object", "O"),
        own_words="Your own words",
    )
    show(server, browser, popup=popup)
    field = "document.querySelector('.objection input')"
    assert browser.evaluate("document.querySelector('.said [data-speaker=objection]').textContent") == objection
    browser.evaluate(f"{field}.focus()")
    browser.press("o")
    assert browser.evaluate(f"{field}.value") == "o"
    assert "RaiseObjectionAct" not in "".join(server.received)
    browser.evaluate(f"{field}.blur()")
    browser.press("o")
    assert sent(server, browser, "RaiseObjectionAct")[-1] == {"act": "RaiseObjectionAct", "text": "o"}
    show(server, browser, popup=replace(popup, objects=None, own_words=""))
    assert browser.evaluate(f"{field}.offsetParent") is None


def test_texts_are_read_when_they_are_on_the_screen(server: StateServer, browser: Chromium) -> None:
    show(server, browser, width=360)
    assert browser.evaluate("document.querySelector('.people-switch').textContent") == "Team · 1"
    assert server.received == [] or "MarkReadAct" not in "".join(server.received)
    browser.evaluate("document.querySelector('.people-switch').click()")
    assert sent(server, browser, "MarkReadAct")[-1] == {"act": "MarkReadAct", "line": 3}
    browser.until("document.querySelector('.people-switch').hidden")


def test_the_chosen_addressee_reaches_the_game(server: StateServer, browser: Chromium) -> None:
    show(server, browser)
    browser.evaluate(
        "(() => { const chooser = document.querySelector('.people select'); chooser.selectedIndex = 2;"
        " chooser.dispatchEvent(new Event('change')); })()"
    )
    assert sent(server, browser, "ChooseAddressee")[-1] == {"act": "ChooseAddressee", "seat": "scout"}


@pytest.mark.parametrize("width", [360, 800, 1024, 1440])
def test_the_panel_fits_the_page(server: StateServer, browser: Chromium, width: int) -> None:
    show(server, browser, width=width)
    assert browser.evaluate("document.documentElement.scrollWidth <= innerWidth")
    parts = "[...document.querySelectorAll('.people > :not([hidden])')]"
    low = "part.getBoundingClientRect().bottom <= part.parentElement.getBoundingClientRect().bottom + 1"
    inside = f"{parts}.every((part) => {low})"
    assert browser.evaluate(inside)
