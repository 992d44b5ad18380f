"""Votes, hand-over and hidden data in the window."""

from dataclasses import replace

from PySide6.QtCore import Qt
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication

from tests.support.windows import sample_screens
from ui.model.playing.screen import Action, CastVote, HandOverAct, OpenVote, SelectRoomAct, VoteAct

USUAL = sample_screens.playing()
VOTE = OpenVote(
    3,
    0,
    "The driver proposes that robot 1 goes to room 3.",
    (CastVote("The namer agrees.", True),),
    "1 more person must agree.",
    "0:40 left",
    Action(VoteAct(3, True), "Agree", "Y"),
    Action(VoteAct(3, False), "Disagree", "N"),
)


def voting(**changes):
    return replace(USUAL, votes=(replace(VOTE, **changes),))


def test_a_vote_is_over_the_map_and_is_cast_with_the_reason(opened):
    shown = opened(voting())
    (row,) = shown.window.map_area.votes.votes
    assert row.isVisible()
    assert (row.title.text(), row.left.text(), row.needed.text()) == (VOTE.title, VOTE.left, VOTE.needed)
    row.reason.setText(" too far ")
    row.buttons.buttons[1].click()
    assert shown.done[-1] == VoteAct(3, False, "too far")
    assert row.reason.text() == ""


def test_keys_that_are_typed_into_a_reason_do_nothing_else(opened):
    shown = opened(voting())
    reason = shown.window.map_area.votes.votes[0].reason
    reason.setFocus()
    QTest.keyClicks(reason, "n3")
    QTest.keyClick(reason, Qt.Key.Key_Return)
    assert reason.text() == "n3"
    assert not any(isinstance(act, VoteAct | SelectRoomAct) for act in shown.done)
    QTest.keyClick(reason, Qt.Key.Key_Escape)
    assert not reason.hasFocus()


def test_a_reason_stays_while_the_clock_of_the_vote_runs(opened):
    shown = opened(voting())
    shown.window.map_area.votes.votes[0].reason.setText("too")
    shown.show(voting(left="0:39 left"))
    (row,) = shown.window.map_area.votes.votes
    assert (row.reason.text(), row.left.text()) == ("too", "0:39 left")
    shown.show(USUAL)
    assert not shown.window.map_area.votes.isVisible()


def test_hidden_energy_score_and_map_leave_no_bar_number_or_map(opened):
    cards = tuple(replace(card, energy=None, cost=None) for card in USUAL.cards)
    tiles = tuple(replace(tile, cost=None) for tile in USUAL.tiles)
    shown = opened(replace(USUAL, cards=cards, tiles=tiles, score=None, no_map="In this game, you do not see the map."))
    window = shown.window
    assert not window.top.score.isVisible()
    assert not window.map.isVisible()
    usual = opened(USUAL).window.column.cards.cards[0].face.sizeHint().height()
    assert window.column.cards.cards[0].face.sizeHint().height() < usual


def test_the_buttons_of_a_card_are_next_to_each_other(opened):
    driving = replace(
        USUAL.cards[0], holder="You", hand_over=Action(HandOverAct(0), "Hand over", "R"), stop=USUAL.cards[0].stop
    )
    shown = opened(replace(USUAL, cards=(driving, *USUAL.cards[1:])))
    QApplication.processEvents()
    card = shown.window.column.cards.cards[0]
    assert card.hand_over.isVisible()
    if driving.stop is not None:
        assert not card.stop.geometry().intersects(card.hand_over.geometry())
    card.hand_over.click()
    assert shown.done[-1] == HandOverAct(0)
