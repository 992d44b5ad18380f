"""Effects of noise for drawings: spread of odometry, spread of a particle filter without scans, a noisy laser scan.

The models are the simulation's models: `sim.world.physics` for odometry, `sim.robot.localization.motion` for amcl, and
`sim.world.sensors` for the laser. Seeds are fixed, so that two drawings differ only by the changed parameters.
"""

import math
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import Literal

import numpy as np

from sim.common.geometry import Pose2
from sim.common.grid import FREE, OCCUPIED, OccupancyGrid
from sim.common.observations import TICK, Scan
from sim.numerics.float_array import FloatArray
from sim.numerics.kernels import njit
from sim.numerics.noise import key
from sim.numerics.noise_arrays import NoiseStream, normals
from sim.parameters import AmclParameters, OdometryNoise, WorldParameters
from sim.robot.localization.motion import Alphas, MotionModel
from sim.world.physics import Misplaced, World
from sim.world.sensor_noise import WheelNoise, measured_increment, wheel_noise_of
from sim.world.sensors import Sensors

PATHS = 200
"""Number of random paths."""
SEED = 1
_KEPT = 60
"""Number of points of a drawn path."""
_CHI_SQUARE_95 = 5.991464547107979
"""95 % quantile of the chi-square distribution with two degrees of freedom, for the 95 % ellipse in the plane."""

CourseShape = Literal["straight", "square"]

STRAIGHT = 10.0
"""Length of the straight course, meters."""
SIDE = 2.5
"""Side of the square course, meters. Both courses have the same length."""


@dataclass(frozen=True, slots=True, eq=False)
class PathSpread:
    """Random paths of one drive, and the spread of their ends.

    Attributes:
        driven: (k, 2) path without noise, meters. It starts at the origin, along x.
        paths: (n, k, 2) paths with noise.
        centre: (2,) mean of the ends of the paths.
        ellipse: (m, 2) outline of the 95 % ellipse of the ends.
        along: longer half axis of the ellipse, meters.
        across: shorter half axis of the ellipse, meters.
    """

    driven: FloatArray
    paths: FloatArray
    centre: FloatArray
    ellipse: FloatArray
    along: float
    across: float


def odometry_spread(noise: OdometryNoise, course: CourseShape, speed: float, turn: float) -> PathSpread:
    """Return paths in the odometry of a robot that drives exactly along a course.

    Args:
        noise: the true noise of the wheels' odometry.
        course: 10 m straight, or once around a square with sides of 2.5 m.
        speed: driving speed, m/s. The error in a tick is proportional to the driven distance. So in a slow drive with
            many ticks, more errors cancel each other.
        turn: rotation speed in place, rad/s.
    """
    movements = _movements(course, speed, turn)
    stride = max(1, len(movements) // _KEPT)
    paths = _reported(movements, _draws(len(movements)), wheel_noise_of(noise), stride)
    return _spread(_poses(movements)[:, :2], paths)


def belief_spread(amcl: AmclParameters, course: CourseShape, speed: float, turn: float) -> PathSpread:
    """Return paths of amcl's particles without scans, for odometry that is exactly on a course.

    Args:
        amcl: motion model, alphas, and minimum motion between two updates.
        course: see `odometry_spread`.
        speed: driving speed, m/s.
        turn: rotation speed in place, rad/s.
    """
    driven = _poses(_movements(course, speed, turn))
    alphas = Alphas(amcl.odom_alpha1, amcl.odom_alpha2, amcl.odom_alpha3, amcl.odom_alpha4, amcl.odom_alpha5)
    model = MotionModel(amcl.odom_model_type, alphas)
    noise = NoiseStream.named(SEED, "fan", "believed")
    particles = np.zeros((PATHS, 3))
    before = Pose2(0.0, 0.0, 0.0)
    positions, reported = [particles[:, :2].copy()], [(0.0, 0.0)]
    for tick, (x, y, theta) in enumerate(driven.tolist()):
        here = Pose2(x, y, theta)
        moved = math.hypot(x - before.x, y - before.y), abs(math.remainder(theta - before.theta, math.tau))
        if moved[0] < amcl.update_min_d and moved[1] < amcl.update_min_a and tick < len(driven) - 1:
            continue
        particles = model.move(particles, before, here, noise.normals(tick, 3 * PATHS))
        before = here
        positions.append(particles[:, :2].copy())
        reported.append((x, y))
    return _spread(np.array(reported), np.stack(positions, axis=1))


def _movements(course: CourseShape, speed: float, turn: float) -> FloatArray:
    """Return (k, 2) motions of a robot in each tick: length of the chord (m), and half of the turn (rad)."""
    if course == "straight":
        return _in_ticks(STRAIGHT, 0.0, STRAIGHT / speed)
    side, corner = _in_ticks(SIDE, 0.0, SIDE / speed), _in_ticks(0.0, 0.25 * math.pi, 0.5 * math.pi / turn)
    return np.concatenate([side, corner] * 4)


def _in_ticks(distance: float, half: float, seconds: float) -> FloatArray:
    ticks = max(1, round(seconds / TICK))
    return np.tile(np.array([[distance / ticks, half / ticks]]), (ticks, 1))


@lru_cache(maxsize=4)
def _draws(ticks: int) -> FloatArray:
    """Return (n, ticks, 3) standard normal numbers. They do not depend on parameters, so drawings are comparable."""
    keys = np.array([key(SEED, "fan", f"path{i + 1}") for i in range(PATHS)], dtype=np.uint64)
    draws = np.empty((PATHS, ticks, 3))
    for i in range(PATHS):
        _draw(keys[i], draws[i])
    return draws


@njit(cache=True)
def _draw(key: np.uint64, out: FloatArray) -> None:
    for tick in range(out.shape[0]):
        normals(key, tick, out[tick])


@njit(cache=True, nogil=True)
def _reported(movements: FloatArray, draws: FloatArray, wheels: WheelNoise, stride: int) -> FloatArray:
    """Return (n, k, 2) positions of n robots in odometry: at the start, every `stride` ticks, and at the end."""
    ticks = movements.shape[0]
    kept = 1 + (ticks + stride - 1) // stride
    paths = np.zeros((draws.shape[0], kept, 2))
    for i in range(draws.shape[0]):
        x, y, theta = 0.0, 0.0, 0.0
        for tick in range(ticks):
            first, chord, second = measured_increment(wheels, movements[tick, 0], movements[tick, 1], draws[i, tick])
            x += chord * math.cos(theta + first)
            y += chord * math.sin(theta + first)
            theta += first + second
            if (tick + 1) % stride == 0 or tick == ticks - 1:
                paths[i, (tick + stride) // stride, 0] = x
                paths[i, (tick + stride) // stride, 1] = y
    return paths


@njit(cache=True)
def _poses(movements: FloatArray) -> FloatArray:
    """Return (k + 1, 3) poses of a robot with exactly these movements."""
    poses = np.zeros((movements.shape[0] + 1, 3))
    for tick in range(movements.shape[0]):
        chord, half = movements[tick]
        heading = poses[tick, 2] + half
        poses[tick + 1, 0] = poses[tick, 0] + chord * math.cos(heading)
        poses[tick + 1, 1] = poses[tick, 1] + chord * math.sin(heading)
        poses[tick + 1, 2] = heading + half
    return poses


def _spread(driven: FloatArray, paths: FloatArray) -> PathSpread:
    ends = paths[:, -1]
    centre: FloatArray = ends.mean(axis=0)
    lengths, axes = np.linalg.eigh(np.cov(ends.T))
    halves = np.sqrt(_CHI_SQUARE_95 * np.maximum(lengths, 0.0))
    angles = np.linspace(0.0, math.tau, 61)
    circle = np.column_stack([halves[0] * np.cos(angles), halves[1] * np.sin(angles)])
    return PathSpread(driven, paths, centre, centre + circle @ axes.T, float(halves[1]), float(halves[0]))


@dataclass(frozen=True, slots=True, eq=False)
class RoomScan:
    """One laser scan in a room, in the map frame, meters.

    Attributes:
        walls: (k, 2, 2) ends of the lines that represent walls.
        laser: (2,) position of the laser.
        true: (m, 2) true ends of the beams that hit a wall within range.
        seen: (j, 2) ends of the beams in the noisy scan.
        lost: number of beams that hit a wall within range but have no reading.
        beams: number of beams.
    """

    walls: FloatArray
    laser: FloatArray
    true: FloatArray
    seen: FloatArray
    lost: int
    beams: int


def room_scan(world: WorldParameters) -> RoomScan:
    """Return a scan of the world's laser with and without noise, in a room of 6 m by 4 m with a pillar and a door.

    Raises:
        ValueError: the laser's limits are in the wrong order, or its rate does not divide the ticks per second.
    """
    exact = replace(world.laser, range_noise=0.0, range_bias=0.0, dropout=0.0)
    seen, true = _sweep(world), _sweep(replace(world, laser=exact))
    x, y, theta = _LASER_STANDS
    laser = np.array([x + world.laser.x * math.cos(theta), y + world.laser.x * math.sin(theta)])
    hit, returned = np.isfinite(true.ranges), np.isfinite(seen.ranges)
    return RoomScan(
        walls=np.array(_WALLS),
        laser=laser,
        true=_ends(laser, theta, true)[hit],
        seen=_ends(laser, theta, seen)[returned],
        lost=int(np.count_nonzero(hit & ~returned)),
        beams=world.laser.beams,
    )


_LASER_STANDS = (2.0, 1.5, 0.4)
_CELL = 0.05
_WALLS = (
    ((0.0, 0.0), (6.0, 0.0)),
    ((6.0, 0.0), (6.0, 1.5)),
    ((6.0, 2.5), (6.0, 4.0)),
    ((6.0, 4.0), (0.0, 4.0)),
    ((0.0, 4.0), (0.0, 0.0)),
    ((3.5, 2.5), (4.0, 2.5)),
    ((4.0, 2.5), (4.0, 3.0)),
    ((4.0, 3.0), (3.5, 3.0)),
    ((3.5, 3.0), (3.5, 2.5)),
)


def _sweep(world: WorldParameters) -> Scan:
    """Return the scan of a robot in the room."""
    grid = _room()
    state = World(grid, world, SEED, 1.0).start([Pose2(*_LASER_STANDS)])
    if isinstance(state, Misplaced):
        # A body that is too large for the room is replaced by the standard body. The scan does not depend on the body.
        return _sweep(replace(world, footprint=WorldParameters().footprint))
    scan = Sensors(grid, world, SEED, 1.0).sense(state, 0).scan
    if scan is None:
        raise ValueError("the first tick has no scan")
    return scan


def _ends(laser: FloatArray, theta: float, scan: Scan) -> FloatArray:
    """Return (m, 2) ends of the beams. Ends of beams without a reading are not finite."""
    angles = theta + scan.mount.angles()
    ranges = scan.ranges.astype(np.float64)
    with np.errstate(invalid="ignore"):
        ends: FloatArray = laser + ranges[:, None] * np.column_stack([np.cos(angles), np.sin(angles)])
    return ends


@lru_cache(maxsize=1)
def _room() -> OccupancyGrid:
    """Return the grid of the room. Walls are one cell thick. Behind the door, there is the far wall of another room."""
    cells = np.full((82, 162), FREE, dtype=np.int8)
    cells[0, :] = cells[-1, :] = cells[:, 0] = cells[:, -1] = OCCUPIED
    # The outer walls are one cell outside the room, so that their inner faces are at 0 and 6 m, 0 and 4 m.
    cells[:, 121] = OCCUPIED
    cells[31:51, 121] = FREE
    cells[51:61, 71:81] = OCCUPIED
    return OccupancyGrid(cells, _CELL, Pose2(-_CELL, -_CELL, 0.0))


def covered(true: PathSpread, believed: PathSpread) -> float:
    """Return the share of the true ends inside the 95 % ellipse of the filter.

    The two spreads are mirror images. In `true`, the robot follows the course exactly, and its odometry differs. In
    `believed`, odometry follows the course exactly, and the robot differs. For these short distances, the errors
    are equal.
    """
    spread = np.cov(believed.paths[:, -1].T) + 1e-12 * np.eye(2)
    off = believed.centre - believed.driven[-1] - (true.paths[:, -1] - true.driven[-1])
    distances = np.einsum("ni,ni->n", off, np.linalg.solve(spread, off.T).T)
    return float(np.mean(distances <= _CHI_SQUARE_95))
