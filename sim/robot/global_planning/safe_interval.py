"""Safe interval path planning (SIPP): find the quickest itinerary among robots with known itineraries.

Space is a coarse grid. Each cell has a list of safe intervals: spans of time in which no other robot comes near. A
state of the search is a cell and one of its safe intervals. Within an interval, a robot may wait as long as it needs.
So a robot that arrives earlier can do everything that it could do after a later arrival, and only the earliest arrival
in each state is needed. A search in space alone has one state per cell. This search has a few states per cell, one per
interval. A plain search in space and time would have a state for every second of waiting. A* expands states in the
order of arrival time plus the remaining time without other robots. The goal is reached if the robot arrives in an
interval that never ends, so that it may stay there.

Source: Phillips, Likhachev, SIPP: Safe Interval Path Planning for Dynamic Environments (ICRA 2011).
Difference from the source: intervals begin and end at multiples of BIN_LENGTH seconds. The time after the last bin is
safe if the last bin is safe.
"""

import heapq
import math
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sim.common.grid import OccupancyGrid
from sim.numerics import elementary, elementary_arrays
from sim.numerics.float_array import FloatArray
from sim.numerics.kernels import njit
from sim.robot.global_planning.itinerary import ITINERARY_SPEED, NEAR_START, Itinerary, OtherItineraries

CELL_SIDE = 0.2
"""Maximum side of a coarse cell, meters."""
BIN_LENGTH = 0.5
"""Duration of a time bin, seconds. Intervals begin and end between bins."""
BIN_COUNT = 240
"""Number of bins that the search covers: two minutes."""

UNHINDERED = 1.0
"""Maximum delay of an unhindered itinerary, compared with an itinerary without other robots, seconds."""

BoolArray = NDArray[np.bool_]
CellNumbers = NDArray[np.int32]


class BusyBins(NamedTuple):
    """Time bins in which other robots come near cells, for compiled kernels.

    Attributes:
        row: (rows, cols) row of `busy` for each cell of the coarse grid, or -1 if no robot ever comes near.
        busy: (n, bins) True if another robot comes near during a bin.
    """

    row: CellNumbers
    busy: BoolArray


@dataclass(frozen=True, slots=True, eq=False)
class Roadmap:
    """The coarse grid.

    Attributes:
        centres: (rows, cols, 2) map point of each cell: its middle or, if clearance is too small there, the point of
            the cell with most clearance.
        free: (rows, cols) True if a robot can stand and turn at this point without touching a wall.
        corner: (2,) map coordinates of the outer corner of cell (0, 0).
        side: side of a cell, meters.
    """

    centres: FloatArray
    free: BoolArray
    corner: FloatArray
    side: float


def make_roadmap(grid: OccupancyGrid, clearance: FloatArray | NDArray[np.float32], radius: float) -> Roadmap:
    """Make a coarse grid over a map.

    Args:
        grid: the map.
        clearance: (rows, cols) of the map: meters to the nearest obstacle or unknown cell.
        radius: circumscribed radius of the robot, meters.
    """
    stride = max(1, int(CELL_SIDE / grid.resolution + 1e-9))
    rows, cols = grid.rows // stride, grid.cols // stride
    whole = clearance[: rows * stride, : cols * stride]
    blocks = whole.reshape(rows, stride, cols, stride).swapaxes(1, 2).reshape(rows, cols, stride * stride)
    middle = (stride // 2) * stride + stride // 2
    # Compare in double precision, because clearances may have single or double precision.
    needed = np.float64(radius)
    roomiest = np.where(blocks[:, :, middle] >= needed, middle, blocks.argmax(axis=2))
    row, col = np.divmod(roomiest, stride)
    x = (np.arange(cols) * stride + col + 0.5) * grid.resolution + grid.origin.x
    y = (np.arange(rows)[:, np.newaxis] * stride + row + 0.5) * grid.resolution + grid.origin.y
    corner = np.array([grid.origin.x, grid.origin.y])
    return Roadmap(np.stack([x, y], axis=2), blocks.max(axis=2) >= needed, corner, stride * grid.resolution)


@njit(cache=True)
def _shade(
    traffic: BusyBins, count: int, free: BoolArray, centres: FloatArray, corner: FloatArray, side: float, x: float,
    y: float, radius: float, start_x: float, start_y: float, present: float, first: int, last: int,
) -> tuple[BusyBins, int]:  # fmt: skip
    """Mark the free cells around a robot at (x, y) as busy from bin `first` to bin `last`.

    `count` rows of the traffic are in use. Return the new traffic and the new count.

    `present` is the distance of that robot from the planning robot's start (start_x, start_y), meters. At the start,
    the required distance is at most `present`. Otherwise a robot that stands too close to another robot could never
    leave.
    """
    row_of, busy = traffic
    rows, cols = row_of.shape
    bins = busy.shape[1]
    first, last = max(first, 0), min(last, bins - 1)
    if last < first:
        return traffic, count
    col, row = (x - corner[0]) / side, (y - corner[1]) / side
    span = radius / side + 1.0
    near, far = radius * radius * (1.0 - 1e-12), radius * radius * (1.0 + 1e-12)
    for r in range(max(0, int(row - span)), min(rows, int(row + span) + 1)):
        for c in range(max(0, int(col - span)), min(cols, int(col + span) + 1)):
            cx, cy = centres[r, c, 0], centres[r, c, 1]
            dx, dy = cx - x, cy - y
            # For most cells, squared distances are enough, in a tenth of the time. Compute the distance only where
            # rounding could matter.
            squared = dx * dx + dy * dy
            if not free[r, c] or squared > far:
                continue
            distance = 0.0 if squared < near else elementary.hypot(dx, dy)
            if distance >= radius:
                continue
            needed = radius
            if abs(cx - start_x) < side and abs(cy - start_y) < side:
                off = elementary.hypot(cx - start_x, cy - start_y)
                if off < side:
                    # The start is rounded to a cell. This cell may be nearer to the other robot than the start itself,
                    # by up to half a cell's diagonal. The cells next to it may be nearer only by rounding errors.
                    needed = min(radius, present - (0.75 * side if off < 0.71 * side else 0.02))
                    distance = elementary.hypot(dx, dy)
            if distance < needed:
                if row_of[r, c] < 0:
                    if count == busy.shape[0]:
                        more = np.zeros((2 * count, bins), np.bool_)
                        more[:count] = busy
                        busy = more
                    row_of[r, c] = count
                    count += 1
                busy[row_of[r, c], first : last + 1] = True
    return BusyBins(row_of, busy), count


@njit(cache=True)
def _traffic(
    free: BoolArray, centres: FloatArray, corner: FloatArray, side: float, others: OtherItineraries, start: FloatArray,
    time: float, separation: float, bins: int, bin_length: float,
) -> BusyBins:  # fmt: skip
    """Find the time bins in which another robot comes near free cells."""
    traffic, count = BusyBins(np.full(free.shape, -1, np.int32), np.zeros((256, bins), np.bool_)), 0
    for k in range(others.starts.shape[0] - 1):
        begin, end = others.starts[k], others.starts[k + 1]
        # Before an itinerary begins, its robot stands at the first point.
        now_x, now_y = others.points[begin, 0], others.points[begin, 1]
        present = elementary.hypot(now_x - start[0], now_y - start[1])
        first = math.floor((others.times[begin] - time) / bin_length) if others.times[begin] > -math.inf else 0
        traffic, count = _shade(
            traffic, count, free, centres, corner, side, now_x, now_y, separation, start[0], start[1], present, 0, first
        )
        for i in range(begin, end):
            x, y = others.points[i, 0], others.points[i, 1]
            first = 0 if others.times[i] == -math.inf else math.floor((others.times[i] - time) / bin_length)
            last = bins - 1 if i == end - 1 else math.floor((others.times[i + 1] - time) / bin_length)
            traffic, count = _shade(
                traffic, count, free, centres, corner, side, x, y, separation, start[0], start[1], present, first, last
            )
            # The step from one point to the next takes less than a bin. If it crosses the border of two bins, the robot
            # may be near this point in both. A longer span can only be a wait at exactly this point.
            if i > begin:
                first = math.floor((others.times[i - 1] - time) / bin_length)
                last = math.floor((others.times[i] - time) / bin_length)
                if last - first == 1:
                    traffic, count = _shade(
                        traffic, count, free, centres, corner, side, x, y, separation, start[0], start[1], present,
                        first, last,
                    )  # fmt: skip
    return BusyBins(traffic.row, traffic.busy[:count])


@njit(cache=True)
def _distances(free: BoolArray, targets: BoolArray, side: float) -> FloatArray:
    """Return (rows, cols) distances to the nearest target through free cells, meters, or inf if none can be reached.

    The grid is swept forward and backward in turn until nothing changes (a distance transform over eight neighbors). A
    cell is visited again only if one of its neighbors has changed, because otherwise its distance cannot decrease.
    """
    rows, cols = free.shape
    field = np.full((rows, cols), np.inf)
    due = np.zeros((rows, cols), np.bool_)
    # Number of cells to visit in each row.
    in_row = np.zeros(rows, np.int64)
    left = 0
    for r in range(rows):
        for c in range(cols):
            if targets[r, c] and free[r, c]:
                field[r, c] = 0.0
                left += _make_due(due, in_row, free, r, c)
    diagonal = math.sqrt(2.0) * side
    forward = True
    while left > 0:
        for i in range(rows):
            r = i if forward else rows - 1 - i
            if in_row[r] == 0:
                continue
            for j in range(cols):
                c = j if forward else cols - 1 - j
                if not due[r, c]:
                    continue
                due[r, c] = False
                in_row[r] -= 1
                left -= 1
                best = field[r, c]
                for dr in (-1, 0, 1):
                    for dc in (-1, 0, 1):
                        nr, nc = r + dr, c + dc
                        if (dr == 0 and dc == 0) or not (0 <= nr < rows and 0 <= nc < cols) or not free[nr, nc]:
                            continue
                        step = side if dr == 0 or dc == 0 else diagonal
                        best = min(best, field[nr, nc] + step)
                if best < field[r, c] - 1e-9:
                    field[r, c] = best
                    left += _make_due(due, in_row, free, r, c)
        forward = not forward
    return field


@njit(cache=True)
def _make_due(due: BoolArray, in_row: NDArray[np.int64], free: BoolArray, row: int, col: int) -> int:
    """Mark the free cells around a cell for another visit. Return the number of cells that were not marked before."""
    count = 0
    for r in range(max(0, row - 1), min(due.shape[0], row + 2)):
        for c in range(max(0, col - 1), min(due.shape[1], col + 2)):
            if free[r, c] and not due[r, c] and (r != row or c != col):
                due[r, c] = True
                in_row[r] += 1
                count += 1
    return count


@njit(cache=True)
def _reachable(
    free: BoolArray, first: NDArray[np.int64], closes: FloatArray, targets: BoolArray, start_row: int, start_col: int
) -> bool:
    """Return False if a robot cannot get from the start to a target where it may stay, no matter how it waits.

    This is so if no target becomes free permanently, or if robots that stand still block every path. In these cases, a
    search would visit all states without a result. The states are as in `_search`.
    """
    rows, cols = free.shape
    met = np.zeros((rows, cols), np.bool_)
    queue = np.empty(rows * cols, np.int64)
    queue[0] = start_row * cols + start_col
    met[start_row, start_col] = True
    length = 1
    i = 0
    while i < length:
        cell = queue[i]
        i += 1
        r, c = cell // cols, cell % cols
        if targets[r, c] and closes[first[cell + 1] - 1] == np.inf:
            return True
        for nr in range(max(0, r - 1), min(rows, r + 2)):
            for nc in range(max(0, c - 1), min(cols, c + 2)):
                number = nr * cols + nc
                if not met[nr, nc] and first[number + 1] > first[number]:
                    met[nr, nc] = True
                    queue[length] = number
                    length += 1
    return False


@njit(cache=True)
def _search(
    free: BoolArray, traffic: BusyBins, targets: BoolArray, centres: FloatArray, side: float, start_row: int,
    start_col: int, bin_length: float, speed: float,
) -> FloatArray:  # fmt: skip
    """Return the quickest path to a target where the robot may stay.

    The path is (m, 4): x, y, seconds from now, and remaining seconds from there without other robots. It is (0, 4) if
    there is no path.
    """
    rows, cols = free.shape
    row_of, busy = traffic
    bins = busy.shape[1]
    # The heuristic ignores other robots, and walls next to diagonal steps. So it hardly ever overestimates.
    to_go = _distances(free, targets, side)
    if to_go[start_row, start_col] == np.inf:
        return np.empty((0, 4))
    # Number the safe intervals of all cells. The states from first[cell] to first[cell + 1] - 1 are the intervals of a
    # cell, in the order of time. Interval k lasts from opens[k] to closes[k]. An interval that lasts to the end of
    # the last bin never closes.
    first = np.zeros(rows * cols + 1, np.int64)
    for cell in range(rows * cols):
        r, c = cell // cols, cell % cols
        count = 0
        if free[r, c] and row_of[r, c] < 0:
            count = 1
        elif free[r, c]:
            before = True
            for now in busy[row_of[r, c]]:
                if before and not now:
                    count += 1
                before = now
        first[cell + 1] = first[cell] + count
    total = first[rows * cols]
    # Intervals are counted before they are filled in, so that two flat arrays can contain all of them.
    opens, closes = np.empty(total), np.empty(total)
    for cell in range(rows * cols):
        if first[cell + 1] == first[cell]:
            continue
        r, c = cell // cols, cell % cols
        if row_of[r, c] < 0:
            opens[first[cell]], closes[first[cell]] = 0.0, np.inf
            continue
        k = first[cell] - 1
        before = True
        for b in range(bins):
            now = busy[row_of[r, c], b]
            if before and not now:
                k += 1
                opens[k], closes[k] = b * bin_length, np.inf
            elif now and not before:
                closes[k] = b * bin_length
            before = now
    start_cell = start_row * cols + start_col
    if first[start_cell + 1] == first[start_cell] or opens[first[start_cell]] > 0.0:
        return np.empty((0, 4))
    # First do a cheap flood fill, because a search without a solution would visit every state.
    if not _reachable(free, first, closes, targets, start_row, start_col):
        return np.empty((0, 4))
    # Invariant: arrival[k] is the earliest known arrival in state k, and parent[k] is the state before it. Both are
    # final once done[k] is True.
    arrival = np.full(total, np.inf)
    parent = np.full(total, -1, np.int64)
    cell_of = np.empty(total, np.int64)
    done = np.zeros(total, np.bool_)
    root = first[start_cell]
    arrival[root] = 0.0
    cell_of[root] = start_cell
    queue = [(to_go[start_row, start_col] / speed, root)]
    found = -1
    while len(queue) > 0:
        _, state = heapq.heappop(queue)
        if done[state]:
            continue
        done[state] = True
        cell = cell_of[state]
        r, c = cell // cols, cell % cols
        if targets[r, c] and closes[state] == np.inf:
            found = state
            break
        time = arrival[state]
        for dr in (-1, 0, 1):
            for dc in (-1, 0, 1):
                nr, nc = r + dr, c + dc
                if (dr == 0 and dc == 0) or not (0 <= nr < rows and 0 <= nc < cols) or not free[nr, nc]:
                    continue
                # A diagonal step passes between two cells at its sides. Both must be free, because otherwise the step
                # would cut a corner.
                if dr != 0 and dc != 0 and not (free[r, nc] and free[nr, c]):
                    continue
                length = elementary.hypot(centres[nr, nc, 0] - centres[r, c, 0], centres[nr, nc, 1] - centres[r, c, 1])
                takes = length / speed
                target = nr * cols + nc
                for k in range(first[target], first[target + 1]):
                    # Both cells must be safe while the robot is between them. So it leaves at the later of two times:
                    # its arrival here, and the time when the next cell becomes safe.
                    arrives = max(time, opens[k]) + takes
                    if arrives > closes[state]:
                        # This cell does not remain safe until then, and the later intervals of the next cell open even
                        # later.
                        break
                    if arrives > closes[k] or arrives >= arrival[k] - 1e-9:
                        # The arrival is too late for this interval, or no earlier than a known arrival in it.
                        continue
                    arrival[k] = arrives
                    parent[k] = state
                    cell_of[k] = target
                    heapq.heappush(queue, (arrives + to_go[nr, nc] / speed, k))
    if found < 0:
        return np.empty((0, 4))
    trajectory = np.empty((2 * total, 4))
    n = 0
    state = found
    while state >= 0:
        r, c = cell_of[state] // cols, cell_of[state] % cols
        if n > 0:
            x, y = trajectory[n - 1, 0], trajectory[n - 1, 1]
            # If the robot does not leave at once, it waits here. A wait is the same point a second time.
            leaves = trajectory[n - 1, 2] - elementary.hypot(x - centres[r, c, 0], y - centres[r, c, 1]) / speed
            if leaves > arrival[state] + 1e-6:
                trajectory[n] = centres[r, c, 0], centres[r, c, 1], leaves, to_go[r, c] / speed
                n += 1
        trajectory[n] = centres[r, c, 0], centres[r, c, 1], arrival[state], to_go[r, c] / speed
        n += 1
        state = parent[state]
    return trajectory[:n][::-1].copy()


@njit(cache=True)
def _off_path(
    free: BoolArray, centres: FloatArray, corner: FloatArray, side: float, path: FloatArray, distance: float
) -> BoolArray:  # fmt: skip
    """Return a (rows, cols) mask of the free cells that are at least `distance` meters away from all (m, 2) points."""
    off = free.copy()
    rows, cols = free.shape
    span = distance / side + 1.0
    for i in range(path.shape[0]):
        x, y = path[i, 0], path[i, 1]
        col, row = (x - corner[0]) / side, (y - corner[1]) / side
        for r in range(max(0, int(row - span)), min(rows, int(row + span) + 1)):
            for c in range(max(0, int(col - span)), min(cols, int(col + span) + 1)):
                if elementary.hypot(centres[r, c, 0] - x, centres[r, c, 1] - y) < distance:
                    off[r, c] = False
    return off


def _nearest(roadmap: Roadmap, free: BoolArray, x: float, y: float, reach: float) -> tuple[int, int] | None:
    """Return the free cell with the center nearest to a map point, within `reach` meters."""
    place = np.array([x, y]) - roadmap.corner
    if (place < -reach).any() or (place > roadmap.side * np.array(free.shape[::-1]) + reach).any():
        # The cell number of a place so far away may not fit into an integer.
        return None
    col, row = (place / roadmap.side).astype(np.int64)
    span = math.ceil(reach / roadmap.side)
    rows, cols = slice(max(0, row - span), row + span + 1), slice(max(0, col - span), col + span + 1)
    distances = np.where(
        free[rows, cols],
        elementary_arrays.hypot(roadmap.centres[rows, cols, 0] - x, roadmap.centres[rows, cols, 1] - y),
        np.inf,
    )
    if distances.size == 0 or distances.min() > reach:
        return None
    best_row, best_col = np.unravel_index(int(distances.argmin()), distances.shape)
    return int(best_row) + rows.start, int(best_col) + cols.start


def route(
    roadmap: Roadmap,
    free: BoolArray,
    start: FloatArray,
    goal: FloatArray,
    time: float,
    others: OtherItineraries,
    separation: float,
) -> Itinerary | None:
    """Find the quickest itinerary to a goal, clear of all other robots. The robot may stay at its end forever.

    Args:
        roadmap: the coarse grid.
        free: (rows, cols) True for the cells that may be used.
        start: (2,) map point.
        goal: (2,) map point.
        time: start time of the itinerary.
        others: itineraries of the other robots.
        separation: minimum distance from center to center, meters.

    Returns:
        The itinerary, or None if there is none within the time that the search covers.
    """
    cell = _nearest(roadmap, free, goal[0], goal[1], 2 * roadmap.side)
    if cell is None:
        return None
    targets = np.zeros(free.shape, dtype=np.bool_)
    targets[cell] = True
    itinerary = _itinerary_to(roadmap, free, start, targets, time, others, separation)
    if itinerary is None:
        return None
    points = np.vstack([itinerary.points, goal])
    last = float(elementary_arrays.hypot(*(goal - itinerary.points[-1]))) / ITINERARY_SPEED
    return replace(itinerary, points=points, times=np.append(itinerary.times, itinerary.times[-1] + last))


def refuge(
    roadmap: Roadmap,
    free: BoolArray,
    start: FloatArray,
    avoided: FloatArray,
    time: float,
    others: OtherItineraries,
    separation: float,
) -> Itinerary | None:
    """Find the quickest itinerary to a place outside the path that another robot wants to drive.

    Args:
        roadmap: see `route`.
        free: (rows, cols) True for cells that may be used.
        start: (2,) map point.
        avoided: (m, 2) map points of the other robot's path.
        time: start time of the itinerary.
        others: itineraries of the other robots.
        separation: minimum distance from center to center, and from the place to this path, meters.
    """
    # The place is one cell farther away than necessary, because the other robot also plans with rounded positions.
    targets = _off_path(free, roadmap.centres, roadmap.corner, roadmap.side, avoided, separation + roadmap.side)
    return _itinerary_to(roadmap, free, start, targets, time, others, separation)


def _itinerary_to(
    roadmap: Roadmap,
    free: BoolArray,
    start: FloatArray,
    targets: BoolArray,
    time: float,
    others: OtherItineraries,
    separation: float,
) -> Itinerary | None:
    cell = _nearest(roadmap, free, start[0], start[1], NEAR_START)
    if cell is None:
        return None
    traffic = _traffic(
        free, roadmap.centres, roadmap.corner, roadmap.side, others, start, time, separation, BIN_COUNT, BIN_LENGTH
    )
    found = _search(free, traffic, targets, roadmap.centres, roadmap.side, *cell, BIN_LENGTH, ITINERARY_SPEED)
    if len(found) < 2:
        return None
    # The first cell's center is only the rounded start. A robot that has to wait there should not move to this center.
    points = found[:, :2].copy()
    points[(points == points[0]).all(axis=1)] = start
    times, would_be_left = time + found[:, 2], found[:, 3]
    unhindered = times[-1] - times <= would_be_left + UNHINDERED
    return Itinerary(points, times, float(times[np.argmax(unhindered)]) if not unhindered[0] else -math.inf)
