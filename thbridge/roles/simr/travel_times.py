"""Travel times from all places of a map to its rooms, planned on the static map and scaled to the map's known times.

A wavefront of navfn from each room's goal gives a path to this goal from every place. The duration of a path is the sum
of a constant, a part for its length, and a part for the turns on the spot at both ends. The three weights are fitted to
the known times between places (non-negative least squares). So the cost of a room from a robot's position is similar to
the cost from the nearest place with a row in the matrix.
"""

import math
from collections.abc import Sequence
from itertools import combinations
from typing import NamedTuple

import numpy as np

from sim.common.geometry import Pose2
from sim.common.grid import OccupancyGrid
from sim.numerics import elementary, elementary_arrays
from sim.numerics.elementary import wrap_angle
from sim.numerics.float_array import FloatArray
from sim.numerics.matrices import product, solution
from sim.parameters import NavfnParameters
from sim.robot.costmap.costs import CostFrame, Costs
from sim.robot.global_planning.navfn import Navfn
from sim.robot.global_planning.potential_planner import PotentialPlanner
from sim.robot.global_planning.wave import UNREACHED
from thbridge.files.disk.mapped_arrays import mapped

AT_GOAL = 1.0
"""The matrix row of a room applies to robots that are at most this far from the room's goal, in meters."""

_NEAR = 0.5
"""Largest distance to the nearest place with a path, in meters. It is used for estimated positions inside a wall."""
_FIRST_STRETCH = 0.5
"""Length of the segment at each end of a path that determines the path's direction at this end, in meters."""


class _Way(NamedTuple):
    """Unweighted terms of a path's duration: 1, length in meters, and turns on the spot at both ends in radians."""

    one: float
    length: float
    turned: float


class TravelTimes:
    """Computation of the energy of moves from any place of a map.

    Args:
        grid: the map.
        costs: (rows, cols) costs of the map's cells for a robot, with inflation.
        goals: goal pose of each room, in order.
        starts: start poses, at least one. The row of the corridor applies to them.
        matrix: known times between places in seconds, by number (0 is the corridor, rooms start at 1). None if there is
            no move.
    """

    def __init__(
        self,
        grid: OccupancyGrid,
        costs: Costs,
        goals: Sequence[Pose2],
        starts: Sequence[Pose2],
        matrix: Sequence[Sequence[float | None]],
    ) -> None:
        self._to_grid = grid.origin.inverse()
        self._frame = CostFrame(0.0, 0.0, grid.resolution)
        self._goals = tuple(self._to_grid.compose(goal) for goal in goals)
        self._matrix = tuple(tuple(row) for row in matrix)
        self._planner = PotentialPlanner(Navfn(NavfnParameters()))
        # Potentials are memory-mapped, because each has 16 MB for a hectare, and a path reads only a few cells.
        potentials = (self._planner.potential(costs, self._frame, goal) for goal in self._goals)
        self._potentials = mapped(potentials, len(self._goals) * costs.size * np.dtype(np.float32).itemsize)
        places = [[self._to_grid.compose(start) for start in starts], *([goal] for goal in self._goals)]
        self._weights = _fitted(
            [
                ([way for start in places[place] if (way := self._way(room, start)) is not None], time)
                for place, row in enumerate(self._matrix)
                for room, time in enumerate(row[1:])
                if time is not None and place != room + 1
            ]
        )

    def costs_from(self, pose: Pose2) -> tuple[float | None, ...]:
        """Return the energy from a pose to each place, by the place's number. It is a whole number, or None without a
        path.
        """
        here = self._to_grid.compose(pose)
        away = [elementary.hypot(goal.x - here.x, goal.y - here.y) for goal in self._goals]
        nearest = min(range(len(away)), key=lambda room: away[room])
        estimated = [self._seconds(room, here) for room in range(len(self._goals))]
        if away[nearest] > AT_GOAL:
            return None, *estimated
        row = list(self._matrix[nearest + 1])
        # The matrix has no move from a room to itself, but a robot may be in an unvisited room.
        row[nearest + 1] = estimated[nearest]
        return tuple(row)

    def _seconds(self, room: int, here: Pose2) -> float | None:
        way = self._way(room, here)
        return None if way is None else max(1.0, round(float((np.array(way) * self._weights).sum())))

    def _way(self, room: int, here: Pose2) -> _Way | None:
        """Return the parts of the path from a pose in the grid, or from the nearest place with a path.

        Return None if there is no path.
        """
        goal, potential = self._goals[room], self._potentials[room]
        resolution = self._frame.resolution
        col, row, reach = here.x / resolution, here.y / resolution, _NEAR / resolution
        top, left = max(0, math.floor(row - reach)), max(0, math.floor(col - reach))
        reached = np.argwhere(potential[top : math.ceil(row + reach), left : math.ceil(col + reach)] < UNREACHED)
        if not len(reached):
            return None
        centres = reached + np.array([top, left]) + 0.5
        y, x = (
            centres[int(elementary_arrays.hypot(*(centres - np.array([row, col])).T).argmin())] * resolution
        ).tolist()
        points = self._planner.descend(potential, self._frame, Pose2(x, y, 0.0), goal)
        if points is None or len(points) < 2:
            return _Way(1.0, 0.0, abs(wrap_angle(goal.theta - here.theta)))
        steps = elementary_arrays.hypot(*np.diff(points, axis=0).T)
        return _Way(
            1.0,
            float(steps.sum()),
            abs(wrap_angle(_direction(points, steps) - here.theta))
            + abs(wrap_angle(goal.theta - _direction(points[::-1], steps[::-1]) - math.pi)),
        )


def _direction(points: FloatArray, steps: FloatArray) -> float:
    """Return the direction of the first segment of (m, 2) points, radians. `steps`: (m - 1,) distances, meters."""
    end = min(int(np.searchsorted(steps.cumsum(), _FIRST_STRETCH)) + 1, len(points) - 1)
    along = points[end] - points[0]
    return elementary.atan2(along[1], along[0])


def _fitted(known: Sequence[tuple[Sequence[_Way], float]]) -> FloatArray:
    """Return (3,) seconds per unit of each part, fitted to known times.

    If there are several paths for a time, their mean is used.
    """
    rows = [(np.mean(ways, axis=0), seconds) for ways, seconds in known if ways]
    if not rows:
        return np.zeros(3)
    return non_negative_weights(np.array([way for way, _ in rows]), np.array([seconds for _, seconds in rows]))


def non_negative_weights(parts: FloatArray, wholes: FloatArray) -> FloatArray:
    """Return the (k,) non-negative weights with which the weighted sums of the parts are nearest to the wholes.

    The fit is by least squares.

    The best weights are the weights of an unconstrained fit to some of the parts. There are only a few parts, so all
    subsets of parts are tried.

    Args:
        parts: (n, k) parts of each whole.
        wholes: (n,) wholes.
    """
    count = parts.shape[1]
    best, least = np.zeros(count), float((wholes * wholes).sum())
    for size in range(1, count + 1):
        for chosen in map(list, combinations(range(count), size)):
            columns = np.ascontiguousarray(parts[:, chosen])
            rows = np.ascontiguousarray(columns.T)
            weights = solution(product(rows, columns), product(rows, wholes[:, np.newaxis].copy()))[:, 0]
            off = (columns * weights).sum(axis=1) - wholes
            if (weights >= 0.0).all() and (error := float((off * off).sum())) < least:
                best, least = np.zeros(count), error
                best[chosen] = weights
    return best
