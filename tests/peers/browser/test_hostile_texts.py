"""Scripts in every text that a person, a study or a recording may contain stay texts, in Chromium."""

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import msgspec
import pytest
from msgspec import structs

from tests.support.hunts.recorded_hunts import record_beginning
from tests.support.programs.chromium import CHROMIUM, Chromium
from tests.support.programs.shown_pages import PageState, ShownGame, StateServer, shown_game
from tests.support.windows import sample_screens
from thbridge.analysis.report.builder import read_report
from thbridge.files.language_texts import shipped_texts
from thbridge.recording.bag.reading.reader import messages
from thbridge.study.study_file import Study
from ui.model.kiosk import FormItem, FormToFill, GameToJoin, InstructionsSoFar, InstructionText, ResearcherMessage
from ui.web.page.patches import tree
from ui.web.player.content import PlayedRecording
from ui.web.player.gathering import GameContext, floor_of, played_game
from ui.web.player.page import page_of, words_of

pytestmark = pytest.mark.skipif(not CHROMIUM.exists(), reason="Chromium is not installed (make peers, as root)")

TEXTS = shipped_texts()
HOSTILE = (
    "</script></div><img src=x onerror='pwned = 1'><script>pwned = 1</script><svg onload='pwned = 1'>"
    "<x-pwned>A</x-pwned>"
)
CODES = {
    *("act", "pick", "phase", "speaker", "picture", "enlarged", "sound", "keys", "key", "drawn"),
    *("mark", "language", "words", "walls", "unknown", "times", "values", "steps", "state"),
}
"""Fields that are not texts for people."""
FOREIGN = "[onerror], [onload], img[src='x'], x-pwned, main script, iframe, object"
"""Selector of what the hostile texts would become as HTML."""


def hostile(value: Any, name: str = "") -> Any:
    """Return a tree with a hostile text in the place of each text for people."""
    match value:
        case str():
            return value if not value or name in CODES else HOSTILE
        case list():
            return [hostile(each, name) for each in value]
        case dict():
            return {key: each if key in CODES - {"words"} else hostile(each, key) for key, each in value.items()}
        case _:
            return value


@pytest.fixture(scope="module")
def server() -> Iterator[StateServer]:
    with StateServer(TEXTS).running() as running:
        yield running


@pytest.fixture(scope="module")
def browser() -> Iterator[Chromium]:
    with Chromium() as running:
        yield running


def assert_harmless(browser: Chromium, least: int) -> None:
    """Check that the page shows the hostile text, at least this often, and that none of it has become an element."""
    assert browser.evaluate("document.body.textContent").count(HOSTILE) >= least
    assert browser.evaluate(f'document.querySelectorAll("{FOREIGN}").length') == 0
    assert browser.evaluate("typeof pwned") == "undefined"


@pytest.mark.parametrize(
    "name", ["dialogue", "arguing", "questions", "naming", "picture", "commanded", "question", "over", "people"]
)
def test_names_of_robots_and_what_people_and_robots_say(server: StateServer, browser: Chromium, name: str) -> None:
    plan = sample_screens.floor_plan()
    rooms = tuple(replace(room, name=HOSTILE) for room in plan.rooms)
    game = shown_game(TEXTS, sample_screens.states()[name], floor=structs.replace(plan, rooms=rooms))
    page = hostile(tree(game.page))
    for card in page["cards"]:
        card["state"] = HOSTILE
    shown = ShownGame(page, game.floor, {})
    server.state = PageState(name, (ResearcherMessage(HOSTILE), GameToJoin(1, "", 0, "", False)), shown)
    browser.open(server.address)
    browser.until(f"document.body.textContent.split({HOSTILE!r}).length > 10")
    assert_harmless(browser, 10)


def test_forms_answers_and_instructions(server: StateServer, browser: Chromium) -> None:
    item = FormItem("a", HOSTILE, "choice", options=(HOSTILE,), labels=(HOSTILE,))
    typed = FormItem("b", HOSTILE, "text")
    form = FormToFill(1, HOSTILE, HOSTILE, (item, typed), {"b": HOSTILE})
    read = InstructionsSoFar((InstructionText(HOSTILE), InstructionText(HOSTILE, markdown=True)))
    server.state = PageState("form", (read, form))
    browser.open(server.address)
    browser.until("!!document.querySelector('textarea')?.value")
    browser.evaluate("document.querySelector('#strip .acts button').click()")
    browser.until("document.querySelector('#sheet').open")
    assert browser.evaluate("document.querySelector('textarea').value") == HOSTILE
    assert_harmless(browser, 6)


def test_the_player_of_a_recording(browser: Chromium, tmp_path: Path) -> None:
    bag = record_beginning(tmp_path / "hunt.bag", 2, 16.0)
    report = read_report(messages(bag))
    assert report.grid is not None
    game = played_game(report, GameContext(None, TEXTS), several=False)
    floor = floor_of(report.grid, (), report.rooms, Study())
    recording = PlayedRecording("en", words_of(TEXTS), floor, (), (game,))
    content = hostile(msgspec.to_builtins(recording))
    page = page_of(msgspec.convert(content, PlayedRecording), HOSTILE, HOSTILE)
    (tmp_path / "player.html").write_text(page)
    browser.open((tmp_path / "player.html").as_uri())
    browser.until("document.querySelector('#entries')?.textContent")
    assert_harmless(browser, 8)


def test_a_draft_that_the_game_put_back(server: StateServer, browser: Chromium) -> None:
    game = shown_game(TEXTS, sample_screens.states()["people"])
    people = ShownGame(hostile(tree(game.page)), game.floor, {})
    server.state = PageState("draft", (GameToJoin(1, "", 0, "", False),), people)
    browser.open(server.address)
    browser.until("!!document.querySelector('.people textarea')?.value")
    assert browser.evaluate("document.querySelector('.people textarea').value") == HOSTILE
    assert_harmless(browser, 4)
