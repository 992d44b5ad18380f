"""Page in Chromium that cannot go on: it says so, and what to do; the gateway prints the cause once."""

from collections.abc import Iterator

import pytest

from tests.support.programs.chromium import CHROMIUM, Chromium
from tests.support.programs.shown_pages import NO_SOCKET, PageState, StateServer
from thbridge.files.language_texts import shipped_texts
from ui.model.kiosk import TextToRead

pytestmark = pytest.mark.skipif(not CHROMIUM.exists(), reason="Chromium is not installed (make peers, as root)")

TEXTS = shipped_texts()
MODULES = ("main.js", "dom.js", "study.js", "game.js", "map.js", "patches.js", "people.js", "sounds.js")


@pytest.fixture(scope="module")
def server() -> Iterator[StateServer]:
    with StateServer(TEXTS).running() as running:
        running.state = PageState("text", (TextToRead(1, "Please read", "This is a text.", "Go on"),))
        yield running


@pytest.fixture
def browser() -> Iterator[Chromium]:
    with Chromium() as running:
        yield running


def words(browser: Chromium) -> str:
    return str(browser.evaluate("document.body.innerText"))


def test_each_script_that_does_not_load_leads_to_a_sentence(
    server: StateServer, browser: Chromium, caplog: pytest.LogCaptureFixture
) -> None:
    for module in MODULES:
        browser.open(server.address, blocked=[f"*{module}"])
        browser.until("document.querySelector('#failed:not([hidden])').offsetParent !== null")
        assert TEXTS.text("web.failed_text") in words(browser)
        assert TEXTS.text("web.load_again") in words(browser)
    assert "did not load" in caplog.text


def test_an_error_in_a_script_is_shown_and_printed_once(
    server: StateServer, browser: Chromium, caplog: pytest.LogCaptureFixture
) -> None:
    browser.open(server.address)
    browser.until("document.querySelector('#main button:not([disabled])') !== null")
    browser.evaluate("setTimeout(() => { throw new Error('first fault') })")
    browser.evaluate("void Promise.reject(new Error('second fault'))")
    browser.until("document.querySelector('#failed').offsetParent !== null")
    assert TEXTS.text("web.failed") in words(browser)
    browser.until("performance.getEntriesByType('resource').some((each) => each.name.endsWith('/trouble'))")
    assert caplog.text.count("fault") == 1


@pytest.mark.parametrize("missing", ["delete window.HTMLDialogElement", "CSS.supports = () => false"])
def test_a_browser_that_is_too_old_is_asked_for_a_newer_one(
    server: StateServer, browser: Chromium, missing: str
) -> None:
    browser.open(server.address, before=missing)
    assert TEXTS.text("web.too_old") in words(browser)
    assert "This is a text." not in words(browser)


def test_without_scripts_the_page_says_what_it_needs(server: StateServer, browser: Chromium) -> None:
    browser.command("Emulation.setScriptExecutionDisabled", value=True)
    browser.open(server.address)
    assert TEXTS.text("web.needs_script") in words(browser)


def test_if_no_script_runs_at_all_a_sentence_appears(server: StateServer, browser: Chromium) -> None:
    browser.open(server.address, blocked=["*.js"])
    assert browser.evaluate("document.querySelector('#too-old').textContent") == TEXTS.text("web.needs_newer")
    # It appears by its style alone, after some seconds.
    browser.evaluate("document.getAnimations().forEach((each) => each.finish())")
    assert browser.evaluate("getComputedStyle(document.querySelector('#too-old')).visibility") == "visible"


def test_a_lost_connection_is_named(server: StateServer, browser: Chromium) -> None:
    browser.open(server.address, before=NO_SOCKET)
    browser.until("document.querySelector('#connection').offsetParent !== null")
    assert TEXTS.text("web.lost") in words(browser)
