import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sim.common.geometry import Pose2
from sim.common.grid import OccupancyGrid
from sim.common.observations import TICK
from sim.numerics.float_array import FloatArray
from sim.parameters import OdometryNoise, WorldParameters
from sim.world.physics import Misplaced, World, WorldState, with_charge

CALM = WorldParameters(odometry=OdometryNoise(0, 0, 0, 0))
STILL = np.zeros((1, 2))


def grid_of(width: float, height: float, resolution: float = 0.05, origin: Pose2 | None = None) -> OccupancyGrid:
    """A closed room with walls 0.1 m thick, lower left outer corner at the origin."""
    thick = round(0.1 / resolution)
    cells = np.full((round(height / resolution), round(width / resolution)), 100, dtype=np.int8)
    cells[thick:-thick, thick:-thick] = 0
    return OccupancyGrid(cells, resolution, origin or Pose2(0.0, 0.0, 0.0))


def open_grid() -> OccupancyGrid:
    return OccupancyGrid(np.zeros((100, 100), dtype=np.int8), 0.05, Pose2(-2.5, -2.5, 0.0))


def begun(world: World, *poses: Pose2) -> WorldState:
    state = world.start(poses)
    assert isinstance(state, WorldState)
    return state


def driven(world: World, state: WorldState, ticks: int, *command: tuple[float, float]) -> WorldState:
    for _ in range(ticks):
        state = world.step(state, np.array(command, dtype=np.float64))
    return state


def same(a: WorldState, b: WorldState) -> bool:
    return a.tick == b.tick and all(
        np.array_equal(getattr(a, name), getattr(b, name))
        for name in ("poses", "twists", "odom_poses", "odom_twists", "charge", "contact", "collisions")
    )


# --- motion


@given(st.floats(-1, 1), st.floats(-1.5, 1.5), st.floats(-3, 3))
def test_constant_commands_drive_an_exact_arc(linear: float, angular: float, heading: float) -> None:
    world = World(open_grid(), replace(CALM, acc_lim_x=100, acc_lim_theta=100), 0, 100.0)
    state = driven(world, begun(world, Pose2(0, 0, heading)), 50, (linear, angular))
    if abs(angular) < 1e-6:
        ahead, aside = linear, 0.5 * linear * angular
    else:
        ahead, aside = linear / angular * math.sin(angular), linear / angular * (1 - math.cos(angular))
    expected = Pose2(0, 0, heading).compose(Pose2(ahead, aside, angular))
    assert state.poses[0, :2] == pytest.approx([expected.x, expected.y], abs=1e-9)
    assert math.cos(state.poses[0, 2] - expected.theta) == pytest.approx(1.0, abs=1e-12)
    assert -math.pi <= state.poses[0, 2] < math.pi
    # Wheels that do not err say the same, from where they started.
    assert state.odom_poses[0, :2] == pytest.approx([ahead, aside], abs=1e-9)


def test_motors_accelerate_and_brake_no_faster_than_they_can() -> None:
    world = World(open_grid(), replace(CALM, acc_lim_x=2.0, acc_lim_theta=3.0), 0, 100.0)
    state = begun(world, Pose2(0, 0, 0))
    for tick in range(1, 11):
        state = world.step(state, np.array([[0.3, -0.5]]))
        assert state.twists[0] == pytest.approx([min(0.3, 2.0 * tick * TICK), -min(0.5, 3.0 * tick * TICK)])
    assert world.step(state, STILL).twists[0] == pytest.approx([0.26, -0.44])


def test_motors_run_no_faster_than_they_can() -> None:
    world = World(open_grid(), replace(CALM, max_vel_x=0.7, max_vel_theta=0.9), 0, 100.0)
    state = begun(world, Pose2(0, 0, 0))
    assert driven(world, state, 20, (50.0, -50.0)).twists[0] == pytest.approx([0.7, -0.9])
    assert driven(world, state, 20, (-50.0, 50.0)).twists[0] == pytest.approx([-0.7, 0.9])


# --- walls


@pytest.mark.parametrize(
    ("heading", "speed", "front"),
    [(0.0, 1.0, 0.35), (0.0, -1.0, 0.25), (math.pi / 2, 1.0, 0.35), (math.pi, -1.0, 0.25)],
)
def test_a_body_stops_before_the_wall_with_the_side_it_really_has(heading: float, speed: float, front: float) -> None:
    world = World(grid_of(4, 4), CALM, 0, 100.0)
    state = driven(world, begun(world, Pose2(2, 2, heading)), 200, (speed, 0.0))
    moved = math.hypot(*(state.poses[0, :2] - 2.0))
    gap = 1.9 - front - moved
    assert 0.0 < gap < 0.2 * TICK  # pressed on: from rest the next creep is one tick's acceleration
    assert state.twists[0].tolist() == [0.0, 0.0]
    assert state.odom_poses[0, 0] == pytest.approx(math.copysign(moved, speed))


def test_pressing_on_is_one_collision_and_coming_back_is_another() -> None:
    world = World(grid_of(4, 4), CALM, 0, 100.0)
    state = driven(world, begun(world, Pose2(2, 2, 0)), 150, (1.0, 0.0))
    assert state.contact.tolist() == [True]
    assert state.collisions.tolist() == [1]
    state = driven(world, state, 50, (0.0, 0.0))
    assert (state.contact.tolist(), state.collisions.tolist()) == ([True], [1])
    state = driven(world, state, 25, (-0.5, 0.0))
    assert (state.contact.tolist(), state.collisions.tolist()) == ([False], [1])
    state = driven(world, state, 100, (1.0, 0.0))
    assert (state.contact.tolist(), state.collisions.tolist()) == ([True], [2])


def test_a_body_does_not_turn_into_a_wall() -> None:
    world = World(grid_of(4, 4), CALM, 0, 100.0)
    beside = Pose2(2, 0.1 + 0.26, 0)  # the side clears the wall by a centimeter, the tip would not
    state = driven(world, begun(world, beside), 100, (0.0, -1.0))
    assert state.contact[0]
    assert -0.5 < state.poses[0, 2] < 0.0


def test_a_thin_post_inside_the_body_is_a_wall() -> None:
    cells = np.zeros((100, 100), dtype=np.int8)
    cells[50, 50] = 100
    world = World(OccupancyGrid(cells, 0.02, Pose2(0, 0, 0)), CALM, 0, 100.0)
    refused = world.start([Pose2(1.01, 1.01, 0.3)])
    assert isinstance(refused, Misplaced)
    assert refused.reason == "wall"


def test_a_body_inside_one_great_wall_is_in_a_wall() -> None:
    world = World(OccupancyGrid(np.full((3, 3), 100, dtype=np.int8), 1.0, Pose2(0, 0, 0)), CALM, 0, 100.0)
    assert isinstance(world.start([Pose2(1.5, 1.5, 0.0)]), Misplaced)


@pytest.mark.parametrize("heading", np.linspace(-3, 3, 9).tolist())
def test_no_wall_is_so_thin_that_speed_gets_through_it(heading: float) -> None:
    cells = np.zeros((300, 300), dtype=np.int8)
    cells[100, 100:201] = cells[200, 100:201] = cells[100:201, 100] = cells[100:201, 200] = 100
    small = ((0.05, 0.0), (-0.05, 0.05), (-0.05, -0.05))
    fast = replace(CALM, footprint=small, max_vel_x=20.0, acc_lim_x=100.0)
    world = World(OccupancyGrid(cells, 0.02, Pose2(-3, -3, 0)), fast, 0, 100.0)
    state = driven(world, begun(world, Pose2(0, 0, heading)), 60, (20.0, 0.0))
    assert state.contact[0]
    assert np.abs(state.poses[0, :2]).max() < 1.0


def test_unknown_cells_and_the_outside_are_no_walls() -> None:
    unknown = OccupancyGrid(np.full((40, 40), -1, dtype=np.int8), 0.05, Pose2(0, 0, 0))
    world = World(unknown, CALM, 0, 100.0)
    state = driven(world, begun(world, Pose2(1, 1, 0)), 200, (1.0, 0.0))
    assert state.poses[0, 0] > 4.0


@given(st.floats(-20, 20), st.floats(-20, 20), st.floats(-3.1, 3.1), st.integers(0, 2**32 - 1))
@settings(max_examples=20, deadline=None)
def test_a_turned_map_makes_the_same_world(x: float, y: float, yaw: float, seed: int) -> None:
    origin = Pose2(x, y, yaw)
    commands = np.random.default_rng(seed).uniform(-1.5, 1.5, (8, 1, 2))
    world, turned = World(grid_of(3, 2), CALM, 0, 100.0), World(grid_of(3, 2, origin=origin), CALM, 0, 100.0)
    begin = Pose2(1.5, 1.0, 0.4)
    here, there = begun(world, begin), begun(turned, origin.compose(begin))
    for command in commands:
        for _ in range(25):
            here, there = world.step(here, command), turned.step(there, command)
    expected = origin.compose(Pose2(*here.poses[0].tolist()))
    assert there.poses[0, :2] == pytest.approx([expected.x, expected.y], abs=1e-6)
    assert there.collisions.tolist() == here.collisions.tolist()


def body_points(spacing: float) -> FloatArray:
    """(m, 2) points all over the default body, base frame."""
    xs, ys = np.meshgrid(np.arange(-0.249, 0.35, spacing), np.arange(-0.249, 0.25, spacing))
    points = np.column_stack((xs.ravel(), ys.ravel()))
    return points[points[:, 0] < 0.349 - 0.4 * np.abs(points[:, 1])]


@given(st.integers(0, 2**32 - 1))
@settings(max_examples=10, deadline=None)
def test_no_body_ever_overlaps_a_wall_or_another_body(seed: int) -> None:
    rng = np.random.default_rng(seed)
    cells = grid_of(3, 3).cells.copy()
    cells[rng.integers(0, 60, 4), rng.integers(0, 60, 4)] = 100
    grid = OccupancyGrid(cells, 0.05, Pose2(0, 0, 0))
    world = World(grid, CALM, 0, 100.0)
    starts: list[Pose2] = []
    while len(starts) < 3:
        pose = Pose2(*rng.uniform(0, 3, 2).tolist(), rng.uniform(-3, 3))
        if isinstance(world.start([*starts, pose]), WorldState):
            starts.append(pose)
    state = begun(world, *starts)
    body = body_points(0.01)
    for _ in range(12):
        command = rng.uniform(-1.5, 1.5, (3, 2))
        for _ in range(20):
            state = world.step(state, command)
        for i, pose in enumerate(state.poses.tolist()):
            points = Pose2(*pose).transform(body)
            rows, cols = grid.cells_of(points).T
            assert not (grid.cells[rows, cols] == 100).any()
            for other in state.poses[:i].tolist():
                inside = Pose2(*other).inverse().transform(points)
                x, y = inside[:, 0], np.abs(inside[:, 1])
                assert not ((x > -0.249) & (y < 0.249) & (x < 0.349 - 0.4 * y)).any()
    assert state.collisions.sum() > 0


# --- other robots


def test_both_robots_of_a_collision_count_it_once() -> None:
    world = World(grid_of(6, 4), CALM, 0, 100.0)
    state = begun(world, Pose2(2, 2, 0), Pose2(4, 2, 0), Pose2(2, 1, 0))
    state = driven(world, state, 150, (1.0, 0.0), (0.0, 0.0), (0.0, 0.0))
    assert state.contact.tolist() == [True, True, False]
    assert state.collisions.tolist() == [1, 1, 0]
    assert 4 - 0.25 - 0.35 - 0.2 * TICK < state.poses[0, 0] < 4 - 0.25 - 0.35
    assert state.poses[1].tolist() == [4.0, 2.0, 0.0]


def test_a_robot_may_drive_away_from_one_that_presses_on_it() -> None:
    world = World(grid_of(8, 4), CALM, 0, 100.0)
    state = begun(world, Pose2(2, 2, 0), Pose2(4, 2, 0))
    state = driven(world, state, 100, (1.0, 0.0), (0.0, 0.0))
    state = driven(world, state, 50, (0.5, 0.0), (1.0, 0.0))
    assert state.contact.tolist() == [False, False]
    assert state.poses[1, 0] > 4.9


def test_a_robot_far_away_changes_nothing_for_the_others() -> None:
    commands = np.random.default_rng(3).uniform(-1, 1, (20, 3, 2))
    world = World(grid_of(12, 4), WorldParameters(), 11, 100.0)
    two = begun(world, Pose2(1, 1, 0), Pose2(2, 2, 1))
    three = begun(world, Pose2(1, 1, 0), Pose2(2, 2, 1), Pose2(11, 3, 2))
    for command in commands:
        for _ in range(10):
            two, three = world.step(two, command[:2]), world.step(three, command)
            assert np.array_equal(two.poses, three.poses[:2])
            assert np.array_equal(two.odom_poses, three.odom_poses[:2])
            assert np.array_equal(two.odom_twists, three.odom_twists[:2])
            assert np.array_equal(two.collisions, three.collisions[:2])


# --- odometry


@pytest.mark.parametrize(
    ("linear", "angular"), [(0.8, 0.0), (-0.8, 0.0), (0.0, 1.2), (0.6, -0.9)], ids=["ahead", "back", "turn", "arc"]
)
def test_odometry_errs_as_table_5_6_says(linear: float, angular: float) -> None:
    alpha1, alpha2, alpha3, alpha4 = 0.03, 0.05, 0.02, 0.01
    noisy = replace(CALM, odometry=OdometryNoise(alpha1, alpha2, alpha3, alpha4), acc_lim_x=100, acc_lim_theta=100)
    world = World(open_grid(), noisy, 5, 100.0)
    n = 4000
    before = begun(world, Pose2(0, 0, 0))
    found = np.empty((n, 3))
    twists = np.empty((n, 2))
    for tick in range(n):
        after = world.step(before, np.array([[linear, angular]]))
        theta = before.odom_poses[0, 2]
        dx, dy = after.odom_poses[0, :2] - before.odom_poses[0, :2]
        trans = math.copysign(math.hypot(dx, dy), linear)
        rot1 = math.remainder(math.atan2(dy * trans, dx * trans) - theta, 2 * math.pi)
        rot2 = math.remainder(after.odom_poses[0, 2] - theta - rot1, 2 * math.pi)
        found[tick] = rot1, trans, rot2
        twists[tick] = after.odom_twists[0]
        before = after
    rot = 0.5 * angular * TICK
    trans = linear * TICK * (math.sin(rot) / rot if rot else 1.0)
    turn_variance = alpha1 * rot**2 + alpha2 * trans**2
    trans_variance = alpha3 * trans**2 + alpha4 * (rot**2 + rot**2)
    five_deviations = 5 * math.sqrt(2 / n)
    assert np.var(twists[:, 0] * TICK) == pytest.approx(trans_variance, rel=five_deviations)
    assert np.var(twists[:, 1] * TICK) == pytest.approx(2 * turn_variance, rel=five_deviations)
    assert twists.mean(axis=0) * TICK == pytest.approx(
        [trans, 2 * rot], abs=5 * math.sqrt(max(trans_variance, 2 * turn_variance) / n)
    )
    if linear:  # without a way, the first turn cannot be told from the second
        assert found.var(axis=0) == pytest.approx([turn_variance, trans_variance, turn_variance], rel=five_deviations)
        assert abs(np.corrcoef(found.T)[np.triu_indices(3, 1)]).max() < 5 / math.sqrt(n)
        assert found[:, 1] == pytest.approx(twists[:, 0] * TICK)


def test_wheels_of_a_wrong_size_report_everything_by_the_same_factor() -> None:
    world = World(open_grid(), replace(CALM, odometry=OdometryNoise(0, 0, 0, 0, 1.05, 1.1)), 5, 100.0)
    straight = driven(world, begun(world, Pose2(0, 0, 0)), 50, (0.5, 0.0))
    assert straight.odom_poses[0, 0] == pytest.approx(1.05 * straight.poses[0, 0])
    turned = driven(world, begun(world, Pose2(0, 0, 0)), 50, (0.0, 0.5))
    assert turned.odom_poses[0, 2] == pytest.approx(1.1 * turned.poses[0, 2])
    assert turned.odom_twists[0, 1] == pytest.approx(1.1 * turned.twists[0, 1])


def test_wheels_at_rest_do_not_err() -> None:
    world = World(grid_of(4, 4), WorldParameters(), 0, 100.0)
    state = driven(world, begun(world, Pose2(2, 2, 0)), 100, (0.0, 0.0))
    assert not state.odom_poses.any()
    assert not state.odom_twists.any()


def test_no_two_robots_or_ticks_share_an_error() -> None:
    world = World(grid_of(9, 9), WorldParameters(acc_lim_x=100), 0, 100.0)
    state = begun(world, Pose2(1, 1, 0), Pose2(1, 3, 0), Pose2(1, 5, 0))
    measured: list[float] = []
    for _ in range(100):
        state = world.step(state, np.full((3, 2), [1.0, 0.0]))
        measured.extend(state.odom_twists[:, 0].tolist())
    assert len(set(measured)) == 300


def test_another_seed_errs_otherwise() -> None:
    ends = [
        driven(world, begun(world, Pose2(2, 2, 0)), 20, (0.5, 0.5)).odom_poses.tolist()
        for world in (World(grid_of(4, 4), WorldParameters(), seed, 100.0) for seed in (0, 1))
    ]
    assert ends[0] != ends[1]


# --- states are values


def test_any_recorded_tick_can_be_a_new_beginning() -> None:
    commands = np.random.default_rng(1).uniform(-1, 1, (60, 2, 2))
    begin = [Pose2(1, 1, 0), Pose2(3, 3, 2)]
    world = World(grid_of(4, 4), WorldParameters(), 9, 100.0)
    states = [begun(world, *begin)]
    for command in commands:
        states.append(world.step(states[-1], command))
    again = states[25]
    other_world = World(grid_of(4, 4), WorldParameters(), 9, 100.0)
    for command in commands[25:]:
        again = other_world.step(again, command)
    assert same(again, states[-1])


def test_a_state_cannot_be_written_to() -> None:
    world = World(grid_of(4, 4), CALM, 0, 100.0)
    state = driven(world, begun(world, Pose2(2, 2, 0)), 1, (1.0, 0.0))
    with pytest.raises(ValueError, match="read-only"):
        state.poses[0, 0] = 7.0


def test_charge_is_what_was_set() -> None:
    world = World(grid_of(4, 4), CALM, 0, 100.0)
    state = begun(world, Pose2(1, 1, 0), Pose2(3, 3, 0))
    assert state.charge.tolist() == [100.0, 100.0]
    less = driven(world, with_charge(state, 1, 83.0), 10, (0.5, 0.0), (0.5, 0.0))
    assert less.charge.tolist() == [100.0, 83.0]
    assert state.charge.tolist() == [100.0, 100.0]


def test_a_robot_can_be_lifted_and_its_wheels_do_not_know() -> None:
    world = World(grid_of(4, 4), WorldParameters(), 0, 100.0)
    state = driven(world, begun(world, Pose2(1, 1, 0), Pose2(3, 3, 0)), 30, (0.5, 0.0), (0.1, 0.0))
    lifted = world.place(state, 0, Pose2(1, 3, 7.0))
    assert isinstance(lifted, WorldState)
    assert lifted.poses[0] == pytest.approx([1, 3, 7.0 - 2 * math.pi])
    assert lifted.twists[0].tolist() == [0, 0]
    assert np.array_equal(lifted.odom_poses, state.odom_poses)
    assert np.array_equal(lifted.poses[1], state.poses[1])
    assert np.array_equal(lifted.twists[1], state.twists[1])


@pytest.mark.parametrize(
    ("pose", "reason"),
    [(Pose2(0.3, 2, 0), "wall"), (Pose2(3.3, 3, 0), "robot"), (Pose2(9, 9, 0), "outside")],
)
def test_a_robot_is_not_put_where_its_body_has_no_room(pose: Pose2, reason: str) -> None:
    world = World(grid_of(4, 4), CALM, 0, 100.0)
    state = begun(world, Pose2(1, 1, 0), Pose2(3, 3, 0))
    placed, started = world.place(state, 0, pose), world.start([Pose2(3, 3, 0), pose])
    assert isinstance(placed, Misplaced)
    assert isinstance(started, Misplaced)
    assert (placed.robot, placed.reason) == (0, reason)
    assert (started.robot, started.reason) == (1, reason)
    assert "robot 1 cannot be at" in placed.sentence
    assert "robot 2 cannot be at" in started.sentence


def test_a_robot_may_be_put_where_it_stands() -> None:
    world = World(grid_of(4, 4), CALM, 0, 100.0)
    assert isinstance(world.place(begun(world, Pose2(1, 1, 0)), 0, Pose2(1.1, 1, 0)), WorldState)


def test_every_robot_needs_one_finite_command() -> None:
    world = World(grid_of(4, 4), CALM, 0, 100.0)
    state = begun(world, Pose2(1, 1, 0), Pose2(3, 3, 0))
    with pytest.raises(ValueError, match=r"2 robots need commands of shape \(2, 2\), not \(1, 2\)"):
        world.step(state, STILL)
    with pytest.raises(ValueError, match="finite"):
        world.step(state, np.array([[0.0, 0.0], [math.nan, 0.0]]))


def test_a_body_needs_an_area() -> None:
    with pytest.raises(ValueError, match="three corners"):
        World(grid_of(4, 4), replace(CALM, footprint=((0.0, 0.0), (1.0, 0.0))), 0, 100.0)
