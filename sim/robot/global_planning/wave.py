"""Potentials that spread over a costmap like a wave, and paths down their slope. navfn and global_planner share them.

The potential of a cell is the cost of the cheapest path to it from the start of the wave. The only minimum is at the
start, so going downhill finds a path from any cell (a navigation function). The wave is Dijkstra's algorithm with two
changes. First, the potential of a cell is computed as for a plane wave between its two lowest neighbors, and not as
the potential of one neighbor plus a step. So paths are not restricted to rows, columns and diagonals (Konolige's
gradient method). Second, three unsorted queues replace a sorted queue. They contain the cells of this round, the cells
of the next round, and cells that are postponed because they cost more than a threshold. The threshold rises when the
first two queues are empty. So a cell may be visited before its potential is final. It is queued again when a neighbor
can lower its potential.

Cells are numbered row by row. Positions are (x, y) in cells, with whole numbers at cell centers. Costs of crossing are
whole numbers from 1 to 255, or BLOCKED. All cells at the border of the map are blocked.

A wave over a large map takes longer than the time of one tick. So it can spread one portion at a time. The result does
not depend on the portions, because they end between two rounds.

Source: ros-planning/navigation, navfn/src/navfn.cpp; global_planner/src/dijkstra.cpp and gradient_path.cpp; Konolige,
A Gradient Method for Realtime Robot Control (IROS 2000).
Differences from ROS: the numbers of waiting cells, cycles and path points are not limited. ROS has limits, at which it
gives up or drops cells. A path never passes between two blocked cells that meet at a corner. If the slope does not lead
down, the path goes from cell to cell until the potential is lower than at all earlier cells. So a path is found if a
path exists.
"""

from collections import deque
from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from sim.numerics import elementary
from sim.numerics.kernels import njit
from sim.robot.costmap.costs import Costs

Potential = NDArray[np.float32]
"""(rows * cols,) cost of the cheapest path from the robot, or UNREACHED if the wave did not reach the cell."""
CellCosts = NDArray[np.uint8]
Cells = NDArray[np.uint32]
Points = NDArray[np.float32]

BLOCKED = 0
UNREACHED = np.float32(1.0e10)
MAX_STEPS_WITHOUT_DESCENT = 8
"""Number of steps that a path may follow the slope without getting lower than before."""


class Workspace:
    """Arrays for one map size, reused for every plan.

    Attributes:
        shape: rows and columns.
        costs: (rows * cols,) cost of crossing a cell.
        potential: (rows * cols,).
        waiting: (rows * cols,) True while a cell waits in a queue.
        queues: (3, rows * cols) waiting cells.
        users: searches that use the workspace. The first uses it now, and the others wait.
    """

    def __init__(self, rows: int, cols: int) -> None:
        self.shape = (rows, cols)
        self.costs = np.empty(rows * cols, np.uint8)
        self.potential = np.empty(rows * cols, np.float32)
        self.waiting = np.empty(rows * cols, np.bool_)
        self.queues = np.empty((3, rows * cols), np.uint32)
        self.users: deque[object] = deque()


@njit(cache=True)
def prepare(
    costs: Costs, table: CellCosts, passage: CellCosts, potential: Potential, waiting: NDArray[np.bool_]
) -> None:
    """Translate costs, block the border, and reset the potential.

    Every cell that the wave enters has four neighbors, because the border is blocked. So no step needs to check the
    limits of the map.

    Args:
        costs: (rows, cols).
        table: (256,) cost of crossing a cell for each cost.
        passage: (rows * cols,) output.
        potential: (rows * cols,) output.
        waiting: (rows * cols,) output.
    """
    rows, cols = costs.shape
    for r in range(rows):
        line = costs[r]
        begin = r * cols
        for c in range(cols):
            passage[begin + c] = table[line[c]]
        passage[begin] = passage[begin + cols - 1] = BLOCKED
    passage[:cols] = BLOCKED
    passage[-cols:] = BLOCKED
    potential[:] = UNREACHED
    waiting[:] = False


@njit(cache=True)
def wave_value(
    left: np.float32, right: np.float32, below: np.float32, above: np.float32, cost: np.float32, quadratic: bool
) -> np.float32:
    """Return the potential of a cell, from the potentials of its four neighbors and its own cost of crossing."""
    across = left if left < right else right
    along = below if below < above else above
    gap = across - along
    lowest = along
    if gap < 0:
        gap, lowest = -gap, across
    if gap >= cost or not quadratic:
        return np.float32(lowest + cost)
    # This is navfn's quadratic approximation of a plane wave between the two lower neighbors.
    d = gap / cost
    return np.float32(lowest + cost * np.float32(-0.2301 * d * d + 0.5307 * d + 0.7040))


@njit(cache=True)
def value_of(potential: Potential, cell: int, cols: int, cost: int, quadratic: bool) -> np.float32:
    """Do the same as `wave_value` for the cell with this number. The cell must not be at the border."""
    left, right, below, above = potential[cell - 1], potential[cell + 1], potential[cell - cols], potential[cell + cols]
    return np.float32(wave_value(left, right, below, above, np.float32(cost), quadratic))


@njit(cache=True)
def _lowered(value: np.float32, rank: np.float32, cost: int) -> bool:
    """Return True if a cell of this rank may lower the potential of a neighbor with this value and cost.

    The neighbor's new value would be at least the rank plus 0.7 of the neighbor's cost. The factor is that of a
    diagonal wave in `wave_value`.
    """
    return bool(cost != BLOCKED and value > rank + np.float32(0.707106781 * cost))


@njit(cache=True)
def _push(queues: Cells, queue: int, length: int, waiting: NDArray[np.bool_], cell: np.uint64) -> int:
    """Put a cell into one of the queues unless it is already waiting. Return the new length of the queue."""
    if waiting[cell]:
        return length
    waiting[cell] = True
    queues[queue, length] = cell
    return length + 1


@njit(cache=True)
def _begin(
    potential: Potential, costs: CellCosts, waiting: NDArray[np.bool_], queue: Cells, cols: int, seeds: Cells
) -> int:
    """Put the neighbors of the seeds into a queue. Return the queue's length."""
    length = 0
    for seed in seeds:
        for step in (1, -1, -cols, cols):
            first = np.int64(seed) + step
            inside = 0 <= first < costs.size
            if inside and costs[first] != BLOCKED and not waiting[first] and potential[first] == UNREACHED:
                queue[length] = first
                length += 1
                waiting[first] = True
    return length


@njit(cache=True)
def _spread_on(
    potential: Potential,
    costs: CellCosts,
    waiting: NDArray[np.bool_],
    queues: Cells,
    lengths: NDArray[np.int64],
    cols: int,
    target: int,
    attraction: float,
    limit: np.float32,
    increment: float,
    quadratic: bool,
    portion: int,
) -> tuple[np.float32, bool]:
    """Continue a wave, round by round, until `portion` cells have been visited.

    Args:
        potential: (rows * cols,) present potential.
        costs: (rows * cols,) cost of crossing a cell.
        waiting: (rows * cols,) True for the cells in the queues.
        queues: (3, rows * cols) cells of this round, cells of the next round, and postponed cells.
        lengths: (3,) lengths of the queues, changed in place. The second length is 0.
        cols: number of columns.
        target: cell at which to stop; -1 for the whole map.
        attraction: as in `spread`.
        limit: cells of at most this cost are visited first.
        increment: step by which the limit rises.
        quadratic: as in `spread`.
        portion: number of cells to visit.

    Returns:
        The new limit, and True if the wave continues.
    """
    # Invariant: `waiting` is True exactly for the cells in the queues, and each of them is in only one queue, once. So
    # no queue ever contains more cells than the map has.
    current, following, later = 0, 1, 2
    n_current, n_following, n_later = lengths[0], 0, lengths[2]
    target_row, target_col = target // cols, target % cols
    # Unsigned, so that numba omits the code for negative indices, which count from the end.
    one, width = np.uint64(1), np.uint64(cols)
    visited = 0
    goes_on = n_current > 0
    while goes_on and visited < portion:
        visited += n_current
        for i in range(n_current):
            # First mark all cells of this round as not waiting, then visit them, because a visit may put another cell
            # of this round into a queue again.
            waiting[queues[current, i]] = False
        for i in range(n_current):
            cell = np.uint64(queues[current, i])
            left, right = potential[cell - one], potential[cell + one]
            below, above = potential[cell - width], potential[cell + width]
            value = wave_value(left, right, below, above, np.float32(costs[cell]), quadratic)
            if value >= potential[cell]:
                continue
            potential[cell] = value
            rank = value
            if attraction > 0.0:
                row, col = cell // width, cell % width
                away = elementary.hypot(float(col) - target_col, float(row) - target_row)
                rank += np.float32(np.float32(away) * attraction)
            # As in navfn's A*, neighbors are also compared with this rank. So cells that were reached are seldom
            # visited again.
            near = rank < limit
            queue, n = (following, n_following) if near else (later, n_later)
            if _lowered(left, rank, costs[cell - one]):
                n = _push(queues, queue, n, waiting, cell - one)
            if _lowered(right, rank, costs[cell + one]):
                n = _push(queues, queue, n, waiting, cell + one)
            if _lowered(below, rank, costs[cell - width]):
                n = _push(queues, queue, n, waiting, cell - width)
            if _lowered(above, rank, costs[cell + width]):
                n = _push(queues, queue, n, waiting, cell + width)
            if near:
                n_following = n
            else:
                n_later = n
        current, following = following, current
        n_current, n_following = n_following, 0
        if n_current == 0:
            # All cells below the threshold are done. The threshold rises, and the postponed cells are next.
            limit += np.float32(increment)
            current, later = later, current
            n_current, n_later = n_later, 0
        # As in ROS, the wave stops at the end of the round in which it reaches the target.
        goes_on = n_current > 0 and not (target >= 0 and potential[target] < UNREACHED)
    if goes_on:
        # Move the waiting cells to the queues where the next call expects them.
        this, put_off = queues[current, :n_current].copy(), queues[later, :n_later].copy()
        # Copy the cells one by one. For slices of possibly different shapes, numba would compile an error message,
        # which takes about a second.
        for i in range(n_current):
            queues[0, i] = this[i]
        for i in range(n_later):
            queues[2, i] = put_off[i]
        lengths[0], lengths[2] = n_current, n_later
    return limit, goes_on


def spread(
    space: Workspace,
    seeds: Cells,
    target: int,
    attraction: float,
    threshold: float,
    increment: float,
    quadratic: bool,
    portion: int,
) -> Iterator[None]:
    """Spread a wave, cheap cells first, until it reaches the target or all cells that can be reached.

    Args:
        space: prepared workspace. The potential is set at the seeds, and UNREACHED elsewhere.
        seeds: cells where the wave begins. Their neighbors are visited first.
        target: cell at which to stop; -1 for the whole map.
        attraction: cost per cell of the straight line to the target. A* adds it to choose the next cells. 0 without A*.
        threshold: cells of at most this cost are visited first.
        increment: step by which the threshold rises.
        quadratic: True if the wave spreads equally in all directions, False if along rows and columns.
        portion: number of cells to visit at a time. The round in which this number is reached is finished.

    Yields:
        Between two portions.
    """
    cols = space.shape[1]
    arrays = space.potential, space.costs, space.waiting, space.queues
    lengths = np.zeros(3, np.int64)
    lengths[0] = _begin(space.potential, space.costs, space.waiting, space.queues[0], cols, seeds)
    limit = np.float32(threshold)
    while True:
        limit, goes_on = _spread_on(*arrays, lengths, cols, target, attraction, limit, increment, quadratic, portion)
        if not goes_on:
            return
        yield


@njit(cache=True)
def _slope(potential: Potential, cell: int, cols: int) -> tuple[np.float32, np.float32]:
    """Return the unit vector (x, y) of the steepest descent at a cell, or (0, 0) if there is no slope."""
    here = potential[cell]
    dx = dy = np.float32(0.0)
    left, right, below, above = potential[cell - 1], potential[cell + 1], potential[cell - cols], potential[cell + cols]
    if left < UNREACHED:
        dx += left - here
    if right < UNREACHED:
        dx += here - right
    if below < UNREACHED:
        dy += below - here
    if above < UNREACHED:
        dy += here - above
    norm = np.float32(elementary.hypot(float(dx), float(dy)))
    if norm == 0.0:
        return dx, dy
    norm = np.float32(1.0 / norm)
    return norm * dx, norm * dy


@njit(cache=True)
def _mixed(a: np.float32, b: np.float32, share: np.float32) -> np.float32:
    return np.float32((1.0 - share) * a + share * b)


@njit(cache=True)
def _lowest_beside(potential: Potential, cell: int, cols: int) -> tuple[int, bool]:
    """Return the cell with the lowest potential among a cell and its neighbors, and True if the wave reached all.

    A diagonal neighbor does not count if the wave reached neither of the two cells on both sides of the diagonal.
    """
    lowest, value, inside = cell, potential[cell], True
    for up in (-cols, 0, cols):
        for aside in (-1, 0, 1):
            neighbour = cell + up + aside
            inside = inside and potential[neighbour] < UNREACHED
            squeezed = (
                up != 0
                and aside != 0
                and potential[cell + up] >= UNREACHED
                and potential[cell + aside] >= UNREACHED
            )  # fmt: skip
            if potential[neighbour] < value and not squeezed:
                lowest, value = neighbour, potential[neighbour]
    return lowest, inside


@njit(cache=True)
def descend(potential: Potential, cols: int, x: float, y: float, end_x: float, end_y: float) -> Points:
    """Follow the slope from a reached place to the start of the wave, in steps of half a cell.

    Args:
        potential: (rows * cols,).
        cols: number of columns of the map.
        x: x of the first place. The wave must have reached the nearest cell.
        y: y of the first place.
        end_x: x of the start of the wave.
        end_y: y of the start of the wave.

    Returns:
        (m, 2) positions, from (x, y) to the end.
    """
    path = np.empty((256, 2), np.float32)
    col, row = round(x), round(y)
    cell = row * cols + col
    dx, dy = np.float32(x - col), np.float32(y - row)
    best, since_best, by_cells = potential[cell], 0, False
    n = 0
    while True:
        here_x, here_y = np.float32(cell % cols + dx), np.float32(cell // cols + dy)
        if n + 1 >= path.shape[0]:
            longer = np.empty((2 * path.shape[0], 2), np.float32)
            for i in range(n):
                longer[i, 0], longer[i, 1] = path[i, 0], path[i, 1]
            path = longer
        if abs(here_x - end_x) <= 0.5 and abs(here_y - end_y) <= 0.5:
            break
        path[n, 0], path[n, 1] = here_x, here_y
        n += 1
        if potential[cell] < best:
            best, since_best, by_cells = potential[cell], 0, False
        else:
            since_best += 1
            # The path goes in circles, so go down from cell to cell to a potential lower than at all earlier cells.
            by_cells = by_cells or since_best > MAX_STEPS_WITHOUT_DESCENT
        lowest, inside = _lowest_beside(potential, cell, cols)
        # Interpolated slopes may lead back and forth between two positions. Treat this like a place without a slope.
        swings = n > 2 and path[n - 1, 0] == path[n - 3, 0] and path[n - 1, 1] == path[n - 3, 1]
        step_x = step_y = np.float32(0.0)
        if inside and not swings and not by_cells:
            ax, ay = _slope(potential, cell, cols)
            bx, by = _slope(potential, cell + 1, cols)
            cx, cy = _slope(potential, cell + cols, cols)
            ex, ey = _slope(potential, cell + cols + 1, cols)
            step_x = _mixed(_mixed(ax, bx, dx), _mixed(cx, ex, dx), dy)
            step_y = _mixed(_mixed(ay, by, dx), _mixed(cy, ey, dx), dy)
        if step_x == 0.0 and step_y == 0.0:
            if lowest == cell:
                # This is the bottom: one of the cells where the wave began.
                break
            cell = lowest
            dx = dy = np.float32(0.0)
            continue
        scale = np.float32(0.5 / elementary.hypot(float(step_x), float(step_y)))
        dx += step_x * scale
        dy += step_y * scale
        if dx > 1.0:
            cell += 1
            dx -= np.float32(1.0)
        if dx < -1.0:
            cell -= 1
            dx += np.float32(1.0)
        if dy > 1.0:
            cell += cols
            dy -= np.float32(1.0)
        if dy < -1.0:
            cell -= cols
            dy += np.float32(1.0)
    path[n, 0], path[n, 1] = end_x, end_y
    return path[: n + 1]


@njit(cache=True)
def descend_by_cells(potential: Potential, cols: int, x: float, y: float, end_x: float, end_y: float) -> Points:
    """Do the same as `descend`, but from cell to cell, always to the lowest of the eight cells around."""
    path = [(np.float32(x), np.float32(y))]
    cell = round(y) * cols + round(x)
    end = round(end_y) * cols + round(end_x)
    while cell != end:
        lowest, _ = _lowest_beside(potential, cell, cols)
        if lowest == cell:
            break
        cell = lowest
        path.append((np.float32(cell % cols), np.float32(cell // cols)))
    path.append((np.float32(end_x), np.float32(end_y)))
    return np.array(path)
