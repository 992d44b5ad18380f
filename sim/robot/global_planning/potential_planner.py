"""Global planner that spreads a potential from the robot, and follows the potential's slope down from the goal.

Source: ros-planning/navigation, navfn/src/navfn_ros.cpp, global_planner/src/planner_core.cpp.
Differences from ROS: a start in a lethal cell is refused, while ROS clears the cell. A path to a
reachable goal ends exactly at the goal, even with a tolerance, while navfn's path ends at a raster point near the goal.
Positions refer to the cells' centers, while navfn's paths are shifted by half a cell toward the origin. The costmap is
not changed.
"""

import math
from collections.abc import Iterator
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from sim.common.geometry import Pose2
from sim.numerics import elementary_arrays
from sim.numerics.float_array import FloatArray
from sim.robot.costmap.costs import LETHAL, CostFrame, Costs
from sim.robot.global_planning.path import OUTERMOST, Path, PathSearch, PlanRefusal, plan_refusal, with_edge
from sim.robot.global_planning.wave import BLOCKED, UNREACHED, CellCosts, Points, Potential, Workspace, prepare

MAX_CELLS = 1e9
"""Positions at a greater distance from a map's corner are not distinguished, cells."""
PORTION = 300_000
"""Approximate number of cells that a search visits in a tick. This is twice the number for a wave over 26 m x 14 m, and
about six milliseconds of work. It is a number of cells and not a time, so that plans are the same on every machine."""


class PotentialMethod(Protocol):
    """Functions in which planners with a potential differ: costs, spreading, tracing, headings."""

    @property
    def table(self) -> CellCosts:
        """(256,) cost of crossing a cell for each cell cost, or BLOCKED if it cannot be crossed."""

    @property
    def tolerance(self) -> float:
        """Maximum distance between the end of a path and a goal that cannot be reached, meters."""

    @property
    def exact(self) -> bool:
        """True if the wave and the path start at exact positions, False if both start at centers of cells."""

    def spread(self, space: Workspace, x: float, y: float, target: int, portion: int) -> Iterator[None]:
        """Fill the potential from a position, in cells, until the target is reached. -1 means no target.

        Yield after every portion (a number of visited cells) except the last.
        """

    def trace(self, potential: Potential, cols: int, x: float, y: float, end_x: float, end_y: float) -> Points:
        """Return (m, 2) positions from a reached place down to the start of the wave."""

    def orient(self, points: FloatArray, start: float, goal: float) -> FloatArray:
        """Return (m, 3) poses on (m, 2) points, for given headings at both ends."""


class PotentialPlanner:
    """Global planner that uses a potential over the costmap.

    Args:
        method: functions in which planners differ.
        space: workspace, used if it fits the costmap. Nothing is kept in it between plans, so planners may share it. A
            search waits for searches that began before it. If None, the planner makes its own workspace.
    """

    def __init__(self, method: PotentialMethod, space: Workspace | None = None) -> None:
        self._method = method
        self._space = space or Workspace(0, 0)

    def reached(self, costs: Costs, frame: CostFrame, start: Pose2) -> NDArray[np.bool_]:
        """Return a (rows, cols) mask of the cells where a path from a start may end. See `search` for the arguments."""
        return self.potential(costs, frame, start) < UNREACHED

    def potential(self, costs: Costs, frame: CostFrame, start: Pose2) -> Potential:
        """Return the (rows, cols) potential from a start, with UNREACHED where no path can end.

        See `search` for the arguments.
        """
        rows, cols = costs.shape
        x, y = _position(frame, start)
        if not (0 <= round(y) < rows and 0 <= round(x) < cols) or costs[round(y), round(x)] == LETHAL:
            return np.full(costs.shape, UNREACHED, dtype=np.float32)
        if not self._method.exact:
            x, y = float(round(x)), float(round(y))
        space = self._fitting(costs)
        self._prepare(space, costs)
        for _ in self._method.spread(space, x, y, -1, PORTION):
            pass
        return space.potential.reshape(rows, cols).copy()

    def descend(self, potential: Potential, frame: CostFrame, place: Pose2, start: Pose2) -> FloatArray | None:
        """Return (m, 2) points from a place down to the start of a `potential`, meters; None for an unreached place."""
        rows, cols = potential.shape
        (x, y), (end_x, end_y) = _position(frame, place), _position(frame, start)
        if not (0 <= round(y) < rows and 0 <= round(x) < cols) or potential[round(y), round(x)] >= UNREACHED:
            return None
        if not self._method.exact:
            x, y, end_x, end_y = (float(round(at)) for at in (x, y, end_x, end_y))
        down = self._method.trace(potential.ravel(), cols, x, y, end_x, end_y)
        points: FloatArray = (down + 0.5) * frame.resolution + np.array([frame.x, frame.y])
        return points

    def plan(self, costs: Costs, frame: CostFrame, start: Pose2, goal: Pose2) -> Path | PlanRefusal:
        """Plan a path at once. See `search` for the arguments."""
        search = self.search(costs, frame, start, goal)
        while True:
            try:
                next(search)
            except StopIteration as done:
                path: Path | PlanRefusal = done.value
                return path

    def search(self, costs: Costs, frame: CostFrame, start: Pose2, goal: Pose2) -> PathSearch:
        """Search for a path from start to goal that avoids obstacles according to their costs.

        Args:
            costs: (rows, cols). They are read when the search begins. If it has to wait for other searches, this is
                later than the first step.
            frame: frame of the costs in the map.
            start: pose of the base, in the costmap's frame.
            goal: pose at the end.

        Yields:
            None, after every portion of work except the last portion.

        Returns:
            The path, or the reason why none exists.
        """
        method = self._method
        rows, cols = costs.shape
        x, y = _position(frame, start)
        goal_x, goal_y = _position(frame, goal)
        row, col, goal_row, goal_col = round(y), round(x), round(goal_y), round(goal_x)
        if not (0 <= row < rows and 0 <= col < cols):
            return plan_refusal("start_outside")
        goal_within = 0 <= goal_row < rows and 0 <= goal_col < cols
        if not goal_within and method.tolerance == 0.0:
            return plan_refusal("goal_outside")
        rim = not (0 < goal_row < rows - 1 and 0 < goal_col < cols - 1)
        blocked = not goal_within or rim or method.table[costs[goal_row, goal_col]] == BLOCKED
        at_goal = (row, col) == (goal_row, goal_col)
        if blocked and method.tolerance == 0.0 and not at_goal:
            only_rim = rim and goal_within and method.table[costs[goal_row, goal_col]] != BLOCKED
            return (
                PlanRefusal("goal_occupied", f"the goal lies {OUTERMOST}")
                if only_rim
                else plan_refusal("goal_occupied")
            )
        if costs[row, col] == LETHAL:
            return plan_refusal("start_occupied")
        if at_goal:
            return Path(np.array([[start.x, start.y, goal.theta], [goal.x, goal.y, goal.theta]]))
        if not method.exact:
            x, y, goal_x, goal_y = float(col), float(row), float(goal_col), float(goal_row)
        space, user = self._fitting(costs), object()
        space.users.append(user)
        try:
            while space.users[0] is not user:
                yield
            self._prepare(space, costs)
            yield from method.spread(space, x, y, -1 if blocked else goal_row * cols + goal_col, PORTION)
            end = goal
            if blocked or space.potential[goal_row * cols + goal_col] >= UNREACHED:
                nearest = _nearest_reached(space, goal_x, goal_y, method.tolerance / frame.resolution)
                if nearest is None:
                    refusal = plan_refusal("no_way" if goal_within else "goal_outside")
                    return with_edge(refusal, costs.shape, frame, start, goal)
                goal_x, goal_y = float(nearest[0]), float(nearest[1])
                end = Pose2(
                    frame.x + (goal_x + 0.5) * frame.resolution, frame.y + (goal_y + 0.5) * frame.resolution, goal.theta
                )
            down = method.trace(space.potential, cols, goal_x, goal_y, x, y)
        finally:
            # This also happens if a search is stopped before its end.
            space.users.remove(user)
        points = (down[::-1] + 0.5) * frame.resolution + np.array([frame.x, frame.y])
        if len(points) == 1:
            points = np.repeat(points, 2, axis=0)
        points[0] = start.x, start.y
        points[-1] = end.x, end.y
        return Path(method.orient(points, start.theta, end.theta))

    def _fitting(self, costs: Costs) -> Workspace:
        """Return a workspace that fits these costs."""
        if self._space.shape != costs.shape:
            self._space = Workspace(*costs.shape)
        return self._space

    def _prepare(self, space: Workspace, costs: Costs) -> None:
        """Prepare the workspace for these costs, with nothing reached."""
        prepare(costs, self._method.table, space.costs, space.potential, space.waiting)


def _position(frame: CostFrame, pose: Pose2) -> tuple[float, float]:
    """Return the position in cells. Whole numbers are centers, so rounding gives the cell."""
    x, y = (pose.x - frame.x) / frame.resolution, (pose.y - frame.y) / frame.resolution
    # The lower edge belongs to the cell, although rounding half to even could give another cell.
    return _within(x), _within(y)


def _within(position: float) -> float:
    # Positions farther away are on no map, and may even be infinite.
    position = min(max(position, -MAX_CELLS), MAX_CELLS)
    cell = math.floor(position)
    return cell + min(max(position - cell - 0.5, -0.499999), 0.499999)


def _nearest_reached(space: Workspace, x: float, y: float, tolerance: float) -> tuple[int, int] | None:
    """Return (col, row) of the reached cell nearest to a position, within the tolerance. All units are cells."""
    rows, cols = space.shape
    top, left = max(0, math.floor(y - tolerance)), max(0, math.floor(x - tolerance))
    window = space.potential.reshape(rows, cols)[
        top : math.ceil(y + tolerance) + 1, left : math.ceil(x + tolerance) + 1
    ]
    reached = np.argwhere(window < UNREACHED) + np.array([top, left])
    if len(reached) == 0:
        return None
    away = elementary_arrays.hypot(reached[:, 1] - x, reached[:, 0] - y)
    first = int(away.argmin())
    if away[first] > tolerance + 1e-9:
        return None
    return int(reached[first, 1]), int(reached[first, 0])
