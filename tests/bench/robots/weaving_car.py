"""A car that weaves through corridors, with odometry computed from the command to its steering.

Such odometry is wrong in two ways that wheel encoders are not: the wheels turn less than the command says, and later.
"""

import math
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from scipy.ndimage import binary_dilation

from sim.common.geometry import Pose2
from sim.common.grid import FREE, OCCUPIED, UNKNOWN, OccupancyGrid
from sim.common.observations import STANDSTILL, TICKS_PER_SECOND, Imu, LaserMount, Odometry, Scan
from sim.common.raycast import Raycaster
from sim.numerics.elementary import wrap_angle
from sim.numerics.float_array import FloatArray
from sim.numerics.noise_arrays import NoiseStream
from tests.bench.robots.recorded_run import Run

RATE = 40
"""Scans a second."""
MOUNT = LaserMount(Pose2(0.15, 0.0, 0.0), -0.75 * math.pi, 1.5 * math.pi / 1080, 1081, 0.05, 30.0)
RANGE_NOISE = 0.02
WIDTH, HEIGHT, CORRIDOR, MARGIN = 34.0, 18.0, 2.4, 1.5
"""Meters: a corridor of this width runs around a block, with doors and niches in its walls."""
CORNER = 1.2
"""Meters: radius of the corridor's middle line at its corners."""
LENGTH = 60.0
"""Meters driven."""
GAINS, LEADS, SPEEDS = (1.0, 1.4, 1.7), (0.0, 0.1, 0.2), (1.0, 2.0)
"""Reported turns per real turn; seconds by which odometry leads the scans; meters a second."""
_FINE = 400
"""Poses a second between which the car's path is interpolated."""


@dataclass(frozen=True, slots=True, eq=False)
class Drive:
    """What the car does, before anything is wrong with its odometry.

    Attributes:
        scans: (n, 1081) ranges, `RATE` a second.
        times: (m,) seconds, beyond the scans at both ends.
        truth: (m, 3) of the base in the map at these times; headings are not wrapped.
    """

    scans: np.ndarray
    times: FloatArray
    truth: FloatArray

    def at(self, seconds: FloatArray, path: FloatArray) -> FloatArray:
        """(n, 3) poses of a path, which goes with `times`, at other times."""
        return np.stack([np.interp(seconds, self.times, column) for column in path.T], axis=1)

    @property
    def scan_times(self) -> FloatArray:
        """(n,) seconds of the scans."""
        return np.arange(len(self.scans)) / RATE


def corridors() -> OccupancyGrid:
    """The map: free corridors around a block, in walls with doors and niches every few meters."""
    resolution = 0.05
    rows, cols = int((HEIGHT + 2 * MARGIN) / resolution), int((WIDTH + 2 * MARGIN) / resolution)
    y, x = (np.indices((rows, cols)) + 0.5) * resolution - MARGIN
    outside = np.maximum(np.maximum(-x, x - WIDTH), np.maximum(-y, y - HEIGHT))
    inside = np.minimum(np.minimum(x - CORRIDOR, WIDTH - CORRIDOR - x), np.minimum(y - CORRIDOR, HEIGHT - CORRIDOR - y))
    free = (outside <= 0.0) & (inside <= 0.0)
    noise = NoiseStream.named(1, "doors of the corridors")
    for side, (along, depth) in enumerate(((x, outside), (y, outside), (x, inside), (y, inside))):
        last = (WIDTH if side % 2 == 0 else HEIGHT) - CORRIDOR
        shifts, widths, depths = noise.uniforms(side, 30).reshape(3, 10)
        for place, width, deep in zip(CORRIDOR + 4.0 * np.arange(10) + 2.0 * shifts, widths, depths, strict=True):
            if place + 2.0 < last:
                niche = (along > place) & (along < place + 0.9 + width) & (depth > 0.0) & (depth < 0.15 + deep)
                free |= niche
    # Nothing is known behind walls, as in the map of a real building: amcl believes in places inside solid ones.
    wall = binary_dilation(free, np.ones((3, 3)), iterations=2) & ~free
    cells = np.where(free, FREE, np.where(wall, OCCUPIED, UNKNOWN)).astype(np.int8)
    return OccupancyGrid(cells, resolution, Pose2(-MARGIN, -MARGIN, 0.0))


def middle_line(way: FloatArray) -> FloatArray:
    """(n, 3) places and directions on the corridor's middle line, after driving so far around the block."""
    half = CORRIDOR / 2.0
    long, short = WIDTH - CORRIDOR - 2 * CORNER, HEIGHT - CORRIDOR - 2 * CORNER
    bend = math.pi / 2.0 * CORNER
    starts = np.cumsum([0.0, long, bend, short, bend, long, bend, short, bend])
    way = way % starts[-1]
    out = np.empty((len(way), 3))
    corner = np.array([half + CORNER, half])
    direction = 0.0
    for piece, (begin, end) in enumerate(pairwise(starts.tolist())):
        here = (way >= begin) & (way < end)
        on = way[here] - begin
        c, s = math.cos(direction), math.sin(direction)
        ahead, left = np.array([c, s]), np.array([-s, c])
        if piece % 2 == 0:
            out[here, :2] = corner + on[:, np.newaxis] * ahead
            out[here, 2] = direction
            corner = corner + (end - begin) * ahead
        else:
            angle = on / CORNER
            out[here, :2] = corner + CORNER * (
                np.sin(angle)[:, np.newaxis] * ahead + (1 - np.cos(angle))[:, np.newaxis] * left
            )
            out[here, 2] = direction + angle
            corner = corner + CORNER * (ahead + left)
            direction += math.pi / 2.0
    return out


def drive(grid: OccupancyGrid, speed: float, seed: int) -> Drive:
    """Weave around the block, from a random place and in random waves; at full speed after a second."""
    start, phase, length, width, clockwise = NoiseStream.named(seed, "weaving").uniforms(0, 5)
    length, width = 3.2 + 1.2 * length, 0.25 + 0.1 * width
    times = np.arange(-_FINE, int((LENGTH / speed + 2.0) * _FINE)) / _FINE
    fast = np.clip(times, 0.0, 1.0)
    far = speed * (np.where(times < 1.0, fast * fast / 2.0, times - 0.5))
    way = 100.0 * start + far
    line = middle_line(way)
    aside = width * np.sin(2.0 * math.pi * (way / length + phase))
    line[:, 0] -= aside * np.sin(line[:, 2])
    line[:, 1] += aside * np.cos(line[:, 2])
    if clockwise < 0.5:
        line[:, 1] = HEIGHT - line[:, 1]
    # Smoothed over a quarter of a second: a car's steering does not jump where a corner begins.
    # The heading is that of the path, as for the rear axle of a car.
    box = np.ones(_FINE // 4) / (_FINE // 4)
    places = np.stack([np.convolve(np.pad(line[:, k], _FINE // 8, mode="edge"), box, "same") for k in (0, 1)], axis=1)
    places = places[_FINE // 8 : -(_FINE // 8)]
    steps = np.gradient(places, axis=0)
    moving = np.hypot(*steps.T) > 1e-6
    heading = np.unwrap(np.arctan2(steps[moving, 1], steps[moving, 0]))
    truth = np.column_stack((places, np.interp(times, times[moving], heading)))
    seen = np.arange(0, int(LENGTH / speed * RATE)) / RATE
    poses = np.stack([np.interp(seen, times, column) for column in truth.T], axis=1)
    lasers = np.stack([Pose2(*pose).compose(MOUNT.laser_in_base).array() for pose in poses])
    ranges = np.concatenate(
        [Raycaster.of(grid).ranges(some, MOUNT.angles(), MOUNT.range_max) for some in np.array_split(lasers, 20)]
    )
    noise = NoiseStream.named(seed, "weaving", "laser").normals(0, ranges.size).reshape(ranges.shape)
    return Drive((ranges + RANGE_NOISE * noise).astype(np.float32), times, truth)


def by_steering(driven: Drive, gain: float, lead: float) -> Run:
    """The drive with odometry that reports `gain` times each turn, `lead` seconds before the scans show it."""
    truth = driven.truth
    steps = np.diff(truth, axis=0)
    turned = np.concatenate(([0.0], np.cumsum(gain * steps[:, 2])))
    ahead = steps[:, 0] * np.cos(truth[:-1, 2]) + steps[:, 1] * np.sin(truth[:-1, 2])
    x = np.concatenate(([0.0], np.cumsum(ahead * np.cos(turned[:-1] + np.diff(turned) / 2.0))))
    y = np.concatenate(([0.0], np.cumsum(ahead * np.sin(turned[:-1] + np.diff(turned) / 2.0))))
    path = np.column_stack((x, y, turned))
    return run_of(driven, driven.at(driven.scan_times + lead, path))


def run_of(driven: Drive, odometry: FloatArray) -> Run:
    """The drive as a filter sees it, with (n, 3) odometry at its scans."""
    observations = []
    for number, (ranges, (x, y, theta)) in enumerate(zip(driven.scans, odometry.tolist(), strict=True)):
        tick = number * TICKS_PER_SECOND // RATE
        told = Odometry(tick, Pose2(x, y, wrap_angle(theta)), STANDSTILL)
        observations.append((told, Imu(tick, 0.0), Scan(tick, MOUNT, ranges)))
    truth = driven.at(driven.scan_times, driven.truth)
    truth[:, 2] = (truth[:, 2] + math.pi) % (2.0 * math.pi) - math.pi
    return Run(MOUNT, tuple(observations), truth)


def with_spikes(driven: Drive, size: float, seed: int) -> Run:
    """The drive with faultless odometry but for one message every two seconds, which is off by so many meters."""
    odometry = _faultless(driven)
    seconds = np.arange(2, len(odometry) // RATE - 1, 2)
    after, bearing = NoiseStream.named(seed, "spikes").uniforms(0, 2 * len(seconds)).reshape(2, -1)
    wrong = ((seconds + after) * RATE).astype(np.int64)
    odometry[wrong, 0] += size * np.cos(2.0 * math.pi * bearing)
    odometry[wrong, 1] += size * np.sin(2.0 * math.pi * bearing)
    return run_of(driven, odometry)


def with_resets(driven: Drive) -> Run:
    """The drive with faultless odometry that begins again at 0 every ten seconds."""
    odometry = _faultless(driven)
    for begin in range(10 * RATE, len(odometry), 10 * RATE):
        origin = Pose2(*odometry[begin].tolist())
        odometry[begin:] = [origin.between(Pose2(*pose)).array() for pose in odometry[begin:].tolist()]
    return run_of(driven, odometry)


def _faultless(driven: Drive) -> FloatArray:
    """(n, 3) odometry of a drive at its scans that is the truth, from the start on."""
    truth = driven.at(driven.scan_times, driven.truth)
    start = Pose2(*truth[0].tolist())
    return np.stack([start.between(Pose2(*pose)).array() for pose in truth.tolist()])


def weaving_runs(grid: OccupancyGrid, seed: int) -> Iterator[tuple[str, Run]]:
    """Names and runs of all troubles with odometry, of one seed."""
    for speed in SPEEDS:
        driven = drive(grid, speed, seed)
        for gain in GAINS:
            for lead in LEADS:
                name = f"{speed:g} m/s, turns multiplied by {gain:g}, odometry {lead:g} s ahead"
                yield name, by_steering(driven, gain, lead)
    for size in (1.0, 1000.0):
        yield f"2 m/s, spikes of {size:g} m", with_spikes(driven, size, seed)
    yield "2 m/s, odometry reset", with_resets(driven)
