"""global_planner: navfn's successor, with other costs, exact path ends, and several modes of headings.

Source: ros-planning/navigation, global_planner/src (dijkstra.cpp, astar.cpp, quadratic_calculator.cpp,
gradient_path.cpp, grid_path.cpp, orientation_filter.cpp).
Differences from ROS: the wave begins in the cells around the robot, with their distances from the robot. Costs that
overflow a byte in ROS are limited to the maximum of a byte. `default_tolerance` has an effect, while ROS reads it but
does not use it. Cells around the goal that the wave has not reached are filled only if they can be crossed, so that no
path ends behind a wall. The interpolation of ForwardThenInterpolate starts at the beginning of the last straight
stretch, as intended. See also `wave` and `potential_planner`.
"""

import heapq
import math
from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from sim.numerics import elementary, elementary_arrays
from sim.numerics.elementary import wrap_angle
from sim.numerics.float_array import FloatArray
from sim.numerics.kernels import njit
from sim.parameters import GlobalPlannerParameters
from sim.robot.costmap.costs import UNKNOWN
from sim.robot.global_planning.wave import (
    BLOCKED,
    UNREACHED,
    CellCosts,
    Points,
    Potential,
    Workspace,
    descend,
    descend_by_cells,
    spread,
    value_of,
)

MAX_PASSAGE_COST = 255
"""Maximum cost of crossing a cell, the maximum of a byte."""
STRAIGHT_ANGLE = 0.35
"""Maximum turn between poses of one straight stretch, radians."""
FILL_REACH = 2
"""Cells on each side of the goal that are filled if the wave has not reached them."""


def passage_costs(parameters: GlobalPlannerParameters) -> CellCosts:
    """Return the (256,) costs of crossing a cell, for each cost of a costmap."""
    costs = np.arange(256)
    lethal = parameters.lethal_cost
    if not parameters.use_dijkstra:
        # A* uses costs without a factor.
        taken: CellCosts = np.minimum(costs + parameters.neutral_cost, MAX_PASSAGE_COST).astype(np.uint8)
        taken[lethal:] = BLOCKED
        if parameters.allow_unknown:
            taken[UNKNOWN] = MAX_PASSAGE_COST
        return taken
    scaled = np.floor(costs * parameters.cost_factor + parameters.neutral_cost)
    table: CellCosts = np.minimum(scaled, max(lethal - 1, 1)).astype(np.uint8)
    passable = costs < lethal - 1
    if parameters.allow_unknown:
        passable[UNKNOWN] = True
    table[~passable] = BLOCKED
    return table


@njit(cache=True)
def _astar_on(
    potential: Potential,
    costs: CellCosts,
    cols: int,
    target: int,
    neutral: float,
    quad: bool,
    ranks: FloatArray,
    cells: NDArray[np.int64],
    portion: int,
) -> tuple[FloatArray, NDArray[np.int64]]:
    """Continue A* from the (n,) waiting cells, with their ranks, until `portion` cells have been visited.

    Returns:
        Ranks and numbers of the cells that then wait, in the heap's order. They are empty if the target is reached or
        all cells have been visited.
    """
    queue = [(ranks[i], cells[i]) for i in range(ranks.size)]
    visited = 0
    met = False
    while len(queue) > 0 and visited < portion and not met:
        _, cell = heapq.heappop(queue)
        visited += 1
        met = cell == target
        for step in (1, -1, cols, -cols):
            neighbour = cell + step
            if (
                met
                or not 0 <= neighbour < costs.size
                or potential[neighbour] < UNREACHED
                or costs[neighbour] == BLOCKED
            ):
                continue
            if quad:
                value = value_of(potential, neighbour, cols, costs[neighbour], True)
            else:
                value = np.float32(potential[cell] + np.float32(costs[neighbour]))
            potential[neighbour] = value
            # This is the Manhattan distance as in ROS, because steps lead only to four neighbors.
            away = abs(neighbour % cols - target % cols) + abs(neighbour // cols - target // cols) if target >= 0 else 0
            heapq.heappush(queue, (float(value) + away * neutral, neighbour))
    left = 0 if met else len(queue)
    still_ranks, still = np.empty(left), np.empty(left, np.int64)
    for i in range(left):
        still_ranks[i], still[i] = queue[i]
    return still_ranks, still


def astar(space: Workspace, start: int, target: int, neutral: float, quad: bool, portion: int) -> Iterator[None]:
    """Fill the potential cell by cell until the target is reached. The cell with the cheapest estimated path is next.

    As in ROS, the potential of a cell is set only once, when the first neighbor reaches it. So the path is not always
    the cheapest path, even if the estimate of the remaining cost (`neutral` for each step of the Manhattan distance) is
    not too high.

    Args:
        space: prepared workspace.
        start: first cell.
        target: cell where the search ends, or -1 for the whole map.
        neutral: estimated cost of a step toward the target.
        quad: see `quadratic` of `spread`.
        portion: number of cells to visit at a time.

    Yields:
        Between two portions.
    """
    space.potential[start] = np.float32(0.0)
    cols = space.shape[1]
    ranks, cells = np.zeros(1), np.array([start], np.int64)
    while True:
        ranks, cells = _astar_on(space.potential, space.costs, cols, target, neutral, quad, ranks, cells, portion)
        if not cells.size:
            return
        yield


@njit(cache=True)
def fill_around(potential: Potential, costs: CellCosts, cols: int, cell: int, reach: int, quadratic: bool) -> None:
    """Set the potential of cells around a reached cell if they can be crossed."""
    rows = costs.size // cols
    row, col = cell // cols, cell % cols
    for r in range(max(1, row - reach), min(rows - 1, row + reach + 1)):
        for c in range(max(1, col - reach), min(cols - 1, col + reach + 1)):
            near = r * cols + c
            if potential[near] >= UNREACHED and costs[near] != BLOCKED:
                value = value_of(potential, near, cols, costs[near], quadratic)
                potential[near] = min(value, UNREACHED)


class GlobalPlanner:
    """Functions that are specific to global_planner. See `PotentialMethod`.

    Args:
        parameters: parameters of global_planner.
    """

    def __init__(self, parameters: GlobalPlannerParameters) -> None:
        self.table = passage_costs(parameters)
        self.tolerance = parameters.default_tolerance
        self.exact = not parameters.old_navfn_behavior
        self._parameters = parameters

    def spread(self, space: Workspace, x: float, y: float, target: int, portion: int) -> Iterator[None]:
        """Spread the wave in the order of Dijkstra or A*."""
        parameters = self._parameters
        cols = space.shape[1]
        start = round(y) * cols + round(x)
        neutral, quadratic = float(parameters.neutral_cost), parameters.use_quadratic
        if parameters.use_dijkstra:
            seeds = self._seeds(space, x, y)
            threshold = float(parameters.lethal_cost)
            yield from spread(space, seeds, target, 0.0, threshold, 2.0 * neutral, quadratic, portion)
        else:
            # Half the portion, because a cell in the heap of A* takes much longer than a cell in the unsorted queues.
            yield from astar(space, start, target, neutral, quadratic, portion // 2)
        if target >= 0 and self.exact and space.potential[target] < UNREACHED:
            fill_around(space.potential, space.costs, cols, target, FILL_REACH, quadratic)

    def trace(self, potential: Potential, cols: int, x: float, y: float, end_x: float, end_y: float) -> Points:
        """Trace the path down the slope, or from cell to cell, as the parameters require."""
        trace = descend_by_cells if self._parameters.use_grid_path else descend
        return trace(potential, cols, x, y, end_x, end_y)

    def orient(self, points: FloatArray, start: float, goal: float) -> FloatArray:
        """Set the headings according to `orientation_mode`. The last heading is always the goal's."""
        mode, window = self._parameters.orientation_mode, self._parameters.orientation_window_size
        return np.column_stack([points, orientations(points, mode, window, start, goal)])

    def _seeds(self, space: Workspace, x: float, y: float) -> NDArray[np.uint32]:
        """Set the potential where the wave begins: in the robot's cell and, if `exact`, in three cells around it."""
        rows, cols = space.shape
        row, col = round(y), round(x)
        start = row * cols + col
        if not self.exact:
            space.potential[start] = 0.0
            return np.array([start], np.uint32)
        aside, up = (1 if x >= col else -1), (1 if y >= row else -1)
        seeds = [(row, col)]
        for r, c in ((row, col + aside), (row + up, col)):
            if 0 <= r < rows and 0 <= c < cols and space.costs[r * cols + c] != BLOCKED:
                seeds.append((r, c))
        across = (row + up, col + aside)
        within = all(0 <= i < n for i, n in zip(across, space.shape, strict=True))
        if len(seeds) > 1 and within and space.costs[across[0] * cols + across[1]] != BLOCKED:
            seeds.append(across)
        for r, c in seeds:
            space.potential[r * cols + c] = self._parameters.neutral_cost * elementary.hypot(c - x, r - y)
        return np.array([r * cols + c for r, c in seeds], np.uint32)


def orientations(points: FloatArray, mode: int, window: int, start: float, goal: float) -> FloatArray:
    """Return (m,) headings on (m, 2) points, m at least 2.

    Args:
        points: meters.
        mode: 0 none, 1 forward, 2 interpolated from start to goal, 3 forward then interpolated, 4 backward, 5 leftward,
            6 rightward.
        window: the direction at a point is from the point `window` places before it to the point `window` places after
            it.
        start: heading of the robot.
        goal: heading of the goal.
    """
    last = len(points) - 1
    index = np.arange(last + 1)
    chords = points[np.minimum(index + window, last)] - points[np.maximum(index - window, 0)]
    turned = {4: math.pi, 5: -math.pi / 2, 6: math.pi / 2}.get(mode, 0.0)
    headings = wrapped(elementary_arrays.atan2(chords[:, 1], chords[:, 0]) + turned)
    if mode == 0:
        headings[:] = 0.0
    begin = last
    if mode == 2:
        begin, headings[0] = 0, start
    elif mode == 3:
        begin = max(0, last - 2)
        straight = headings[begin]
        while begin > 0 and abs(wrap_angle(headings[begin - 1] - straight)) <= STRAIGHT_ANGLE:
            begin -= 1
        headings[0] = start
    if begin < last:
        difference = wrap_angle(goal - headings[begin])
        headings[begin:] = wrapped(headings[begin] + difference * np.linspace(0.0, 1.0, last - begin + 1))
    headings[last] = goal
    return headings


def wrapped(angles: FloatArray) -> FloatArray:
    """Wrap angles to [-pi, pi)."""
    return (angles + math.pi) % math.tau - math.pi
