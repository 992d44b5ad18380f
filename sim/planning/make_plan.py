"""A plan for somebody who asks, to a goal or as near to it as they accept.

Source: ros-planning/navigation, move_base/src/move_base.cpp (planService).
Differs: costs are left as they are; which places can be reached is found out once, not by a plan to each; offered also
while the robot drives.
"""

import math
from collections.abc import Iterator

import numpy as np

from sim.costmap.costs import CostFrame, Costs
from sim.geometry import FloatArray, Pose2
from sim.planning.path import Path, Refused
from sim.planning.potential_planner import PotentialPlanner

STEP = 3
"""Cells from one square of places around the goal to the next."""


def make_plan(
    planner: PotentialPlanner,
    costs: Costs,
    frame: CostFrame,
    start: Pose2,
    goal: Pose2,
    tolerance: float,
    add_unreachable_goal: bool,
) -> FloatArray | Refused:
    """A path to the goal, or else to the first place of ever larger squares around it that can be reached.

    Args:
        planner: finds the way.
        costs: (rows, cols).
        frame: where they lie.
        start: where it begins, in the costmap's frame.
        goal: where it shall end.
        tolerance: half the side of the largest square, metres.
        add_unreachable_goal: whether the goal itself follows after a place near to it.

    Returns:
        (m, 3) poses in the costmap's frame, or why there is no path to the goal itself.
    """
    path = planner.plan(costs, frame, start, goal)
    if isinstance(path, Path):
        return path.poses
    if not tolerance > 0.0:
        return path
    reached = planner.reached(costs, frame, start)
    # Beyond the map's size there is nothing to search.
    farthest = min(tolerance, sum(costs.shape) * frame.resolution)
    for x, y in _around(goal, min(STEP * frame.resolution, tolerance), farthest):
        row, col = math.floor((y - frame.y) / frame.resolution), math.floor((x - frame.x) / frame.resolution)
        if not (0 <= row < costs.shape[0] and 0 <= col < costs.shape[1] and reached[row, col]):
            continue
        near = planner.plan(costs, frame, start, Pose2(x, y, goal.theta))
        if isinstance(near, Path):
            return np.vstack([near.poses, goal.array()]) if add_unreachable_goal else near.poses
    return path


def _around(goal: Pose2, step: float, farthest: float) -> Iterator[tuple[float, float]]:
    """Points of squares around a goal, from the smallest on; on each in the order in which ROS tries them."""
    for ring in range(1, math.floor(farthest / step + 1e-6) + 1):
        for up in range(ring + 1):
            for right in range(ring + 1):
                if max(up, right) < ring:
                    continue
                for dy in sorted({-up, up}):
                    for dx in sorted({-right, right}):
                        yield goal.x + dx * step, goal.y + dy * step
