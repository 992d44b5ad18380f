"""The page of a game offers what the screen offers, and has no other words."""

from dataclasses import replace

import pytest

from tests.support.windows import sample_screens
from thbridge.files.language_texts import shipped_texts
from ui.model.playing.keys import act_for
from ui.model.playing.offers import offers
from ui.model.playing.screen import Action, DialoguePopup, OpenVote, RaiseObjectionAct, Screen, ShowNext, VoteAct
from ui.web.page.game_page import KEYS, BrowserPage, BrowserPageMaker, PageButton
from ui.web.page.messages import decode_act
from ui.web.page.patches import tree

STATES = sample_screens.states()


VOTE = OpenVote(
    3,
    0,
    "The driver proposes that robot 1 goes to room 3.",
    (),
    "1 more person must agree.",
    "0:40 left",
    Action(VoteAct(3, True), "Agree", "Y"),
    Action(VoteAct(3, False), "Disagree", "N"),
)


def page_of(screen: Screen) -> BrowserPage:
    maker = BrowserPageMaker(lambda picture: "" if picture is None else "picture")
    return maker.page(shipped_texts(), screen, (), None)


def buttons(value: object) -> list[PageButton]:
    """Return all buttons of a page."""
    match value:
        case PageButton():
            return [value]
        case tuple():
            return [each for part in value for each in buttons(part)]
        case _ if hasattr(value, "__dataclass_fields__"):
            return [each for name in value.__dataclass_fields__ for each in buttons(getattr(value, name))]
        case _:
            return []


@pytest.mark.parametrize("name", STATES)
def test_each_state_offers_the_acts_of_its_screen(name: str) -> None:
    screen = STATES[name]
    page = page_of(screen)
    shown = {repr(button.act) for button in buttons(page)}
    assert {repr(action.act) for action in offers(screen)} <= shown
    assert set(page.keys) == {key for key in KEYS if act_for(key, screen) is not None}
    assert isinstance(tree(page), dict)


def test_an_objection_is_on_the_page_and_comes_back_with_the_own_words() -> None:
    pop = DialoguePopup(
        0,
        "Robot 1: room 3",
        (("robot", "Shall I go?"), ("objection", "The scout objects: That room is too far.")),
        (),
        Action(ShowNext(), "Close", "Esc"),
        partner="the driver",
        objects=Action(RaiseObjectionAct(), "Object", "O"),
        own_words="Your own words",
    )
    page = page_of(replace(STATES["playing"], popup=pop))
    assert page.dialogue is not None and page.dialogue.objection is not None
    assert page.dialogue.objection.own_words == "Your own words"
    assert (page.dialogue.sentences[-1].who, page.dialogue.sentences[-1].speaker) == ("", "objection")
    assert "O" in page.keys
    given = tree(page.dialogue.objection.button.act)
    assert isinstance(given, dict)
    assert decode_act({**given, "text": "too far"}) == RaiseObjectionAct("too far")


def test_a_vote_is_on_the_page_and_comes_back_with_the_reason() -> None:
    page = page_of(replace(STATES["playing"], votes=(VOTE,)))
    (vote,) = page.votes
    assert [button.label for button in vote.buttons] == ["Agree", "Disagree"]
    assert {"Y", "N"} <= set(page.keys)
    sent = {**tree(vote.buttons[1].act), "reason": "too far"}
    assert decode_act(sent) == VoteAct(3, False, "too far")


def test_hidden_energy_and_score_are_not_on_the_page() -> None:
    usual = STATES["playing"]
    cards = tuple(replace(card, energy=None, cost=None) for card in usual.cards)
    page = page_of(replace(usual, cards=cards, score=None, no_map="In this game, you do not see the map."))
    assert (page.score, page.score_spoken) == ("", "")
    assert [(card.energy, card.left, card.kept) for card in page.cards] == [((), 0.0, 0.0)] * len(cards)
    assert all("nergy" not in card.select.spoken for card in page.cards if not card.trouble)
    assert page.no_map
