import math
from dataclasses import replace

import numpy as np
import pytest
from scipy import stats

from sim.common.geometry import Pose2
from sim.common.grid import OccupancyGrid
from sim.common.observations import TICKS_PER_SECOND, Scan
from sim.numerics.float_array import FloatArray
from sim.parameters import LaserParameters, OdometryNoise, WorldParameters
from sim.world.physics import World, WorldState, with_charge
from sim.world.sensors import Sensors, mount_of

PERFECT_LASER = LaserParameters(range_noise=0, dropout=0)
PERFECT = WorldParameters(gyro_noise=0, odometry=OdometryNoise(0, 0, 0, 0), laser=PERFECT_LASER)


def hall() -> OccupancyGrid:
    """20 m by 4 m inside walls of one cell, whose inner corner is at (0, 0)."""
    cells = np.full((82, 402), 100, dtype=np.int8)
    cells[1:-1, 1:-1] = 0
    return OccupancyGrid(cells, 0.05, Pose2(-0.05, -0.05, 0.0))


def begun(parameters: WorldParameters, *poses: Pose2, seed: int = 0) -> WorldState:
    state = World(hall(), parameters, seed, 100.0).start(poses)
    assert isinstance(state, WorldState)
    return state


def sensors_of(parameters: WorldParameters, seed: int = 0) -> Sensors:
    return Sensors(hall(), parameters, seed, 100.0)


def scan_of(sensors: Sensors, state: WorldState, robot: int) -> Scan:
    """The robot's scan, whichever tick it is: the world as it is, in the next tick that is due."""
    for tick in range(state.tick, state.tick + TICKS_PER_SECOND):
        scan = sensors.sense(replace(state, tick=tick), robot).scan
        if scan is not None:
            return scan
    raise LookupError("no scan within a second")


def beam(scan: Scan, angle: float) -> float:
    """The range of the beam nearest to an angle of the laser's frame."""
    return float(scan.ranges[np.argmin(np.abs(scan.mount.angles() - angle))])


def many_ranges(parameters: WorldParameters, sweeps: int) -> FloatArray:
    """(sweeps, beams) from one place; rows of different ticks."""
    state, sensors = begun(parameters, Pose2(10, 2, 0)), sensors_of(parameters)
    period = TICKS_PER_SECOND // parameters.laser.rate
    scans = [sensors.sense(replace(state, tick=tick), 0).scan for tick in range(0, sweeps * period, period)]
    return np.array([scan.ranges for scan in scans if scan is not None], dtype=np.float64)


# --- wheels, gyroscope, battery


def test_wheels_and_battery_say_what_the_world_says() -> None:
    world = World(hall(), WorldParameters(), 3, 100.0)
    state = begun(WorldParameters(), Pose2(2, 2, 0), Pose2(5, 2, 0), seed=3)
    for _ in range(30):
        state = world.step(state, np.array([[0.5, 0.3], [0.4, -0.3]]))
    seen = sensors_of(WorldParameters(), 3).sense(with_charge(state, 1, 42.0), 1)
    assert seen.tick == seen.odometry.tick == seen.imu.tick == seen.battery.tick == 30
    assert seen.odometry.base_in_odom.array().tolist() == state.odom_poses[1].tolist()
    assert [seen.odometry.twist.linear, seen.odometry.twist.angular] == state.odom_twists[1].tolist()
    assert (seen.battery.charge, seen.battery.capacity) == (42.0, 100.0)


def test_the_gyroscope_errs_around_the_true_rate_of_turn() -> None:
    parameters = replace(WorldParameters(), gyro_noise=0.05)
    state = replace(begun(parameters, Pose2(2, 2, 0)), twists=np.array([[0.0, 0.7]]))
    sensors = sensors_of(parameters)
    rates = [sensors.sense(replace(state, tick=tick), 0).imu.angular_velocity for tick in range(2000)]
    assert stats.kstest(rates, "norm", args=(0.7, 0.05)).pvalue > 1e-3


# --- the laser


@pytest.mark.parametrize("rate", [1, 5, 10, 25, 50])
def test_scans_come_at_their_rate_and_not_all_at_once(rate: int) -> None:
    parameters = replace(PERFECT, laser=replace(PERFECT_LASER, rate=rate))
    period = TICKS_PER_SECOND // rate
    state = begun(parameters, *(Pose2(1.0 + 1.5 * i, 2, 0) for i in range(10)))
    sensors = sensors_of(parameters)
    due = np.array(
        [
            [sensors.sense(replace(state, tick=tick), robot).scan is not None for robot in range(10)]
            for tick in range(2 * period)
        ]
    )
    assert (due[:period].sum(axis=0) == 1).all()
    assert np.array_equal(due[:period], due[period:])
    assert due.sum(axis=1).max() == math.ceil(10 / period)


def test_a_scan_measures_from_where_the_laser_sits() -> None:
    scan = scan_of(sensors_of(PERFECT), begun(PERFECT, Pose2(1, 1, math.pi / 2)), 0)
    assert beam(scan, 0.0) == pytest.approx(4.0 - 1.1, abs=1e-6)
    assert beam(scan, math.pi / 2) == pytest.approx(1.0, abs=1e-6)
    assert scan.ranges.dtype == np.float32
    assert scan.mount == mount_of(PERFECT_LASER)


def test_beams_spread_evenly_about_straight_ahead() -> None:
    angles = mount_of(LaserParameters(beams=5, field_of_view=math.pi)).angles()
    assert angles == pytest.approx(np.array([-2, -1, 0, 1, 2]) * math.pi / 4)


def test_the_body_of_another_robot_is_seen_by_its_true_outline() -> None:
    state = begun(PERFECT, Pose2(5, 2, 0), Pose2(8, 2, 0), Pose2(2, 2, 0))
    sensors = sensors_of(PERFECT)
    # Tail on, from behind: 0.25 m of body towards the viewer; from ahead its tip of 0.35 m.
    assert beam(scan_of(sensors, state, 0), 0.0) == pytest.approx(8 - 0.25 - 5.1, abs=1e-6)
    looking_back = begun(PERFECT, Pose2(5, 2, math.pi), Pose2(8, 2, 0), Pose2(2, 2, 0))
    assert beam(scan_of(sensors, looking_back, 0), 0.0) == pytest.approx(4.9 - 2.35, abs=1e-6)
    turned = begun(PERFECT, Pose2(5, 2, 0), Pose2(8, 2, math.pi))
    assert beam(scan_of(sensors, turned, 0), 0.0) == pytest.approx(8 - 0.35 - 5.1, abs=1e-6)


def test_a_robot_does_not_see_itself() -> None:
    around = replace(PERFECT, laser=replace(PERFECT_LASER, field_of_view=6.28))
    scan = scan_of(sensors_of(around), begun(around, Pose2(10, 2, 0)), 0)
    assert scan.ranges.min() > 1.9


def test_a_robot_behind_a_wall_is_not_seen() -> None:
    cells = hall().cells.copy()
    cells[:, 120:123] = 100
    grid = OccupancyGrid(cells, 0.05, hall().origin)
    alone = World(grid, PERFECT, 0, 100.0).start([Pose2(4, 2, 0)])
    both = World(grid, PERFECT, 0, 100.0).start([Pose2(4, 2, 0), Pose2(8, 2, 0)])
    assert isinstance(alone, WorldState)
    assert isinstance(both, WorldState)
    sensors = Sensors(grid, PERFECT, 0, 100.0)
    assert np.array_equal(scan_of(sensors, alone, 0).ranges, scan_of(sensors, both, 0).ranges)


def test_ranges_err_normally_and_independently() -> None:
    parameters = replace(PERFECT, laser=replace(PERFECT_LASER, range_noise=0.03))
    truth = many_ranges(PERFECT, 1)[0]
    in_reach = truth < 7.8  # where noise cannot lift a range over the limit
    measured = many_ranges(parameters, 400)[:, in_reach] - truth[in_reach]
    assert stats.kstest(measured.ravel(), "norm", args=(0, 0.03)).pvalue > 1e-3
    lagged = np.corrcoef(measured[1:].ravel(), measured[:-1].ravel())[0, 1]
    aside = np.corrcoef(measured[:, 1:].ravel(), measured[:, :-1].ravel())[0, 1]
    assert max(abs(lagged), abs(aside)) < 5 / math.sqrt(measured.size)


def test_a_bias_makes_every_range_too_long() -> None:
    truth = many_ranges(PERFECT, 1)[0]
    in_reach = truth < 7.8
    biased = many_ranges(replace(PERFECT, laser=replace(PERFECT_LASER, range_bias=0.1)), 1)[0]
    assert biased[in_reach] == pytest.approx(truth[in_reach] + 0.1, abs=1e-6)


def test_lost_beams_are_not_a_number() -> None:
    lost = np.isnan(many_ranges(replace(PERFECT, laser=replace(PERFECT_LASER, dropout=0.02)), 200))
    assert stats.binomtest(int(lost.sum()), lost.size, 0.02).pvalue > 1e-3
    assert not np.isnan(many_ranges(PERFECT, 2)).any()


def test_what_is_too_far_is_infinite_and_what_is_too_near_is_range_min() -> None:
    laser = LaserParameters(range_min=1.9, range_max=2.4, range_noise=0.3, dropout=0)
    ranges = many_ranges(replace(PERFECT, laser=laser), 200)
    measured = ranges[np.isfinite(ranges)]
    assert not np.isneginf(ranges).any()
    assert np.isposinf(ranges).any()
    assert measured.max() <= np.float32(2.4)
    assert measured.min() == np.float32(1.9)


def test_a_far_robot_changes_no_bit_of_what_the_others_perceive() -> None:
    world, sensors = World(hall(), WorldParameters(), 4, 100.0), sensors_of(WorldParameters(), 4)
    near = (Pose2(1, 1, 0), Pose2(3, 2, 1))
    two, three = begun(WorldParameters(), *near), begun(WorldParameters(), *near, Pose2(18, 2, 2))
    commands = np.random.default_rng(8).uniform(-1, 1, (10, 3, 2))
    scans = 0
    for command in commands:
        for _ in range(10):
            two, three = world.step(two, command[:2]), world.step(three, command)
            for robot in range(2):
                few, many = sensors.sense(two, robot), sensors.sense(three, robot)
                assert (few.odometry, few.imu, few.battery) == (many.odometry, many.imu, many.battery)
                assert (few.scan is None) == (many.scan is None)
                if few.scan is not None and many.scan is not None:
                    assert few.scan.ranges.tobytes() == many.scan.ranges.tobytes()
                    scans += 1
    assert scans == 2 * 100 // 5


def test_robots_at_one_place_and_tick_err_differently() -> None:
    always = replace(WorldParameters(), laser=LaserParameters(rate=TICKS_PER_SECOND))
    state = begun(always, Pose2(10, 2, 0), Pose2(18, 2, 0))
    here = replace(state, poses=np.array([[10.0, 2.0, 0.0], [10.0, 2.0, 0.0]]))
    sensors = sensors_of(always)
    one, two = sensors.sense(here, 0), sensors.sense(here, 1)
    assert one.imu != two.imu
    assert not np.array_equal(scan_of(sensors, here, 0).ranges, scan_of(sensors, here, 1).ranges, equal_nan=True)


@pytest.mark.parametrize(
    ("laser", "complaint"),
    [(LaserParameters(rate=7), "laser.rate must divide 50"), (LaserParameters(range_min=9.0), "laser.range_min")],
)
def test_a_laser_that_cannot_be_is_refused(laser: LaserParameters, complaint: str) -> None:
    with pytest.raises(ValueError, match=complaint):
        sensors_of(replace(PERFECT, laser=laser))
