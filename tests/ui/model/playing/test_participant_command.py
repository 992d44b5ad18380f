"""The participant's screen and acts when somebody else commands a robot."""

import pytest

from tests.support.hunts.participant_views import asking, model_of, texts, view, with_robot, with_room
from tests.support.hunts.screen_player import ScreenPlayer, agree, events, go
from tests.support.hunts.scripted_hunt import NAME, SENTENCE, TAKE
from thbridge.hunt.events import Commander, RobotDeparted, TreasureIdentified
from thbridge.roles.shared.robot_requests import ReleaseCommand, StationSend, TakeCommand
from thbridge.roles.shared.view import IdentificationVerdict, RequestHandback, RequestSuggestion, SelectRoom, StopRobot
from ui.model.playing.keys import act_for
from ui.model.playing.offers import offer
from ui.model.playing.participant import Participant
from ui.model.playing.screen import (
    ChooseRobot,
    IdentifyTreasureAct,
    LeaveTreasureAct,
    PickName,
    RequestHandbackAct,
    RequestSuggestionAct,
    SelectRoomAct,
    ShowWaiting,
    StopRobotAct,
    TreasurePopup,
)

THEIRS = {"commander": Commander.GROUND_STATION, "commander_name": NAME}
BACK = "You get it back when the ground station releases it."
WHY = f"Robot 1 is commanded by {NAME}. {BACK}"


def test_card_map_and_buttons_say_who_commands_and_that_it_comes_back():
    screen = model_of(with_robot(view(), 0, **THEIRS)).screen(0.0)
    card = screen.cards[0]
    assert (card.commanded, card.select.hint, card.state) == (f"commanded by {NAME}", WHY, "at rest")
    for action in (screen.ask_advice, *(tile.choose for tile in screen.tiles)):
        assert (action.enabled, action.hint) == (False, WHY)
    assert screen.cards[1].commanded == ""


def test_whose_a_researcher_is_is_not_said():
    screen = model_of(with_robot(view(), 0, commander=Commander.RESEARCHER)).screen(0.0)
    assert screen.cards[0].commanded == "commanded by a researcher"
    assert screen.ask_advice.hint == (
        "Robot 1 is commanded by a researcher. You get it back when the researcher is done."
    )


def test_the_other_robots_are_as_they_were():
    model = model_of(with_robot(view(), 0, **THEIRS))
    model.do(ChooseRobot(1), 0.0)
    screen = model.screen(0.0)
    assert screen.ask_advice.enabled and all(tile.choose.enabled for tile in screen.tiles)


def test_it_is_told_when_a_robot_goes_and_comes_back():
    model = model_of(view())
    model.receive(with_robot(view(), 0, **THEIRS), 1.0)
    screen = model.screen(1.0)
    assert screen.banner.text == screen.announcement == f"Robot 1 is commanded by {NAME} now. {BACK}"
    assert model.screen(10.0).banner is None
    model.receive(view(), 11.0)
    screen = model.screen(11.0)
    assert screen.banner.text == screen.announcement == "Robot 1 is yours again."
    assert texts(screen)[-2:] == [f"Robot 1 is commanded by {NAME} now. {BACK}", "Robot 1 is yours again."]


def test_a_talk_that_ends_so_is_explained():
    model = model_of(view(dialogues=(asking(0, 3),)))
    model.receive(with_robot(view(), 0, **THEIRS), 1.0)
    screen = model.screen(1.0)
    assert screen.popup is None
    assert screen.banner.text.endswith(f"{BACK} You no longer need to discuss where this robot goes.")


@pytest.mark.parametrize(
    ("act", "wanted"), [(SelectRoomAct(3), SelectRoom(0, 3)), (RequestSuggestionAct(), RequestSuggestion(0))]
)
def test_a_request_on_its_way_is_taken_back(act, wanted):
    model = model_of(view())
    model.do(act, 0.0)
    assert model.requests() == (wanted,)
    model.receive(with_robot(view(), 0, **THEIRS), 1.0)
    assert model.requests() == ()
    assert model.screen(1.0).banner.text == WHY


def test_a_robot_of_others_is_not_stopped_here():
    moving = with_room(with_robot(view(), 0, moving_to=3), 3, state="reserved", robot=0)
    model = model_of(moving)
    model.do(StopRobotAct(0), 0.0)
    assert model.requests() == (StopRobot(0),)
    model.receive(with_robot(moving, 0, **THEIRS), 1.0)
    assert (model.requests(), model.screen(1.0).cards[0].stop) == ((), None)
    model.do(StopRobotAct(), 1.0)
    assert (model.requests(), model.screen(1.0).banner.text) == ((), WHY)


def test_what_others_robots_find_is_named_here():
    seat = ScreenPlayer(robots=2)
    seat.hunt.session.ask("station", TAKE)
    seat.hunt.session.ask("station", StationSend(0, 3))
    screen = seat.run(30)
    assert isinstance(screen.popup, TreasurePopup) and screen.popup.room == 3
    seat.press(PickName(seat.hunt.session.game.treasures[2].name))
    seat.do(IdentifyTreasureAct() if seat.offered(IdentifyTreasureAct()).enabled else LeaveTreasureAct())
    agree(seat)
    assert events(seat, TreasureIdentified)[0].points > 0


def test_a_robot_that_came_back_is_sent_as_ever():
    seat = ScreenPlayer(robots=2)
    seat.hunt.session.ask("station", TAKE)
    seat.run()
    seat.press(SelectRoomAct(3))
    assert not events(seat, RobotDeparted)
    seat.hunt.session.ask("station", ReleaseCommand(0))
    seat.run()
    go(seat, 3)
    assert [event.room.people for event in events(seat, RobotDeparted)] == [3]
    assert not any(SENTENCE in text for text in texts(seat.screen))


def test_a_participant_without_any_robot_of_their_own_is_told_what_is_left_to_do():
    seat = ScreenPlayer(model=Participant(), robots=2)
    for robot in (0, 1):
        seat.hunt.session.ask("station", TakeCommand(robot, NAME))
    seat.run()
    seat.now += 10.0
    assert (
        seat.screen.banner.text
        == "Others command all robots at the moment. You can name what the robots find, and ask for the robots back."
    )


def test_a_robot_of_others_is_asked_for_once_and_again_when_that_may_help():
    theirs = with_robot(view(), 0, **THEIRS)
    model = model_of(theirs)
    screen = model.screen(0.0)
    assert screen.cards[1].ask_back is None and act_for("B", screen) == RequestHandbackAct()
    ask = offer(screen, RequestHandbackAct())
    assert (ask.label, ask.key, ask.enabled) == ("Ask for it back", "B", True)
    assert ask.hint == f"Robot 1 is commanded by ground station 255. {BACK}"
    model.do(RequestHandbackAct(), 0.0)
    ask = model.screen(0.0).cards[0].ask_back
    assert (model.requests(), ask.label, ask.enabled, ask.pending) == ((RequestHandback(0),), "Asked", False, True)
    model.receive(with_robot(theirs, 0, asked_back=True), 0.1)
    screen = model.screen(0.1)
    ask = screen.cards[0].ask_back
    assert (model.requests(), ask.label, ask.enabled, ask.pending) == ((), "Asked", False, False)
    assert (
        screen.announcement == screen.banner.text == texts(screen)[-1] == f"You have asked {NAME} to give robot 1 back."
    )
    model.do(RequestHandbackAct(0), 0.1)
    assert model.requests() == () and "again in a few seconds" in model.screen(0.1).banner.text
    model.receive(theirs, 10.0)
    assert model.screen(10.0).cards[0].ask_back.enabled


def test_what_comes_back_meanwhile_is_asked_for_no_more():
    model = model_of(with_robot(view(), 0, **THEIRS))
    model.do(RequestHandbackAct(0), 0.0)
    model.receive(view(), 1.0)
    screen = model.screen(1.0)
    assert (model.requests(), screen.cards[0].ask_back, screen.banner.text) == ((), None, "Robot 1 is yours again.")
    model.do(RequestHandbackAct(), 2.0)
    assert (model.requests(), model.screen(2.0).banner.text) == ((), "You command robot 1 yourself.")


def test_who_cannot_end_the_game_is_told_whom_to_ask():
    model = model_of(with_robot(view(), 0, moving_to=3, **THEIRS))
    assert model.screen(0.0).end.hint == f"Robot 1 is still on its way. {WHY}"


def test_what_a_station_leaves_unnamed_stays_on_the_table():
    seat = ScreenPlayer(robots=2)
    seat.hunt.session.ask("station", TAKE)
    seat.hunt.session.ask("station", StationSend(0, 3))
    assert seat.run(30).popup.room == 3
    seat.hunt.session.ask("station", StationSend(0, 4))
    screen = seat.run(6)
    assert screen.banner.text == (
        "Robot 1 was sent on, and what it found stays in room 3. You can still name the treasure."
    )
    assert (screen.popup.room, screen.popup.title) == (3, "Robot 1 found something in room 3 and was sent on")
    assert screen.popup.picture_note == "No picture was taken."
    assert screen.popup.take_picture.hint == "Robot 1 is no longer in room 3."
    screen = seat.run(30)
    assert screen.popup.room == 3 and [waiting.text for waiting in screen.waiting] == [
        "Robot 1 is in room 4 and found something"
    ]
    assert seat.do(ShowWaiting(0, 4)).popup.room == 4
    assert [waiting.text for waiting in seat.screen.waiting] == ["Robot 1 found something in room 3"]
    assert seat.do(ShowWaiting(0, 3)).popup.room == 3
    seat.press(PickName(seat.hunt.session.game.treasures[2].name))
    seat.do(IdentifyTreasureAct())
    agree(seat)
    assert "is right" in seat.screen.popup.verdict and seat.screen.popup.title == "What robot 1 found in room 3"
    assert (events(seat, TreasureIdentified)[0].robot, seat.screen.score) == (
        0,
        events(seat, TreasureIdentified)[0].points,
    )


def test_what_nobody_can_pay_to_name_is_said_and_left():
    found = with_room(with_robot(view(), 0, place=3, energy=0.5, **THEIRS), 3, state="visited", robot=0)
    found = with_room(found, 3, sensed={"colour": "Pink", "footprint": "Small"})
    model = model_of(found)
    model.receive(with_robot(found, 0, moving_to=2), 1.0)
    screen = model.screen(1.0)
    assert screen.banner.text.endswith("Naming it costs 1; robot 1 has 0.5 energy.")
    assert not screen.popup.name_it.enabled and screen.popup.leave.enabled


def test_a_verdict_is_shown_although_nothing_was_received_since_before_the_robot_came():
    model = model_of(with_room(with_robot(view(), 0, moving_to=3), 3, state="reserved", robot=0))
    found = with_room(
        with_robot(view(), 0, place=3), 3, state="visited", robot=0, sensed={"colour": "Pink", "footprint": "Small"}
    )
    model.receive(with_room(found, 3, verdict=IdentificationVerdict("Pink can", 30)), 1.0)
    assert model.screen(1.0).popup.points == 30
