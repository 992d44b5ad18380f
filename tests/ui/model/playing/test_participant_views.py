"""The screen after single views, and after messages on the robots' progress."""

from base64 import b64encode
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st
from msgspec import structs

from tests.support.hunts.participant_views import asking, model_of, refusal, texts, view, with_robot, with_room
from thbridge.hunt.events import Condition
from thbridge.roles.shared.notices import (
    Ellipse,
    FloorPlan,
    PicturePiece,
    PlannedPaths,
    PoseTelemetry,
    RobotMotion,
    RoomOutline,
)
from thbridge.roles.shared.view import (
    AnswerDialogue,
    Consent,
    Debrief,
    EndGame,
    GiveConsent,
    IdentificationVerdict,
    IdentifyTreasure,
    LeaveTreasure,
    PlayAgain,
    RequestSuggestion,
    RoomDebrief,
    SelectRoom,
    SendRobot,
    SenseTreasure,
    StopRobot,
)
from ui.model.playing.keys import act_for
from ui.model.playing.participant import Participant
from ui.model.playing.screen import (
    AnswerDialogueAct,
    ChooseRobot,
    Confirm,
    ConsiderRoom,
    EndGameAct,
    FitMap,
    FollowRobot,
    GiveConsentAct,
    GoOnFromGame,
    IdentifyTreasureAct,
    LeaveTreasureAct,
    Phase,
    PickName,
    PlayAgainAct,
    RequestSuggestionAct,
    SelectRoomAct,
    ShowHelp,
    ShowNext,
    ShowWaiting,
    StopRobotAct,
    TypeDigit,
)

UNDER_WAY = with_room(with_robot(view(), 0, moving_to=3, energy=93.0), 3, state="reserved", robot=0)
FOUND = structs.replace(
    with_room(
        with_robot(view(), 0, place=3),
        3,
        state="visited",
        robot=0,
        sensed={"colour": "Pink", "footprint": "Round and Large"},
    ),
    names=("ball", "can"),
)
HOUSE = FloorPlan(
    "hall",
    0.05,
    (0.0, 0.0, 0.0),
    10,
    10,
    "",
    (
        RoomOutline(1, "Kitchen", ((0.0, 0.0), (1.0, 0.0), (1.0, 1.0)), (0.5, 0.5, 0.0)),
        RoomOutline(2, "", (), (0,) * 3),
    ),
    ((0.1, 0.1), (-0.1, 0.1), (-0.1, -0.1)),
)


def where(tick, *motions, x=0.0, ellipses=None):
    return PoseTelemetry(tick, ((x, 0.0, 0.0),) * 2, motions or (RobotMotion(), RobotMotion()), ellipses)


def test_before_there_is_a_game_it_says_what_it_waits_for():
    model = Participant()
    screen = model.screen(0.0)
    assert (screen.phase, screen.waiting_for) == (
        Phase.CONNECTING,
        "Connecting to the game.",
    )
    model.receive(view(ready=False), 0.1)
    assert model.screen(0.1).phase is Phase.CONNECTING
    model.connected(0.2)
    assert model.screen(0.2).waiting_for == "Connected to the game. The robots are getting ready."
    model.lost("Nobody answers.", 1.0)
    screen = model.screen(1.0)
    assert screen.waiting_for == "Cannot reach the game. Nobody answers. Reconnecting…"
    assert screen.banner.text.startswith("The connection to the game is lost. Nobody answers. Reconnecting…")
    model.connected(2.0)
    model.receive(view(), 2.0)
    assert model.screen(2.0).phase is Phase.PLAYING


def test_consent_comes_before_everything_else():
    times = iter(("2026-11-23T09:30:00Z", "2026-11-23T09:30:05Z"))
    model = Participant(lambda: next(times))
    model.connected(0.0)
    model.receive(view(consent="May we record what you do?"), 0.0)
    screen = model.screen(0.0)
    assert (screen.phase, screen.consent) == (Phase.CONSENT, "May we record what you do?")
    model.do(SelectRoomAct(1), 0.0)
    assert model.requests() == ()
    model.do(GiveConsentAct(), 0.0)
    model.do(GiveConsentAct(), 0.0)
    assert model.requests() == (GiveConsent("2026-11-23T09:30:00Z"),), "the time of the first yes"
    assert model.screen(0.0).agree.pending
    model.receive(view(), 1.0)
    assert (model.screen(1.0).phase, model.requests()) == (Phase.PLAYING, ())


def test_the_screen_is_the_same_object_while_nothing_changes():
    model = model_of(UNDER_WAY, where(1, RobotMotion("driving", None, 0.101), RobotMotion()))
    screen = model.screen(0.0)
    for tick in range(2, 20):
        model.receive(where(tick, RobotMotion("driving", None, 0.1 + tick * 0.0001), RobotMotion()), tick * 0.04)
        assert model.screen(tick * 0.04) is screen
    model.receive(where(21, RobotMotion("driving", None, 0.2), RobotMotion()), 0.84)
    assert model.screen(0.84) is not screen
    assert model.screen(0.84).cards[0].progress == 0.2


MOTIONS = st.builds(
    RobotMotion,
    st.sampled_from(["driving", "resting", "waiting", "planning", "clearing"]),
    st.sampled_from([None, 1]),
    st.sampled_from([0.0, 0.104, 0.106, 0.7]),
    makes_way_for=st.sampled_from([None, 0]),
)


@given(
    st.sampled_from([view(), UNDER_WAY, FOUND, structs.replace(UNDER_WAY, dialogues=(asking(1, 2),))]),
    st.sampled_from([None, SelectRoomAct(2), ChooseRobot(1), TypeDigit(2)]),
    st.lists(st.tuples(MOTIONS, MOTIONS), min_size=1, max_size=4),
)
@example(
    UNDER_WAY, SelectRoomAct(2), [(RobotMotion("driving", None, share), RobotMotion()) for share in (0.1, 0.1, 0.7)]
)
def test_motions_change_the_screen_as_if_all_of_it_were_made_again(game, act, motions):
    model = model_of(game, where(1), where(2, *motions[0]))
    if act is not None:
        model.do(act, 0.0)
    for step, both in enumerate(motions, 1):
        now = 0.1 * step
        model.screen(now)
        model.receive(where(26 * step, *both), now)
    screen = model.screen(now)
    model.connected(now)  # All of it is made again.
    assert model.screen(now) == screen


@pytest.mark.parametrize(
    ("motion", "state"),
    [
        (RobotMotion("driving", None, 0.5), "traveling to room 3"),
        (RobotMotion("waiting", 1), "waiting for robot 2"),
        (RobotMotion("waiting"), "waiting for another robot"),
        (RobotMotion("waiting", 1, makes_way_for=1), "making way for robot 2"),
        (RobotMotion("driving", None, 0.5, makes_way_for=1), "making way for robot 2"),
        (RobotMotion("clearing"), "trying to get free"),
        (RobotMotion("planning"), "looking for a path to room 3"),
    ],
)
def test_what_a_robot_under_way_does_is_said_in_words(motion, state):
    card = model_of(UNDER_WAY, where(1, motion, RobotMotion())).screen(0.0).cards[0]
    assert (card.state, card.trouble, card.progress) == (state, False, motion.progress)
    assert card.place == "from the corridor"


def test_a_robot_at_rest_that_drives_out_of_another_ones_way_says_so_as_long_as_it_does():
    model = model_of(view(), where(1))
    at_rest = model.screen(0.0).cards[0].state
    model.receive(where(2, RobotMotion("driving", makes_way_for=1), RobotMotion()), 0.04)
    assert model.screen(0.04).cards[0].state == "making way for robot 2"
    model.receive(where(3), 0.08)
    assert model.screen(0.08).cards[0].state == at_rest


def test_a_robot_that_came_to_rest_is_at_the_end_of_its_way_until_the_game_knows():
    model = model_of(UNDER_WAY, where(1, RobotMotion("driving", None, 0.98), RobotMotion()))
    model.receive(where(2), 0.04)
    card = model.screen(0.04).cards[0]
    assert (card.progress, card.state) == (0.98, "traveling to room 3")
    model.receive(FOUND, 0.08)
    model.receive(where(3), 0.12)
    model.receive(with_robot(FOUND, 0, moving_to=2), 0.16)
    assert model.screen(0.16).cards[0].progress == 0.0


@pytest.mark.parametrize(
    ("changes", "state"),
    [
        ({"condition": Condition.SILENT}, "does not answer"),
        ({"condition": Condition.LOST, "moving_to": 3}, "lost, looking for its position"),
        ({"condition": Condition.LOST}, "lost, does not know where it is"),
        ({"energy": 0.0, "blocked": True}, "no energy left"),
        ({"energy": 3.0}, "not enough energy for any room"),
    ],
)
def test_trouble_is_a_word_and_a_sign(changes, state):
    card = model_of(with_robot(view(), 0, **changes)).screen(0.0).cards[0]
    assert (card.state, card.trouble) == (state, True)


def test_the_cost_of_the_room_looked_at_is_on_the_card_of_the_robot_commanded():
    model = model_of(view())
    assert [card.cost for card in model.screen(0.0).cards] == [None, None]
    model.do(ConsiderRoom(2), 0.0)
    screen = model.screen(0.0)
    assert [card.cost for card in screen.cards] == [9.0, None]
    assert [tile.considered for tile in screen.tiles] == [False, True, False]
    model.receive(with_robot(with_robot(view(), 0, energy=8.0), 1, energy=50.0), 0.1)
    card = model.screen(0.1).cards[0]
    assert (card.cost, card.affordable, card.energy_at_start) == (9.0, False, 100.0)
    model.do(ConsiderRoom(None), 0.2)
    assert model.screen(0.2).cards[0].cost is None


def test_the_cost_of_the_room_talked_about_is_on_its_robots_card():
    screen = model_of(view(dialogues=(asking(1, 3),))).screen(0.0)
    assert [card.cost for card in screen.cards] == [None, 7.0]


def test_a_talk_about_a_room_warns_as_its_tile_does():
    poor = with_robot(view(dialogues=(asking(0, 3),)), 0, energy=7.5)
    screen = model_of(poor).screen(0.0)
    assert screen.popup.warning == "Enough energy to get there, but not to name what is there."
    told = "Costs 5; robot 1 then has 2.5 left. Enough energy to name what is there, but not to take a picture."
    assert screen.tiles[0].choose.hint == told


@pytest.mark.parametrize(
    ("left", "warning"),
    [
        (0.5, "Enough energy to get there, but not to name what is there."),
        (4.0, "Enough energy to name what is there, but not to take a picture."),
        (5.5, "Enough energy to take a picture there or to name what is there, but not for both."),
        (6.0, ""),
    ],
)
def test_a_room_warns_of_what_the_energy_left_there_does_not_suffice_for(left, warning):
    """A picture costs 5 and a name 1, whatever was paid for the way."""
    screen = model_of(with_robot(view(dialogues=(asking(0, 2),)), 0, energy=9.0 + left)).screen(0.0)
    assert screen.popup.warning == screen.tiles[1].warning == warning
    standing = model_of(with_robot(view(), 0, energy=9.0 + left)).screen(0.0).tiles[1]
    assert standing.choose.enabled
    assert standing.choose.hint == f"Costs 9; robot 1 then has {left:g} left. {warning}".rstrip()


def test_what_a_robot_under_way_could_do_is_counted_from_where_it_would_stop():
    # It paid 7 for its way, which come back; from the corridor, where it would stop, room 2 costs 9 and room 1 costs 5.
    model = model_of(with_robot(UNDER_WAY, 0, energy=1.0))
    tiles = model.screen(0.0).tiles
    assert [tile.choose.enabled for tile in tiles] == [True, False, False]
    assert [tile.cost for tile in tiles] == [5.0, 9.0, None]
    assert tiles[1].choose.hint == "This move costs 9; robot 1 has 8 energy."
    assert tiles[0].choose.hint == "Robot 1 is on its way to room 3 and would be stopped first."


def test_a_driving_robot_s_rooms_have_no_price_where_moves_are_priced_by_where_it_would_stop():
    tiles = model_of(structs.replace(with_robot(UNDER_WAY, 0, energy=1.0), by_position=True)).screen(0.0).tiles
    assert [tile.cost for tile in tiles] == [None, None, None]
    assert tiles[1].choose.enabled


def test_a_robot_may_spend_all_it_has():
    spent = with_robot(view(identify_cost=0.0), 0, energy=5.0)
    tile = model_of(spent).screen(0.0).tiles[0]
    assert tile.choose.enabled
    # It is switched off there, even where naming costs nothing.
    assert tile.warning == "Enough energy to get there, but not to name what is there."
    nameable = model_of(with_robot(spent, 0, energy=5.5)).screen(0.0).tiles[0]
    assert nameable.warning == "Enough energy to name what is there, but not to take a picture."


def test_what_follows_from_agreements_is_wanted_without_being_asked_again():
    model = model_of(view(consents=(Consent(0, "select-room", 3),)))
    assert model.requests() == (SendRobot(0, 3),)
    assert model.screen(0.0).cards[0].state == "about to set out for room 3"
    model.receive(with_room(FOUND, 3, sensed=None), 0.1)
    assert model.requests() == (SenseTreasure(3),)
    model.receive(with_robot(with_room(FOUND, 3, sensed=None), 0, condition=Condition.SILENT), 0.05)
    assert model.requests() == ()
    assert model.screen(0.1).popup.title == "Robot 1 looks around in room 3"


def test_an_agreed_name_is_said_only_as_it_was_picked():
    agreed = structs.replace(FOUND, consents=(Consent(0, "take-treasure", 3),))
    model = model_of(agreed)
    assert model.requests() == ()
    model.do(PickName("no such thing"), 0.0)
    model.do(IdentifyTreasureAct(), 0.0)
    assert model.requests() == ()
    model.do(PickName("can"), 0.0)
    model.do(IdentifyTreasureAct(), 0.0)
    assert model.requests() == (), "it has not been drawn as picked yet"
    assert model.screen(0.0).popup.picked == "can"
    model.do(IdentifyTreasureAct(), 0.0)
    assert model.requests() == (IdentifyTreasure(3, "can"),)
    model.do(PickName("ball"), 0.0)
    assert model.requests() == (IdentifyTreasure(3, "can"),)
    assert model.screen(0.0).popup.name_it.pending
    model.receive(structs.replace(agreed, refusal=refusal(1, "Identify")), 0.1)
    assert model.requests() == ()
    assert not model.screen(0.1).popup.name_it.enabled
    assert model.screen(0.1).popup.picked is None


def test_an_act_for_what_has_gone_from_the_screen_meanwhile_does_nothing():
    two = with_room(
        with_robot(FOUND, 1, place=2),
        2,
        state="visited",
        robot=1,
        sensed={"colour": "Blue", "footprint": "Square and Small"},
    )
    model = model_of(FOUND)
    model.receive(two, 0.1)
    assert model.screen(0.1).popup.room == 3
    model.receive(with_room(two, 3, left=True), 0.2)
    model.do(LeaveTreasureAct(), 0.2)
    assert model.requests() == ()
    assert model.screen(0.2).popup.room == 2
    model.do(LeaveTreasureAct(), 0.3)
    assert model.requests() == (LeaveTreasure(2),)


def test_what_came_up_meanwhile_is_not_put_aside_unseen():
    two = with_room(
        with_robot(FOUND, 1, place=2), 2, state="visited", robot=1, sensed={"colour": "Blue", "footprint": "Square"}
    )
    model = model_of(FOUND)
    model.receive(with_room(two, 3, left=True), 0.1)
    model.do(ShowNext(), 0.1)
    assert model.screen(0.1).popup.room == 2


def test_a_robot_that_arrives_as_it_is_called_back_stays_with_what_it_found():
    model = model_of(UNDER_WAY)
    model.do(SelectRoomAct(1), 0.0)
    model.screen(0.0)
    model.do(Confirm(), 0.0)
    assert model.requests() == (StopRobot(0),)
    model.receive(FOUND, 0.1)
    assert model.requests() == ()
    assert model.screen(0.1).banner.text == "Robot 1 was already in room 3 when you stopped it."
    assert model.screen(0.1).popup.room == 3


def test_a_robot_that_is_stopped_after_all_is_sent_nowhere_else():
    model = model_of(UNDER_WAY)
    model.do(SelectRoomAct(1), 0.0)
    model.screen(0.0)
    model.do(Confirm(), 0.0)
    model.do(StopRobotAct(), 0.0)
    model.receive(view(), 0.1)
    assert model.requests() == ()
    assert model.screen(0.1).popup is None


def test_an_act_for_one_game_is_none_for_the_next():
    model = model_of(view())
    model.receive(view(game=2), 0.1)
    model.do(SelectRoomAct(3), 0.1)
    assert model.requests() == ()


def test_advice_is_asked_for_once():
    model = model_of(view())
    model.do(RequestSuggestionAct(), 0.0)
    asked = model.screen(0.0).ask_advice
    assert (asked.enabled, asked.pending, model.requests()) == (False, True, (RequestSuggestion(0),))
    suggestion = replace(asking(0, 2), suggested=True)
    model.receive(view(dialogues=(suggestion,)), 0.1)
    model.screen(0.1)
    model.do(ShowNext(), 0.1)
    assert model.screen(0.1).popup is None
    model.do(RequestSuggestionAct(), 0.2)
    assert model.requests() == (), "what the robot has suggested is shown, and not asked for again"
    assert model.screen(0.2).popup is not None


def test_a_picture_after_which_nothing_could_be_named_is_warned_of():
    poor = with_robot(FOUND, 0, energy=5.5)
    screen = model_of(poor).screen(0.0)
    assert screen.popup.take_picture.hint == "Costs 5 of 5.5 energy. Too little energy is then left to name it."
    assert model_of(FOUND).screen(0.0).popup.take_picture.hint == "Costs 5 of 100 energy."
    # It cannot go anywhere any more, but there is something left to do.
    assert model_of(with_robot(FOUND, 0, energy=2.0)).screen(0.0).cards[0].state == "found something"


def test_what_follows_on_an_act_before_the_screen_does_is_for_nothing_shown():
    model = model_of(FOUND)
    model.do(ShowNext(), 0.0)
    model.do(LeaveTreasureAct(), 0.0)
    assert model.requests() == ()
    model.do(ShowNext(), 0.0)
    assert model.screen(0.0).popup is None


def test_a_question_is_answered_by_nobody_who_has_not_seen_it():
    model = model_of(view())
    model.do(EndGameAct(), 0.0)
    model.do(Confirm(), 0.0)
    assert model.requests() == ()
    assert model.screen(0.0).confirmation is not None
    model.do(Confirm(), 0.0)
    assert model.requests() == (EndGame(1),)


def test_nobody_is_asked_about_a_treasure_that_the_robot_cannot_name():
    model = model_of(with_robot(structs.replace(FOUND, identify_cost=50.0), 0, energy=20.0))
    model.do(SelectRoomAct(1), 0.0)
    assert model.screen(0.0).confirmation is None
    assert model.requests() == (SelectRoom(0, 1),)


def test_an_answer_names_the_turn_that_was_read():
    model = model_of(view(dialogues=(asking(0, 3, turn=1),)))
    model.receive(view(dialogues=(asking(0, 3, turn=3),)), 0.1)
    model.do(AnswerDialogueAct(0), 0.1)
    assert model.requests() == ()
    model.screen(0.1)
    model.do(AnswerDialogueAct(0), 0.2)
    assert model.requests() == (AnswerDialogue(1, 3, 0),)


def test_wishes_outlive_a_connection():
    model = model_of(view())
    model.do(SelectRoomAct(3), 0.0)
    model.lost("", 1.0)
    assert model.requests() == (SelectRoom(0, 3),)
    model.connected(9.0)
    model.receive(view(), 9.0)
    assert model.requests() == (SelectRoom(0, 3),)
    model.receive(view(dialogues=(asking(0, 3),)), 9.1)
    assert model.requests() == ()


def test_a_game_that_stands_still_is_said_so_and_no_more_when_it_moves():
    model = model_of(view(), where(1))
    assert model.screen(1.4).banner is None
    assert (
        model.screen(1.6).banner.text
        == "There is no news from the robots at the moment. The game goes on as soon as news arrives."
    )
    model.receive(where(2), 1.7)
    assert model.screen(1.7).banner is None


def test_robots_that_are_not_there_are_said_so_in_the_middle_of_a_game():
    model = model_of(view())
    model.receive(view(ready=False), 1.0)
    screen = model.screen(1.0)
    assert screen.phase is Phase.PLAYING
    away = "The robots are not connected at the moment. The game goes on as soon as they are back."
    assert screen.banner.text == away


def test_a_refusal_is_shown_for_some_seconds_and_only_once():
    model = model_of(view(refusal=refusal(1, "Select")))
    assert model.screen(0.0).banner is None
    model.receive(view(refusal=refusal(2, "Select")), 1.0)
    assert model.screen(1.0).banner.text == "No Select."
    model.receive(view(refusal=refusal(2, "Select"), score=1), 2.0)
    assert model.screen(6.9).banner.text == "No Select."
    assert model.screen(7.1).banner is None
    model.receive(view(), 8.0)
    model.receive(view(refusal=refusal(1, "Select")), 8.0)
    assert model.screen(8.0).banner.text == "No Select."


@pytest.mark.parametrize(
    "other",
    [
        view(game=2),
        view(),
        view(robots=3),
        with_room(FOUND, 3, state="unvisited", robot=None, verdict=IdentificationVerdict("can", 5)),
        with_room(FOUND, 3, verdict=IdentificationVerdict("ball", 5)),
        structs.replace(with_room(FOUND, 3, verdict=IdentificationVerdict("can", 5)), costs=((5.0,) * 4,) * 4),
    ],
    ids=["number", "began anew", "robots", "rooms", "verdicts", "house"],
)
def test_another_game_begins_with_nothing_of_the_last_one(other):
    verdict = with_room(FOUND, 3, verdict=IdentificationVerdict("can", 5))
    model = model_of(FOUND)
    model.do(PickName("can"), 0.0)
    model.receive(verdict, 0.5)
    assert model.screen(0.5).popup.points == 5
    model.do(SelectRoomAct(2), 0.6)
    model.receive(other, 1.0)
    screen = model.screen(1.0)
    assert (screen.popup, screen.waiting, model.requests()) == (None, (), ())
    assert len(screen.history) == 1


@pytest.mark.parametrize("act", [ShowWaiting(1), ChooseRobot(1)])
def test_a_verdict_that_was_left_for_what_waits_has_been_read(act):
    beside = with_room(with_robot(FOUND, 1, place=2), 2, state="visited", robot=1, sensed={"colour": "Blue"})
    model = model_of(beside)
    model.do(ShowWaiting(0), 0.1)
    model.screen(0.1)
    model.receive(with_room(beside, 3, verdict=IdentificationVerdict("can", 5)), 0.5)
    assert model.screen(0.5).popup.points == 5
    model.do(act, 1.0)
    screen = model.screen(1.0)
    assert (screen.popup.room, screen.waiting) == (2, ())


def test_a_verdict_that_comes_while_another_find_is_shown_waits_to_be_read():
    beside = with_room(with_robot(FOUND, 1, place=2), 2, state="visited", robot=1, sensed={"colour": "Blue"})
    model = model_of(beside)
    assert model.screen(0.0).popup.room == 2
    model.receive(with_room(beside, 3, verdict=IdentificationVerdict("can", 5)), 0.5)
    assert [waiting.robot for waiting in model.screen(0.5).waiting] == [0]


def test_that_the_game_is_over_is_not_noted_above_the_card_that_says_it():
    model = model_of(FOUND)
    model.do(EndGameAct(), 0.1)
    assert model.screen(0.1).confirmation is not None
    model.receive(structs.replace(FOUND, over="no-move-left"), 0.2)
    screen = model.screen(0.2)
    assert screen.ending is not None and screen.banner is None
    assert "The game is over." in screen.announcement


def test_the_end_says_why_and_what_came_of_it():
    played = with_room(with_room(FOUND, 3, verdict=IdentificationVerdict("can", 20)), 1, state="visited", left=True)
    model = model_of(structs.replace(played, score=20, over="no-move-left"))
    screen = model.screen(0.0)
    assert screen.phase is Phase.OVER
    assert screen.ending.title == "The game is over. Score: 20"
    assert screen.ending.lines == (
        "No robot has the energy for another move.",
        "2 of 3 rooms visited. 1 treasure named, 1 correctly.",
        "Room 1: the treasure was left there.",
        "Room 3: Can is right, 20 points won.",
        "Thank you for playing.",
    )
    model.do(PlayAgainAct(), 0.0)
    assert model.requests() == (PlayAgain(1),)
    assert model.screen(0.0).ending.again.pending


def test_where_one_game_is_played_its_end_leads_on_and_to_no_other_game():
    model = Participant(once=True)
    model.connected(0.0)
    model.receive(structs.replace(FOUND, over="given-up"), 0.0)
    screen = model.screen(0.0)
    assert (screen.ending.again.act, screen.ending.again.label) == (GoOnFromGame(), "Continue")
    assert act_for("Enter", screen) == GoOnFromGame()
    assert act_for("A", screen) is None
    # The number would be 1 in each of a person's games.
    assert screen.game == 0
    assert texts(screen)[0].startswith("The game is under way")


def test_the_end_tells_what_was_in_the_rooms_and_what_was_possible_where_the_study_tells():
    wrong = with_room(FOUND, 3, verdict=IdentificationVerdict("can", -30))
    played = with_room(wrong, 1, state="visited", left=True)
    rooms = (RoomDebrief(1, "beer_bottle", 20), RoomDebrief(2, "can", 10), RoomDebrief(3, "ball", 30))
    told = Debrief(rooms, 60, "Thank you.\nPlease fetch the researcher.")
    ending = model_of(structs.replace(played, score=-30, over="given-up", debrief=told)).screen(0.0).ending
    assert ending.lines[2:] == (
        "With the same energy, 60 points were possible.",
        "Room 1: the treasure was left there. It was beer bottle, 20 points.",
        "Room 2: not visited; it held can, 10 points.",
        "Room 3: Can is wrong, 30 points lost. It was ball, 30 points.",
        "Thank you.\nPlease fetch the researcher.",
    )


def test_points_are_told_before_a_name_is_given_where_the_study_tells():
    model = model_of(structs.replace(FOUND, worth=(20, None), wrong_share=0.5))
    assert model.screen(0.0).popup.worth == (20, None)
    model.do(PickName("ball"), 0.0)
    hint = model.screen(0.0).popup.name_it.hint
    assert "If it is right, it wins 20 points. A wrong name loses 50% of the treasure's points." in hint
    model.do(PickName("can"), 0.0)
    assert "A right name wins points. A wrong name loses 50%" in model.screen(0.0).popup.name_it.hint


def test_a_picture_is_shown_when_all_of_it_is_there():
    model = model_of(PicturePiece(1, 3, 0, 1, b64encode(b"image").decode()), FOUND)
    assert model.screen(0.0).popup.picture is None
    model.receive(with_room(FOUND, 3, picture="a.jpg"), 0.1)
    pop = model.screen(0.1).popup
    assert (pop.picture, pop.picture_note, pop.take_picture) == (b"image", "", None)


def test_a_picture_of_another_game_by_the_same_number_is_not_shown():
    pictured = with_room(FOUND, 3, picture="a.jpg")
    model = model_of(PicturePiece(1, 3, 0, 1, b64encode(b"image").decode()), pictured)
    assert model.screen(0.0).popup.picture == b"image"
    model.receive(view(), 0.1)
    model.receive(pictured, 0.2)
    assert model.screen(0.2).popup.picture is None


def test_a_game_that_is_over_does_not_go_on():
    model = model_of(structs.replace(FOUND, over="given-up"))
    model.receive(FOUND, 0.1)
    assert texts(model.screen(0.1)) == ["Game 1 is under way, with 2 robots and 3 rooms; the score is 0."]


def test_with_ten_rooms_a_number_has_two_digits_or_ends_with_enter():
    model = model_of(view(rooms=12))
    assert model.screen(0.0).tiles[3].choose.key == "04"
    model.do(TypeDigit(1), 0.0)
    screen = model.screen(0.0)
    assert (screen.typed, screen.tiles[0].considered, model.requests()) == ("1", True, ())
    assert screen.announcement == "1, and another digit, or Enter."
    model.do(TypeDigit(2), 0.5)
    assert model.requests() == (SelectRoom(0, 12),)
    model.do(TypeDigit(4), 1.0)
    assert model.screen(4.9).typed == "4"
    assert model.screen(5.1).typed == ""


def test_robots_are_followed_until_the_whole_map_is_wanted():
    model = model_of(view())
    model.do(FollowRobot(), 0.0)
    assert model.followed == 0
    model.do(ChooseRobot(1), 0.0)
    assert model.followed == 1
    model.do(FitMap(), 0.0)
    assert model.followed is None


def test_the_help_sheet_has_the_rules_with_the_numbers_of_the_game():
    model = model_of(structs.replace(view(), picture_cost=7.0, identify_cost=2.5))
    assert model.screen(0.0).rules == ()
    model.do(ShowHelp(), 0.0)
    assert "A picture costs 7 energy, naming costs 2.5." in " ".join(model.screen(0.0).rules)


def test_the_help_sheet_opens_at_any_time():
    model = Participant()
    model.do(ShowHelp(), 0.0)
    assert ("F1 or H", "Open or close this sheet") in model.screen(0.0).help
    model.do(ShowHelp(), 0.0)
    assert model.screen(0.0).help == ()


def test_whoever_listens_is_told_what_matters_and_the_same_words_twice():
    model = model_of(view())
    before = model.screen(0.0).announcement_number
    model.do(ChooseRobot(1), 0.0)
    screen = model.screen(0.0)
    assert screen.announcement == "Robot 2: in the corridor, ready, 100 energy."
    model.do(ChooseRobot(0), 0.0)
    model.do(ChooseRobot(1), 0.0)
    assert model.screen(0.0).announcement_number > screen.announcement_number > before
    model.do(ChooseRobot(0), 0.0)
    model.screen(0.0)
    model.receive(UNDER_WAY, 1.0)
    model.receive(FOUND, 2.0)
    assert model.screen(2.0).announcement == (
        "Robot 1 sets out for room 3; it has 93 energy left. Robot 1 is in room 3. Something was found in room 3: "
        "pink, round and large. Robot 1 found something in room 3"
    )
    model.lost("", 3.0)
    assert model.screen(3.0).announcement == "The connection to the game is lost. Reconnecting…"


def test_everything_that_happened_is_in_the_history():
    model = model_of(view(dialogues=(asking(0, 3),)))
    model.do(AnswerDialogueAct(0), 0.1)
    model.receive(view(), 0.2)
    model.receive(UNDER_WAY, 0.3)
    model.receive(with_robot(view(), 0, energy=96.5), 0.4)
    model.receive(with_robot(view(), 0, energy=96.5, condition=Condition.LOST), 0.5)
    assert texts(model.screen(0.5)) == [
        "Game 1 begins, with 2 robots and 3 rooms.",
        "Shall I go?",
        "Continue",
        "Robot 1 sets out for room 3; it has 93 energy left.",
        "Robot 1 has stopped before room 3. It gets 3.5 energy back.",
        "Robot 1 is lost: it does not know where it is.",
    ]


def test_energy_that_comes_back_to_a_robot_that_stopped_is_shown_for_a_while():
    model = model_of(UNDER_WAY)
    model.receive(with_robot(view(), 0, energy=99.2), 1.0)
    assert model.screen(1.0).banner.text == "Robot 1 has stopped before room 3. It gets 6.2 energy back."
    assert model.screen(1.0).announcement == model.screen(1.0).banner.text, "and read out once"
    assert model.screen(8.0).banner is None
    model.receive(UNDER_WAY, 9.0)
    model.receive(FOUND, 10.0)
    assert model.screen(10.0).banner is None


def test_a_change_of_goal_is_asked_without_the_price_that_the_room_has_told():
    model = model_of(UNDER_WAY)
    assert model.screen(0.0).tiles[0].cost == 5.0
    model.do(SelectRoomAct(1), 0.0)
    text = model.screen(0.0).confirmation.text
    assert text == (
        "Robot 1 is on its way to room 3. If you stop the robot, it gets back about 7 energy for the rest of that "
        "path. Then it asks you about room 1."
    )


def test_the_map_shows_rooms_and_robots():
    ellipses = (Ellipse(0.3, 0.1, 0.0), Ellipse(0.2, 0.2, 0.0))
    model = model_of(view(), HOUSE, where(1, ellipses=ellipses), PlannedPaths(1, (((0.0, 0.0), (1.0, 0.0)), ())))
    kitchen, second = model.rooms(0.0)
    assert (kitchen.name, kitchen.state, kitchen.choosable) == ("Kitchen", "unvisited", True)
    assert kitchen.region.shape == (3, 2)
    assert second.name == "Room 2"
    assert model.rooms(0.5) is model.rooms(0.6)
    first, other = model.robots(0.1)
    assert (first.label, first.selected, first.trouble, other.selected) == ("1", True, False, False)
    assert np.array_equal(first.path[-1], (1.0, 0.0))
    assert first.ellipse.major == 0.3
    assert model.floor_plan is HOUSE


def test_a_floor_plan_that_comes_late_is_drawn():
    model = model_of(view())
    assert model.rooms(0.0) == ()
    model.receive(structs.replace(HOUSE, rooms=(replace(HOUSE.rooms[0], name=""),)), 0.1)
    model.screen(0.1)
    assert [room.room for room in model.rooms(0.1)] == [1]
