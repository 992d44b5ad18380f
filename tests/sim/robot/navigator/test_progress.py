"""Progress of goals: a robot that gets nowhere gets a recovery behavior, and its goal ends."""

import math
from dataclasses import replace

import numpy as np
import pytest

from sim.common.geometry import Pose2
from sim.common.observations import TICKS_PER_SECOND, Twist
from sim.parameters import RecoveryBehavior, RobotParameters
from sim.robot.local_planning.local_planner import LocalPlanner, PlannedCommand
from sim.robot.navigator.progress import STAY_DISTANCE, STAY_TIMEOUT, GoalProgress
from tests.sim.robot.navigator.ideal_robots import IdealRobots

NO_POSES = np.empty((0, 3))


def rig_by(monkeypatch, follow, **move_base):
    """A robot at (0, -4) that heads for (0, 6), by a local planner that returns `follow(pose)`."""
    monkeypatch.setattr(LocalPlanner, "follow", lambda self, pose, *_: follow(pose))
    parameters = RobotParameters()
    parameters = replace(parameters, move_base=replace(parameters.move_base, **move_base))
    rig = IdealRobots([(0, -4, 0.5 * math.pi)], parameters=parameters)
    rig.step()
    rig.go(0, 0, 6, 0.5 * math.pi)
    return rig


@pytest.mark.parametrize("timeout", [0.0, 600.0])
def test_a_robot_that_moves_to_and_fro_gets_a_recovery_and_its_goal_ends_whatever_oscillation_timeout_is(
    timeout, monkeypatch
):
    commands = [0]

    def to_and_fro(pose):
        commands[0] += 1
        return PlannedCommand(Twist(0.1 if commands[0] % 8 < 4 else -0.1, 0.0), NO_POSES, stuck=False)

    resets = (RecoveryBehavior("conservative_reset"), RecoveryBehavior("aggressive_reset"))
    rig = rig_by(monkeypatch, to_and_fro, oscillation_timeout=timeout, recovery_behaviors=resets)
    rig.run(STAY_TIMEOUT + 3, lambda rig: rig.navigators[0].recovery.tried == 1)
    rig.run(2 * (STAY_TIMEOUT + 3), lambda rig: rig.results[0])
    assert rig.results[0][0].reason == "stuck"
    assert rig.poses[0].distance(Pose2(0, -4, 0)) < 0.1


def test_a_robot_backs_up_as_far_as_it_means_to_however_often_plans_are_made(monkeypatch):
    lowest = [0.0]

    def leads_on_a_little_behind(pose):
        lowest[0] = min(lowest[0], pose.y)
        return PlannedCommand(Twist(0.2, 0.0), NO_POSES, stuck=pose.y > -4.03)

    rig = rig_by(monkeypatch, leads_on_a_little_behind, planner_frequency=10.0)
    rig.run(4, lambda rig: rig.tick == 150)
    assert lowest[0] < -4.0 - rig.navigators[0]._controller.planner.limits.escape_reset_dist


def test_driving_in_one_place_is_counted_and_moving_on_starts_again():
    progress, whole = GoalProgress(0), round(STAY_TIMEOUT * TICKS_PER_SECOND)
    progress.note_driving(5, Pose2(0, 0, 0))
    progress.note_driving(whole + 1, Pose2(0.9 * STAY_DISTANCE, 0, 0))
    assert progress.stays
    progress.note_driving(5, Pose2(STAY_DISTANCE, 0, 0))
    assert not progress.stays
