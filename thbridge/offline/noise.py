"""What noise does: where wheels say that a robot went, where a particle filter believes it may be, what a laser sees.

The models are those of the simulation: the wheels' of `sim.world.physics`, amcl's of `sim.robot.localization.motion`,
the laser's of `sim.world.sensors`. Seeds are fixed, so that two drawings differ by what was changed and nothing else.
"""

import math
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import Literal

import numpy as np

from sim.common.geometry import FloatArray, Pose2
from sim.common.grid import FREE, OCCUPIED, OccupancyGrid
from sim.common.kernels import njit
from sim.common.noise import NoiseStream, key, normals
from sim.common.observations import TICK, Scan
from sim.parameters import AmclParameters, OdometryNoise, WorldParameters
from sim.robot.localization.motion import Alphas, MotionModel
from sim.world.physics import Misplaced, World
from sim.world.sensor_noise import WheelNoise, measured_increment, wheel_noise_of
from sim.world.sensors import Sensors

PATHS = 200
"""Paths in a fan."""
SEED = 1
_KEPT = 60
"""Points of a path; more would not be seen."""
_CHI_SQUARE_95 = 5.991464547107979
"""Of two degrees of freedom: within it lie 95 % of a normal distribution in the plane."""

CourseShape = Literal["straight", "square"]

STRAIGHT = 10.0
"""Metres."""
SIDE = 2.5
"""Metres: a square of the same length."""


@dataclass(frozen=True, slots=True, eq=False)
class PathSpread:
    """Many paths of one drive.

    Attributes:
        driven: (k, 2) the true path, or the one that the wheels report, metres; from the origin along x.
        paths: (n, k, 2) what it may look like.
        centre: (2,) mean of the paths' ends.
        ellipse: (m, 2) the outline that holds 95 % of the ends.
        along: half axis of that ellipse in metres, the longer one.
        across: the shorter one.
    """

    driven: FloatArray
    paths: FloatArray
    centre: FloatArray
    ellipse: FloatArray
    along: float
    across: float


def odometry_spread(noise: OdometryNoise, course: CourseShape, speed: float, turn: float) -> PathSpread:
    """Where the wheels say that a robot went which drove a course exactly.

    Args:
        noise: how wheels truly err.
        course: 10 m straight, or once around a square of 2.5 m.
        speed: of driving, m/s. The error of a tick is a share of the way of that tick, so that a slow drive, of many
            ticks, averages out more of it.
        turn: of turning on the spot, rad/s.
    """
    movements = _movements(course, speed, turn)
    stride = max(1, len(movements) // _KEPT)
    return _fan(_poses(movements)[:, :2], _reported(movements, _draws(len(movements)), wheel_noise_of(noise), stride))


def belief_spread(amcl: AmclParameters, course: CourseShape, speed: float, turn: float) -> PathSpread:
    """Where amcl's particles go, without any scan, when the wheels report a course.

    Args:
        amcl: the model and its alphas, and how far the robot goes from one update to the next.
        course: as for `wheels_fan`.
        speed: of driving, m/s.
        turn: of turning on the spot, rad/s.
    """
    driven = _poses(_movements(course, speed, turn))
    alphas = Alphas(amcl.odom_alpha1, amcl.odom_alpha2, amcl.odom_alpha3, amcl.odom_alpha4, amcl.odom_alpha5)
    model = MotionModel(amcl.odom_model_type, alphas)
    noise = NoiseStream.named(SEED, "fan", "believed")
    particles = np.zeros((PATHS, 3))
    before = Pose2(0.0, 0.0, 0.0)
    ways, reported = [particles[:, :2].copy()], [(0.0, 0.0)]
    for tick, (x, y, theta) in enumerate(driven.tolist()):
        here = Pose2(x, y, theta)
        moved = math.hypot(x - before.x, y - before.y), abs(math.remainder(theta - before.theta, math.tau))
        if moved[0] < amcl.update_min_d and moved[1] < amcl.update_min_a and tick < len(driven) - 1:
            continue
        particles = model.move(particles, before, here, noise.normals(tick, 3 * PATHS))
        before = here
        ways.append(particles[:, :2].copy())
        reported.append((x, y))
    return _fan(np.array(reported), np.stack(ways, axis=1))


def _movements(course: CourseShape, speed: float, turn: float) -> FloatArray:
    """(k, 2) what a robot does in each tick: length of the chord, and half of the angle turned."""
    if course == "straight":
        return _in_ticks(STRAIGHT, 0.0, STRAIGHT / speed)
    side, corner = _in_ticks(SIDE, 0.0, SIDE / speed), _in_ticks(0.0, 0.25 * math.pi, 0.5 * math.pi / turn)
    return np.concatenate([side, corner] * 4)


def _in_ticks(distance: float, half: float, seconds: float) -> FloatArray:
    ticks = max(1, round(seconds / TICK))
    return np.tile(np.array([[distance / ticks, half / ticks]]), (ticks, 1))


@lru_cache(maxsize=4)
def _draws(ticks: int) -> FloatArray:
    """(n, ticks, 3) standard normals: the same for all noise, so that only what is changed makes a difference."""
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
    """(n, k, 2) where the wheels of n robots say that they are: at the start, every `stride` ticks, at the end."""
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
    """(k + 1, 3) the poses of a robot that makes these movements exactly."""
    poses = np.zeros((movements.shape[0] + 1, 3))
    for tick in range(movements.shape[0]):
        chord, half = movements[tick]
        heading = poses[tick, 2] + half
        poses[tick + 1, 0] = poses[tick, 0] + chord * math.cos(heading)
        poses[tick + 1, 1] = poses[tick, 1] + chord * math.sin(heading)
        poses[tick + 1, 2] = heading + half
    return poses


def _fan(driven: FloatArray, paths: FloatArray) -> PathSpread:
    ends = paths[:, -1]
    centre: FloatArray = ends.mean(axis=0)
    lengths, axes = np.linalg.eigh(np.cov(ends.T))
    halves = np.sqrt(_CHI_SQUARE_95 * np.maximum(lengths, 0.0))
    angles = np.linspace(0.0, math.tau, 61)
    circle = np.column_stack([halves[0] * np.cos(angles), halves[1] * np.sin(angles)])
    return PathSpread(driven, paths, centre, centre + circle @ axes.T, float(halves[1]), float(halves[0]))


@dataclass(frozen=True, slots=True, eq=False)
class RoomScan:
    """One sweep in a room. The map frame, metres.

    Attributes:
        walls: (k, 2, 2) ends of the walls' lines.
        laser: (2,) where the laser is.
        true: (m, 2) where the beams truly end, of those that end within range.
        seen: (j, 2) where the laser says that beams end.
        lost: how many beams should end somewhere and return nothing.
        beams: of the sweep.
    """

    walls: FloatArray
    laser: FloatArray
    true: FloatArray
    seen: FloatArray
    lost: int
    beams: int


def room_scan(world: WorldParameters) -> RoomScan:
    """A sweep of this laser, and the same without noise, in a room of 6 m by 4 m with a pillar and a door.

    Raises:
        ValueError: the laser's limits are the wrong way round, or its rate does not divide the ticks of a second.
    """
    exact = replace(world.laser, range_noise=0.0, range_bias=0.0, dropout=0.0)
    seen, true = _sweep(world), _sweep(replace(world, laser=exact))
    x, y, theta = _LASER_STANDS
    laser = np.array([x + world.laser.x * math.cos(theta), y + world.laser.x * math.sin(theta)])
    hit, told = np.isfinite(true.ranges), np.isfinite(seen.ranges)
    return RoomScan(
        walls=np.array(_WALLS),
        laser=laser,
        true=_ends(laser, theta, true)[hit],
        seen=_ends(laser, theta, seen)[told],
        lost=int(np.count_nonzero(hit & ~told)),
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
    """The scan of a robot that stands in the room."""
    grid = _room()
    state = World(grid, world, SEED, 1.0).start([Pose2(*_LASER_STANDS)])
    if isinstance(state, Misplaced):
        # A body larger than the room sees as much as a small one.
        return _sweep(replace(world, footprint=WorldParameters().footprint))
    scan = Sensors(grid, world, SEED, 1.0).sense(state, 0).scan
    if scan is None:
        raise ValueError("the first tick has no scan")
    return scan


def _ends(laser: FloatArray, theta: float, scan: Scan) -> FloatArray:
    """(m, 2) where the beams end; not finite where they do not."""
    angles = theta + scan.mount.angles()
    ranges = scan.ranges.astype(np.float64)
    with np.errstate(invalid="ignore"):
        ends: FloatArray = laser + ranges[:, None] * np.column_stack([np.cos(angles), np.sin(angles)])
    return ends


@lru_cache(maxsize=1)
def _room() -> OccupancyGrid:
    """Walls one cell thick around and in the room; beyond its door lies another room's far wall."""
    cells = np.full((82, 162), FREE, dtype=np.int8)
    cells[0, :] = cells[-1, :] = cells[:, 0] = cells[:, -1] = OCCUPIED
    # One cell around the room, so that its inner faces lie at 0 and 6 m, 0 and 4 m.
    cells[:, 121] = OCCUPIED
    cells[31:51, 121] = FREE
    cells[51:61, 71:81] = OCCUPIED
    return OccupancyGrid(cells, _CELL, Pose2(-_CELL, -_CELL, 0.0))


def covered(true: PathSpread, believed: PathSpread) -> float:
    """Share of the true ends that lie where the belief has 95 % of its own.

    The two fans are mirror images: one has the robot on its course and its wheels elsewhere, the other the wheels on
    the course and the robot elsewhere. Over such short ways the errors themselves are the same.
    """
    spread = np.cov(believed.paths[:, -1].T) + 1e-12 * np.eye(2)
    off = believed.centre - believed.driven[-1] - (true.paths[:, -1] - true.driven[-1])
    distances = np.einsum("ni,ni->n", off, np.linalg.solve(spread, off.T).T)
    return float(np.mean(distances <= _CHI_SQUARE_95))
