"""Robots that know exactly where they are, on wheels that do exactly as told: what is tested is the driving."""

import math
import random
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scipy.stats import spearmanr

from sim.common.geometry import Pose2
from sim.common.grid import OccupancyGrid
from sim.common.observations import STANDSTILL, TICK, LaserMount, Neighbour, Scan
from sim.common.polygons import placed_at
from sim.inputs import PutThing, RemoveThing, ScheduledInput, SendGoal
from sim.numerics.elementary import wrap_angle
from sim.parameters import RobotParameters, WorldParameters
from sim.robot.costmap.costs import LETHAL
from sim.robot.navigator.goals import Cancelled, Goal, GoalReached, NoPath
from sim.robot.navigator.progress import PROGRESS_DISTANCE, PROGRESS_TIMEOUT
from sim.team import Team
from sim.world.thing import Thing
from tests.sim.robot.navigator.ideal_robots import (
    ARENA,
    FOOTPRINT,
    OUTLINE,
    ROOMS,
    IdealRobots,
    dead_end,
    everybody_arrived,
)
from thbridge.files.map_files import read_map

SECONDS_OF_2016 = [
    [99, 17, 14, 17, 13, 13, 16, 13, 15],
    [99, 99, 18, 23, 10, 19, 21, 18, 21],
    [99, 17, 99, 18, 15, 14, 19, 17, 19],
    [99, 23, 22, 99, 18, 10, 22, 19, 21],
    [99, 18, 22, 26, 99, 26, 22, 22, 29],
    [99, 26, 21, 17, 21, 99, 22, 20, 24],
    [99, 29, 27, 29, 24, 24, 99, 16, 21],
    [99, 24, 24, 26, 20, 20, 15, 99, 17],
    [99, 27, 27, 29, 24, 25, 23, 18, 99],
]


WAREHOUSE = read_map(Path(__file__).parents[4] / "maps" / "warehouse12")


def hunt(rig, legs, seed, places=ROOMS, patience=150):
    """Drive all robots to one free place after the other; return the number of goals reached."""
    chance = random.Random(seed)
    bound, begun = {}, {}
    reached = 0
    count = len(rig.poses)
    while reached < legs * count:
        for i in range(count):
            if i in bound and rig.navigators[i]._execution.goal is not None:
                assert (rig.tick - begun[i]) * TICK < patience, rig.describe()
                continue
            free = [k for k in range(len(places)) if k not in bound.values()]
            if free:
                bound[i], begun[i] = chance.choice(free), rig.tick
                rig.go(i, *places[bound[i]])
        before = sum(map(len, rig.results))
        rig.step()
        reached += sum(map(len, rig.results)) - before
    assert all(isinstance(result, GoalReached) for results in rig.results for result in results), rig.describe()


def test_a_robot_arrives_at_the_pose_asked_for():
    rig = IdealRobots([(0, 0, 0)])
    rig.go(0, *ROOMS[3], 2.0)
    rig.run(60, everybody_arrived)
    assert rig.poses[0].distance(Pose2(*ROOMS[3], 0)) <= 0.1
    assert abs(wrap_angle(rig.poses[0].theta - 2.0)) <= 0.05
    assert rig.said[0].state == "idle"
    assert rig.said[0].command == STANDSTILL
    assert len(rig.said[0].plan) == 0


def test_navigation_tells_plan_times_and_what_is_left():
    rig = IdealRobots([(0, 0, 0)])
    rig.go(0, *ROOMS[3])
    rig.run(5, lambda rig: rig.said[0] is not None and rig.said[0].state == "controlling")
    first = rig.said[0]
    assert first.plan[-1].tolist() == [*ROOMS[3], 0.0]
    assert len(first.times) == len(first.plan)
    assert first.remaining == pytest.approx(np.hypot(*np.diff(first.plan[:, :2], axis=0).T).sum())
    rig.run(10, lambda rig: rig.said[0].remaining < first.remaining - 2)
    assert len(rig.said[0].plan) < len(first.plan)


@pytest.mark.slow
def test_times_rank_like_those_of_2016():
    rig = IdealRobots([(0, 0, 0)])
    ours, theirs = [], []
    here = 0
    # One drive through forty of the matrix's entries.
    chance = random.Random(5)
    for _ in range(40):
        there = chance.choice([room for room in range(1, 9) if room != here])
        rig.results[0].clear()
        rig.go(0, *ROOMS[there - 1])
        ours.append(rig.run(60, everybody_arrived))
        theirs.append(SECONDS_OF_2016[here][there])
        here = there
    assert spearmanr(ours, theirs).statistic > 0.85
    assert np.mean(ours) == pytest.approx(np.mean(theirs), rel=0.25)


def test_a_new_goal_takes_the_place_of_the_old_and_cancelling_stops():
    rig = IdealRobots([(0, 0, 0)])
    rig.go(0, *ROOMS[0])
    rig.run(3, lambda rig: rig.tick == 100)
    rig.go(0, *ROOMS[3])
    rig.step()
    assert isinstance(rig.results[0][-1], Cancelled)
    assert rig.said[0].goal.base_in_map.x == ROOMS[3][0]
    rig.navigators[0].cancel()
    rig.step()
    assert isinstance(rig.results[0][-1], Cancelled)
    assert rig.said[0].goal is None
    rig.run(1, lambda rig: rig.twists[0] == STANDSTILL)


@pytest.mark.parametrize(
    ("goal", "reason"), [((-1.0, 0.0), "goal_occupied"), ((40.0, 0.0), "goal_outside"), ((-0.9, 0.0), "goal_occupied")]
)
def test_a_goal_that_cannot_be_is_refused_with_its_reason(goal, reason):
    rig = IdealRobots([(0, 0, 0)])
    rig.go(0, *goal)
    rig.run(2, lambda rig: rig.results[0])
    result = rig.results[0][0]
    assert isinstance(result, NoPath)
    assert result.reason == reason
    assert "goal" in result.sentence


def test_a_room_without_a_door_is_refused():
    cells = np.zeros((100, 100), np.int8)
    cells[:, 50] = cells[0] = cells[-1] = 100
    rig = IdealRobots([(1, 2, 0)], OccupancyGrid(cells, 0.05, Pose2(0, 0, 0)))
    rig.go(0, 4, 2)
    rig.run(10, lambda rig: rig.results[0])
    assert rig.results[0][0].reason == "no_way"


def test_an_obstacle_that_the_map_does_not_know_is_driven_around():
    mount = LaserMount(Pose2(0.0, 0.0, 0.0), -2.35, 4.7 / 180, 181, 0.05, 8.0)
    box = np.array([3.0, 0.1])

    def scan_of(pose):
        """A post of 0.2 m radius."""
        away = box - [pose.x, pose.y]
        distance = math.hypot(*away)
        angles = mount.angles() + pose.theta - math.atan2(away[1], away[0])
        aside = distance * np.abs(np.sin(angles))
        hit = (aside < 0.2) & (np.cos(angles) > 0)
        depth = distance * np.cos(angles) - np.sqrt(np.maximum(0.04 - aside**2, 0))
        return Scan(0, mount, np.where(hit, depth, np.inf).astype(np.float32))

    rig = IdealRobots([(0, 0, 0)])
    rig.scans = scan_of
    rig.go(0, 5.8, 0.1)
    closest = 9.0
    while not everybody_arrived(rig):
        rig.step()
        assert rig.tick < 60 / TICK, rig.describe()
        closest = min(closest, np.hypot(*(rig.poses[0].transform(OUTLINE) - box).T).min())
    assert closest > 0.2


@pytest.mark.parametrize(
    ("starts", "goals"),
    [
        pytest.param([(0, -4, 1.57), (0, 6, -1.57)], [(0, 6), (0, -4)], id="head-on in a corridor"),
        pytest.param([(*ROOMS[1], 0), (*ROOMS[0], 0)], [ROOMS[0], ROOMS[1]], id="two that swap rooms"),
        pytest.param([(-2, 2, 0), (0, 4, -1.57)], [(3, 2), (0, -3)], id="crossing"),
        pytest.param(
            [(3, 2, 3.14), (0, 4, -1.57), (0, -3, 1.57), (-2.5, 2, 0)],
            [(-2.5, 2), (0, -3), (0, 4), (3, 2)],
            id="four that cross at one place",
        ),
        pytest.param([(0, -1.5, 0), (0, -0.6, 0)], [ROOMS[3], ROOMS[2]], id="two that swap places in the first tick"),
        pytest.param(
            [(0, 3.6 + 0.9 * i, 0) for i in range(3)], [ROOMS[0], ROOMS[7], ROOMS[2]], id="a queue that parts"
        ),
        pytest.param(
            [(-0.45 + 0.9 * (i % 2), 3.6 + 0.9 * (i // 2), 0) for i in range(6)],
            [ROOMS[k] for k in (7, 0, 3, 2, 5, 4)],
            id="six that leave one corridor at once",
        ),
    ],
)
def test_meetings_end_with_everybody_there(starts, goals):
    rig = IdealRobots(starts)
    for i, goal in enumerate(goals):
        rig.go(i, *goal)
    rig.run(90, everybody_arrived)


def test_one_that_rests_in_a_door_makes_way():
    rig = IdealRobots([(0, 0, 0), (-1.0, 2.0, 0)])
    rig.go(0, *ROOMS[1])
    rig.run(60, lambda rig: rig.results[0])
    assert isinstance(rig.results[0][0], GoalReached)
    assert not rig.results[1]
    assert rig.said[1].goal is None
    assert rig.ways_made == [(1, 0), (1, None)]


def bounded(rig, robot):
    """Simulated seconds until a robot's goal ends; they have a bound, whatever is in the way."""
    rig.step()
    rig.run(1, lambda rig: rig.said[robot].state != "planning" or len(rig.said[robot].plan) > 0)
    length = rig.said[robot].remaining
    return rig.run((length / PROGRESS_DISTANCE + 2) * PROGRESS_TIMEOUT, lambda rig: rig.results[robot])


def test_who_has_the_right_of_way_and_never_goes_cannot_hold_up_a_goal_for_ever():
    rig = IdealRobots([(0, 0, 0)])
    rig.strangers = [
        Neighbour(1, Pose2(0, 3, 0), STANDSTILL, FOOTPRINT, np.array([[0.0, 3.0], [3.0, 2.0]]), np.zeros(2))
    ]
    rig.go(0, 0, 6)
    assert bounded(rig, 0) < 3 * PROGRESS_TIMEOUT
    assert rig.results[0][0].reason == "robots_in_the_way"
    assert rig.waits == {(0, 1)}


def test_one_that_cannot_make_way_ends_a_goal_with_its_reason():
    cells = np.zeros((24, 160), np.int8)
    cells[0], cells[-1], cells[:, 0], cells[:, -1] = 100, 100, 100, 100
    rig = IdealRobots([(1, 0.6, 0), (4, 0.6, 0)], OccupancyGrid(cells, 0.05, Pose2(0, 0, 0)))
    rig.go(0, 7, 0.6)
    bounded(rig, 0)
    assert rig.results[0][0].reason == "robots_in_the_way"
    assert rig.waits == {(0, 1)}
    assert not rig.ways_made, "who asks for a way makes none"


def test_who_waits_stands_and_says_for_whom():
    rig = IdealRobots([(-2, 2, 0), (0, 4, -1.57)])
    rig.go(0, 3, 2)
    rig.go(1, 0, -3)
    rig.run(3, lambda rig: rig.tick == 100)
    # Who planned first goes first, and here is held up.
    rig.broken = {0}
    rig.run(9, lambda rig: rig.tick == 500)
    rig.broken = set()
    rig.run(90, everybody_arrived)
    assert rig.waits == {(1, 0)}
    assert rig.ways_made == [(1, 0), (1, None)], "short pauses between do not count"


def test_who_drives_round_another_one_says_for_whom_until_it_goes_on_as_if_alone():
    rig = IdealRobots([(-2, 2, 0), (0, 4, -1.57)])
    rig.go(0, 3, 2)
    rig.go(1, 0, -3)
    rig.run(10, lambda rig: rig.twists[1].linear > 0.1)
    assert rig.said[1].makes_way_for == 0
    rig.run(90, everybody_arrived)
    assert rig.ways_made == [(1, 0), (1, None)]
    assert not rig.waits


def test_who_is_alone_makes_way_for_nobody():
    rig = IdealRobots([(0, 0, 0)])
    rig.go(0, *ROOMS[3])
    rig.run(60, everybody_arrived)
    assert not rig.ways_made


def test_a_robot_whose_wheels_do_not_turn_gives_up():
    rig = IdealRobots([(0, 0, 0)])
    rig.go(0, 0, 6)
    rig.broken = {0}
    bounded(rig, 0)
    assert rig.results[0][0].reason == "stuck"


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(2))
def test_six_robots_hunt(seed):
    hunt(IdealRobots([(0, -1.5 + 0.9 * i, 0) for i in range(6)]), 3, seed)


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(10))
def test_one_to_six_robots_hunt_long(seed):
    hunt(IdealRobots([(0, -1.5 + 0.9 * i, 0) for i in range(1 + seed % 6)]), 6, seed)


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(1))
def test_ten_robots_hunt(seed):
    starts = [(0, 0), (1.5, 2.45), (2.5, 2.45), (3.5, 2.45), (1.5, -0.45), (2.5, -0.45), (3.5, -0.45)]
    starts += [(5.55, 3.6), (5.55, 4.6), (5.55, -1.6)]
    hunt(
        IdealRobots([(*start, 0) for start in starts]),
        2,
        seed,
        [*ROOMS, (1.5, 2.4), (3.5, 2.4), (2.0, -0.4), (4.0, -0.4)],
    )


def test_the_same_twice():
    ends = []
    for _ in range(2):
        rig = IdealRobots([(0, -1.5 + 0.9 * i, 0) for i in range(3)])
        for i in range(3):
            rig.go(i, *ROOMS[i])
        rig.run(20, lambda rig: rig.tick == 500)
        ends.append([pose.array().tobytes() for pose in rig.poses])
    assert ends[0] == ends[1]


def touch_nothing_and_arrive(grid, starts, goals, seed, waits=0):
    """The whole chain: noisy wheels and lasers, particle filters."""
    count = len(starts)
    team = Team(grid, WorldParameters(), [RobotParameters()] * count, starts, seed, 1000.0)
    for _ in range(waits):
        team.step()
    snapshot = team.step([SendGoal(i, Goal(i, goal)) for i, goal in enumerate(goals)])
    results = {}
    while len(results) < count and snapshot.tick < 100 / TICK:
        snapshot = team.step()
        for i, output in enumerate(snapshot.robots):
            if output.navigation.result:
                results[i] = output.navigation.result
    assert len(results) == count
    assert all(isinstance(result, GoalReached) for result in results.values()), results
    assert not snapshot.world.collisions.any()


@pytest.mark.parametrize("seed", [0, pytest.param(1, marks=pytest.mark.slow)])
def test_six_robots_that_start_in_a_row_touch_nothing_on_noisy_wheels(seed):
    starts = [Pose2(0, -1.5 + 0.9 * i, 0) for i in range(6)]
    rooms = random.Random(seed).sample(ROOMS, 6)
    touch_nothing_and_arrive(ARENA, starts, [Pose2(*room, 0.0) for room in rooms], seed)


def test_three_at_a_crossing_do_not_wait_for_each_other():
    """Planning from where they stood too near to one another, two of them once barred each other's way for good."""
    goals = [WAREHOUSE.rooms[k].goal for k in (6, 7, 0)]
    touch_nothing_and_arrive(WAREHOUSE.grid, WAREHOUSE.starts[:3], goals, seed=116, waits=12)


def test_ten_robots_in_twelve_rooms_touch_nothing_on_noisy_wheels():
    rooms = random.Random(1).sample(WAREHOUSE.rooms, 10)
    touch_nothing_and_arrive(WAREHOUSE.grid, WAREHOUSE.starts[:10], [room.goal for room in rooms], 1)


def test_a_map_whose_origin_is_turned_is_driven_like_any_other():
    turn = Pose2(4.0, -1.0, 0.6)
    rig = IdealRobots([(0, 0, 0)], OccupancyGrid(ARENA.cells, 0.05, turn.compose(ARENA.origin)))
    rig.poses = [turn.compose(Pose2(0, 0, 0))]
    goal = turn.compose(Pose2(*ROOMS[3], 1.0))
    rig.navigators[0].go(Goal(1, goal))
    rig.run(60, lambda rig: rig.results[0])
    assert isinstance(rig.results[0][0], GoalReached)
    assert rig.results[0][0].goal.base_in_map == goal
    assert rig.poses[0].distance(goal) <= 0.1
    assert abs(wrap_angle(rig.poses[0].theta - goal.theta)) <= 0.05


def test_goals_that_change_under_way_end_once_each_and_hardly_slow_the_robot_down():
    rig = IdealRobots([(0, -4, 1.57)])
    rig.go(0, 0, 6, 1.57)
    rig.run(10, lambda rig: rig.poses[0].y > -2.5)
    slowest = rig.twists[0].linear
    for aside in (0.1, -0.1, 0.0):
        rig.go(0, aside, 6, 1.57)
        begun = rig.tick
        while rig.tick < begun + 1 / TICK:
            rig.step()
            slowest = min(slowest, rig.twists[0].linear)
    rig.run(60, lambda rig: rig.said[0].goal is None)
    assert [type(result) for result in rig.results[0]] == [Cancelled, Cancelled, Cancelled, GoalReached]
    assert slowest > 0.3


def test_a_lost_robot_that_sees_nothing_stands_until_it_knows_its_place_and_not_for_ever():
    rig = IdealRobots([(0, -4, 1.57)])
    rig.go(0, 0, 6, 1.57)
    rig.run(10, lambda rig: rig.poses[0].y > -3)
    rig.lost = {0}
    rig.run(2, lambda rig: rig.twists[0] == STANDSTILL)
    place = rig.poses[0]
    rig.run(6, lambda rig: rig.tick % 250 == 0)
    assert rig.poses[0] == place
    rig.lost = set()
    rig.run(60, everybody_arrived)
    rig.lost = {0}
    rig.go(0, 0, -4)
    assert rig.run(PROGRESS_TIMEOUT + 60, lambda rig: len(rig.results[0]) == 2) > PROGRESS_TIMEOUT
    assert rig.results[0][1].reason == "lost"


def test_a_lost_robot_with_a_goal_turns_on_the_spot_whatever_it_believes():
    rig = IdealRobots([(0, -4, 1.57)])
    mount = LaserMount(Pose2(0.1, 0.0, 0.0), -2.3, 0.05, 93, 0.05, 8.0)
    rig.scans = lambda pose: Scan(0, mount, np.full(93, 2.0, np.float32))
    rig.lost = {0}
    rig.run(2, lambda rig: rig.tick == 50)
    assert rig.poses[0].theta == 1.57
    rig.go(0, 0, 6, 1.57)
    rig.run(6, lambda rig: rig.tick == 200)
    assert 1.0 < rig.poses[0].theta - 1.57 < 2.0
    assert rig.poses[0].distance(Pose2(0, -4, 0)) < 0.01


@pytest.mark.parametrize("heading", [0.0, *(pytest.param(each, marks=pytest.mark.slow) for each in (0.6, 0.95, 1.2))])
def test_a_lost_robot_with_no_room_to_turn_stays_off_the_wall_ahead_however_noisy_its_scans(heading):
    rig = IdealRobots([(0, -4, heading)])
    mount = LaserMount(Pose2(0.1, 0.0, 0.0), -2.35619449, 4.71238898 / 180, 181, 0.05, 8.0)
    along, chance = np.cos(mount.angles()), np.random.default_rng(4)

    def beside_a_wall(pose):
        """A wall at x = 1 m, and something right behind the robot wherever it goes."""
        laser = pose.transform(np.array([[0.1, 0.0]]))[0]
        to_wall = np.cos(pose.theta + mount.angles())
        ranges = np.where(to_wall > 0.0, (1.0 - laser[0]) / np.maximum(to_wall, 1e-9), np.inf)
        ranges = np.minimum(ranges, np.where(along < 0.0, 0.5 / np.maximum(-along, 1e-9), 8.0))
        return Scan(0, mount, (ranges + chance.normal(0.0, 0.02, 181)).astype(np.float32))

    rig.scans, rig.lost = beside_a_wall, {0}
    rig.go(0, 0, 6, 0.5 * math.pi)
    rig.run(150, lambda rig: rig.tick * TICK >= 100)
    left = 1.0 - placed_at(FOOTPRINT, *rig.poses[0].array())[:, 0].max()
    assert 0.04 < left < 0.2


def test_a_lost_robot_turns_on_when_what_barred_its_turn_was_seen_once_only():
    rig = IdealRobots([(0, -4, 0.5 * math.pi)])
    mount = LaserMount(Pose2(0.1, 0.0, 0.0), -2.3, 0.05, 93, 0.05, 8.0)
    free = np.full(93, 2.0, np.float32)
    # Something beside each corner in front, where a turn either way would bring it.
    crowded = np.where(abs(abs(mount.angles()) - 1.18) < 0.06, np.float32(0.32), free)
    rig.scans, rig.lost = lambda pose: Scan(0, mount, crowded if 50 <= rig.tick < 80 else free), {0}
    rig.go(0, 0, 6, 0.5 * math.pi)
    rig.run(5, lambda rig: rig.tick == 100)
    before = rig.poses[0].theta
    rig.run(5, lambda rig: rig.tick == 200)
    assert wrap_angle(rig.poses[0].theta - before) > 0.5


@pytest.mark.parametrize(("frequency", "plans"), [(0.0, (1, 1)), (2.0, (8, 11))])
def test_planner_frequency_makes_new_plans_under_way(frequency, plans):
    parameters = RobotParameters()
    rig = IdealRobots(
        [(0, -4, 1.57)],
        parameters=replace(parameters, move_base=replace(parameters.move_base, planner_frequency=frequency)),
    )
    rig.go(0, 0, 6, 1.57)
    made = []
    for _ in range(int(5 / TICK)):
        rig.step()
        times = rig.said[0].times.base
        if times is not None and (not made or times is not made[-1]):
            made.append(times)
    assert plans[0] <= len(made) <= plans[1]


def test_those_in_the_way_of_those_in_the_way_are_asked_in_the_name_of_whoever_waits_longest():
    rig = IdealRobots([(1, 2, 0), (4, 2, 0), (5.2, 2, 0)], dead_end())
    rig.run(1, lambda rig: rig.tick == 10)
    rig.go(0, 8, 1.2)
    rig.run(10, lambda rig: rig.tick == 100)
    rig.run(120, lambda rig: rig.results[0])
    assert isinstance(rig.results[0][0], GoalReached)


def closed(seconds, *, opens, parameters=None):
    """A robot bound for the next room, the only door of which is shut by a crate; whether and when it gets there."""
    cells = np.zeros((80, 160), np.int8)
    cells[:, 79:82] = cells[0] = cells[-1] = 100
    cells[:, 0] = cells[:, -1] = 100
    cells[28:52, 79:82] = 0
    grid = OccupancyGrid(cells, 0.05, Pose2(0, 0, 0))
    crate = Thing("crate", ((0.2, 0.5), (-0.2, 0.5), (-0.2, -0.5), (0.2, -0.5)), Pose2(4.0, 2.0, 0.0))
    schedule = [ScheduledInput(1, PutThing(crate)), ScheduledInput(round(opens / TICK), RemoveThing("crate"))]
    robot = replace(parameters or RobotParameters(), localization="truth")
    team = Team(grid, WorldParameters(), [robot], [Pose2(1.5, 2.0, 0.0)], 1, 1000.0, schedule)
    snapshot = team.step([SendGoal(0, Goal(1, Pose2(6.0, 2.0, 0.0)))])
    while snapshot.robots[0].navigation.result is None:
        snapshot = team.step()
        assert snapshot.tick < seconds / TICK
    assert not snapshot.world.collisions.any()
    return snapshot.robots[0].navigation.result, snapshot.tick * TICK


def test_a_closed_door_is_waited_for_then_given_up_with_its_reason():
    result, seconds = closed(90, opens=1000)
    assert isinstance(result, NoPath)
    assert result.reason == "blocked_by_obstacle"
    assert "obstacle" in result.sentence
    assert seconds > 4 * RobotParameters().move_base.planner_patience


def test_a_door_that_opens_in_time_is_passed():
    result, seconds = closed(60, opens=12)
    assert isinstance(result, GoalReached)
    assert seconds < 35


def test_without_recovery_a_closed_door_is_given_up_after_the_retries_allowed():
    parameters = RobotParameters()
    move_base = replace(parameters.move_base, recovery_behavior_enabled=False, max_planning_retries=3)
    result, seconds = closed(30, opens=1000, parameters=replace(parameters, move_base=move_base))
    assert result.reason == "blocked_by_obstacle"
    assert seconds < 10


@pytest.mark.parametrize("shut_down", [False, True])
def test_costmaps_that_are_shut_down_take_no_notice_of_obstacles_without_a_goal(shut_down):
    parameters = RobotParameters()
    parameters = replace(
        parameters,
        move_base=replace(parameters.move_base, shutdown_costmaps=shut_down),
        global_costmap=replace(parameters.global_costmap, publish_frequency=50.0),
    )
    rig = IdealRobots([(0, 0, 0)], parameters=parameters)
    mount = LaserMount(Pose2(0.0, 0.0, 0.0), -0.1, 0.1, 3, 0.05, 8.0)
    rig.scans = lambda pose: Scan(0, mount, np.full(3, 0.7, np.float32))

    def seen():
        rig.step()
        return bool((rig.said[0].global_costmap.read().costs[ARENA.cells == 0] == LETHAL).any())

    assert seen() is not shut_down
    rig.go(0, 0, 6)
    assert seen()
