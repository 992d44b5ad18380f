import math
from dataclasses import replace

import numpy as np
import pytest

from sim.common.geometry import Pose2
from sim.common.grid import OccupancyGrid
from sim.common.observations import TICKS_PER_SECOND
from sim.inputs import KidnapRobot, KillRobot, PlaceRobot, PutThing, RemoveThing, ReviveRobot, ScheduledInput, SendGoal
from sim.parameters import LaserParameters, OdometryNoise, RobotParameters, WorldParameters
from sim.robot.navigator.goals import Cancelled, Goal, GoalReached
from sim.team import Team
from sim.world.physics import Misplaced, World, WorldState, with_thing, without_thing
from sim.world.sensors import Sensors
from sim.world.thing import Thing
from sim.world.things import ROBOT_MARGIN, TURN_BACK_TICKS, RobotBodies, ThingState, step_things

SQUARE = ((0.25, 0.25), (-0.25, 0.25), (-0.25, -0.25), (0.25, -0.25))
QUIET = WorldParameters(
    footprint=SQUARE,
    odometry=OdometryNoise(0.0, 0.0, 0.0, 0.0),
    gyro_noise=0.0,
    laser=LaserParameters(beams=5, field_of_view=math.pi, x=0.0, range_noise=0.0, dropout=0.0),
)


def crate(x: float, y: float, name: str = "crate") -> Thing:
    return Thing(name, SQUARE, Pose2(x, y, 0.0))


def walker(path: tuple[tuple[float, float], ...], back_and_forth: bool = False) -> Thing:
    (x, y), *rest = path
    return Thing("visitor", SQUARE, Pose2(x, y, 0.0), tuple(rest), 1.0, back_and_forth)


def hall() -> OccupancyGrid:
    cells = np.zeros((100, 200), dtype=np.int8)
    cells[0] = cells[-1] = 100
    cells[:, 0] = cells[:, -1] = 100
    return OccupancyGrid(cells, 0.05, Pose2(0.0, 0.0, 0.0))


WORLD = World(hall(), QUIET, seed=1, charge=100.0)


def start(*poses: tuple[float, float, float]) -> WorldState:
    state = WORLD.start([Pose2(*pose) for pose in poses])
    assert isinstance(state, WorldState)
    return state


def run(state: WorldState, ticks: int, *commands: tuple[float, float]) -> WorldState:
    for _ in range(ticks):
        state = WORLD.step(state, np.array(commands))
    return state


def robots_at(*poses: tuple[float, float, float], speed: float = 0.0) -> RobotBodies:
    twists = np.tile((speed, 0.0), (len(poses), 1))
    return RobotBodies(np.array(poses, dtype=np.float64).reshape(-1, 3), twists, np.array(SQUARE), 0.36)


def walk(thing: Thing, ticks: int, robots: RobotBodies) -> list[ThingState]:
    (presence,) = step_things([ThingState(thing)], robots)
    found = [presence]
    for _ in range(ticks):
        (presence,) = step_things([presence], robots)
        found.append(presence)
    return found


# What a thing does


def test_a_thing_stands_where_it_is_put():
    (presence,) = step_things([ThingState(crate(3, 2))], robots_at())
    assert presence.appeared
    assert presence.pose() == Pose2(3, 2, 0)
    assert step_things([presence], robots_at()) == (presence,)


def test_who_walks_passes_the_points_of_the_path_at_its_speed():
    visitor = walker(((1, 1), (3, 1), (3, 2)))
    found = walk(visitor, 200, robots_at())
    halfway, turned, end = (found[ticks].pose() for ticks in (50, 125, 200))
    assert halfway.array() == pytest.approx([2, 1, 0])
    assert turned.array() == pytest.approx([3, 1.5, math.pi / 2])
    assert end.array() == pytest.approx([3, 2, math.pi / 2])


def test_who_walks_back_and_forth_turns_at_both_ends():
    found = walk(walker(((1, 1), (2, 1)), back_and_forth=True), 200, robots_at())
    xs = np.array([presence.pose().x for presence in found])
    assert xs.max() == pytest.approx(2.0) and xs[60:].min() == pytest.approx(1.0)
    assert xs[150] > 1.9


def test_a_thing_waits_to_appear_until_robots_have_left_its_place():
    near = 0.5 + ROBOT_MARGIN - 0.01
    (presence,) = step_things([ThingState(crate(3, 2))], robots_at((3 - near, 2, 0)))
    assert not presence.appeared
    (presence,) = step_things([presence], robots_at((3 - near - 0.02, 2, 0)))
    assert presence.appeared


def test_a_thing_does_not_appear_right_before_a_robot_that_drives():
    (presence,) = step_things([ThingState(crate(3, 2))], robots_at((1.5, 2, 0), speed=1.0))
    assert not presence.appeared
    (presence,) = step_things([ThingState(crate(3, 2))], robots_at((1.5, 2, 0), speed=0.3))
    assert presence.appeared


def test_who_walks_stops_before_a_robot_and_turns_back_when_it_stays():
    found = walk(walker(((1, 1), (5, 1))), 100 + TURN_BACK_TICKS + 60, robots_at((3, 1, 0)))
    xs = np.array([presence.pose().x for presence in found])
    assert xs.max() == pytest.approx(3 - 0.5 - ROBOT_MARGIN, abs=0.021)
    assert np.count_nonzero(xs == xs.max()) > TURN_BACK_TICKS
    assert xs[-1] < xs.max()


def test_who_walks_may_walk_away_from_a_robot_that_came_near():
    found = walk(walker(((1, 1), (5, 1))), 0, robots_at())
    (after,) = step_things(found, robots_at((0.4, 1, 0)))
    assert after.walked > 0.0


def test_what_has_no_body_or_cannot_walk_is_refused():
    with pytest.raises(ValueError, match="three corners"):
        Thing("line", SQUARE[:2], Pose2(0, 0, 0))
    with pytest.raises(ValueError, match="twice in a row"):
        Thing("visitor", SQUARE, Pose2(1, 1, 0), ((1, 1),), 1.0)


# Things in the world


def test_a_robot_is_stopped_by_a_thing_and_one_collision_is_counted():
    state = with_thing(start((1, 2, 0)), crate(3, 2))
    state = run(state, 200, (0.5, 0.0))
    assert state.poses[0, 0] == pytest.approx(2.5, abs=0.02)
    assert state.poses[0, 0] <= 2.5
    assert state.collisions.tolist() == [1]
    assert run(without_thing(state, "crate"), 10, (0.5, 0.0)).poses[0, 0] > state.poses[0, 0] + 0.05


def test_a_thing_of_the_same_name_takes_its_place():
    state = run(with_thing(start((1, 2, 0)), crate(3, 2)), 1, (0.0, 0.0))
    state = run(with_thing(state, crate(5, 2)), 1, (0.0, 0.0))
    assert [presence.pose().x for presence in state.things] == [5]
    assert state.bodies.circles[:, 0].tolist() == [5.0]


def test_a_robot_cannot_be_put_into_a_thing():
    state = run(with_thing(start((1, 2, 0)), crate(3, 2)), 1, (0.0, 0.0))
    refused = WORLD.place(state, 0, Pose2(3.2, 2, 0))
    assert isinstance(refused, Misplaced) and refused.reason == "thing"


def test_lasers_see_things_from_every_side():
    sensors = Sensors(hall(), QUIET, 1, 100.0)
    state = run(with_thing(start((3, 2, math.pi / 2)), crate(3, 3.5)), 1, (0.0, 0.0))
    state = replace(state, tick=10)
    scan = sensors.sense(state, 0).scan
    assert scan is not None
    assert scan.ranges[2] == pytest.approx(1.25)
    bare = sensors.sense(replace(run(without_thing(state, "crate"), 1, (0.0, 0.0)), tick=10), 0).scan
    assert bare is not None
    assert bare.ranges[2] == pytest.approx(2.95)


@pytest.mark.parametrize("seed", range(5))
def test_nobody_walks_into_a_robot_that_drives_about(seed):
    chance = np.random.default_rng(seed)
    # The robot turns on the spot or drives slowly enough that all of its way is respected.
    state = start((5, 2.5, 0))
    for number, (x, y) in enumerate(((1, 1), (9, 1), (1, 4), (9, 4))):
        visitor = Thing(f"visitor{number}", SQUARE, Pose2(x, y, 0), ((10 - x, 5 - y),), 1.2, back_and_forth=True)
        state = with_thing(state, visitor)
    for _ in range(20):
        state = run(state, 50, (0.0, float(chance.uniform(-1, 1))))
    assert state.collisions.tolist() == [0]


# Things that befall robots


def team(*starts: tuple[float, float, float], schedule: tuple[ScheduledInput, ...] = ()) -> Team:
    robots = [RobotParameters(localization="ekf")] * len(starts)
    return Team(hall(), QUIET, robots, [Pose2(*pose) for pose in starts], 1, 100.0, schedule)


def test_a_carried_robot_is_elsewhere_and_is_not_told():
    moved = team((1, 2, 0))
    moved.step()
    snapshot = moved.step([KidnapRobot(0, Pose2(6, 3, 1.0))])
    assert snapshot.world.poses[0] == pytest.approx([6, 3, 1.0])
    assert snapshot.robots[0].estimate.base_in_map.distance(Pose2(1, 2, 0)) < 0.1
    told = moved.step([PlaceRobot(0, Pose2(6, 3, 1.0))])
    assert told.robots[0].estimate.base_in_map.distance(Pose2(6, 3, 1.0)) < 0.1


def test_a_carried_robot_is_set_down_when_the_place_is_free():
    moved = team((1, 2, 0), (6, 3, 0))
    snapshot = moved.step([KidnapRobot(0, Pose2(6, 3, 0))])
    assert snapshot.world.poses[0, 0] == 1
    snapshot = moved.step([KidnapRobot(1, Pose2(3, 1, 0))])
    snapshot = moved.step()
    assert snapshot.world.poses[0, 0] == 6
    assert moved.step([KidnapRobot(0, Pose2(0, 0, 0))]).world.poses[0, 0] == 6


def test_a_dead_robot_brakes_and_is_silent_until_it_revives():
    driven = team((1, 2.5, 0), (8, 1, 0))
    driven.step([SendGoal(0, Goal(7, Pose2(7, 2.5, 0)))])
    for _ in range(2 * TICKS_PER_SECOND):
        snapshot = driven.step()
    assert snapshot.world.twists[0, 0] > 0.1
    snapshot = driven.step([KillRobot(0), SendGoal(0, Goal(8, Pose2(2, 2.5, 0)))])
    assert snapshot.dead == {0}
    said = snapshot.robots[0]
    for _ in range(TICKS_PER_SECOND):
        snapshot = driven.step()
    assert snapshot.world.twists[0].tolist() == [0.0, 0.0]
    assert snapshot.robots[0].observations is said.observations
    assert snapshot.robots[0].navigation.result is None
    assert snapshot.robots[1].observations.tick == snapshot.tick
    snapshot = driven.step([ReviveRobot(0)])
    assert snapshot.dead == frozenset()
    result = snapshot.robots[0].navigation.result
    assert isinstance(result, Cancelled) and result.goal.id == 7
    assert snapshot.robots[0].navigation.goal is None
    driven.step([SendGoal(0, Goal(9, Pose2(4, 2.5, 0)))])
    ended = [driven.step().robots[0].navigation.result for _ in range(15 * TICKS_PER_SECOND)]
    assert any(isinstance(result, GoalReached) for result in ended)


def test_what_is_scheduled_happens_of_its_own_accord_and_as_if_it_had_come_in():
    thing = crate(3, 2)
    plan = (
        ScheduledInput(30, RemoveThing("crate")),
        ScheduledInput(10, PutThing(thing)),
        ScheduledInput(20, KillRobot(0)),
    )
    scheduled, live = team((1, 2, 0), schedule=plan), team((1, 2, 0))
    for tick in range(1, 41):
        inputs = [timed.input for timed in plan if timed.tick == tick]
        first, second = scheduled.step(), live.step(inputs)
        assert (len(first.world.bodies.circles) > 0) == (10 <= tick < 30)
        assert first.dead == second.dead == ({0} if tick >= 20 else set())
        assert first.world.things == second.world.things
