"""What the participant sees and may do when somebody else commands a robot."""

import pytest

from tests.thbridge.roles.test_command import NAME, SENTENCE, TAKE
from tests.ui.model.seat import Seat
from tests.ui.model.test_participant import agree, events, go
from tests.ui.model.test_participant_views import model_of, texts
from tests.ui.model.views import asking, view, with_robot, with_room
from thbridge.hunt.events import Commander, Departed, Identified
from thbridge.roles.requests import ReleaseCommand, SendFor, TakeCommand
from thbridge.roles.view import CallBack, Select, Unsure
from ui.model.participant import Participant
from ui.model.screen import ChooseRobot, ChooseRoom, DontKnow, LeaveIt, NameIt, PickName, StopRobot, TreasurePop

THEIRS = {"commander": Commander.GROUND_STATION, "commander_name": NAME}
BACK = "You get it back when the ground station releases it."
WHY = f"Robot 1 is commanded by {NAME}. {BACK}"


def test_card_map_and_buttons_say_who_commands_and_that_it_comes_back():
    screen = model_of(with_robot(view(), 0, **THEIRS)).screen(0.0)
    card = screen.cards[0]
    assert (card.commanded, card.select.hint) == (f"commanded by {NAME}", WHY)
    for action in (screen.dont_know, *(tile.choose for tile in screen.tiles)):
        assert (action.enabled, action.hint) == (False, WHY)
    assert screen.cards[1].commanded == ""


def test_whose_a_researcher_is_is_not_said():
    screen = model_of(with_robot(view(), 0, commander=Commander.RESEARCHER)).screen(0.0)
    assert screen.cards[0].commanded == "commanded by a researcher"
    assert screen.dont_know.hint == (
        "Robot 1 is commanded by a researcher. You get it back when the researcher is done."
    )


def test_the_other_robots_are_as_they_were():
    model = model_of(with_robot(view(), 0, **THEIRS))
    model.do(ChooseRobot(1), 0.0)
    screen = model.screen(0.0)
    assert screen.dont_know.enabled and all(tile.choose.enabled for tile in screen.tiles)


def test_it_is_told_when_a_robot_goes_and_comes_back():
    model = model_of(view())
    model.hear(with_robot(view(), 0, **THEIRS), 1.0)
    screen = model.screen(1.0)
    assert screen.banner.text == screen.announcement == f"Robot 1 is commanded by {NAME} now. {BACK}"
    assert model.screen(10.0).banner is None
    model.hear(view(), 11.0)
    screen = model.screen(11.0)
    assert screen.banner.text == screen.announcement == "Robot 1 is yours again."
    assert texts(screen)[-2:] == [f"Robot 1 is commanded by {NAME} now. {BACK}", "Robot 1 is yours again."]


def test_a_talk_that_ends_so_is_explained():
    model = model_of(view(dialogues=(asking(0, 3),)))
    model.hear(with_robot(view(), 0, **THEIRS), 1.0)
    screen = model.screen(1.0)
    assert screen.pop is None
    assert screen.banner.text.endswith(f"{BACK} Where it should go need not be talked over any more.")


@pytest.mark.parametrize(("act", "wish"), [(ChooseRoom(3), Select(0, 3)), (DontKnow(), Unsure(0))])
def test_a_wish_on_its_way_is_taken_back(act, wish):
    model = model_of(view())
    model.do(act, 0.0)
    assert model.wishes() == (wish,)
    model.hear(with_robot(view(), 0, **THEIRS), 1.0)
    assert model.wishes() == ()
    assert model.screen(1.0).banner.text == WHY


def test_a_robot_of_others_is_not_stopped_here():
    moving = with_room(with_robot(view(), 0, moving_to=3), 3, state="reserved", robot=0)
    model = model_of(moving)
    model.do(StopRobot(0), 0.0)
    assert model.wishes() == (CallBack(0),)
    model.hear(with_robot(moving, 0, **THEIRS), 1.0)
    stop = model.screen(1.0).cards[0].stop
    assert (model.wishes(), stop.enabled, stop.hint) == ((), False, WHY)
    model.do(StopRobot(0), 1.0)
    assert model.wishes() == ()


def test_what_others_robots_find_is_named_here():
    seat = Seat(robots=2)
    seat.stage.session.ask("station", TAKE)
    seat.stage.session.ask("station", SendFor(0, 3))
    screen = seat.run(30)
    assert isinstance(screen.pop, TreasurePop) and screen.pop.room == 3
    seat.press(PickName(seat.stage.session.game.treasures[2].name))
    seat.do(NameIt() if seat.offered(NameIt()).enabled else LeaveIt())
    agree(seat)
    assert events(seat, Identified)[0].points > 0


def test_a_robot_that_came_back_is_sent_as_ever():
    seat = Seat(robots=2)
    seat.stage.session.ask("station", TAKE)
    seat.run()
    seat.press(ChooseRoom(3))
    assert not events(seat, Departed)
    seat.stage.session.ask("station", ReleaseCommand(0))
    seat.run()
    go(seat, 3)
    assert [event.room.people for event in events(seat, Departed)] == [3]
    assert not any(SENTENCE in text for text in texts(seat.screen))


def test_a_participant_without_any_robot_of_their_own_is_told_what_is_left_to_do():
    seat = Seat(model=Participant(), robots=2)
    for robot in (0, 1):
        seat.stage.session.ask("station", TakeCommand(robot, NAME))
    seat.run()
    seat.now += 10.0
    assert seat.screen.banner.text == "Others command all robots just now. You name what they find."
