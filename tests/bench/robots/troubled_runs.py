"""Tours of the office with trouble of one kind: what a map does not show, or what a robot is wrong about."""

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np
from scipy.ndimage import distance_transform_edt

from sim.common.geometry import Pose2
from sim.common.grid import FREE, OCCUPIED, OccupancyGrid
from sim.numerics.float_array import FloatArray
from sim.numerics.noise_arrays import NoiseStream
from sim.world.thing import Thing
from tests.bench.robots.recorded_run import DEGRADED, Run, tour
from thbridge.files.map_files import Map

ROOMS = 4
HALF = 0.35
FAST = replace(DEGRADED, laser=replace(DEGRADED.laser, rate=50), max_vel_theta=3.5)
"""A laser of 50 Hz, the rate next to 40 that divides ticks, on a robot that turns quickly."""


@dataclass(frozen=True, slots=True)
class TroubledRun:
    """A run, and the map that the filter is given.

    Attributes:
        trouble: its name.
        run: with the truth in that map.
        believed: the map.
    """

    trouble: str
    run: Run
    believed: Map


def troubled_runs(place: Map, seed: int) -> Iterator[TroubledRun]:
    """One run of each trouble, drawn by a seed."""
    plain = tour(place, seed, ROOMS)
    yield TroubledRun("none", plain, place)
    for count in (1, 3, 10):
        yield TroubledRun(
            f"{count} unmapped things", tour(place, seed, ROOMS, bodies=things(place, seed, count)), place
        )
    for count in (1, 3, 6):
        yield TroubledRun(f"{count} people walking", tour(place, seed, ROOMS, bodies=people(place, seed, count)), place)
    yield TroubledRun("doors changed", plain, with_other_doors(place, plain, seed))
    yield scaled(plain, place, 1.02)
    yield TroubledRun("walls 25 cm off", plain, warped(place, 0.25, 8.0))
    yield TroubledRun("laser turned by 3 degrees", with_turned_laser(plain, math.radians(3.0)), place)
    for factor in (0.8, 1.2):
        wheels = replace(DEGRADED.odometry, linear_scale=factor, angular_scale=factor)
        run = tour(place, seed, ROOMS, replace(DEGRADED, odometry=wheels))
        yield TroubledRun(f"wheels report {factor:g} of the way", run, place)
    fast = tour(place, seed, ROOMS, FAST, spin=3.0)
    yield TroubledRun("50 Hz, turns of 3 rad/s", fast, place)
    yield TroubledRun("the same, scans 40 ms late", late(fast, 2), place)


def octagon(radius: float) -> tuple[tuple[float, float], ...]:
    """Corners of a body that is about round."""
    return tuple((radius * math.cos(k * math.pi / 4), radius * math.sin(k * math.pi / 4)) for k in range(8))


def clearance(grid: OccupancyGrid) -> FloatArray:
    """(rows, cols) meters to the nearest cell that is not free."""
    return np.asarray(distance_transform_edt(grid.cells == FREE) * grid.resolution)


def free_points(grid: OccupancyGrid, least: float, noise: NoiseStream, count: int) -> list[tuple[float, float]]:
    """Random points that far from walls."""
    rows, cols = np.nonzero(clearance(grid) > least)
    chosen = (noise.uniforms(0, count) * len(rows)).astype(int)
    cells = np.column_stack((rows[chosen], cols[chosen]))
    return [(float(x), float(y)) for x, y in grid.centres_of(cells)]


def things(place: Map, seed: int, count: int) -> list[Thing]:
    """Bodies 40 to 100 cm wide that stand about, not where the robot starts nor at its goals."""
    noise = NoiseStream.named(seed, "unmapped things")
    start = place.starts[0]
    points = [
        point
        for point in free_points(place.grid, 0.6, noise, 50 * count)
        if math.dist(point, (start.x, start.y)) > 1.5
        and all(math.dist(point, (room.goal.x, room.goal.y)) > 1.0 for room in place.rooms)
    ]
    sizes = noise.uniforms(1, count)
    return [
        Thing(f"box{number}", octagon(0.2 + 0.3 * sizes[number]), Pose2(*points[number], 0.0))
        for number in range(count)
    ]


def people(place: Map, seed: int, count: int) -> list[Thing]:
    """Bodies 50 cm wide that walk to and fro on straight lines of 3 to 12 m."""
    grid, far = place.grid, clearance(place.grid)
    points = iter(free_points(grid, 0.5, NoiseStream.named(seed, "people"), 8000))
    start, found = place.starts[0], []
    for here, there in zip(points, points, strict=False):
        length = math.dist(here, there)
        if len(found) == count:
            break
        if not 3.0 < length < 12.0 or math.dist(here, (start.x, start.y)) < 1.5:
            continue
        between = np.linspace(here, there, int(length / 0.1))
        if (far[cells_of(grid, between)] < HALF).any():
            continue
        heading = math.atan2(there[1] - here[1], there[0] - here[0])
        found.append(Thing(f"person{len(found)}", octagon(0.25), Pose2(*here, heading), (there,), 0.8, True))
    return found


def cells_of(grid: OccupancyGrid, points: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Rows and columns of (n, 2) points, on a grid that is not turned."""
    cols, rows = ((points - (grid.origin.x, grid.origin.y)) / grid.resolution).astype(int).T
    return rows, cols


def with_cells(place: Map, cells: np.ndarray, resolution: float | None = None) -> Map:
    """Return a map with other cells."""
    return replace(place, grid=OccupancyGrid(cells, resolution or place.grid.resolution, place.grid.origin))


def with_other_doors(place: Map, run: Run, seed: int) -> Map:
    """Return a map that shows up to three doors shut through which the robot drives, and eight walls with a gap."""
    grid, noise = place.grid, NoiseStream.named(seed, "doors")
    cells = grid.cells.copy()
    narrow = run.truth[clearance(grid)[cells_of(grid, run.truth[:, :2])] < 0.65]
    shut: list[tuple[float, float]] = []
    for chance in noise.uniforms(0, 40 if len(narrow) else 0):
        x, y, theta = narrow[int(chance * len(narrow))]
        if len(shut) == 3 or any(math.dist((x, y), other) < 2.0 for other in shut):
            continue
        shut.append((x, y))
        for side in (1.0, -1.0):
            for away in np.arange(0.0, 1.5, 0.02):
                point = np.array([[x - side * away * math.sin(theta), y + side * away * math.cos(theta)]])
                row, col = cells_of(grid, point)
                if grid.cells[row, col] != FREE:
                    break
                cells[row, col] = OCCUPIED
    walls = np.argwhere(grid.cells == OCCUPIED)
    reach = int(0.6 / grid.resolution)
    for chance in noise.uniforms(1, 8):
        row, col = walls[int(chance * len(walls))]
        piece = cells[max(0, row - reach) : row + reach, max(0, col - reach) : col + reach]
        piece[piece == OCCUPIED] = FREE
    return with_cells(place, cells)


def scaled(run: Run, place: Map, factor: float) -> TroubledRun:
    """Return a map that is too large, and the truth in it."""
    truth, origin = run.truth.copy(), np.array((place.grid.origin.x, place.grid.origin.y))
    truth[:, :2] = origin + (truth[:, :2] - origin) * factor
    believed = with_cells(place, place.grid.cells, place.grid.resolution * factor)
    return TroubledRun(f"map {100 * (factor - 1):.0f} % too large", replace(run, truth=truth), believed)


def warped(place: Map, amplitude: float, wave: float) -> Map:
    """Return a map whose walls lie up to `amplitude` meters off, along x and y, in waves of `wave` meters."""
    grid = place.grid
    row, col = np.indices(grid.cells.shape)
    shift = amplitude / grid.resolution
    rows = np.clip(np.round(row + shift * np.sin(2.0 * np.pi * col * grid.resolution / wave)), 0, grid.rows - 1)
    cols = np.clip(np.round(col + shift * np.sin(2.0 * np.pi * row * grid.resolution / wave)), 0, grid.cols - 1)
    return with_cells(place, np.ascontiguousarray(grid.cells[rows.astype(int), cols.astype(int)]))


def with_turned_laser(run: Run, angle: float) -> Run:
    """Let the filter believe that the laser is mounted otherwise than it is."""
    laser = run.mount.laser_in_base
    return replace(run, mount=replace(run.mount, laser_in_base=Pose2(laser.x, laser.y, laser.theta + angle)))


def late(run: Run, scans: int) -> Run:
    """Let each scan come when so many later ones are taken."""
    shown = [
        (odometry, imu, run.observations[max(0, number - scans)][2])
        for number, (odometry, imu, _) in enumerate(run.observations)
    ]
    return replace(run, observations=tuple(shown))
