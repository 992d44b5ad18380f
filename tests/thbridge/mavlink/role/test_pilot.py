"""At the helm of real (simulated) robots in a real game: what becomes of what a ground station asks."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from sim.common.geometry import Pose2
from sim.common.grid import OCCUPIED, UNKNOWN
from sim.common.observations import Twist
from sim.inputs import KillRobot, SendGoal
from sim.parameters import NavfnParameters, RobotParameters
from sim.robot.navigator.goals import Goal
from tests.support.hunts.scripted_hunt import ScriptedPlayer
from tests.support.mavlink.piloted_hunt import STATION, Parameters, PilotedHunt, setting
from thbridge.app.compose.game import build_briefing
from thbridge.app.compose.setting import read_setting
from thbridge.app.compose.vehicles import build_game_setup
from thbridge.hunt.costs import CostMatrix
from thbridge.hunt.events import (
    Commander,
    CommanderChanged,
    GameStarted,
    HandbackRequested,
    MoveFailed,
    RobotArrived,
    RobotDeparted,
    TreasureIdentified,
    TreasureLeft,
    TreasurePictured,
)
from thbridge.hunt.game import GameState, apply, begin
from thbridge.hunt.rooms import Room
from thbridge.mavlink.role.pilot import Pilot
from thbridge.mavlink.role.speed_limit import SpeedLimit
from thbridge.mavlink.role.station_texts import game_texts, handback_texts
from thbridge.mavlink.values.conventions import BY_PARTICIPANT
from thbridge.mavlink.values.vehicle_interface import DenialKind, Denied, LegState, Target
from thbridge.mavlink.vehicle.mode.operator_control import OperatorControl
from thbridge.roles.participant.tabui import TabUI
from thbridge.roles.shared.failure_reasons import failure_sentence
from thbridge.roles.shared.robot_requests import SetParameters
from thbridge.roles.shared.view import RequestHandback
from thbridge.roles.simr.controls import MANUAL_DRIVE_TICKS
from thbridge.ros.messages.records import SimpleGoal
from thbridge.study.seats import SeatEntry

UNDER_WAY, ARRIVED, FAILED = LegState.UNDER_WAY, LegState.ARRIVED, LegState.FAILED


class RealRobots:
    """Their software is not ours to change."""

    def tuning(self, robot):
        return None

    def ask(self, request):
        """Nobody does it."""


OF_OTHERS = SpeedLimit(0, RobotParameters(), RealRobots())


@pytest.fixture
def flight() -> PilotedHunt:
    return PilotedHunt()


@pytest.fixture
def taken(flight: PilotedHunt) -> PilotedHunt:
    return flight.taken()


def test_readings_before_anybody_has_come(flight: PilotedHunt) -> None:
    readings = flight.run()
    assert readings.responsive and not readings.lost and not readings.under_way
    assert (readings.commander, readings.commanded_by, readings.leg) == (None, "participant", None)
    assert (readings.energy, readings.capacity) == (100.0, 100.0)
    assert readings.base_in_map.distance(flight.pilot.start()) < 0.01


def test_taking_and_releasing_is_seen_with_the_next_tick(flight: PilotedHunt) -> None:
    flight.pilot.take(STATION)
    readings = flight.run()
    assert (readings.commander, readings.commanded_by) == ("ground station 255", "ground station 255")
    flight.pilot.release()
    readings = flight.run()
    assert (readings.commander, readings.commanded_by) == (None, "participant")


def test_only_who_commands_drives(flight: PilotedHunt) -> None:
    refused = Denied("Robot 1 is commanded by the participant just now.")
    assert flight.pilot.go_to(Target(*flight.goal_of(3))) == refused
    assert flight.pilot.drive(Twist(0.1, 0.0)) == refused
    assert flight.pilot.photograph() == refused
    # What was asked for between two ticks holds already.
    flight.pilot.take(STATION)
    assert isinstance(flight.pilot.go_to(Target(*flight.goal_of(3))), int)
    flight.pilot.release()
    assert flight.pilot.drive(Twist(0.1, 0.0)) == refused


def test_a_point_in_a_room_is_a_move_of_the_game(taken: PilotedHunt) -> None:
    x, y = taken.goal_of(4)
    number = taken.pilot.go_to(Target(x + 0.1, y - 0.1, 1.0))
    readings = taken.run(3)
    assert readings.leg.number == number and readings.leg.state is UNDER_WAY and readings.leg.remaining > 0.5
    readings = taken.run(20)
    assert readings.under_way and readings.goal_in_map.distance(taken.setting.map.rooms[3].goal) < 1e-9
    assert readings.energy == 100.0 - taken.events(RobotDeparted)[0].cost
    readings = taken.until(ARRIVED)
    assert readings.leg.number == number and readings.leg.remaining == 0.0
    assert taken.events(RobotDeparted, RobotArrived)[1] == RobotArrived(0, Room(4))
    taken.run(3)
    assert taken.session.game.room(Room(4)).sensed is not None


def test_rules_answer_at_once(taken: PilotedHunt) -> None:
    taken.pilot.go_to(Target(*taken.goal_of(4)))
    taken.pilots[1].take(STATION)
    taken.run(2)
    denied = taken.pilots[1].go_to(Target(*taken.goal_of(4)))
    assert denied == Denied("Robot 1 is already under way to room 4.")
    assert len(taken.events(RobotDeparted)) == 1


def test_too_little_energy_is_said_at_once() -> None:
    taken = PilotedHunt(energy=15.0).taken()
    denied = taken.pilot.go_to(Target(*taken.goal_of(3)))
    assert isinstance(denied, Denied) and "energy left, but going to room 3 costs" in denied.sentence
    assert not taken.events(RobotDeparted)


def test_a_point_outside_all_rooms_is_no_move_of_the_game(taken: PilotedHunt) -> None:
    home = taken.pilot.start()
    number = taken.pilot.go_to(Target(home.x + 0.6, home.y, 0.5))
    readings = taken.until(ARRIVED)
    assert readings.leg.number == number
    assert readings.base_in_map.distance(Pose2(home.x + 0.6, home.y, 0.5)) < 0.35
    assert readings.energy == 100.0 and not taken.events(RobotDeparted)
    assert [event.by for event in taken.events(CommanderChanged)] == [Commander.GROUND_STATION]


def _wall(taken: PilotedHunt) -> tuple[float, float]:
    """The middle of a wall outside of all rooms."""
    grid, setup = taken.setting.map.grid, build_game_setup(taken.setting)
    walls = (grid.centre_of(int(row), int(col)) for row, col in np.argwhere(grid.cells == OCCUPIED))
    return next(point for point in walls if setup.room_at(*point) is None)


def test_a_place_where_no_robot_can_stand_is_denied_at_once_with_the_navigators_words(taken: PilotedHunt) -> None:
    wall = _wall(taken)
    number = taken.pilot.go_to(Target(*taken.goal_of(4)))
    taken.run(5)
    for point, axis in ((wall, None), ((500.0, 0.0), "x"), ((0.0, -500.0), "y")):
        denied = taken.pilot.go_to(Target(*point))
        assert denied == taken.pilot.misplaced(*point) == taken.pilot.unreachable(*point)
        assert denied.axis == axis
        assert taken.run().leg.number == number, "the leg under way goes on"
        # The navigator of the other robot, asked directly, says the same.
        taken.ask(SendGoal(1, Goal(7, Pose2(*point, 0.0))))
        while (end := taken.session_snapshot.robots[1].navigation.result) is None:
            taken.run()
        assert failure_sentence(0, end.reason) == denied.sentence
        taken.run()


def test_a_place_of_which_the_map_knows_nothing_is_denied_and_one_beside_it_is_not(taken: PilotedHunt) -> None:
    setup, start = build_game_setup(taken.setting), taken.setting.map.starts[0]
    x, y = start.x + 0.6, start.y
    cells = setup.floor.grid.cells.copy()
    cells[setup.floor.grid.cell_of(x, y)] = UNKNOWN
    floor = replace(setup.floor, grid=replace(setup.floor.grid, cells=cells))
    pilot = Pilot(0, replace(setup, floor=floor), start, OF_OTHERS, Parameters(), taken.ask)
    assert pilot.misplaced(x, y) == Denied("The map does not show what is at the place where robot 1 should stand.")
    assert pilot.misplaced(x - 0.1, y) is None


def test_where_plans_may_end_apart_from_their_goal_the_navigator_has_the_last_word(taken: PilotedHunt) -> None:
    software = replace(taken.setting.study.robot, NavfnROS=NavfnParameters(default_tolerance=1.0))
    study = replace(taken.setting.study, robot=software)
    setup = build_game_setup(read_setting(study, Path()))
    pilot = Pilot(0, setup, taken.pilot.start(), OF_OTHERS, Parameters(), taken.ask)
    assert pilot.unreachable(500.0, 500.0) is None
    assert pilot.misplaced(500.0, 500.0) is not None


def test_points_in_rooms_are_for_the_game_to_judge_and_one_that_was_visited_is_done(taken: PilotedHunt) -> None:
    place = Target(*taken.goal_of(4))
    assert taken.pilot.unreachable(place.x, place.y) is None
    taken.pilot.go_to(place)
    taken.until(ARRIVED)
    taken.pilot.go_to(Target(taken.pilot.start().x, taken.pilot.start().y))
    taken.pilots[1].take(STATION)
    taken.run(2)
    assert taken.pilots[1].go_to(place) == Denied("Room 4 has been visited already.", is_done=True)


@pytest.mark.parametrize("point", [(float("nan"), 0.0), (0.0, float("inf"))])
def test_no_point_at_all_is_refused(taken: PilotedHunt, point: tuple[float, float]) -> None:
    assert isinstance(taken.pilot.go_to(Target(*point)), Denied)


def test_a_move_under_way_is_called_back_before_the_next_and_gives_its_energy_back(taken: PilotedHunt) -> None:
    first = taken.pilot.go_to(Target(*taken.goal_of(4)))
    taken.run(60)
    second = taken.pilot.go_to(Target(*taken.goal_of(3)))
    assert second == first + 1
    readings = taken.until(ARRIVED)
    assert readings.leg.number == second
    happened = taken.events(RobotDeparted, MoveFailed, RobotArrived)
    assert [type(event) for event in happened] == [RobotDeparted, MoveFailed, RobotDeparted, RobotArrived]
    assert happened[1].refund > 0.0 and happened[3].room == Room(3)


def test_legs_asked_for_within_one_tick_leave_the_last_one(taken: PilotedHunt) -> None:
    home = taken.pilot.start()
    taken.pilot.go_to(Target(*taken.goal_of(4)))
    taken.pilot.go_to(Target(home.x + 0.5, home.y))
    last = taken.pilot.go_to(Target(*taken.goal_of(3)))
    readings = taken.until(ARRIVED)
    assert readings.leg.number == last and taken.events(RobotArrived) == [RobotArrived(0, Room(3))]


def test_the_same_room_again_goes_on(taken: PilotedHunt) -> None:
    taken.pilot.go_to(Target(*taken.goal_of(3)))
    taken.run(30)
    number = taken.pilot.go_to(Target(*taken.goal_of(3)))
    assert taken.until(ARRIVED).leg.number == number
    assert len(taken.events(RobotDeparted)) == 1 and not taken.events(MoveFailed)


@pytest.mark.parametrize("ticks", [0, 1, pytest.param(2, marks=pytest.mark.slow), 3, 40])
def test_halt_ends_whatever_is_under_way(taken: PilotedHunt, ticks: int) -> None:
    number = taken.pilot.go_to(Target(*taken.goal_of(4)))
    taken.run(ticks)
    taken.pilot.stop_robot()
    readings = taken.run(10)
    assert (readings.leg.number, readings.leg.state, readings.leg.reason) == (number, FAILED, "It was stopped.")
    assert not readings.under_way and taken.session.game.robots[0].bound_for is None
    again = taken.pilot.go_to(Target(*taken.goal_of(3)))
    assert taken.until(ARRIVED).leg.number == again


def test_anybody_at_the_helm_may_halt_what_the_participant_ordered(flight: PilotedHunt) -> None:
    flight.taken()
    flight.pilot.go_to(Target(*flight.goal_of(4)))
    flight.run(20)
    flight.pilot.release()
    flight.run(2)
    flight.pilot.stop_robot()
    flight.run(10)
    assert [event.room for event in flight.events(MoveFailed)] == [Room(4)]


def test_a_robot_goes_on_when_it_is_given_back(taken: PilotedHunt) -> None:
    taken.pilot.go_to(Target(*taken.goal_of(3)))
    taken.run(5)
    taken.pilot.release()
    assert taken.until(ARRIVED).commanded_by == "participant"


def test_a_way_home_outlives_the_command_of_a_station_that_was_lost(taken: PilotedHunt) -> None:
    taken.pilot.go_to(Target(*taken.goal_of(4)))
    taken.run(60)
    home = taken.pilot.start()
    number = taken.pilot.go_to(Target(home.x, home.y, home.theta))
    taken.pilot.release()
    readings = taken.until(ARRIVED)
    assert (readings.leg.number, readings.commanded_by) == (number, "participant")
    assert readings.base_in_map.distance(home) < 0.35
    assert [event.room for event in taken.events(MoveFailed)] == [Room(4)]


def test_a_way_home_ends_where_the_participant_sends_the_robot_elsewhere(taken: PilotedHunt) -> None:
    home = taken.pilot.start()
    taken.pilot.go_to(Target(home.x + 1.5, home.y))
    taken.pilot.release()
    taken.run(5)
    taken.send_as_participant(3)
    readings = taken.run(5)
    assert (readings.leg.state, readings.leg.reason) == (FAILED, "It was sent elsewhere, or stopped.")


def test_hand_driving_needs_repeating_and_takes_the_place_of_a_leg(taken: PilotedHunt) -> None:
    number = taken.pilot.go_to(Target(*taken.goal_of(4)))
    taken.run(30)
    for _ in range(10):
        assert taken.pilot.drive(Twist(0.0, 0.5)) is None
        readings = taken.run(5)
    assert (readings.leg.number, readings.leg.state) == (number, FAILED)
    assert taken.session.game.robots[0].bound_for is None
    assert readings.twist.angular > 0.3
    taken.run(MANUAL_DRIVE_TICKS + 20)
    assert abs(taken.readings[0].twist.angular) < 0.1
    assert taken.readings[0].commanded_by == "ground station 255"


def test_a_researcher_goes_before_and_is_named(taken: PilotedHunt) -> None:
    home = taken.pilot.start()
    taken.session.ask("/rviz", SimpleGoal(0, Pose2(home.x, home.y, home.theta + 2.0), 1_000_000_000))
    taken.run(3)
    readings = taken.readings[0]
    # The station keeps the robot, and has it again when the researcher is done.
    assert (readings.commander, readings.commanded_by) == ("ground station 255", "researcher")
    denied = taken.pilot.go_to(Target(*taken.goal_of(3)))
    assert denied == Denied("Robot 1 is commanded by a researcher just now.", DenialKind.NOT_NOW)
    for _ in range(600):
        if taken.run().commanded_by != "researcher":
            break
    assert isinstance(taken.pilot.go_to(Target(*taken.goal_of(3))), int)
    assert [(event.by, event.name) for event in taken.events(CommanderChanged)][1:] == [
        (Commander.RESEARCHER, "/rviz"),
        (Commander.GROUND_STATION, "ground station 255"),
    ]


def test_a_dead_robot_says_so_and_is_refused(taken: PilotedHunt) -> None:
    home = taken.pilot.start()
    taken.pilot.go_to(Target(home.x + 0.6, home.y))
    taken.run(5)
    taken.session.ask("researcher", KillRobot(0))
    readings = taken.run(120)
    assert not readings.responsive and not readings.under_way
    assert (readings.leg.state, readings.leg.reason) == (FAILED, "Robot 1 no longer answers.")
    refused = Denied("Robot 1 no longer answers.")
    assert taken.pilot.go_to(Target(*taken.goal_of(3))) == refused
    assert taken.pilot.drive(Twist(0.1, 0.0)) == refused
    assert taken.pilot.take(STATION) == refused


def test_treasures_are_pictured_named_and_left_from_the_helm(taken: PilotedHunt) -> None:
    assert taken.pilot.photograph() == Denied("The corridor is not a room of this game; it has 1 to 8.")
    taken.pilot.go_to(Target(*taken.goal_of(3)))
    taken.until(ARRIVED)
    taken.run(3)
    assert isinstance(taken.pilot.identify(0), Denied)
    assert taken.pilot.photograph() is None
    names = build_briefing(taken.setting).names
    treasure = taken.session.game.treasure(Room(3))
    assert taken.pilot.identify(names.index(treasure.name) + 1) is None
    taken.run(3)
    assert [event.points for event in taken.events(TreasureIdentified)] == [treasure.points]
    assert taken.news == [
        "Robot 1 is in room 3.",
        f"Room 3: something {', '.join(treasure.properties.values()).lower()}.",
        "Room 3: a picture was taken.",
        f"Room 3: {treasure.name}, {treasure.points:+d} points.",
    ]
    assert len(taken.events(TreasurePictured)) == 1
    assert taken.pilot.leave() == Denied("The treasure in room 3 has been decided already.")
    assert not taken.events(TreasureLeft)


def test_a_station_is_told_what_the_participant_asks_of_it_and_no_other_is(taken: PilotedHunt) -> None:
    taken.pilots[1].take(STATION)
    taken.run(2)
    asked = []
    taken.player.wish = (RequestHandback(0),)
    taken.tabui.poll_player()
    for _ in range(10):
        taken.run()
        asked.append([readings.participant_requests for readings in taken.readings])
    assert [told for told in asked if any(told)] == [[("The participant asks for robot 1 back.",), ()]]


def test_what_a_participant_asks_of_a_researcher_alone_is_told_to_no_station() -> None:
    def asks(state: GameState) -> list[str]:
        return [*handback_texts(0, state, apply(state, HandbackRequested(0)))]

    costs = CostMatrix(((0.0, 1.0), (1.0, 0.0)))
    state = begin(GameStarted(1, 1, 1, 10.0, 1.0, 1.0, 1.0, costs))
    researcher = CommanderChanged(0, Commander.RESEARCHER, "/rviz")
    assert asks(apply(state, researcher)) == []
    station = CommanderChanged(0, Commander.GROUND_STATION, "ground station 255")
    assert asks(apply(apply(state, station), researcher)) == ["The participant asks for robot 1 back."]


def test_a_robot_returns_to_the_seat_that_had_it_and_stations_read_the_names_of_seats() -> None:
    seats = (SeatEntry("driver", robots=(1, 2)), SeatEntry("namer", label="die Namensgeberin"))
    player = ScriptedPlayer()
    hunt = PilotedHunt(participant=TabUI(player, seat="namer"), seats=seats)
    said: list[str] = []
    control = OperatorControl(hunt.pilot, 5.0, lambda _, text: said.append(text))
    control.follow(0, hunt.readings[0])
    assert (hunt.readings[0].commanded_by, control.commander_id) == ("driver", BY_PARTICIPANT)
    assert control.take(STATION) is None
    control.follow(1, hunt.run(2))
    player.wish = (RequestHandback(0),)
    hunt.tabui.poll_player()
    asked = [text for _ in range(10) for text in hunt.run().participant_requests]
    assert asked == ["Die Namensgeberin asks for robot 1 back."]
    control.release()
    control.follow(2, hunt.run(2))
    assert said == ["Commanded by ground station 255.", "Commanded by the driver again."]
    assert hunt.readings[0].commanded_by == "driver"
    assert [(each.by, each.name) for each in hunt.events(CommanderChanged)] == [
        (Commander.GROUND_STATION, "ground station 255"),
        (Commander.PARTICIPANT, "driver"),
    ]


def test_a_station_is_told_that_the_participant_leaves_a_find_and_takes_it_up_again() -> None:
    costs = CostMatrix(((0.0, 1.0), (1.0, 0.0)))
    state = begin(GameStarted(1, 1, 1, 10.0, 1.0, 1.0, 1.0, costs))
    for event in (CommanderChanged(0, Commander.GROUND_STATION, "ground station 255"), RobotArrived(0, Room(1))):
        state = apply(state, event)
    left = apply(state, TreasureLeft(Room(1)))
    assert [*game_texts(0, state, left)] == ["Room 1: what is there is left there."]
    assert [*game_texts(0, left, state)] == ["Room 1: what is there is taken up again."]


def test_speed_is_limited_and_as_the_study_says_again(taken: PilotedHunt) -> None:
    assert taken.pilot.limit_speed(0.2) is None
    assert taken.asked[-1] == SetParameters(0, (("TrajectoryPlannerROS.max_vel_x", 0.2),))
    taken.pilot.limit_speed(50.0)
    assert taken.asked[-1] == SetParameters(0, (("TrajectoryPlannerROS.max_vel_x", 1.0),))
    taken.pilot.limit_speed(-1.0)
    assert taken.asked[-1] == SetParameters(0, (("TrajectoryPlannerROS.max_vel_x", 1.0),))
    count = len(taken.asked)
    assert isinstance(taken.pilot.limit_speed(0.01), Denied)
    assert isinstance(taken.pilot.limit_speed(float("nan")), Denied)
    assert len(taken.asked) == count


def test_a_limit_holds_for_hand_driving_too(taken: PilotedHunt) -> None:
    taken.pilot.limit_speed(0.2)
    for _ in range(4):
        taken.pilot.drive(Twist(0.9, 0.0))
        taken.run(10)
    assert 0.15 < taken.readings[0].twist.linear < 0.25


def test_who_changes_the_local_planner_by_a_parameter_has_the_other_ones_speed_limited(taken: PilotedHunt) -> None:
    taken.simr.ask(SetParameters(0, (("move_base.base_local_planner", "dwa_local_planner/DWAPlannerROS"),)))
    assert taken.pilot.limit_speed(0.2) is None
    assert taken.asked[-1] == SetParameters(0, (("DWAPlannerROS.max_vel_x", 0.2), ("DWAPlannerROS.max_vel_trans", 0.2)))
    taken.run(2)
    assert taken.pilot.fastest().linear == 0.2


def test_who_changes_a_speed_by_a_parameter_finds_it_changed(taken: PilotedHunt) -> None:
    taken.simr.ask(SetParameters(0, (("TrajectoryPlannerROS.max_vel_x", 0.4),)))
    assert taken.pilot.fastest().linear == 0.4


def test_real_robots_speeds_are_not_ours() -> None:
    flight = PilotedHunt()
    pilot = Pilot(0, build_game_setup(setting()), Pose2(0.0, 0.0, 0.0), OF_OTHERS, Parameters(), flight.ask)
    denied = pilot.limit_speed(0.5)
    assert isinstance(denied, Denied) and denied.kind is DenialKind.UNSUPPORTED


def test_nothing_is_granted_before_there_is_a_game() -> None:
    pilot = Pilot(0, build_game_setup(setting()), Pose2(0.0, 0.0, 0.0), OF_OTHERS, Parameters(), lambda _: None)
    for refused in (pilot.take(STATION), pilot.go_to(Target(0.0, 0.0)), pilot.drive(Twist(0.0, 0.0)), pilot.leave()):
        assert isinstance(refused, Denied) and refused.kind is DenialKind.NOT_NOW
    pilot.stop_robot()
