"""The obstacle layer: readings of the laser mark obstacles, and clear the space in front of them.

Every cell has a mark: LETHAL, FREE or UNKNOWN. A scan is processed in three steps. First it clears: the cells that a
beam passed before its end become free (ray tracing by Bresenham's lines). Then it marks: the cell where a beam ended
becomes lethal. Finally the cells under the robot become free. Clearing comes first, so that a beam that grazes an
obstacle does not clear cells that another beam of the same scan marks. A mark remains until a later scan looks through
it. So the robot remembers obstacles that it does not see at present.

Source: ros-planning/navigation, costmap_2d/plugins/obstacle_layer.cpp.
Differences from ROS: with `explained_distance`, readings that the map or another robot explains do not mark. Otherwise
every error of localization would thicken the walls, and every passing robot would leave a trail. `clear_between_beams`
clears distant cells between two beams, which no beam would ever clear. A beam that hit nothing never marks. A scan
marks immediately, while ROS keeps the last scan for the next update.
"""

import copy
import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sim.common.distance_fields import near_walls
from sim.common.geometry import Pose2
from sim.common.grid import OccupancyGrid
from sim.common.observations import Scan
from sim.numerics import elementary
from sim.numerics.float_array import FloatArray
from sim.numerics.kernels import njit
from sim.parameters import ObservationSource, ObstacleParameters
from sim.robot.costmap.costs import FREE, LETHAL, UNKNOWN, Changes, CostFrame, Costs, Window
from sim.robot.costmap.footprint_cost import in_cells
from sim.robot.costmap.lines import clear_line, fill_convex, include

OVERWRITE = 0
MAXIMUM = 1

NOWHERE: NDArray[np.bool_] = np.empty((0, 0), np.bool_)
"""Array without walls."""
NOWHERE.setflags(write=False)

TILE = 64
"""Side of the tiles in which marks are searched, cells."""


class Sweep(NamedTuple):
    """A scan for compiled kernels: the laser's pose in the map, and direction and reading of each beam.

    Attributes:
        x: pose of the laser in the map, with `y` and `theta`; meters, radians.
        angle_min: angle of the first beam, in the laser's frame.
        angle_increment: angle from one beam to the next.
        ranges: (beams,) meters. NaN if unknown, +inf if nothing was hit.
        rays: (beams, 2) cosine and sine of each beam's direction in the map.
    """

    x: float
    y: float
    theta: float
    angle_min: float
    angle_increment: float
    ranges: FloatArray
    rays: FloatArray


class KnownObstacles(NamedTuple):
    """Known walls and robots. Readings near them do not mark obstacles.

    Attributes:
        distance: distance within which a reading is explained, meters.
        near_walls: (rows, cols) of the static map, True within this distance of a wall.
        row: row of the marks' cell (0, 0) in the static map; `col` is its column.
        discs: (n, 3) x, y and radius of the other robots, meters.
    """

    distance: float
    near_walls: NDArray[np.bool_]
    row: int
    col: int
    discs: FloatArray


@njit(cache=True)
def _rays(theta: float, angle_min: float, angle_increment: float, beams: int) -> FloatArray:
    """Return the rays of a `Sweep`, for a laser with heading `theta` in the map."""
    rays = np.empty((beams, 2))
    for i in range(beams):
        angle = theta + angle_min + i * angle_increment
        rays[i, 0], rays[i, 1] = elementary.cos_sin(angle)
    return rays


@njit(cache=True)
def _readings(ranges: NDArray[np.float32], range_min: float, range_max: float) -> FloatArray:
    """Return the readings of a `Sweep`."""
    readings = np.empty(ranges.shape[0])
    for i in range(ranges.shape[0]):
        reading = float(ranges[i])
        # Other numbers are not readings. ROS's laser_geometry ignores them too.
        valid = range_min <= reading < range_max or reading == np.inf
        readings[i] = reading if valid else np.nan
    return readings


class CostmapObservation:
    """A scan with the poses that are needed to use it. Both costmaps of a robot process the same object.

    Args:
        base_in_map: pose of the robot during the scan.
        scan: the readings.
        discs: (n, 3) x, y and radius of the other robots, meters.
        before: the observation before, by the same laser. If the robot has not turned since then, its rays are used
            again.

    Attributes:
        sweep: the scan for kernels.
    """

    def __init__(
        self, base_in_map: Pose2, scan: Scan, discs: FloatArray, before: "CostmapObservation | None" = None
    ) -> None:
        mount = scan.mount
        laser = base_in_map.compose(mount.laser_in_base)
        if before is not None and before.sweep.theta == laser.theta and before.scan.mount is mount:
            rays = before.sweep.rays
        else:
            rays = _rays(laser.theta, mount.angle_min, mount.angle_increment, mount.beams)
        readings = _readings(scan.ranges, mount.range_min, mount.range_max)
        self.base_in_map = base_in_map
        self.scan: Scan = scan
        self.discs = discs
        self.sweep: Sweep = Sweep(laser.x, laser.y, laser.theta, mount.angle_min, mount.angle_increment, readings, rays)


@njit(cache=True)
def _clear_along_beams(
    marks: Costs,
    frame: CostFrame,
    sweep: Sweep,
    farthest: float,
    raytrace_range: float,
    kept: NDArray[np.int64],
    changed: NDArray[np.int64],
) -> None:
    """Clear the cells from the laser to the end of each beam, up to raytrace_range.

    Args:
        marks: (rows, cols).
        frame: frame of the marks in the map.
        sweep: the scan.
        farthest: length of beams that hit nothing, meters. If 0, these beams are ignored.
        raytrace_range: maximum distance that is cleared, meters.
        kept: (4,) window that contains all marks other than FREE. Most beams end before it, and need no work.
        changed: (4,) window, which grows by the cells that change.
    """
    rows, cols = marks.shape
    size = frame.resolution
    row, col = math.floor((sweep.y - frame.y) / size), math.floor((sweep.x - frame.x) / size)
    if row < 0 or col < 0 or row >= rows or col >= cols:
        return
    longest = math.ceil(raytrace_range / size)
    right, top = frame.x + cols * size, frame.y + rows * size
    last_row, last_col = -1, -1
    for i in range(sweep.ranges.shape[0]):
        reading = sweep.ranges[i] if sweep.ranges[i] != np.inf else farthest
        if not reading > 0.0:
            continue
        a, b = reading * sweep.rays[i, 0], reading * sweep.rays[i, 1]
        x, y = sweep.x + a, sweep.y + b
        # Beams that leave the costmap end at its border.
        if x < frame.x:
            x, y = frame.x, sweep.y + b * (frame.x - sweep.x) / a
        if y < frame.y:
            x, y = sweep.x + a * (frame.y - sweep.y) / b, frame.y
        if x > right:
            # End 1 mm inside the border, as in ROS, because the border itself is outside the last cell.
            x, y = right - 0.001, sweep.y + b * (right - sweep.x) / a
        if y > top:
            x, y = sweep.x + a * (top - sweep.y) / b, top - 0.001
        row_end, col_end = math.floor((y - frame.y) / size), math.floor((x - frame.x) / size)
        if row_end < 0 or col_end < 0 or row_end >= rows or col_end >= cols:
            continue
        if max(row, row_end) < kept[0] or min(row, row_end) >= kept[2]:
            continue
        if max(col, col_end) < kept[1] or min(col, col_end) >= kept[3]:
            continue
        # Near the laser, several beams end in the same cell. Clear the line to this cell only once.
        if row_end != last_row or col_end != last_col:
            clear_line(marks, row, col, row_end, col_end, longest, changed)
            last_row, last_col = row_end, col_end


@njit(cache=True)
def _clear_between_beams(
    marks: Costs, frame: CostFrame, sweep: Sweep, farthest: float, raytrace_range: float, changed: NDArray[np.int64]
) -> None:
    """Clear lethal cells between two neighboring beams that both end farther away.

    Far away, neighboring beams are more than a cell apart. No beam passes through a cell between them, so ray tracing
    would leave the cell's mark forever, for example where a person walked by.
    """
    rows, cols = marks.shape
    size = frame.resolution
    beams = sweep.ranges.shape[0]
    reach = math.ceil(raytrace_range / size)
    row, col = math.floor((sweep.y - frame.y) / size), math.floor((sweep.x - frame.x) / size)
    for r in range(max(0, row - reach), min(rows, row + reach + 1)):
        for c in range(max(0, col - reach), min(cols, col + reach + 1)):
            if marks[r, c] != LETHAL:
                continue
            dx, dy = frame.x + (c + 0.5) * size - sweep.x, frame.y + (r + 0.5) * size - sweep.y
            distance = elementary.hypot(dx, dy)
            if distance > raytrace_range:
                continue
            # Bearing of the cell as a fractional beam index. The cell is between the beams with the two nearest
            # indices.
            ahead = (elementary.atan2(dy, dx) - sweep.theta - sweep.angle_min) / sweep.angle_increment
            whole_turn = math.tau / abs(sweep.angle_increment)
            ahead -= math.floor(ahead / whole_turn) * whole_turn
            before = int(ahead)
            behind = before + 1
            if behind == beams and beams >= whole_turn - 0.5:
                # The laser sees all around, so its first beam follows its last beam.
                behind = 0
            if behind >= beams:
                continue
            one = sweep.ranges[before] if sweep.ranges[before] != np.inf else farthest
            other = sweep.ranges[behind] if sweep.ranges[behind] != np.inf else farthest
            if one > distance + size and other > distance + size:
                marks[r, c] = FREE
                include(changed, r, c)


@njit(cache=True)
def _mark(
    marks: Costs,
    frame: CostFrame,
    sweep: Sweep,
    obstacle_range: float,
    known: KnownObstacles,
    changed: NDArray[np.int64],
) -> bool:
    """Make cells lethal where beams end within obstacle_range, unless a known wall or robot explains the reading.

    Returns:
        True if one of these cells was not lethal before.
    """
    rows, cols = marks.shape
    marked = False
    for i in range(sweep.ranges.shape[0]):
        reading = sweep.ranges[i]
        if not reading < obstacle_range:
            continue
        x, y = sweep.x + reading * sweep.rays[i, 0], sweep.y + reading * sweep.rays[i, 1]
        row, col = math.floor((y - frame.y) / frame.resolution), math.floor((x - frame.x) / frame.resolution)
        if row < 0 or col < 0 or row >= rows or col >= cols or marks[row, col] == LETHAL:
            continue
        if known.distance > 0.0:
            # Check the map's walls first, then the other robots. The distance allows for errors in the poses of all
            # robots.
            r, c = row + known.row, col + known.col
            in_map = r >= 0 and c >= 0 and r < known.near_walls.shape[0] and c < known.near_walls.shape[1]
            explained = in_map and known.near_walls[r, c]
            k = 0
            while not explained and k < known.discs.shape[0]:
                reach = known.discs[k, 2] + known.distance
                dx, dy = x - known.discs[k, 0], y - known.discs[k, 1]
                explained = abs(dx) <= reach and abs(dy) <= reach and elementary.hypot(dx, dy) <= reach
                k += 1
            if explained:
                continue
        marks[row, col] = LETHAL
        marked = True
        include(changed, row, col)
    return marked


@njit(cache=True)
def _clear_footprint(
    marks: Costs, frame: CostFrame, footprint: FloatArray, x: float, y: float, theta: float, changed: NDArray[np.int64]
) -> None:  # fmt: skip
    """Clear the cells under a robot with (n, 2) corners in the base frame, at the pose (x, y, theta) in the map."""
    corners = in_cells(footprint, frame, x, y, theta)
    left, right = math.floor(corners[:, 0].min()), math.floor(corners[:, 0].max())
    low, high = math.floor(corners[:, 1].min()), math.floor(corners[:, 1].max())
    # As in ROS, a footprint that is not completely on the costmap clears nothing.
    if low < 0 or left < 0 or high >= marks.shape[0] or right >= marks.shape[1]:
        return
    if fill_convex(marks, corners, FREE):
        include(changed, low, left)
        include(changed, high, right)


@njit(cache=True)
def _combine(
    costs: Costs, row: int, col: int, marks: Costs, first: int, left: int, rows: int, cols: int, overwrite: bool
) -> None:  # fmt: skip
    """Write `rows` by `cols` marks from (first, left) over costs from (row, col), or only raise the costs."""
    for r in range(rows):
        source, target = marks[first + r, left : left + cols], costs[row + r, col : col + cols]
        for c in range(cols):
            raises = target[c] == UNKNOWN or target[c] < source[c]
            if source[c] != UNKNOWN and (overwrite or raises):
                target[c] = source[c]


@njit(cache=True)
def _tiles_other_than(marks: Costs, mark: int) -> NDArray[np.int64]:
    """Return (n, 2) rows and columns of the tiles that contain a mark other than `mark`, row by row."""
    rows, cols = (marks.shape[0] + TILE - 1) // TILE, (marks.shape[1] + TILE - 1) // TILE
    tiles = np.empty((rows * cols, 2), np.int64)
    count = 0
    for i in range(rows):
        for j in range(cols):
            tile = marks[i * TILE : (i + 1) * TILE, j * TILE : (j + 1) * TILE]
            other = False
            for r in range(tile.shape[0]):
                # The loop over a row has no branch, so that the compiler can compare many cells at once.
                differing = 0
                for c in range(tile.shape[1]):
                    differing |= tile[r, c] ^ mark
                if differing != 0:
                    other = True
                    break
            if other:
                tiles[count, 0], tiles[count, 1] = i, j
                count += 1
    return tiles[:count]


@njit(cache=True)
def _any_lethal(marks: Costs, row: int, col: int, standing: NDArray[np.int64]) -> bool:
    """Return True if a mark in a window is lethal. Otherwise make the window empty.

    Args:
        marks: (rows, cols).
        row: row of the marks' cell (0, 0) in the static map; `col` is its column.
        standing: (4,) window of the static map.
    """
    for r in range(max(0, standing[0] - row), min(marks.shape[0], standing[2] - row)):
        for c in range(max(0, standing[1] - col), min(marks.shape[1], standing[3] - col)):
            if marks[r, c] == LETHAL:
                return True
    standing[:] = 0
    return False


@njit(cache=True)
def _observe(
    marks: Costs, grid_x: float, grid_y: float, size: float, row: int, col: int,
    laser_x: float, laser_y: float, laser_theta: float, angle_min: float, angle_increment: float,
    readings: FloatArray, rays: FloatArray, range_max: float,
    sources: FloatArray, clears: bool, clears_between: bool, tracks_unknown: bool,
    explained_distance: float, near_walls: NDArray[np.bool_], discs: FloatArray,
    footprint: FloatArray, x: float, y: float, theta: float,
    standing: NDArray[np.int64], changed: NDArray[np.int64],
) -> None:  # fmt: skip
    """Process a scan. All arguments are numbers or arrays, because passing tuples takes longer than the rest.

    Args:
        marks: (rows, cols).
        grid_x: x of the static map's cell (0, 0), meters, with `grid_y`; `size` is the side of a cell.
        row: row of the marks' cell (0, 0) in the static map; `col` is its column.
        laser_x: see `Sweep`, also for the next six arguments.
        range_max: length of beams that hit nothing, if these are valid, meters.
        sources: (s, 5) for each source: 1 if it clears, 1 if beams that hit nothing are valid, its raytrace_range, 1 if
            it marks, its obstacle_range.
        clears: True if the space in front of the readings is cleared.
        clears_between: True if the space between beams is also cleared.
        tracks_unknown: True if cells that no beam has reached are UNKNOWN.
        explained_distance: see `KnownObstacles`, also for the next two arguments.
        footprint: (n, 2) padded corners of the robot, base frame. (0, 2) if the cells under the robot are not cleared.
        x: pose of the robot in the map, with `y` and `theta`.
        standing: (4,) window of the static map, which grows to contain all lethal marks.
        changed: (4,) window of the marks, which grows by the cells that change.
    """
    frame = CostFrame(grid_x + col * size, grid_y + row * size, size)
    sweep = Sweep(laser_x, laser_y, laser_theta, angle_min, angle_increment, readings, rays)
    known = KnownObstacles(explained_distance, near_walls, row, col, discs)
    kept = np.array([0, 0, marks.shape[0], marks.shape[1]])
    if not tracks_unknown:
        for side in range(4):
            kept[side] = standing[side] - (row if side % 2 == 0 else col)
    for i in range(sources.shape[0]):
        if sources[i, 0] != 0.0 and clears:
            farthest = range_max if sources[i, 1] != 0.0 else 0.0
            if kept[0] < kept[2]:
                _clear_along_beams(marks, frame, sweep, farthest, sources[i, 2], kept, changed)
            if clears_between and _any_lethal(marks, row, col, standing):
                _clear_between_beams(marks, frame, sweep, farthest, sources[i, 2], changed)
    for i in range(sources.shape[0]):
        # All sources have cleared before the first source marks (see the module's docstring).
        if sources[i, 3] != 0.0 and _mark(marks, frame, sweep, sources[i, 4], known, changed):
            new = standing[2] <= standing[0] or standing[3] <= standing[1]
            for side in range(2):
                offset = row if side == 0 else col
                first, end = changed[side] + offset, changed[side + 2] + offset
                standing[side] = first if new else min(standing[side], first)
                standing[side + 2] = end if new else max(standing[side + 2], end)
    if footprint.shape[0] > 0:
        _clear_footprint(marks, frame, footprint, x, y, theta, changed)


def _window(changed: NDArray[np.int64], row: int, col: int) -> Window:
    """Return the changed window in cells of the static map. There, (row, col) is the marks' cell (0, 0)."""
    first, left, end, right = changed.tolist()
    return Window(first + row, left + col, end + row, right + col)


class ObstacleLayer:
    """Layer with marks of the obstacles and the free space that the laser has seen.

    Args:
        parameters: parameters of costmap_2d.
        grid: the map. The marks have the same cells.
        footprint: (n, 2) padded corners of the robot, base frame. The cells under it are free.
        track_unknown_space: value of the costmap, used if the layer's own is None.
        shape: rows and columns of a rolling costmap. If None, the layer covers the map.
        explained_by_walls: True if the costmap shows the map's walls, so that readings near them need no mark.

    Attributes:
        marks: (rows, cols) LETHAL for obstacles, FREE for seen free space, otherwise UNKNOWN.
        explained_range: distance from the laser, meters. Beyond it, no discs are needed to explain readings.
    """

    reach = 0

    def __init__(
        self,
        parameters: ObstacleParameters,
        grid: OccupancyGrid,
        footprint: FloatArray,
        track_unknown_space: bool = False,
        shape: tuple[int, int] | None = None,
        explained_by_walls: bool = True,
    ) -> None:
        self._parameters = parameters
        self._grid = grid
        self._cleared_footprint = footprint if parameters.footprint_clearing_enabled else footprint[:0]
        distance = parameters.explained_distance
        if distance > 0.0 and explained_by_walls:
            self._near_walls = near_walls(grid, distance)
        else:
            self._near_walls = NOWHERE
        own = parameters.track_unknown_space
        self._default = UNKNOWN if (track_unknown_space if own is None else own) else FREE
        # `np.zeros` is used where possible, because its arrays use no memory until they are overwritten.
        blank = np.zeros if self._default == FREE else np.ones
        self.marks: Costs = blank(shape or grid.cells.shape, dtype=np.uint8)
        if self._default != FREE:
            self.marks[:] = self._default
        self._origin = (0, 0)
        self._changes = Changes()
        self._standing = np.zeros(4, np.int64)
        self._sources = np.array(
            [
                (
                    source.clearing,
                    source.inf_is_valid,
                    self._raytrace_range(source),
                    source.marking,
                    self._obstacle_range(source),
                )
                for source in parameters.observation_sources
            ],
            dtype=np.float64,
        ).reshape(-1, 5)
        marking = (self._obstacle_range(source) for source in parameters.observation_sources if source.marking)
        self.explained_range = max(marking, default=0.0) + distance

    @property
    def any_marks(self) -> bool:
        """True if a mark is lethal."""
        # `_standing` grows by marking, but clearing does not shrink it. So check whether its last mark has been
        # cleared.
        return bool(_any_lethal(self.marks, *self._origin, self._standing))

    @property
    def window(self) -> Window:
        """Cells of the static map that the marks cover."""
        row, col = self._origin
        return Window(row, col, row + self.marks.shape[0], col + self.marks.shape[1])

    def roll(self, origin: tuple[int, int]) -> None:
        """Move the marks with a rolling costmap, which now starts at this cell of the static map.

        Marks outside are lost.
        """
        if origin == self._origin:
            return
        moved: Costs = np.full_like(self.marks, self._default)
        row, col = origin
        kept = self.window.clipped(Window(row, col, row + moved.shape[0], col + moved.shape[1]))
        if not kept.empty:
            kept.of(moved, origin)[:] = kept.of(self.marks, self._origin)
        self.marks, self._origin = moved, origin

    def observe(self, seen: CostmapObservation, clears: bool = True) -> None:
        """Process a scan: every source clears, then every source marks, then the cells under the robot are cleared.

        Args:
            seen: the scan.
            clears: True if the space in front of the readings is cleared, which is the slowest part.
        """
        (row, col), corner, base, sweep = self._origin, self._grid.origin, seen.base_in_map, seen.sweep
        changed = np.array([*self.marks.shape, -1, -1], dtype=np.int64)
        _observe(
            self.marks,
            corner.x,
            corner.y,
            self._grid.resolution,
            row,
            col,
            *sweep,
            seen.scan.mount.range_max,
            self._sources,
            clears,
            self._parameters.clear_between_beams,
            self._default != FREE,
            self._parameters.explained_distance,
            self._near_walls,
            seen.discs,
            self._cleared_footprint,
            base.x,
            base.y,
            base.theta,
            self._standing,
            changed,
        )
        if changed[2] > changed[0]:
            self._changes.add(_window(changed, row, col))

    def _obstacle_range(self, source: ObservationSource) -> float:
        return self._parameters.obstacle_range if source.obstacle_range is None else source.obstacle_range

    def _raytrace_range(self, source: ObservationSource) -> float:
        return self._parameters.raytrace_range if source.raytrace_range is None else source.raytrace_range

    def copied(self) -> "ObstacleLayer":
        """Return a copy with its own marks."""
        other = copy.copy(self)
        other.marks, other._changes, other._standing = self.marks.copy(), Changes(), self._standing.copy()
        return other

    def take_over(self, other: "ObstacleLayer") -> None:
        """Copy the marks of another layer to the cells that both cover."""
        common = self.window.clipped(other.window)
        if not common.empty:
            common.of(self.marks, self._origin)[:] = common.of(other.marks, other._origin)
            self._standing[:] = other._standing

    def clear(self) -> None:
        """Forget all marks (move_base's clear_costmap_recovery)."""
        for window in self.extents():
            window.of(self.marks, self._origin)[:] = self._default
            self._changes.add(window)

    def clear_inside(self, x: float, y: float, side: float) -> None:
        """Forget all marks inside a square of this side around a map point (Nav2: clear_around)."""
        inside = self._square(x, y, side)
        if not inside.empty:
            inside.of(self.marks, self._origin)[:] = self._default
            self._changes.add(inside)

    def clear_outside(self, x: float, y: float, side: float) -> None:
        """Forget all marks outside a square of this side around a map point (clear_costmap_recovery)."""
        inside = self._square(x, y, side)
        kept = None if inside.empty else inside.of(self.marks, self._origin).copy()
        self.clear()
        if kept is not None:
            inside.of(self.marks, self._origin)[:] = kept

    def _square(self, x: float, y: float, side: float) -> Window:
        """Return the cells of a square of this side around a map point, as far as the marks cover them."""
        low, high = (
            math.floor((y - self._grid.origin.y + half) / self._grid.resolution) for half in (-side / 2, side / 2)
        )
        left, right = (
            math.floor((x - self._grid.origin.x + half) / self._grid.resolution) for half in (-side / 2, side / 2)
        )
        return Window(low, left, high + 1, right + 1).clipped(self.window)

    def bounds(self) -> tuple[Window, ...]:
        """Return the windows that were marked or cleared since the last call."""
        return self._changes.take()

    def extents(self) -> tuple[Window, ...]:
        """Return windows that contain all marks."""
        row, col = self._origin
        tiles = TILE * _tiles_other_than(self.marks, self._default) + np.array([row, col])
        return tuple(Window(r, c, r + TILE, c + TILE).clipped(self.window) for r, c in tiles.tolist())

    def write(self, costs: Costs, origin: tuple[int, int], window: Window) -> None:
        """Combine the marks with the costs of previous layers, by `combination_method`."""
        inside = window.clipped(self.window)
        if inside.empty:
            return
        method = self._parameters.combination_method
        if method not in (OVERWRITE, MAXIMUM):
            return
        _combine(
            costs,
            inside.row - origin[0],
            inside.col - origin[1],
            self.marks,
            inside.row - self._origin[0],
            inside.col - self._origin[1],
            inside.row_end - inside.row,
            inside.col_end - inside.col,
            method == OVERWRITE,
        )
