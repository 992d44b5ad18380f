"""Plan on request, to a goal or to a place near it within the caller's tolerance.

Source: ros-planning/navigation, move_base/src/move_base.cpp (planService).
Differences from ROS: costs are not changed. One search finds all reachable places, while ROS plans to each place
separately. The request also works while the robot drives.
"""

import math

import numpy as np

from sim.common.geometry import Pose2
from sim.numerics.float_array import FloatArray
from sim.robot.costmap.costs import CostFrame, Costs
from sim.robot.global_planning.path import Path, PlanRefusal, RobotPathPlanner

STEP = 3
"""Cells between two successive squares of places around the goal."""


def make_plan(
    planner: RobotPathPlanner,
    costs: Costs,
    frame: CostFrame,
    start: Pose2,
    goal: Pose2,
    tolerance: float,
    add_unreachable_goal: bool,
) -> FloatArray | PlanRefusal:
    """Plan a path to the goal, or to the first reachable place on increasingly large squares around it.

    Args:
        planner: planner that finds the paths.
        costs: (rows, cols).
        frame: frame of the costs in the map.
        start: pose at the beginning, in the costmap's frame.
        goal: pose at the end.
        tolerance: half the maximum side of a square, meters.
        add_unreachable_goal: True to append the goal itself after a place near it.

    Returns:
        (m, 3) poses in the costmap's frame, or the reason why no path leads to the goal itself.
    """
    path = planner.plan(costs, frame, start, goal)
    if isinstance(path, Path):
        return path.poses
    if not tolerance > 0.0:
        return path
    reached = planner.reached(costs, frame, start)
    step = min(STEP * frame.resolution, tolerance)
    rows, cols = costs.shape
    corner = np.array([frame.x, frame.y])
    # Subtract a little, because rounding might lead to a cell beyond the last cell.
    opposite = corner + (np.array([cols, rows]) - 1e-6) * frame.resolution
    # Places beyond the map need no search.
    farthest = min(tolerance, (rows + cols) * frame.resolution)
    for ring in range(1, math.floor(farthest / step + 1e-6) + 1):
        points = np.array([goal.x, goal.y]) + _square(ring) * step
        points = points[((points >= corner) & (points < opposite)).all(axis=1)]
        cells = ((points[:, ::-1] - corner[::-1]) / frame.resolution).astype(np.int64)
        for x, y in points[reached[cells[:, 0], cells[:, 1]]].tolist():
            near = planner.plan(costs, frame, start, Pose2(x, y, goal.theta))
            if isinstance(near, Path):
                return np.vstack([near.poses, goal.array()]) if add_unreachable_goal else near.poses
    return path


_SIGNS = np.array([(-1, -1), (1, -1), (-1, 1), (1, 1)])


def _square(ring: int) -> FloatArray:
    """Return (k, 2) points on a square around (0, 0), in ROS's order. Half its side is `ring`; units are steps."""
    along = np.arange(ring + 1)
    sides = np.column_stack([np.full(ring, ring), along[:-1]])
    ends = np.column_stack([along, np.full(ring + 1, ring)])
    points: FloatArray = (np.vstack([sides, ends])[:, np.newaxis] * _SIGNS).reshape(-1, 2).astype(np.float64)
    return points
