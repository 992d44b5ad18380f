"""Sensors: a robot's wheels, gyroscope, laser and battery measure the world, each with its own keyed noise."""

import math
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from sim.common.geometry import Pose2
from sim.common.grid import GridFrame, OccupancyGrid
from sim.common.observations import TICKS_PER_SECOND, Battery, Imu, LaserMount, Observations, Odometry, Scan, Twist
from sim.common.polygons import Polygons
from sim.common.raycast import BeamFan, FreeSquares, cast_beams, directions_of, free_squares_of, shorten_fan_by_polygon
from sim.common.robot_numbers import namespace_of
from sim.numerics import elementary, elementary_arrays
from sim.numerics.float_array import FloatArray
from sim.numerics.kernels import njit
from sim.numerics.noise import key
from sim.numerics.noise_arrays import normals, uniforms
from sim.parameters import LaserParameters, WorldParameters
from sim.world.physics import WorldState


@njit(cache=True)
def _sweep(
    robot: int,
    poses: FloatArray,
    laser_x: float,
    fan: BeamFan,
    range_max: float,
    footprint: FloatArray,
    radius: float,
    squares: FreeSquares,
    frame: GridFrame,
    bodies: Polygons,
    wall_poses: FloatArray,
    wall_ranges: FloatArray,
) -> FloatArray:
    """Return the (m,) true ranges of a robot's laser to walls, other robots and things. They are inf beyond range_max.

    `radius`, meters, is the radius of a circle around the base that contains the (v, 2) corners of the footprint.
    `wall_poses` has the pose at each robot's last scan, and `wall_ranges` the ranges from there to the walls.
    """
    theta = poses[robot, 2]
    laser = np.empty((1, 3))
    ahead, left = elementary.cos_sin(theta)
    laser[0, 0] = poses[robot, 0] + laser_x * ahead
    laser[0, 1] = poses[robot, 1] + laser_x * left
    laser[0, 2] = theta
    kept = wall_poses[robot]
    if kept[0] != poses[robot, 0] or kept[1] != poses[robot, 1] or kept[2] != theta:
        cast_beams(squares, frame, laser, fan.directions, range_max, wall_ranges[robot : robot + 1])
        for k in range(3):
            kept[k] = poses[robot, k]
    ranges: FloatArray = wall_ranges[robot].copy()
    # Bodies are placed in the laser's frame, so that the directions of its beams need not be rotated.
    farthest = range_max + 2.0 * radius
    body = np.empty_like(footprint)
    for j in range(poses.shape[0]):
        if j == robot:
            continue
        dx = poses[j, 0] - laser[0, 0]
        dy = poses[j, 1] - laser[0, 1]
        if abs(dx) > farthest or abs(dy) > farthest:
            continue
        x = dx * ahead + dy * left
        y = dy * ahead - dx * left
        c, s = elementary.cos_sin(poses[j, 2] - theta)
        for k in range(footprint.shape[0]):
            body[k, 0] = x + c * footprint[k, 0] - s * footprint[k, 1]
            body[k, 1] = y + s * footprint[k, 0] + c * footprint[k, 1]
        shorten_fan_by_polygon(body, fan, range_max, ranges)
    for k in range(bodies.circles.shape[0]):
        seen = bodies.corners[bodies.ends[k] : bodies.ends[k + 1]].copy()
        for corner in seen:
            dx = corner[0] - laser[0, 0]
            dy = corner[1] - laser[0, 1]
            corner[0] = dx * ahead + dy * left
            corner[1] = dy * ahead - dx * left
        shorten_fan_by_polygon(seen, fan, range_max, ranges)
    return ranges


@njit(cache=True)
def _measured(
    true_ranges: FloatArray,
    tick: int,
    range_key: np.uint64,
    dropout_key: np.uint64,
    range_noise: float,
    range_bias: float,
    dropout: float,
    range_min: float,
    range_max: float,
) -> NDArray[np.float32]:
    """Return (m,) ranges as the laser reports them. See `Sensors`."""
    errors = np.empty(true_ranges.size)
    chances = np.empty(true_ranges.size)
    normals(range_key, tick, errors)
    uniforms(dropout_key, tick, chances)
    ranges = np.empty(true_ranges.size, dtype=np.float32)
    for j in range(true_ranges.size):
        reading = max(range_min, true_ranges[j] + range_bias + range_noise * errors[j])
        if chances[j] < dropout:
            reading = math.nan
        elif reading > range_max:
            reading = math.inf
        ranges[j] = reading
    return ranges


@njit(cache=True)
def _scan(
    robot: int, tick: int, poses: FloatArray, laser_x: float, angle_min: float, angle_increment: float,
    directions: FloatArray, range_min: float, range_max: float, footprint: FloatArray, radius: float,
    squares: FreeSquares, frame: GridFrame, corners: FloatArray, ends: NDArray[np.int64],
    circles: FloatArray, keys: NDArray[np.uint64], noise: FloatArray, wall_poses: FloatArray, wall_ranges: FloatArray,
) -> NDArray[np.float32]:  # fmt: skip
    """Return (m,) ranges as one robot's laser reports them, in one call with plain arguments.

    Args:
        robot: see `_sweep`. Arguments that are fields of `BeamFan` or `Polygons` are described in these classes.
        tick: see `_measured`.
        keys: (robots, 3) see `_keys`.
        noise: (robots, 3) range_noise, range_bias and dropout.
        wall_poses: (robots, 3) see `_sweep`, also for `wall_ranges`.
    """
    fan = BeamFan(angle_min, angle_increment, directions)
    bodies = Polygons(corners, ends, circles)
    true_ranges = _sweep(
        robot, poses, laser_x, fan, range_max, footprint, radius, squares, frame, bodies, wall_poses, wall_ranges
    )  # fmt: skip
    return _measured(
        true_ranges, tick, keys[robot, 1], keys[robot, 2], noise[robot, 0], noise[robot, 1], noise[robot, 2],
        range_min, range_max,
    )  # fmt: skip


@njit(cache=True)
def _inner(
    robot: int, tick: int, odom_poses: FloatArray, odom_twists: FloatArray, twists: FloatArray, charge: FloatArray,
    keys: NDArray[np.uint64], gyro: FloatArray,
) -> tuple[float, float, float, float, float, float, float]:  # fmt: skip
    """Return all measurements except the scan: pose and twist of odometry, angular velocity, and charge.

    Args:
        robot: index of the robot.
        tick: the present tick.
        odom_poses: (robots, 3). See `WorldState` for this and the next three arguments.
        keys: (robots, 3) see `_keys`.
        gyro: (robots,) noise of the angular velocity, rad/s.
    """
    error = np.empty(1)
    normals(keys[robot, 0], tick, error)
    return (
        odom_poses[robot, 0], odom_poses[robot, 1], odom_poses[robot, 2], odom_twists[robot, 0], odom_twists[robot, 1],
        twists[robot, 1] + gyro[robot] * error[0], charge[robot],
    )  # fmt: skip


@lru_cache(maxsize=64)
def _keys(seed: int, robots: int) -> NDArray[np.uint64]:
    """Return (robots, 3) keys of each robot's noise streams: gyroscope, ranges, and lost beams."""
    names = [namespace_of(robot) for robot in range(robots)]
    return np.array(
        [(key(seed, name, "gyro"), key(seed, name, "laser"), key(seed, name, "laser", "dropout")) for name in names],
        dtype=np.uint64,
    )


@lru_cache(maxsize=64)
def _turns(period: int, robots: int) -> NDArray[np.bool_]:
    """Return (period, robots) True for the robots that scan in ticks with this remainder."""
    turns: NDArray[np.bool_] = (np.arange(period)[:, np.newaxis] + np.arange(robots)) % period == 0
    return turns


def mount_of(parameters: LaserParameters) -> LaserMount:
    """Return the laser's mount and beams, which are spread evenly and symmetrically around straight ahead."""
    return LaserMount(
        laser_in_base=Pose2(parameters.x, 0.0, 0.0),
        angle_min=-0.5 * parameters.field_of_view,
        angle_increment=parameters.field_of_view / (parameters.beams - 1),
        beams=parameters.beams,
        range_min=parameters.range_min,
        range_max=parameters.range_max,
    )


class Sensors:
    """The sensors of all robots in one map. They measure the same WorldState, which also contains their noise.

    Wheels and gyroscope report in every tick. The laser reports `rate` times per second. Robots with successive indices
    scan in different ticks, so that the work is spread over time. The laser sees walls, other robots and things, but
    not its own robot. A range is the true range plus a bias and normal noise. Below range_min it is range_min, beyond
    range_max it is +inf. The range of a lost beam is NaN.
    """

    def __init__(self, grid: OccupancyGrid, parameters: WorldParameters, seed: int, capacity: float) -> None:
        """Mount the sensors. `capacity` is the charge of a full battery, in the game's units.

        Raises:
            ValueError: the laser's rate does not divide the ticks per second, or its limits are in the wrong order.
        """
        laser = parameters.laser
        if TICKS_PER_SECOND % laser.rate != 0:
            raise ValueError(f"laser.rate must divide {TICKS_PER_SECOND} without a remainder, not {laser.rate}")
        if not laser.range_min < laser.range_max:
            raise ValueError(
                f"laser.range_min must be less than laser.range_max, not {laser.range_min} and {laser.range_max}"
            )
        self.mount = mount_of(laser)
        self._laser = laser
        self._seed = seed
        self._capacity = capacity
        self._period = TICKS_PER_SECOND // laser.rate
        self._fan = BeamFan(self.mount.angle_min, self.mount.angle_increment, directions_of(self.mount.angles()))
        self._footprint = np.array(parameters.footprint, dtype=np.float64)
        self._radius = float(elementary_arrays.hypot(*self._footprint.T).max())
        self._squares = free_squares_of(grid)
        self._frame = grid.frame
        # For each robot, the pose at its last scan, and the true ranges from there to the walls. Walls never move, so a
        # robot that stands needs no new rays.
        self._wall_poses = np.full((0, 3), np.nan)
        self._wall_ranges = np.empty((0, laser.beams))

    def _ranges_to_walls(self, robots: int) -> tuple[FloatArray, FloatArray]:
        if len(self._wall_poses) != robots:
            self._wall_poses = np.full((robots, 3), np.nan)
            self._wall_ranges = np.empty((robots, self.mount.beams))
        return self._wall_poses, self._wall_ranges

    def scan_due(self, tick: int, robot: int) -> bool:
        """Return True if a robot's laser scans in this tick."""
        return (tick + robot) % self._period == 0

    def scanning(self, tick: int, robots: int) -> NDArray[np.bool_]:
        """Return (robots,) True for the robots whose lasers scan in this tick."""
        scanning: NDArray[np.bool_] = _turns(self._period, robots)[tick % self._period]
        return scanning

    def sense(self, state: WorldState, robot: int, scan: Scan | None = None) -> Observations:
        """Return everything that a robot (index in the team) perceives in this tick.

        Args:
            state: the present world.
            robot: index of the robot.
            scan: the scan of this tick, if it has been made already.
        """
        tick, keys = state.tick, _keys(self._seed, len(state.poses))
        x, y, theta, linear, angular, rate, charge = _inner(
            robot, tick, state.odom_poses, state.odom_twists, state.twists, state.charge, keys, state.noise.gyro
        )
        return Observations(
            tick,
            Odometry(tick, Pose2(x, y, theta), Twist(linear, angular)),
            Imu(tick, rate),
            scan or (self.scan(state, robot) if self.scan_due(tick, robot) else None),
            Battery(tick, charge, self._capacity),
        )

    def scan(self, state: WorldState, robot: int) -> Scan:
        """Make a robot's scan. All beams measure at the same instant."""
        laser, fan, keys = self._laser, self._fan, _keys(self._seed, len(state.poses))
        ranges = _scan(
            robot,
            state.tick,
            state.poses,
            laser.x,
            fan.angle_min,
            fan.angle_increment,
            fan.directions,
            laser.range_min,
            laser.range_max,
            self._footprint,
            self._radius,
            self._squares,
            self._frame,
            *state.bodies,
            keys,
            state.noise.laser,
            *self._ranges_to_walls(len(state.poses)),
        )
        ranges.flags.writeable = False
        return Scan(state.tick, self.mount, ranges)
