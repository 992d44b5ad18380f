"""The transition tables of the navigator and of its follower: all that they declare occurs, and nothing else."""

import math
from dataclasses import replace

import numpy as np
import pytest

from sim.common.geometry import Pose2
from sim.common.observations import STANDSTILL, Claim, LaserMount, Neighbour, Scan
from sim.parameters import RecoveryBehavior, RobotParameters
from sim.robot.global_planning.itinerary import timed_itinerary
from sim.robot.local_planning.local_planner import PlannedCommand
from sim.robot.navigator import follower, goal_execution, move_base
from sim.robot.navigator.follower import NO_POSES, Follower
from sim.robot.navigator.states import TRANSITIONS, Clearing, Controlling, Idle, Planning
from tests.sim.robot.navigator.ideal_robots import ARENA, FOOTPRINT, IdealRobots, dead_end

NO_TIMES = np.empty(0)


@pytest.fixture
def occurred(monkeypatch):
    """The transitions that occur; one that is not declared raises."""
    seen = set()
    for module in (goal_execution, follower):

        def check(table, state, event, following, checked=module.check_transition):
            checked(table, state, event, following)
            seen.add((type(state), event, type(following)))

        monkeypatch.setattr(module, "check_transition", check)
    return seen


def rig_at(start, grid=ARENA, **move_base):
    rotation = (RecoveryBehavior("rotate_recovery"),)
    parameters = RobotParameters()
    parameters = replace(parameters, move_base=replace(parameters.move_base, recovery_behaviors=rotation, **move_base))
    rig = IdealRobots([start], grid, parameters)
    rig.step()
    return rig


def asking(begin, end):
    """A robot with an older goal than anybody's that wants a straight path."""
    return Neighbour(9, Pose2(*begin, 0.0), STANDSTILL, FOOTPRINT, np.linspace(begin, end, 20), NO_TIMES, Claim(-1, 9))


def resting(x, y):
    return Neighbour(8, Pose2(x, y, 0.0), STANDSTILL, FOOTPRINT, np.empty((0, 2)), NO_TIMES)


def until(rig, state, seconds=30):
    rig.run(seconds, lambda rig: isinstance(rig.navigators[0]._execution.state, state))
    return rig


def idle():
    return rig_at((0, 3, 1.57), oscillation_timeout=1.0)


def planning():
    rig = idle()
    rig.go(0, 0, 6, 1.57)
    return rig


def controlling():
    return until(planning(), Controlling)


def giving_way():
    rig = idle()
    rig.strangers = [asking((0.0, 1.0), (0.0, 4.0))]
    return until(rig, Controlling)


def clearing():
    rig = controlling()
    rig.broken = {0}
    return until(rig, Clearing)


def clearing_without_goal():
    rig = giving_way()
    rig.broken = {0}
    return until(rig, Clearing)


def blocking(pose):
    """A wall 1.2 m ahead of where the robot looked first."""
    mount = LaserMount(Pose2(0.0, 0.0, 0.0), -0.6, 0.02, 61, 0.05, 8.0)
    return Scan(0, mount, (1.2 / np.cos(mount.angles())).astype(np.float32))


def requests():
    """Every request in every state."""
    for begun in (idle, planning, controlling, giving_way, clearing, clearing_without_goal):
        for request in ("replan", "cancel"):
            rig = begun()
            getattr(rig.navigators[0], request)()
        rig = begun()
        rig.lost = {0}
        rig.step()
        rig.lost = set()
        rig.step()
        rig = begun()
        until(rig, Idle | Planning)


def plans():
    """Plans made, refused, blocked by robots, and again under way."""
    rig = rig_at((0, -4, 1.57), planner_frequency=2.0)
    rig.go(0, 0, 6, 1.57)
    rig.run(10, lambda rig: rig.tick == 150)
    rig = rig_at((1, 2, 0), dead_end())
    rig.go(0, 8, 1.2)
    until(rig, Controlling)
    rig.strangers = [resting(5.2, 2.0)]
    until(rig, Planning)
    rig.run(2, lambda rig: rig.said[0].claim is not None)
    asked = rig.tick
    rig.run(2, lambda rig: rig.tick == asked + 50)
    rig = rig_at((3, 2, 0), dead_end())
    rig.go(0, 8, 1.2)
    until(rig, Controlling)
    rig.scans = blocking
    until(rig, Planning)


def ways_given():
    """Requests to clear a path, with and without a goal, with and without a place to go."""
    for goal in (None, (0.0, 4.0)):
        rig = rig_at((0, 3, 1.57))
        if goal is not None:
            rig.go(0, *goal)
        rig.strangers = [asking((0.0, 1.0), (0.0, 5.0))]
        until(rig, Controlling)
        until(rig, Idle | Planning)
    for goal in (None, (2.0, 2.0)):
        rig = rig_at((4, 2, 0), dead_end())
        if goal is not None:
            rig.go(0, *goal)
        rig.strangers = [asking((1.0, 2.0), (7.0, 2.0)), resting(5.2, 2.0)]
        rig.run(5, lambda rig: rig.said[0].claim is not None)
        rig.strangers = []
        rig.run(5, lambda rig: rig.said[0].claim is None)
    rig = rig_at((7, 2, math.pi), dead_end(), max_planning_retries=0)
    rig.scans = blocking
    rig.step()
    rig.scans = lambda pose: None
    rig.go(0, 1, 2)
    rig.strangers = [asking((8.0, 2.6), (7.0, 2.0))]
    until(rig, Clearing)
    rig.broken = {0}
    until(rig, Controlling)


def test_the_navigator_changes_its_state_as_its_transition_table_says(occurred):
    for scenario in (requests, plans, ways_given):
        scenario()
    assert occurred - follower.TRANSITIONS == TRANSITIONS


def test_a_change_that_is_not_declared_raises():
    with pytest.raises(RuntimeError, match="no command"):
        follower.check_transition(follower.TRANSITIONS, follower.AtEnd(), "no command", follower.Following())


def test_the_follower_changes_its_state_as_its_transition_table_says(occurred, monkeypatch):
    parameters = RobotParameters()
    planner = replace(parameters.TrajectoryPlannerROS, latch_xy_goal_tolerance=False)
    navigator = move_base.Navigator(replace(parameters, TrajectoryPlannerROS=planner), FOOTPRINT, ARENA)
    points = np.column_stack([np.zeros(11), np.linspace(0.0, 1.0, 11)])
    driven = Follower(
        navigator._controller, navigator._itinerary_planner, 0, timed_itinerary(points, 0.0), 1.57, turns_at_end=True
    )

    def drive(*places):
        for y, theta in places:
            driven.step(0, Pose2(0.0, y, theta), STANDSTILL, ())

    drive((0.0, 1.57), (0.4, 1.57), (0.8, 1.57), (0.95, 1.0), (0.85, 1.57))
    # From here on, no command leads on, but backing up does.
    monkeypatch.setattr(navigator._controller.planner, "follow", lambda *_: PlannedCommand(STANDSTILL, NO_POSES, True))
    monkeypatch.setattr(navigator._controller.planner, "escape", lambda *_: PlannedCommand(STANDSTILL, NO_POSES, False))
    drive((0.85, 1.57), (0.92, 1.57), (0.85, 1.57), (0.5, 1.57), (0.85, 1.57), (0.95, 1.57), (0.95, -1.0))
    assert occurred == follower.TRANSITIONS
