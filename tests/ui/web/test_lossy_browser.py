"""A browser whose messages are lost, late or repeated does no act twice, and has the page of any other browser."""

from collections import Counter
from collections.abc import Sequence
from functools import cache

from hypothesis import given
from hypothesis import strategies as st

from tests.support.front_ends.at_browser import BrowserPerson
from thbridge.hunt.events import DialogueOpened, DialogueSaid, GameEnded, JournalEntry, RobotDeparted
from thbridge.study.study_file import Study
from ui.model.playing.screen import AnswerDialogueAct, ChooseRobot, RequestSuggestionAct, SelectRoomAct
from ui.web.page.patches import Json, tree
from ui.web.seat import PAGE_PERIOD

STUDY = Study(map="practice", templates="practice", robots=2, seed=4)
ACTS = (SelectRoomAct(1), AnswerDialogueAct(0), ChooseRobot(1), RequestSuggestionAct(), AnswerDialogueAct(0))

Fate = Sequence[str]
"""For each message of the browser: "sent", "lost", "twice", "late" (after the next one), or "again" (the browser
connects again before it)."""


class LossyBrowser(BrowserPerson):
    """Browser at an unreliable network; see `Fate`."""

    def __init__(self, study: Study) -> None:
        self.fates: list[str] = []
        self._late: list[dict[str, Json]] = []
        super().__init__(study)

    def send(self, message: dict[str, Json]) -> None:
        """Send a message as its fate wants."""
        fate = self.fates.pop() if self.fates and message["t"] == "act" else "sent"
        if fate == "late":
            self._late.append(message)
            return
        if fate == "lost":
            return
        if fate == "again":
            self.connect()
            self.wait(20)  # The browser paints the new page, and the message about the old one arrives late.
        super().send(message)
        if fate == "twice":
            super().send(message)
        late, self._late = self._late, []
        for each in late:
            super().send(each)


def play(fates: Fate) -> LossyBrowser:
    """Return a browser after the same acts, each pressed once; then the network is reliable."""
    browser = LossyBrowser(STUDY)
    browser.wait(40)
    browser.fates = list(reversed(fates))
    for act in ACTS:
        browser.send({"t": "act", "n": browser.number, "at": browser.now * 1000.0, "act": tree(act), "on_map": False})
        browser.wait(60)
    browser.fates = []
    browser.wait(100)
    return browser


@cache
def reliable() -> LossyBrowser:
    return play(())


def acts_of(entries: Sequence[JournalEntry]) -> Counter[str]:
    """Return how often each thing happened that follows from an act, without its time."""
    kinds = (DialogueOpened, DialogueSaid, RobotDeparted, GameEnded)
    return Counter(
        repr((type(entry).__name__, getattr(entry, "robot", None), getattr(entry, "text", "")))
        for entry in entries
        if isinstance(entry, kinds)
    )


@given(st.lists(st.sampled_from(("sent", "lost", "twice", "late", "again")), max_size=len(ACTS)))
def test_no_act_happens_twice_and_the_page_is_complete(fates: list[str]) -> None:
    browser = play(fates)
    opened = [entry for entry in browser.game.log.entries if isinstance(entry, DialogueOpened)]
    departures = [entry for entry in browser.game.log.events if isinstance(entry, RobotDeparted)]
    assert len(opened) <= sum(isinstance(act, SelectRoomAct | RequestSuggestionAct) for act in ACTS)
    assert len(departures) <= sum(isinstance(act, AnswerDialogueAct) for act in ACTS)
    if set(fates) <= {"sent", "twice"}:
        assert acts_of(browser.game.log.entries) == acts_of(reliable().game.log.entries)
    browser.now += PAGE_PERIOD
    browser.look()
    by_differences = browser.tree
    browser.connect()
    browser.look()
    assert browser.tree == by_differences
