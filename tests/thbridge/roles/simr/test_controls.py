"""What is asked of robots beside the game, and how that goes together with the game."""

from dataclasses import replace
from pathlib import Path

import pytest

from sim.common.geometry import Pose2
from sim.common.observations import Twist
from sim.parameters import RobotParameters
from sim.parameters.reconfiguration import ParameterRejection, with_values
from tests.thbridge.roles.simr.driven_simr import DrivenSimR, orders
from thbridge.app.compose.robots import build_simr
from thbridge.app.compose.setting import read_setting
from thbridge.roles.shared.notices import KEEPER, MoveOrder, Orders, TeamStatus
from thbridge.roles.shared.robot_requests import SetParameters
from thbridge.roles.simr.controls import MANUAL_DRIVE_TICKS
from thbridge.ros.messages.records import CancelRequest, GoalRequest, InitialPose, SimpleGoal, VelocityCommand
from thbridge.study.study_file import Study
from thbridge.text_protocol.wire import canonical, legacy
from thbridge.text_protocol.wire.notice_format import encode_notice

NEAR = Pose2(0.5, 0.0, 0.0)
CLIENT = 10**6


@pytest.fixture
def driver():
    """Two robots; the first is under way for the game to room 2, its move 1."""
    driver = DrivenSimR(build_simr(read_setting(replace(Study(), robots=2), Path())))
    driver.run(30, orders(1, MoveOrder(1, 2), None))
    assert goal_of(driver) == 1
    return driver


def goal_of(driver: DrivenSimR) -> int | None:
    goal = driver.simr.snapshot.robots[0].navigation.goal
    return None if goal is None else goal.id


def ask_for(driver: DrivenSimR, number: int = CLIENT, goal: Pose2 | None = None) -> None:
    here = driver.simr.snapshot.robots[0].estimate.base_in_map
    target = goal or Pose2(here.x, here.y, here.theta + 1.0)
    driver.simr.ask(GoalRequest(0, f"client-{number}", 0, target, number))


def test_a_clients_goal_wins_and_then_the_order_of_the_game_goes_on(driver):
    ask_for(driver)
    driver.run(1)
    assert goal_of(driver) == CLIENT
    for _ in range(1000):
        driver.run(1)
        if goal_of(driver) != CLIENT:
            break
    driver.run(3)
    assert goal_of(driver) == 1
    assert driver.levels(TeamStatus)[-1].results[0] is None
    driver.until('%%error SimR TabUI "0;1" ')
    assert driver.levels(TeamStatus)[-1].results[0].arrived


@pytest.mark.parametrize("pause", [0, 1])
def test_a_client_whose_next_goal_comes_right_after_its_last_keeps_the_robot(driver, pause):
    ask_for(driver)
    driver.run(1)
    while goal_of(driver) == CLIENT:
        driver.run(1)
    driver.run(pause)
    assert goal_of(driver) is None
    ask_for(driver, CLIENT + 1)
    driver.run(1)
    assert goal_of(driver) == CLIENT + 1


def test_the_newest_goal_of_clients_wins(driver):
    ask_for(driver)
    driver.simr.ask(SimpleGoal(0, NEAR, CLIENT + 1))
    driver.run(1)
    assert goal_of(driver) == CLIENT + 1


def test_an_order_of_the_game_takes_the_robot_from_a_client(driver):
    ask_for(driver)
    driver.run(1)
    driver.run(1, orders(1, MoveOrder(2, 3), None))
    assert goal_of(driver) == 2


def test_a_client_can_take_its_goal_back_but_not_the_game_s_for_long(driver):
    ask_for(driver)
    driver.run(1)
    driver.simr.ask(CancelRequest(0, f"client-{CLIENT}", 0))
    driver.run(1)
    assert goal_of(driver) is None
    driver.run(3)
    assert goal_of(driver) == 1
    driver.simr.ask(CancelRequest(0, "", 0))
    driver.run(1)
    assert goal_of(driver) is None
    driver.run(3)
    assert goal_of(driver) == 1


def test_a_cancel_of_a_goal_that_ended_touches_nothing(driver):
    driver.simr.ask(CancelRequest(0, "long ago", 0))
    driver.run(2)
    assert goal_of(driver) == 1


def test_a_goal_that_cannot_be_used_is_none(driver):
    driver.simr.ask(GoalRequest(0, "bad", 0, None, CLIENT, "it is not finite"))
    driver.run(1)
    assert driver.simr.snapshot.robots[0].navigation.goal is None
    driver.run(3)
    assert goal_of(driver) == 1


def test_hands_on_the_wheel_hold_the_order_back_and_no_longer(driver):
    for _ in range(4):
        driver.simr.ask(VelocityCommand(0, Twist(0.0, 0.5)))
        driver.run(MANUAL_DRIVE_TICKS - 1)
        assert goal_of(driver) is None
        assert driver.simr.snapshot.commands[0].tolist() == [0.0, 0.5]
    driver.run(4)
    assert goal_of(driver) == 1


def test_an_initial_pose_moves_the_belief_and_not_the_robot(driver):
    before = driver.simr.snapshot.world.poses[0].copy()
    driver.simr.ask(InitialPose(0, Pose2(-3.0, -3.0, 0.0), driver.simr.snapshot.robots[0].estimate.covariance))
    driver.run(1)
    believed = driver.simr.snapshot.robots[0].estimate.base_in_map
    assert believed.distance(Pose2(-3.0, -3.0, 0.0)) < 0.5
    assert abs(driver.simr.snapshot.world.poses[0] - before).max() < 0.1
    assert goal_of(driver) == 1


def test_parameters_asked_for_in_one_tick_add_up(driver):
    driver.simr.ask(SetParameters(0, (("amcl.max_particles", 400),)))
    driver.simr.ask(SetParameters(0, (("amcl.laser_z_rand", 0.25),)))
    driver.simr.ask(SetParameters(0, (("amcl.laser_z_hit", 0.9), ("amcl.no_such_thing", 1))))
    driver.run(1)
    amcl = driver.simr._team.parameters[0].amcl
    assert (amcl.max_particles, amcl.laser_z_rand) == (400, 0.25)
    assert amcl.laser_z_hit == RobotParameters().amcl.laser_z_hit
    assert goal_of(driver) == 1


def test_robots_that_there_are_not_are_not_asked(driver):
    driver.simr.ask(VelocityCommand(2, Twist(1.0, 0.0)))
    driver.simr.ask(VelocityCommand(-1, Twist(1.0, 0.0)))
    driver.run(2)
    assert driver.simr.snapshot.commands[1].tolist() == [0.0, 0.0]


def test_values_that_only_fit_together_come_in_any_order():
    parameters = RobotParameters()
    greatest = parameters.amcl.max_particles
    together = (("amcl.min_particles", greatest + 1), ("amcl.max_particles", greatest + 2))
    for values in (together, together[::-1]):
        changed = with_values(parameters, values)
        assert isinstance(changed, RobotParameters)
        assert (changed.amcl.min_particles, changed.amcl.max_particles) == (greatest + 1, greatest + 2)
    assert isinstance(with_values(parameters, together[:1]), ParameterRejection)


def researchers(driver: DrivenSimR) -> tuple[str | None, ...]:
    return driver.levels(TeamStatus)[-1].researchers


def test_whoever_sets_a_goal_is_told_to_intervene_until_it_ends(driver):
    assert researchers(driver) == (None, None)
    here = driver.simr.snapshot.robots[0].estimate.base_in_map
    driver.simr.ask(GoalRequest(0, "client", 0, Pose2(here.x, here.y, here.theta + 1.0), CLIENT), "/move_base_client")
    driver.run(1)
    assert researchers(driver) == ("/move_base_client", None)
    while goal_of(driver) == CLIENT:
        driver.run(1)
    driver.run(1)
    assert researchers(driver) == (None, None)


def test_whoever_drives_by_hand_intervenes_until_the_last_command_is_over(driver):
    driver.simr.ask(VelocityCommand(1, Twist(0.1, 0.0)), "/teleop")
    driver.run(MANUAL_DRIVE_TICKS - 1)
    assert researchers(driver) == (None, "/teleop")
    driver.run(2)
    assert researchers(driver) == (None, None)


def test_what_is_asked_in_nobody_s_name_is_no_intervention(driver):
    driver.simr.ask(VelocityCommand(1, Twist(0.1, 0.0)))
    ask_for(driver)
    driver.run(60)
    assert all(status.researchers == (None, None) for status in driver.levels(TeamStatus))


def test_a_room_that_the_keeper_refuses_is_no_point_in_metres(driver):
    free = Orders(1, (None, None), (90.0, 80.0), (0, 0), None)
    driver.run(1, encode_notice(KEEPER, legacy.SIMR, free))
    driver.run(3, legacy.GotoRoom(0, 8).message(), canonical.encode(canonical.GotoPoint(1, 0.5, 0.0), "Me", "SimR"))
    assert driver.simr.snapshot.robots[0].navigation.goal is None
    assert driver.simr.snapshot.robots[1].navigation.goal is not None


def test_no_line_drives_a_robot_that_somebody_has_taken(driver):
    taken = Orders(1, (MoveOrder(1, 2), None), (90.0, 80.0), (0, 0), None, taken=(1,))
    driver.run(1, encode_notice(KEEPER, legacy.SIMR, taken))
    lines = (canonical.GotoPoint(1, 0.5, 0.0), canonical.MoveByHand(1, canonical.MoveDirection.FORWARD, 5))
    driver.run(1, *(canonical.encode(line, "Me", "SimR") for line in lines))
    driver.run(3)
    assert driver.simr.snapshot.robots[1].navigation.goal is None
    assert not driver.simr.snapshot.commands[1].any()
