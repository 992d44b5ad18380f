"""A robot driven through an arena, with everything it sensed on the way."""

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cache

import numpy as np
import pytest

from sim.common.geometry import Pose2
from sim.common.grid import OccupancyGrid
from sim.common.observations import TICK, Imu, LaserMount, Odometry, Scan, Twist
from sim.common.raycast import cast_beams, directions_of, free_squares_of, shorten_by_polygon
from sim.numerics.float_array import FloatArray
from sim.numerics.noise_arrays import NoiseStream
from sim.parameters import OdometryNoise

WALLS = (
    "v -5 -5 7; v 11 -5 7; h -5 -5 11; h 7 -5 11;"
    "v 5 3 7; h 3 -5 -1; v -1 3 5; v 1 3 5; h 3 1 5; v 7 3 5; h 3 7 11;"
    "v -1 -3 1; h -1 -5 -1; h -1 1 5; v 1 -3 -1; v 5 -5 -1; v 7 -3 1; h -1 7 11"
)
FURNITURE = "h 4.5 -4.5 -3; v 9.5 4 5.5; h -2 -4.5 -2.5; v 4.2 -4 -2.5; h 0.2 -4.6 -3.9; v 4 5 5.8; h 0.3 8 8.6"
TOUR = (
    (0.0, 2.0), (-3.0, 2.0), (-3.0, 0.5), (-2.5, 2.0), (0.0, 2.0), (0.0, 6.0), (3.0, 6.0), (3.0, 4.5), (3.0, 6.0),
    (0.0, 5.8), (0.2, 1.0), (3.0, 1.0), (6.0, 1.0), (6.0, -4.0), (9.0, -4.0), (9.0, -2.0), (8.5, -4.0), (6.0, -4.0),
    (6.0, 2.0), (9.0, 2.0),
)  # fmt: skip
LASER = LaserMount(Pose2(0.1, 0.0, 0.0), -2.35619449, 4.71238898 / 180, 181, 0.05, 8.0)


def draw_arena(furnished: bool = False, walls_off: float = 0.0, seed: int = 0) -> OccupancyGrid:
    """Sixteen meters by twelve, eight rooms of four meters with open doors, two corridors and a hall.

    Turned by half a circle it is much the same; only furniture tells where one is. Each wall may be some meters off.
    """
    off = np.random.default_rng(seed)
    resolution, thickness = 0.05, 0.12
    x0, y0, width, height = -5.2, -5.2, 16.4, 12.4
    xs = x0 + (np.arange(round(width / resolution)) + 0.5) * resolution
    ys = y0 + (np.arange(round(height / resolution)) + 0.5) * resolution
    x, y = np.meshgrid(xs, ys)
    wall = np.zeros(x.shape, dtype=bool)
    half = thickness / 2
    for line in (f"{WALLS};{FURNITURE}" if furnished else WALLS).split(";"):
        direction, *numbers = line.split()
        at, low, high = map(float, numbers)
        at += off.normal(0.0, walls_off)
        across, along = (x, y) if direction == "v" else (y, x)
        wall |= (abs(across - at) <= half) & (along >= low - half) & (along <= high + half)
    return OccupancyGrid(np.where(wall, 100, 0).astype(np.int8), resolution, Pose2(x0, y0, 0.0))


@dataclass(frozen=True)
class Moment:
    """One tick: the truth and what the robot perceived of it."""

    truth: Pose2
    odometry: Odometry
    imu: Imu
    scan: Scan | None


@dataclass(frozen=True)
class Drive:
    grid: OccupancyGrid
    mount: LaserMount
    moments: tuple[Moment, ...]

    def __iter__(self) -> Iterator[Moment]:
        return iter(self.moments)

    @property
    def start(self) -> Pose2:
        return self.moments[0].truth


DriveMaker = Callable[..., Drive]


def follow_tour(ticks: int, speed: float) -> FloatArray:
    """(ticks, 2) speeds that lead along the tour, given the truth: drive towards the next point, turn on the spot."""
    x, y, theta = *TOUR[0], math.pi
    target = 1
    twists = np.zeros((ticks, 2))
    for i in range(ticks):
        if math.hypot(TOUR[target][0] - x, TOUR[target][1] - y) < 0.15:
            target = (target + 1) % len(TOUR)
        bearing = math.atan2(TOUR[target][1] - y, TOUR[target][0] - x) - theta
        bearing = math.remainder(bearing, 2 * math.pi)
        angular = max(-1.0, min(1.0, 2.0 * bearing))
        linear = speed if abs(bearing) < 0.5 else 0.0
        twists[i] = linear, angular
        x += linear * TICK * math.cos(theta + angular * TICK / 2)
        y += linear * TICK * math.sin(theta + angular * TICK / 2)
        theta += angular * TICK
    return twists


@cache
def _drive(seed: int, seconds: float, noise: float, others: int, speed: float, furnished: bool = False) -> Drive:
    grid = draw_arena(furnished)
    squares, frame = free_squares_of(grid), grid.frame
    ticks = round(seconds / TICK)
    twists = follow_tour(ticks, speed)
    wheels = OdometryNoise()
    alpha1, alpha2, alpha3, alpha4 = (
        noise * alpha for alpha in (wheels.alpha1, wheels.alpha2, wheels.alpha3, wheels.alpha4)
    )
    wheel_noise = NoiseStream.named(seed, "wheels").normals(0, 3 * ticks).reshape(ticks, 3)
    gyro_noise = NoiseStream.named(seed, "gyro").normals(0, ticks) * 0.01 * noise
    laser_noise, lost = NoiseStream.named(seed, "laser"), NoiseStream.named(seed, "lost")
    directions = directions_of(LASER.angles())
    square = np.array([[0.25, 0.25], [-0.25, 0.25], [-0.25, -0.25], [0.25, -0.25]])
    truth, odom = Pose2(*TOUR[0], -math.pi), Pose2(0.0, 0.0, 0.0)
    moments = []
    for tick in range(ticks):
        linear, angular = twists[tick]
        step = Pose2(
            linear * TICK * math.cos(angular * TICK / 2), linear * TICK * math.sin(angular * TICK / 2), angular * TICK
        )
        truth = truth.compose(step)
        turn, trans = step.theta / 2, linear * TICK
        rotation_sd = math.sqrt(alpha1 * turn**2 + alpha2 * trans**2)
        trans_sd = math.sqrt(alpha3 * trans**2 + 2 * alpha4 * turn**2)
        rot1 = turn + rotation_sd * wheel_noise[tick, 0]
        rot2 = turn + rotation_sd * wheel_noise[tick, 2]
        measured = trans + trans_sd * wheel_noise[tick, 1]
        odom = odom.compose(Pose2(measured * math.cos(rot1), measured * math.sin(rot1), rot1 + rot2))
        scan = None
        if tick % 5 == 0:
            ranges = np.empty((1, LASER.beams))
            laser = truth.compose(LASER.laser_in_base)
            cast_beams(squares, frame, laser.array()[None, :], directions, LASER.range_max, ranges)
            for other in range(others):
                # They circle around the robot, nearer and farther; those beyond a wall hide nothing.
                phase = 2 * math.pi * other / others + 0.3 * tick * TICK
                away = 1.8 + 0.9 * math.sin(0.5 * tick * TICK + other)
                body = Pose2(truth.x + away * math.cos(phase), truth.y + away * math.sin(phase), phase)
                corners = laser.inverse().transform(body.transform(square))
                shorten_by_polygon(corners, directions, LASER.range_max, ranges[0])
            ranges += 0.02 * noise * laser_noise.normals(tick, LASER.beams)
            ranges[0, lost.uniforms(tick, LASER.beams) < 0.005 * noise] = np.nan
            scan = Scan(tick, LASER, ranges[0].astype(np.float32))
        twist = Twist(measured / TICK, (rot1 + rot2) / TICK)
        moments.append(Moment(truth, Odometry(tick, odom, twist), Imu(tick, angular + gyro_noise[tick]), scan))
    return Drive(grid, LASER, tuple(moments))


@pytest.fixture(scope="session")
def drive() -> DriveMaker:
    """A maker of drives: seed, seconds, noise as a multiple of the default variances and deviations, other robots."""

    def make(
        seed: int = 1, seconds: float = 60.0, noise: float = 1.0, others: int = 0, furnished: bool = False
    ) -> Drive:
        return _drive(seed, seconds, noise, others, 0.7, furnished)

    return make


@pytest.fixture(scope="session")
def arena() -> OccupancyGrid:
    return draw_arena()
