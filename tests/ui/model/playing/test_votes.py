"""Votes of the people in a game of several seats, robots of teammates, and dialogues of teammates."""

import pytest

from tests.support.hunts.participant_views import model_of, view
from tests.support.hunts.people_in_a_hunt import ALL_AGREE, HuntOfPeople
from thbridge.hunt.events import CommanderChanged, DecisionProposed, GameEnded, RobotDeparted, VoteCast
from thbridge.roles.shared.notices import PoseTelemetry
from thbridge.roles.shared.view import SendRobot
from ui.model.playing.keys import act_for
from ui.model.playing.offers import offer, offers
from ui.model.playing.screen import (
    AnswerDialogueAct,
    Cancel,
    ChooseRobot,
    Confirm,
    DialoguePopup,
    EndGameAct,
    HandOverAct,
    HandOverTo,
    IdentifyTreasureAct,
    LeaveTreasureAct,
    PickName,
    RequestHandbackAct,
    SelectRoomAct,
    StopRobotAct,
    TreasurePopup,
    VoteAct,
)


@pytest.fixture
def hunt():
    playing = HuntOfPeople(voting=ALL_AGREE)
    playing.run()
    return playing


def entries(hunt, kind):
    return [entry for entry in hunt.hunt.log.entries if isinstance(entry, kind)]


def propose(hunt, room=3):
    """Let the driver agree with robot 1 on a room; the others then vote."""
    driver = hunt.people["driver"]
    driver.do(SelectRoomAct(room))
    hunt.run(12)
    agree(hunt, driver)


def agree(hunt, person):
    while isinstance(person.screen.popup, DialoguePopup) and person.screen.popup.choices:
        person.do(AnswerDialogueAct(0))
        hunt.run(12)


def vote(hunt, seat, agrees, reason="", decision=1):
    hunt.people[seat].do(VoteAct(decision, agrees, reason))
    hunt.run()


def arrive(hunt):
    """Send robot 1 to room 3 with everybody's agreement, and wait until it is there."""
    propose(hunt)
    vote(hunt, "namer", True)
    vote(hunt, "scout", True)
    hunt.run(60)


def test_one_participant_has_no_votes_no_hand_over_and_none_of_their_keys():
    screen = model_of(view()).screen(0.0)
    assert screen.votes == ()
    assert [(card.holder, card.hand_over) for card in screen.cards] == [("", None)] * len(screen.cards)
    assert [act_for(key, screen) for key in ("R", "Y", "N")] == [None] * 3


def test_the_others_see_who_proposes_what_and_vote_by_key(hunt):
    propose(hunt)
    (seen,) = hunt.people["namer"].screen.votes
    assert seen.title == "The driver proposes that robot 1 goes to room 3."
    assert (seen.needed, [button.label for button in seen.buttons]) == (
        "2 more people must agree.",
        ["Agree", "Disagree"],
    )
    assert act_for("Y", hunt.people["namer"].screen) == VoteAct(1, True)
    assert act_for("N", hunt.people["namer"].screen) == VoteAct(1, False)


def test_the_proposer_sees_that_the_others_vote_and_proposes_once(hunt):
    propose(hunt)
    driver = hunt.people["driver"]
    (seen,) = driver.screen.votes
    assert (seen.title, seen.buttons) == ("You propose that robot 1 goes to room 3.", ())
    assert seen.needed == "2 more people must agree. The others vote now."
    assert driver.screen.cards[0].state == "the team votes on room 3"
    assert SendRobot(0, 3) not in driver.model.requests()
    hunt.run(200)
    assert len(entries(hunt, DecisionProposed)) == 1


def test_the_robot_drives_after_the_last_vote_and_the_history_says_so(hunt):
    propose(hunt)
    vote(hunt, "namer", True, "close by")
    (seen,) = hunt.people["scout"].screen.votes
    assert ([cast.words for cast in seen.votes], seen.needed) == (
        ["The namer agrees: “close by”"],
        "1 more person must agree.",
    )
    assert not entries(hunt, RobotDeparted)
    vote(hunt, "scout", True)
    assert [event.robot for event in entries(hunt, RobotDeparted)] == [0]
    assert "The team has agreed: robot 1 goes to room 3." in hunt.people["driver"].history
    assert hunt.people["driver"].screen.votes == ()


def test_a_disagreement_ends_the_vote_and_the_same_can_be_proposed_again(hunt):
    propose(hunt)
    vote(hunt, "scout", False, "too\x1b far")
    driver = hunt.people["driver"]
    assert driver.history[-2:] == [
        "The scout disagrees: “too\\x1b far”",
        "The team does not agree: robot 1 does not go to room 3.",
    ]
    assert driver.screen.banner.text == "The team does not agree: robot 1 does not go to room 3."
    assert driver.screen.cards[0].state == "ready"
    hunt.run(200)
    assert len(entries(hunt, DecisionProposed)) == 1
    propose(hunt)
    assert [vote.decision for vote in driver.screen.votes] == [2]


def test_a_vote_can_be_changed_until_the_end(hunt):
    propose(hunt)
    vote(hunt, "namer", True)
    (seen,) = hunt.people["namer"].screen.votes
    assert (seen.agree.enabled, seen.disagree.enabled, seen.agree.key) == (False, True, "")
    vote(hunt, "namer", False)
    assert [entry.agrees for entry in entries(hunt, VoteCast)] == [True, False]


def test_the_time_left_is_that_of_the_game(hunt):
    propose(hunt)
    model = hunt.people["namer"].model
    at = entries(hunt, DecisionProposed)[0].at
    for seconds, words in ((10, "0:50 left"), (100, "0:00 left")):
        tick = round((at + seconds) / 0.02)
        model.receive(PoseTelemetry(tick, ((0.0, 0.0, 0.0),) * 3, ()), hunt.people["namer"].now)
        assert hunt.people["namer"].screen.votes[0].left == words


def test_the_end_of_the_game_is_voted_on(hunt):
    scout = hunt.people["scout"]
    scout.do(EndGameAct())
    scout.do(Confirm())
    hunt.run()
    assert hunt.people["namer"].screen.votes[0].title == "The scout proposes to end the game."
    assert (scout.screen.end.enabled, scout.screen.end.pending) == (False, False)
    assert scout.screen.end.hint == "The team votes on the end of the game."
    vote(hunt, "namer", True)
    vote(hunt, "driver", True)
    assert entries(hunt, GameEnded)
    assert scout.screen.ending.lines[0] == "The team has ended the game."


def test_the_name_of_a_treasure_is_voted_on(hunt):
    arrive(hunt)
    namer = hunt.people["namer"]
    pop = namer.screen.popup
    assert isinstance(pop, TreasurePopup)
    namer.do(PickName(pop.names[0]))
    namer.do(IdentifyTreasureAct())
    hunt.run()
    agree(hunt, namer)
    name = namer.tabui.view.word_for(pop.names[0])
    title = f"The namer proposes the name {name} for the treasure in room 3."
    assert hunt.people["scout"].screen.votes[0].title == title
    assert namer.screen.popup.talk == f"The team votes on the name {name}."
    vote(hunt, "scout", True, decision=2)
    vote(hunt, "driver", True, decision=2)
    assert namer.tabui.view.room(3).verdict is not None


def test_a_seat_that_may_not_name_sees_who_may_and_no_list(hunt):
    arrive(hunt)
    driver = hunt.people["driver"]
    pop = driver.screen.popup
    assert isinstance(pop, TreasurePopup)
    assert (pop.names, pop.asks_for_name) == ((), False)
    assert pop.talk == "Only the namer or the scout can name it."
    assert pop.take_picture is not None and pop.take_picture.enabled
    assert not {IdentifyTreasureAct(), LeaveTreasureAct()} & {action.act for action in offers(driver.screen)}


def test_a_teammates_find_opens_only_for_those_who_must_name_it(hunt):
    arrive(hunt)
    assert isinstance(hunt.people["namer"].screen.popup, TreasurePopup)
    pop = hunt.people["namer"].screen.popup
    assert not pop.take_picture.enabled
    assert pop.take_picture.hint == "Robot 1 is commanded by the driver. You can ask for it."


def test_a_robot_is_handed_over_to_the_teammate_who_is_chosen(hunt):
    driver = hunt.people["driver"]
    assert act_for("R", driver.screen) == HandOverAct()
    driver.do(HandOverAct())
    question = driver.screen.confirmation
    assert (question.title, [answer.label for answer in question.answers]) == (
        "Hand over robot 1?",
        ["The namer", "Keep it"],
    )
    driver.do(Cancel())
    assert driver.screen.confirmation is None
    driver.do(HandOverAct(1))
    driver.do(HandOverTo("namer"))
    hunt.run()
    assert [(event.robot, event.name) for event in entries(hunt, CommanderChanged)] == [(1, "namer")]
    assert [card.holder for card in driver.screen.cards] == ["You", "The namer", "The scout"]
    assert hunt.people["namer"].history[-1] == "You command robot 2 now."


def test_a_teammate_who_asks_for_a_robot_shows_on_its_card_and_is_offered_first(hunt):
    namer, scout = hunt.people["namer"], hunt.people["scout"]
    namer.do(RequestHandbackAct(2))
    hunt.run()
    assert namer.history[-1] == "You have asked for robot 3. The scout decides now."
    assert not offer(namer.screen, RequestHandbackAct(2)).enabled
    card = scout.screen.cards[2]
    assert (card.holder, card.asked_for) == ("The namer asks for it", True)
    assert scout.screen.banner.text == "The namer asks for robot 3. You can hand it over."
    scout.do(HandOverAct(2))
    assert scout.screen.confirmation.yes.act == HandOverTo("namer")
    # Only those who asked have asked.
    assert offer(hunt.people["driver"].screen, RequestHandbackAct(2)).enabled


def test_a_seat_that_takes_over_no_robots_is_not_offered_to_ask_for_them(hunt):
    scout = hunt.people["scout"]
    assert [card.ask_back for card in scout.screen.cards] == [None] * 3
    scout.do(ChooseRobot(0))
    scout.do(RequestHandbackAct())
    assert scout.screen.banner.text == "You cannot take it over."
    assert scout.screen.tiles[0].choose.hint == "Robot 1 is commanded by the driver. You cannot take it over."


def test_a_dialogue_of_a_teammate_shows_on_request_without_answers(hunt):
    hunt.people["driver"].do(SelectRoomAct(3))
    hunt.run(12)
    namer = hunt.people["namer"]
    assert (namer.screen.popup, namer.screen.waiting) == (None, ())
    assert namer.screen.cards[0].state == "is talking about where to go"
    namer.do(ChooseRobot(1))
    namer.do(ChooseRobot(0))
    pop = namer.screen.popup
    assert (pop.partner, pop.choices) == ("the driver", ())
    assert pop.note == "The driver talks with robot 1. You can read along."
    agree(hunt, hunt.people["driver"])
    assert ("teammate", "the driver", "Continue") in [
        (line.speaker, line.teammate, line.text) for line in namer.screen.history
    ]


def test_a_seat_that_stops_all_robots_is_offered_to_stop_those_of_teammates(hunt):
    propose(hunt)
    vote(hunt, "namer", True)
    vote(hunt, "scout", True)
    stops = {seat: hunt.people[seat].screen.cards[0].stop is not None for seat in ("driver", "namer", "scout")}
    assert stops == {"driver": True, "namer": True, "scout": False}
    hunt.people["namer"].do(StopRobotAct(0))
    hunt.run()
    assert hunt.people["driver"].tabui.view.robots[0].moving_to is None
