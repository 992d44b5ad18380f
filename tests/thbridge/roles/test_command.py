"""Ground stations and researchers in the participant's game: who may do what, and what the participant sees of it."""

import msgspec
import pytest

from tests.support.hunts.hunt_without_simulator import HuntWithoutSimulator
from tests.support.hunts.scripted_hunt import NAME, SENTENCE, TAKE, ScriptedHunt
from thbridge.hunt.events import (
    Commander,
    CommanderChanged,
    HandbackRequested,
    MoveFailed,
    RobotArrived,
    RobotDeparted,
    TreasureIdentified,
    TreasureLeft,
    TreasurePictured,
    TreasureSensed,
    TreasuresHidden,
)
from thbridge.hunt.rooms import CORRIDOR, Room
from thbridge.hunt.rules import RuleReason
from thbridge.roles.participant.bot_strategy import BotStrategy
from thbridge.roles.shared.notices import KEEPER, Orders, TeamStatus
from thbridge.roles.shared.robot_requests import (
    ReleaseCommand,
    StationIdentify,
    StationLeave,
    StationSend,
    StationStop,
    StationTakePicture,
    TakeCommand,
)
from thbridge.roles.shared.view import (
    AnswerDialogue,
    EndGame,
    IdentifyTreasure,
    OpenDialogue,
    ParticipantRequest,
    PlayAgain,
    RequestHandback,
    RequestSuggestion,
    SelectRoom,
    SendRobot,
    StopRobot,
    TakePicture,
    View,
)
from thbridge.text_protocol.wire.notice_format import Notice, decode_notice


@pytest.fixture
def play() -> ScriptedHunt:
    return ScriptedHunt()


def test_the_participant_sees_who_commands_and_gets_the_robot_back(play: ScriptedHunt) -> None:
    assert play.view.robots[0].commander is Commander.PARTICIPANT
    robot = play.ask(TAKE).robots[0]
    assert (robot.commander, robot.commander_name) == (Commander.GROUND_STATION, NAME)
    assert play.view.robots[1].commander is Commander.PARTICIPANT
    robot = play.ask(ReleaseCommand(0)).robots[0]
    assert (robot.commander, robot.commander_name) == (Commander.PARTICIPANT, "")
    assert play.events(CommanderChanged) == [
        CommanderChanged(0, Commander.GROUND_STATION, NAME),
        CommanderChanged(0, Commander.PARTICIPANT, ""),
    ]


@pytest.mark.parametrize("wish", [SelectRoom(0, 3), RequestSuggestion(0), SendRobot(0, 3)])
def test_what_the_participant_wishes_of_a_robot_of_others_is_refused(
    play: ScriptedHunt, wish: ParticipantRequest
) -> None:
    play.ask(TAKE)
    refusal = play.wish(wish).refusal
    assert refusal is not None
    assert (refusal.reason, refusal.sentence) == ("commanded", SENTENCE)
    assert not play.events(RobotDeparted) and not play.view.dialogues


def test_a_robot_of_others_under_way_is_not_called_back_by_the_participant(play: ScriptedHunt) -> None:
    play.ask(TAKE, StationSend(0, 3), ticks=3)
    refusal = play.wish(StopRobot(0), ticks=4).refusal
    assert refusal is not None and (refusal.wish, refusal.sentence) == ("CallBack", SENTENCE)
    play.hunt.run(10)
    assert play.events(RobotArrived) == [RobotArrived(0, Room(3))]


def test_an_open_talk_about_where_to_go_ends_when_somebody_takes_the_robot(play: ScriptedHunt) -> None:
    (dialogue,) = play.wish(SelectRoom(0, 3)).dialogues
    view = play.ask(TAKE)
    assert view.dialogues == () and view.consents == ()
    refused = view.refusal
    # An answer that was on its way means nothing any more, and is no fault of anybody's.
    assert play.wish(AnswerDialogue(dialogue.dialogue, dialogue.turn, 0)).refusal == refused
    assert play.wish(SelectRoom(1, 3)).dialogues[0].robot == 1


def test_an_agreement_to_go_ends_too(play: ScriptedHunt) -> None:
    view = play.wish(SelectRoom(0, 3))
    while not view.consents:
        (dialogue,) = view.dialogues
        view = play.wish(AnswerDialogue(dialogue.dialogue, dialogue.turn, 0))
    assert play.ask(TAKE).consents == ()
    assert play.ask(ReleaseCommand(0)).consents == ()


def test_a_ground_station_sends_its_robot_without_talk_and_what_is_there_is_told_by_itself(play: ScriptedHunt) -> None:
    view = play.ask(TAKE, StationSend(0, 3), ticks=20)
    assert play.events(RobotDeparted, RobotArrived) == [RobotDeparted(0, Room(3), 17.0), RobotArrived(0, Room(3))]
    assert [event.room for event in play.events(TreasureSensed)] == [Room(3)]
    assert view.room(3).sensed and view.room(3).undecided
    assert not [utterance for tick_record in play.hunt.tick_records for utterance in tick_record.utterances]


def test_rules_hold_for_ground_stations_and_the_participant_is_not_bothered(play: ScriptedHunt) -> None:
    for refused in (
        StationSend(0, 3),
        StationTakePicture(0),
        StationIdentify(0, "Pink can"),
        StationLeave(0),
        StationSend(9, 1),
    ):
        view = play.ask(refused)
    view = play.ask(
        TAKE, StationSend(0, 99), StationSend(0, -1), StationTakePicture(0), StationLeave(0), TakeCommand(7, NAME)
    )
    assert not play.events(RobotDeparted, TreasureLeft, TreasurePictured) and view.refusal is None


def test_a_ground_station_pictures_names_and_leaves_where_its_robots_stand(play: ScriptedHunt) -> None:
    play.ask(TAKE, TakeCommand(1, NAME), StationSend(0, 3), StationSend(1, 4), ticks=20)
    game = play.hunt.session.game
    name = game.treasure(Room(3)).name
    view = play.ask(StationTakePicture(0), StationIdentify(0, name), StationLeave(1))
    assert view.room(3).picture is not None and view.room(3).verdict.points > 0 and view.room(4).left
    assert [event.cost for event in play.events(TreasurePictured, TreasureIdentified)] == [5.0, 1.0]
    assert view.score == view.room(3).verdict.points


def test_the_participant_names_what_a_robot_of_others_found(play: ScriptedHunt) -> None:
    play.ask(TAKE, StationSend(0, 3), ticks=20)
    view = play.wish(OpenDialogue(0, "take-picture", 3))
    while view.dialogues:
        (dialogue,) = view.dialogues
        view = play.wish(AnswerDialogue(dialogue.dialogue, dialogue.turn, 0))
    assert play.wish(TakePicture(3)).room(3).picture is not None


def test_anybody_may_stop_a_robot_and_the_energy_for_the_rest_comes_back(play: ScriptedHunt) -> None:
    play.ask(TAKE, StationSend(0, 3), ReleaseCommand(0), ticks=3)
    play.ask(StationStop(0))
    (failed,) = play.events(MoveFailed)
    assert failed.refund == 8.5
    assert play.view.robots[0].moving_to is None
    play.ask(StationStop(0), StationStop(9))
    assert len(play.events(MoveFailed)) == 1


def test_a_participant_whose_robot_is_stopped_by_others_is_told_so_once(play: ScriptedHunt) -> None:
    play.ask(TAKE, StationSend(0, 3), ReleaseCommand(0), ticks=3)
    view = play.ask(StationStop(0), StationStop(0))
    assert (view.refusal.number, view.refusal.sentence) == (1, "A ground station has stopped robot 1.")


def test_a_station_that_stops_its_own_robot_concerns_nobody_else(play: ScriptedHunt) -> None:
    assert play.ask(TAKE, StationSend(0, 3), StationStop(0)).refusal is None


def test_a_robot_that_is_called_back_before_it_was_told_to_go_never_set_out(play: ScriptedHunt) -> None:
    view = play.ask(TAKE, StationSend(0, 3), StationStop(0))
    (failed,) = play.events(MoveFailed)
    assert (failed.refund, failed.at, view.robots[0].energy) == (17.0, CORRIDOR, 100.0)
    assert view.robots[0].moving_to is None
    assert play.ask(StationSend(0, 3), ticks=20).robots[0].place == 3


def test_a_researcher_has_the_robot_while_it_lasts_and_then_whoever_had_it(play: ScriptedHunt) -> None:
    play.ask(TAKE)
    play.hunt.puppets.researchers = ("/rviz", None)
    play.hunt.run(60)
    robot = play.view.robots[0]
    # What a researcher's program is called is not for the participant.
    assert (robot.commander, robot.commander_name) == (Commander.RESEARCHER, "")
    play.hunt.puppets.researchers = (None, None)
    play.hunt.run(60)
    assert play.view.robots[0].commander is Commander.GROUND_STATION
    assert play.events(CommanderChanged)[1:] == [
        CommanderChanged(0, Commander.RESEARCHER, "/rviz"),
        CommanderChanged(0, Commander.GROUND_STATION, NAME),
    ]


def test_whoever_commands_a_robot_has_it_in_the_next_game_too(play: ScriptedHunt) -> None:
    play.ask(TAKE)
    play.wish(EndGame(1))
    view = play.wish(PlayAgain(1), ticks=10)
    assert view.game == 2
    assert [robot.commander for robot in view.robots] == [Commander.GROUND_STATION, Commander.PARTICIPANT]


def test_a_keeper_that_comes_back_gives_robots_back_to_the_participant(play: ScriptedHunt) -> None:
    play.ask(TAKE)
    again = ScriptedHunt(history=play.hunt.log.entries)
    assert again.view.robots[0].commander is Commander.PARTICIPANT
    assert again.events(CommanderChanged)[-1] == CommanderChanged(0, Commander.PARTICIPANT, "")


def test_nobody_is_sent_before_the_treasures_are_hidden() -> None:
    hunt = HuntWithoutSimulator()
    for _ in range(20):
        hunt.session.ask("station", TAKE)
        hunt.session.ask("station", StationSend(0, 3))
        hunt.run(1)
    happened = [type(event) for event in hunt.log.events if isinstance(event, TreasuresHidden | RobotDeparted)]
    assert happened[0] is TreasuresHidden and RobotDeparted in happened


@pytest.mark.parametrize("strategy", BotStrategy)
def test_a_simulated_participant_waits_for_robots_that_others_command(strategy: BotStrategy) -> None:
    hunt = HuntWithoutSimulator(robots=2, strategy=strategy)
    hunt.run(5)
    hunt.session.ask("station", TAKE)
    hunt.run(3000)
    departures = [event for event in hunt.log.events if isinstance(event, RobotDeparted) and event.robot == 0]
    assert hunt.session.game.ended is None and not departures
    hunt.session.ask("station", ReleaseCommand(0))
    hunt.finish()
    assert any(isinstance(event, RobotDeparted) and event.robot == 0 for event in hunt.log.events)


def test_programs_of_before_are_understood(play: ScriptedHunt) -> None:
    fields = msgspec.to_builtins(play.ask(TAKE))
    for robot in fields["robots"]:
        del robot["commander"], robot["commander_name"], robot["asked_back"]
    view = View.of_notice(Notice(KEEPER, "TabUI", "View", fields))
    assert view is not None and view.robots[0].commander is Commander.PARTICIPANT
    status = msgspec.to_builtins(TeamStatus(1, (), (), ()))
    del status["researchers"]
    assert decode_notice(Notice("SimR", KEEPER, "Status", status), TeamStatus) == TeamStatus(1, (), (), ())
    orders = msgspec.to_builtins(Orders(1, (), (), (), None))
    del orders["taken"]
    assert decode_notice(Notice(KEEPER, "SimR", "Orders", orders), Orders) == Orders(1, (), (), (), None)


def test_a_robot_is_asked_for_at_once_and_again_after_ten_seconds(play: ScriptedHunt) -> None:
    view = play.ask(TAKE)
    assert not view.robots[0].asked_back
    assert play.wish(RequestHandback(0)).robots[0].asked_back
    assert play.wish(RequestHandback(0), ticks=480).robots[0].asked_back
    assert play.events(HandbackRequested) == [HandbackRequested(0)]
    play.hunt.run(20)
    assert not play.view.robots[0].asked_back
    assert play.wish(RequestHandback(0)).robots[0].asked_back
    assert play.events(HandbackRequested) == [HandbackRequested(0)] * 2 and play.view.refusal is None


def test_who_takes_a_robot_next_is_asked_anew(play: ScriptedHunt) -> None:
    play.ask(TAKE)
    assert play.wish(RequestHandback(0)).robots[0].asked_back
    assert not play.ask(TakeCommand(0, "ground station 7")).robots[0].asked_back
    assert play.wish(RequestHandback(0)).robots[0].asked_back
    assert not play.ask(ReleaseCommand(0)).robots[0].asked_back


def test_a_researcher_is_asked_too_and_nobody_for_what_is_the_participants(play: ScriptedHunt) -> None:
    play.wish(RequestHandback(0), RequestHandback(1), RequestHandback(9))
    assert not play.events(HandbackRequested)
    play.hunt.puppets.researchers = ("/rviz", None)
    play.hunt.run(60)
    assert play.wish(RequestHandback(0)).robots[0].asked_back
    assert play.events(HandbackRequested) == [HandbackRequested(0)]


def test_another_game_begins_with_nothing_asked_for(play: ScriptedHunt) -> None:
    play.ask(TAKE)
    play.wish(RequestHandback(0))
    assert play.wish(EndGame(1)).over is not None
    refusal = play.wish(RequestHandback(0)).refusal
    assert refusal is not None and refusal.reason == RuleReason.GAME_OVER
    robot = play.wish(PlayAgain(1), ticks=10).robots[0]
    assert (robot.commander, robot.asked_back) == (Commander.GROUND_STATION, False)


def test_what_a_station_leaves_unnamed_the_participant_still_names(play: ScriptedHunt) -> None:
    play.ask(TAKE, StationSend(0, 3), ticks=20)
    view = play.ask(StationSend(0, 4), ticks=3)
    assert view.robots[0].moving_to == 4 and not play.events(TreasureLeft)
    assert (view.room(3).robot, view.room(3).undecided) == (0, True)
    refusal = play.wish(OpenDialogue(0, "take-picture", 3)).refusal
    assert refusal is not None and refusal.sentence == "No robot stands in room 3."
    view = play.wish(OpenDialogue(0, "take-treasure", 3))
    while view.dialogues:
        (dialogue,) = view.dialogues
        view = play.wish(AnswerDialogue(dialogue.dialogue, dialogue.turn, 0), ticks=4)
    name = play.hunt.session.game.treasure(Room(3)).name
    assert play.wish(IdentifyTreasure(3, name)).room(3).verdict.points > 0
    assert play.events(TreasureIdentified)[0].robot == 0


@pytest.mark.parametrize("strategy", BotStrategy)
def test_a_simulated_participant_looks_after_what_stations_leave(strategy: BotStrategy) -> None:
    hunt = HuntWithoutSimulator(robots=2, strategy=strategy)
    hunt.run(5)
    hunt.session.ask("station", TAKE)
    for room in (7, 8):
        # The station moves on as soon as its robot is there, before anybody can have decided.
        hunt.session.ask("station", StationSend(0, room))
        while RobotArrived(0, Room(room)) not in hunt.log.events:
            hunt.run(1)
            assert len(hunt.tick_records) < 200, "the robot does not arrive"
    hunt.session.ask("station", ReleaseCommand(0))
    hunt.finish()
    happened = hunt.log.events
    decided = [
        event for event in happened if isinstance(event, TreasureIdentified | TreasureLeft) and event.room == Room(7)
    ]
    assert happened.index(decided[0]) > next(
        at for at, event in enumerate(happened) if event == RobotArrived(0, Room(7))
    )
    assert not any(isinstance(event, TreasurePictured) and event.room == Room(7) for event in happened)
    assert all(room.is_decided for room in hunt.session.game.rooms if room.sensed)
