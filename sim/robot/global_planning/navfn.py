"""navfn: a potential that spreads like a wave, by Dijkstra or A*, and the path down its slope.

Source: ros-planning/navigation, navfn/src/navfn.cpp and navfn_ros.cpp. Potentials are the same, bit for bit.
Difference from ROS: poses face along the path, while ROS sets only the last heading. See also `wave` and
`potential_planner`.
"""

from collections.abc import Iterator

import numpy as np

from sim.numerics import elementary_arrays
from sim.numerics.float_array import FloatArray
from sim.parameters import NavfnParameters
from sim.robot.costmap.costs import INSCRIBED, LETHAL, UNKNOWN
from sim.robot.global_planning.path import headings
from sim.robot.global_planning.wave import BLOCKED, CellCosts, Points, Potential, Workspace, descend, spread

COST_NEUTRAL = 50
COST_FACTOR = 0.8
COST_OBSTACLE = LETHAL


def passage_costs(allow_unknown: bool) -> CellCosts:
    """Return the (256,) costs of crossing a cell, for each cost of a costmap: 50 if free, more near obstacles."""
    costs = np.arange(256)
    table: CellCosts = np.minimum(COST_NEUTRAL + np.floor(COST_FACTOR * costs), COST_OBSTACLE - 1).astype(np.uint8)
    table[INSCRIBED] = table[LETHAL] = BLOCKED
    table[UNKNOWN] = COST_OBSTACLE - 1 if allow_unknown else BLOCKED
    return table


class Navfn:
    """Functions that are specific to navfn. See `PotentialMethod`.

    Args:
        parameters: parameters of navfn.
    """

    exact = False

    def __init__(self, parameters: NavfnParameters) -> None:
        self.table = passage_costs(parameters.allow_unknown)
        self.tolerance = parameters.default_tolerance
        self._use_astar = parameters.use_astar

    def spread(self, space: Workspace, x: float, y: float, target: int, portion: int) -> Iterator[None]:
        """Spread the wave, cheap cells first. With A*, cells that are cheap and near the target come first."""
        cols = space.shape[1]
        start = round(y) * cols + round(x)
        space.potential[start] = 0.0
        attraction = 0.0
        threshold = float(COST_OBSTACLE)
        if self._use_astar and target >= 0:
            attraction = float(COST_NEUTRAL)
            threshold += float(
                np.float32(
                    elementary_arrays.hypot(target % cols - start % cols, target // cols - start // cols) * COST_NEUTRAL
                )
            )
        seeds = np.array([start], np.uint32)
        return spread(space, seeds, target, attraction, threshold, 2.0 * COST_NEUTRAL, True, portion)

    def trace(self, potential: Potential, cols: int, x: float, y: float, end_x: float, end_y: float) -> Points:
        """Trace the path down the slope in steps of half a cell."""
        return descend(potential, cols, x, y, end_x, end_y)

    def orient(self, points: FloatArray, start: float, goal: float) -> FloatArray:
        """Turn each pose toward the next."""
        return headings(points, goal)
