"""Inputs: all that people, or programs in their place, can do to a robot while it runs."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from sim.common.geometry import Pose2
from sim.common.observations import TICK, Twist
from sim.inputs import (
    ClearCostmapRegion,
    ClearCostmaps,
    DriveManually,
    GlobalLocalization,
    KidnapRobot,
    KillRobot,
    NomotionUpdate,
    PutThing,
    RemoveThing,
    ReviveRobot,
    SendGoal,
    SetPoseEstimate,
)
from sim.parameters import RobotParameters, WorldParameters
from sim.robot.costmap.costs import LETHAL
from sim.robot.navigator.goals import Cancelled, Goal, GoalReached
from sim.team import START_COVARIANCE, Team
from sim.world.thing import Thing
from thbridge.files.map_files import read_map

ARENA = read_map(Path(__file__).parents[2] / "maps" / "arena8")
SECOND = 50
STUDY, MOTORS = RobotParameters(), WorldParameters()
KNOWING = replace(STUDY, localization="truth")
SHOWN_OFTEN = replace(
    KNOWING,
    global_costmap=replace(KNOWING.global_costmap, publish_frequency=10.0),
    local_costmap=replace(KNOWING.local_costmap, publish_frequency=10.0),
)


def team_of(robots=1, parameters=STUDY, world=MOTORS):
    return Team(ARENA.grid, world, [parameters] * robots, ARENA.starts[:robots], 1, 1e9)


def run(team, seconds, *inputs):
    snapshots = [team.step(inputs).read_costmaps()]
    while len(snapshots) < seconds * SECOND:
        snapshots.append(team.step().read_costmaps())
    return snapshots


def trace(snapshots):
    """All that follows from what the robots believe and do, as bytes."""
    parts = []
    for snapshot in snapshots:
        parts += [snapshot.world.poses.tobytes(), snapshot.commands.tobytes()]
        for robot in snapshot.robots:
            navigation = robot.navigation
            parts += [robot.estimate.particles.tobytes(), navigation.plan.tobytes(), navigation.result]
    return parts


def error(snapshot):
    x, y, _ = snapshot.world.poses[0]
    return snapshot.robots[0].estimate.base_in_map.distance(Pose2(x, y, 0.0))


def beside(pose, metres):
    """A crate before the robot that starts at a pose."""
    place = pose.compose(Pose2(metres, 0.0, 0.0))
    return Thing("crate", ((0.15, 0.15), (-0.15, 0.15), (-0.15, -0.15), (0.15, -0.15)), place)


def test_a_robot_that_is_told_where_it_is_believes_it_at_once_and_goes_on_to_its_goal():
    team, elsewhere = team_of(), ARENA.rooms[6].goal
    run(team, 2, SendGoal(0, Goal(1, ARENA.rooms[3].goal)))
    told, *after = run(team, 60, KidnapRobot(0, elsewhere), SetPoseEstimate(0, elsewhere, START_COVARIANCE))
    assert error(told) < 0.05
    assert not any(snapshot.robots[0].estimate.lost for snapshot in after)
    assert [type(s.robots[0].navigation.result) for s in after if s.robots[0].navigation.result] == [GoalReached]
    assert not after[-1].world.collisions.any()


def test_a_robot_that_forgets_where_it_is_is_lost_and_finds_itself():
    team = team_of()
    run(team, 1)
    first, *_, last = run(team, 40, GlobalLocalization(0), SendGoal(0, Goal(1, ARENA.rooms[3].goal)))
    assert first.robots[0].estimate.lost
    assert np.ptp(first.robots[0].estimate.particles[:, 0]) > 10.0
    assert not last.robots[0].estimate.lost
    assert error(last) < 0.2


def test_a_robot_that_stands_weighs_a_scan_when_it_is_asked_to():
    team = team_of()
    run(team, 2)
    assert not any(s.robots[0].estimate.updated for s in run(team, 1))
    assert sum(s.robots[0].estimate.updated for s in run(team, 1, NomotionUpdate(0))) == 1


def test_cleared_costmaps_forget_what_is_seen_no_more():
    start, team = ARENA.starts[0], team_of(parameters=SHOWN_OFTEN)

    def seen(snapshots):
        navigation = [s.robots[0].navigation for s in snapshots if s.robots[0].navigation.local_costmap][-1]
        place = beside(start, 0.9).base_in_map
        cells = []
        for view in (navigation.global_costmap.read(), navigation.local_costmap.read()):
            col = int((place.x - view.origin.x) / view.resolution)
            row = int((place.y - view.origin.y) / view.resolution)
            cells.append(bool((view.costs[row - 4 : row + 5, col - 4 : col + 5] == LETHAL).any()))
        return cells

    # It turns its back to the crate, which then is taken away.
    run(team, 3, PutThing(beside(start, 0.9)), DriveManually(0, Twist(0.0, 1.5), 105))
    run(team, 1, RemoveThing("crate"))
    assert seen(run(team, 1))[0]
    assert seen(run(team, 1, ClearCostmaps(0))) == [False, False]


@pytest.mark.parametrize(
    ("side", "around_crate", "outside"),
    [(0.5, True, False), (3.0, False, False), (0.5, False, True), (None, False, False)],
)
def test_a_region_of_one_costmap_is_cleared_and_its_present_costs_can_be_read(side, around_crate, outside):
    start, team = ARENA.starts[0], team_of(parameters=KNOWING)
    place = beside(start, 0.9).base_in_map

    def lethal():
        """Whether the global costmap has an obstacle at the place, which the robot cannot see."""
        around = [place.compose(Pose2(0.05 * i, 0.05 * k, 0.0)) for i in range(-4, 5) for k in range(-4, 5)]
        return LETHAL in {team.costmap(0, "global_costmap").cost_at(each) for each in around}

    run(team, 3, PutThing(beside(start, 0.9)), DriveManually(0, Twist(0.0, 1.5), 105))
    run(team, 1, RemoveThing("crate"))
    elsewhere = ClearCostmapRegion(0, "global_costmap", 0.5), ClearCostmapRegion(0, "global_costmap", 3.0, None, True)
    run(team, 0.1, *elsewhere, ClearCostmapRegion(0, "local_costmap"))
    assert lethal()
    run(team, 0.1, ClearCostmapRegion(0, "global_costmap", side, place if around_crate else None, outside))
    assert not lethal()


def test_reading_a_costmap_changes_nothing():
    traces = []
    for reads in (False, True):
        team = team_of(2)
        traces.append(trace(run(team, 1, *(SendGoal(robot, Goal(1, ARENA.rooms[3].goal)) for robot in (0, 1)))))
        for _ in range(SECOND):
            traces[-1] += trace([team.step()])
            if reads:
                team.costmap(0, "global_costmap").footprint_cost(ARENA.starts[0])
                team.costmap(0, "local_costmap")
    assert traces[0] == traces[1]


def test_driving_by_hand_ends_a_goal_and_then_stops_by_itself():
    team = team_of()
    run(team, 2, SendGoal(0, Goal(1, ARENA.rooms[3].goal)))
    snapshots = run(team, 1, DriveManually(0, Twist(0.0, 1.0), 25))
    assert isinstance(snapshots[0].robots[0].navigation.result, Cancelled)
    assert [tuple(s.commands[0]) for s in snapshots] == [(0.0, 1.0)] * 25 + [(0.0, 0.0)] * 25


def test_driving_by_hand_that_is_renewed_goes_on_without_a_break():
    team = team_of()
    commands = [
        team.step([DriveManually(0, Twist(0.1, 0.5), 10)] if tick % 9 == 0 else ()).commands[0] for tick in range(50)
    ]
    assert np.all(np.array(commands) == (0.1, 0.5))


def test_driving_by_hand_asks_no_more_of_the_motors_than_they_can():
    world = WorldParameters(acc_lim_x=0.5, acc_lim_theta=1.0)
    snapshots = run(team_of(world=world), 2, DriveManually(0, Twist(-50.0, 50.0), 100))
    twists = np.array([s.world.twists[0] for s in snapshots])
    assert np.abs(np.diff(twists[:, 0])).max() <= 0.5 * TICK + 1e-9
    assert np.abs(np.diff(twists[:, 1])).max() <= 1.0 * TICK + 1e-9
    assert np.abs(twists).max(axis=0) == pytest.approx((1.0, 1.5), rel=0.5)
    assert np.all(np.abs(twists) <= (world.max_vel_x + 1e-9, world.max_vel_theta + 1e-9))


def test_a_dead_robot_hears_nothing():
    said = [
        SetPoseEstimate(0, ARENA.rooms[6].goal, START_COVARIANCE),
        GlobalLocalization(0),
        NomotionUpdate(0),
        ClearCostmaps(0),
        ClearCostmapRegion(0, "global_costmap"),
        DriveManually(0, Twist(1.0, 0.0), 50),
        SendGoal(0, Goal(1, ARENA.rooms[3].goal)),
    ]
    traces = []
    for inputs in ([], said):
        team = team_of()
        run(team, 1)
        traces.append(trace(run(team, 1, KillRobot(0), *inputs) + run(team, 1, ReviveRobot(0))))
    assert traces[0] == traces[1]


def test_costmaps_are_shown_as_often_as_asked_and_robots_take_turns():
    snapshots = run(team_of(robots=2), 12)
    due = {
        (which, robot): [s.tick for s in snapshots if getattr(s.robots[robot].navigation, which) is not None]
        for which in ("global_costmap", "local_costmap")
        for robot in (0, 1)
    }
    assert due["global_costmap", 0] == [1, 250, 500]
    assert due["global_costmap", 1] == [1, 251, 501]
    assert due["local_costmap", 0] == list(range(50, 601, 50))
    assert due["local_costmap", 1] == [1, *range(51, 601, 50)]


def test_costmaps_that_nobody_asked_for_are_not_shown():
    quiet = replace(
        KNOWING,
        global_costmap=replace(KNOWING.global_costmap, publish_frequency=0.0),
        local_costmap=replace(KNOWING.local_costmap, publish_frequency=0.0),
    )
    for snapshot in run(team_of(parameters=quiet), 2):
        navigation = snapshot.robots[0].navigation
        assert navigation.global_costmap is None
        assert navigation.local_costmap is None


def test_what_is_shown_is_the_map_of_the_walls_and_what_stands_before_the_robot():
    start = ARENA.starts[0]
    snapshots = run(team_of(parameters=SHOWN_OFTEN), 2, PutThing(beside(start, 0.9)))
    shown = [s.robots[0].navigation for s in snapshots if s.robots[0].navigation.global_costmap][-1]
    whole, around = shown.global_costmap.read(), shown.local_costmap.read()
    assert whole.costs.shape == ARENA.grid.cells.shape
    assert np.all(whole.costs[ARENA.grid.cells == 100] == LETHAL)
    assert around.costs.shape == (80, 80)
    # Both lie on the same cells; the local one has seen no more than one scan, and nothing else.
    row = round((around.origin.y - whole.origin.y) / whole.resolution)
    col = round((around.origin.x - whole.origin.x) / whole.resolution)
    lethal = whole.costs == LETHAL
    part = lethal[max(row, 0) : row + 80, max(col, 0) : col + 80]
    other = (around.costs == LETHAL)[max(-row, 0) :, max(-col, 0) :][: part.shape[0], : part.shape[1]]
    assert np.all(part >= other)
    walls = (ARENA.grid.cells == 100)[max(row, 0) : row + 80, max(col, 0) : col + 80]
    assert np.all(other >= walls)
    assert (other & ~walls).any()
    with pytest.raises(ValueError, match="read-only"):
        whole.costs[0, 0] = 0


def test_on_a_map_whose_origin_is_turned_costmaps_lie_as_the_map_does():
    grid = replace(ARENA.grid, origin=Pose2(2.0, -1.0, 0.5))
    turned = grid.origin.compose(ARENA.grid.origin.inverse())
    start, goal = (turned.compose(pose) for pose in (ARENA.starts[0], ARENA.rooms[3].goal))
    team = Team(grid, MOTORS, [SHOWN_OFTEN], [start], 1, 1e9)
    shown = [s.robots[0].navigation for s in run(team, 1) if s.robots[0].navigation.local_costmap][-1]
    whole, around = shown.global_costmap.read(), shown.local_costmap.read()
    assert whole.origin == grid.origin
    assert np.array_equal(whole.costs == LETHAL, grid.cells == 100)
    assert around.origin.theta == grid.origin.theta
    middle = around.origin.compose(Pose2(2.0, 2.0, 0.0))
    assert middle.distance(start) < 0.05
    plan = team.make_plan(0, None, goal, 0.0)
    assert plan[-1] == pytest.approx(goal.array())


def test_that_costmaps_are_looked_at_changes_nothing():
    traces = []
    for parameters in (KNOWING, SHOWN_OFTEN):
        team = team_of(robots=2, parameters=parameters)
        inputs = [
            SendGoal(0, Goal(1, ARENA.rooms[3].goal)),
            PutThing(beside(ARENA.starts[0], 0.9)),
            SendGoal(1, Goal(2, ARENA.rooms[0].goal)),
        ]
        traces.append(trace(run(team, 20, *inputs) + run(team, 3, DriveManually(0, Twist(0.3, 0.3), 100))))
    assert traces[0] == traces[1]
