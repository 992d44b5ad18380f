"""Costs of a robot's costmap at points and under the robot's footprint, for questions from outside.

Source: ros-navigation/navigation2, nav2_costmap_2d/src/costmap_2d_ros.cpp and footprint_collision_checker.cpp.
"""

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from sim.common.geometry import Pose2
from sim.numerics.float_array import FloatArray
from sim.robot.costmap.costs import FREE, LETHAL, UNKNOWN, CostFrame, Costs
from sim.robot.costmap.footprint_cost import COLLIDES, footprint_cost


@dataclass(frozen=True, eq=False)
class RobotCostmap:
    """A costmap of a robot at one moment, with the robot's footprint.

    Attributes:
        tick: time of the costs.
        base_in_map: pose estimate of the robot.
        origin: pose of the costmap's first corner, map frame.
        resolution: side of a cell, meters.
        costs: (rows, cols) costs. Row 0 is the lowest.
        footprint: (n, 2) padded corners of the robot, base frame, meters.
        circular: True if the footprint is a circle, so that the cost of one cell is enough to find collisions.
    """

    tick: int
    base_in_map: Pose2
    origin: Pose2
    resolution: float
    costs: Costs
    footprint: FloatArray
    circular: bool

    def cost_at(self, base_in_map: Pose2) -> int | None:
        """Return the cost of the cell at a pose. Return None outside the costmap."""
        base = self.origin.inverse().compose(base_in_map)
        row, col = math.floor(base.y / self.resolution), math.floor(base.x / self.resolution)
        rows, cols = self.costs.shape
        return int(self.costs[row, col]) if 0 <= row < rows and 0 <= col < cols else None

    def footprint_cost(self, base_in_map: Pose2) -> int:
        """Return the maximum cost under the outline of the robot at a pose.

        The cost is LETHAL if the outline crosses an obstacle or leaves the costmap. Otherwise, it is UNKNOWN if the
        outline crosses unknown space.
        """
        base = self.origin.inverse().compose(base_in_map)
        frame, place = CostFrame(0.0, 0.0, self.resolution), (base.x, base.y, base.theta)
        cost = footprint_cost(self.costs, frame, self.footprint, *place)
        if cost != COLLIDES:
            return int(cost)
        # The kernel does not distinguish obstacles from unknown space.
        return LETHAL if footprint_cost(self._known, frame, self.footprint, *place) == COLLIDES else UNKNOWN

    @cached_property
    def _known(self) -> Costs:
        """(rows, cols) costs, with unknown cells as free cells."""
        return np.where(self.costs == UNKNOWN, np.uint8(FREE), self.costs)
