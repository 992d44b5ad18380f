"""navfn: a potential that spreads from the goal like a wave, and the path that runs down it.

Source: ros-planning/navigation, navfn/src/navfn.cpp and navfn_ros.cpp (Dijkstra's order of spreading).
Differs: potentials are computed in 64-bit reals and paths run through cell centres.
"""

import math

import numpy as np
from numba import njit
from numpy.typing import NDArray

from sim.costmap.costs import INSCRIBED, LETHAL, UNKNOWN, CostFrame, Costs
from sim.geometry import FloatArray, Pose2
from sim.planning.path import Path, RefusalCode, Refused, headings

COST_NEUTRAL = 50
COST_FACTOR = 0.8
COST_OBSTACLE = 254
UNREACHED = 1.0e10

_SENTENCES: dict[RefusalCode, str] = {
    "goal_outside": "the goal is outside the map",
    "start_outside": "the robot is outside the map",
    "goal_occupied": "the goal is inside a wall or too near to one",
    "start_occupied": "the robot stands inside an obstacle",
    "no_way": "there is no way from here to the goal",
    "robots_in_the_way": "other robots stand in the way",
}


def translation(allow_unknown: bool) -> NDArray[np.int16]:
    """(256,) what navfn makes of a costmap's costs: 50 for free cells, more near obstacles, 254 for no passage."""
    costs = np.arange(256)
    table = np.minimum(COST_NEUTRAL + (COST_FACTOR * costs).astype(np.int64), COST_OBSTACLE - 1)
    table[INSCRIBED] = table[LETHAL] = COST_OBSTACLE
    table[UNKNOWN] = COST_OBSTACLE - 1 if allow_unknown else COST_OBSTACLE
    return table.astype(np.int16)


@njit(cache=True)
def potential(costs: Costs, table: NDArray[np.int16], start: int, goal: int) -> FloatArray:
    """Cost of the way to the goal from every cell that the wave reached before it reached the start.

    Args:
        costs: (rows, cols); the rim is taken for an obstacle.
        table: see `translation`.
        start: flat index of the robot's cell, which is passable whatever its cost.
        goal: flat index.

    Returns:
        (rows * cols,) UNREACHED where the wave did not come.
    """
    rows, cols = costs.shape
    total = rows * cols
    cell_costs = np.empty(total, np.int16)
    flat = costs.ravel()
    for i in range(total):
        cell_costs[i] = table[flat[i]]
    cell_costs[start] = table[0]
    cell_costs[:cols] = 254
    cell_costs[total - cols :] = 254
    for r in range(rows):
        cell_costs[r * cols] = 254
        cell_costs[r * cols + cols - 1] = 254
    field = np.full(total, 1.0e10)
    if cell_costs[goal] >= 254:
        return field
    pending = np.zeros(total, np.bool_)
    current = np.empty(total, np.int32)
    following = np.empty(total, np.int32)
    overflow = np.empty(total, np.int32)
    n_current = n_following = n_overflow = 0
    field[goal] = 0.0
    for step in (1, -1, cols, -cols):
        if cell_costs[goal + step] < 254:
            current[n_current] = goal + step
            n_current += 1
            pending[goal + step] = True
    threshold = 2.0 * 50.0
    while n_current > 0 or n_overflow > 0:
        if n_current == 0:
            # This level of priority is done: the cells that were put off are next.
            threshold += 2.0 * 50.0
            current, overflow = overflow, current
            n_current, n_overflow = n_overflow, 0
        for i in range(n_current):
            pending[current[i]] = False
        for i in range(n_current):
            cell = current[i]
            left, right = field[cell - 1], field[cell + 1]
            below, above = field[cell - cols], field[cell + cols]
            across, along = min(left, right), min(below, above)
            lowest, gap = (along, across - along) if along < across else (across, along - across)
            cost = float(cell_costs[cell])
            if gap >= cost:
                value = lowest + cost
            else:
                # A plane wave between the two lower neighbours, as navfn's quadratic approximates it.
                d = gap / cost
                value = lowest + cost * (-0.2301 * d * d + 0.5307 * d + 0.7040)
            if value >= field[cell]:
                continue
            field[cell] = value
            for step in (-1, 1, -cols, cols):
                neighbour = cell + step
                reach = cell_costs[neighbour]
                if reach < 254 and not pending[neighbour] and field[neighbour] > value + 0.707106781 * reach:
                    pending[neighbour] = True
                    if value < threshold:
                        following[n_following] = neighbour
                        n_following += 1
                    else:
                        overflow[n_overflow] = neighbour
                        n_overflow += 1
        current, following = following, current
        n_current, n_following = n_following, 0
        if n_current == 0 and field[start] < 1.0e10:
            break
    return field


@njit(cache=True)
def _slope(field: FloatArray, cell: int, cols: int) -> tuple[float, float]:
    """Unit vector (x, y) of the steepest descent at a cell; (0, 0) when it is level."""
    here = field[cell]
    dx = dy = 0.0
    left, right, below, above = field[cell - 1], field[cell + 1], field[cell - cols], field[cell + cols]
    if here >= 1.0e10:
        if left < 1.0e10:
            dx = -254.0
        elif right < 1.0e10:
            dx = 254.0
        if below < 1.0e10:
            dy = -254.0
        elif above < 1.0e10:
            dy = 254.0
    else:
        if left < 1.0e10:
            dx += left - here
        if right < 1.0e10:
            dx += here - right
        if below < 1.0e10:
            dy += below - here
        if above < 1.0e10:
            dy += here - above
    norm = math.hypot(dx, dy)
    return (dx / norm, dy / norm) if norm > 0.0 else (0.0, 0.0)


@njit(cache=True)
def descend(field: FloatArray, rows: int, cols: int, start: int, goal: int) -> FloatArray:
    """(m, 2) columns and rows, in cells, of a path down the potential in half-cell steps; (0, 2) when it gets stuck."""
    limit = 4 * (rows + cols) + rows * cols // 2
    path = np.empty((limit, 2))
    cell = start
    dx = dy = 0.0
    n = 0
    while n < limit - 1:
        nearest = cell + round(dx) + cols * round(dy)
        if nearest == goal or field[max(0, min(rows * cols - 1, nearest))] < 50.0:
            path[n, 0], path[n, 1] = goal % cols, goal // cols
            return path[: n + 1]
        if cell < cols + 1 or cell > rows * cols - cols - 2:
            break
        path[n, 0], path[n, 1] = cell % cols + dx, cell // cols + dy
        n += 1
        swinging = n > 2 and path[n - 1, 0] == path[n - 3, 0] and path[n - 1, 1] == path[n - 3, 1]
        lowest, lowest_value, at_edge = cell, field[cell], swinging
        for row_step in (-cols, 0, cols):
            for step in (-1, 0, 1):
                value = field[cell + row_step + step]
                at_edge = at_edge or value >= 1.0e10
                if value < lowest_value:
                    lowest, lowest_value = cell + row_step + step, value
        if at_edge:
            # Beside an obstacle the slope means little: go from cell to cell.
            if lowest == cell:
                break
            cell = lowest
            dx = dy = 0.0
            continue
        x00, y00 = _slope(field, cell, cols)
        x01, y01 = _slope(field, cell + 1, cols)
        x10, y10 = _slope(field, cell + cols, cols)
        x11, y11 = _slope(field, cell + cols + 1, cols)
        x = (1.0 - dy) * ((1.0 - dx) * x00 + dx * x01) + dy * ((1.0 - dx) * x10 + dx * x11)
        y = (1.0 - dy) * ((1.0 - dx) * y00 + dx * y01) + dy * ((1.0 - dx) * y10 + dx * y11)
        norm = math.hypot(x, y)
        if norm == 0.0:
            break
        dx += 0.5 * x / norm
        dy += 0.5 * y / norm
        if dx > 1.0:
            cell += 1
            dx -= 1.0
        if dx < -1.0:
            cell -= 1
            dx += 1.0
        if dy > 1.0:
            cell += cols
            dy -= 1.0
        if dy < -1.0:
            cell -= cols
            dy += 1.0
    return path[:0]


def refused(code: RefusalCode) -> Refused:
    """The refusal with its sentence."""
    return Refused(code, _SENTENCES[code])


def plan(costs: Costs, frame: CostFrame, start: Pose2, goal: Pose2, allow_unknown: bool) -> Path | Refused:
    """A path from start to goal that keeps off obstacles as their costs ask for.

    Args:
        costs: (rows, cols).
        frame: where they lie.
        start: where the base is, map frame.
        goal: where it shall end.
        allow_unknown: whether unknown space may be crossed.
    """
    rows, cols = costs.shape
    start_row, start_col = _cell(frame, start)
    goal_row, goal_col = _cell(frame, goal)
    if not (0 < start_row < rows - 1 and 0 < start_col < cols - 1):
        return refused("start_outside")
    if not (0 < goal_row < rows - 1 and 0 < goal_col < cols - 1):
        return refused("goal_outside")
    goal_cost = costs[goal_row, goal_col]
    if goal_cost in (INSCRIBED, LETHAL) or (goal_cost == UNKNOWN and not allow_unknown):
        return refused("goal_occupied")
    if costs[start_row, start_col] == LETHAL:
        return refused("start_occupied")
    start_cell, goal_cell = start_row * cols + start_col, goal_row * cols + goal_col
    if start_cell == goal_cell:
        return Path(np.array([[start.x, start.y, goal.theta], [goal.x, goal.y, goal.theta]]))
    field = potential(costs, translation(allow_unknown), start_cell, goal_cell)
    if field[start_cell] >= UNREACHED:
        return refused("no_way")
    cells = descend(field, rows, cols, start_cell, goal_cell)
    if len(cells) == 0:
        return refused("no_way")
    points = (cells + 0.5) * frame.resolution + np.array([frame.x, frame.y])
    points[0] = start.x, start.y
    points = (
        np.vstack([points[:-1], [[goal.x, goal.y]]])
        if len(points) > 1
        else np.array([[start.x, start.y], [goal.x, goal.y]])
    )
    return Path(headings(points, goal.theta))


def _cell(frame: CostFrame, pose: Pose2) -> tuple[int, int]:
    return math.floor((pose.y - frame.y) / frame.resolution), math.floor((pose.x - frame.x) / frame.resolution)
