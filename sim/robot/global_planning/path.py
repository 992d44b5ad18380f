"""Paths through the map, and refusals if no path exists."""

from collections.abc import Generator
from dataclasses import dataclass
from typing import Literal, Protocol

import numpy as np
from numpy.typing import NDArray

from sim.common.geometry import Pose2
from sim.numerics import elementary_arrays
from sim.numerics.float_array import FloatArray
from sim.parameters import RobotParameters
from sim.robot.costmap.costs import CostFrame, Costs

PlanRefusalCode = Literal[
    "goal_occupied",
    "goal_outside",
    "start_occupied",
    "start_outside",
    "no_way",
    "robots_in_the_way",
    "blocked_by_obstacle",
]

_SENTENCES: dict[PlanRefusalCode, str] = {
    "goal_outside": "the goal is outside the map",
    "start_outside": "the robot is outside the map",
    "goal_occupied": "the goal is inside a wall or too near to one",
    "start_occupied": "the robot stands inside an obstacle",
    "no_way": "there is no path from here to the goal",
    "robots_in_the_way": "other robots block the path",
}

OUTERMOST = "in the map's outermost row or column of cells, where planners lead no path"
"""Last part of a sentence about a place at the map's border."""


@dataclass(frozen=True, slots=True)
class Path:
    """Path: poses from start to goal.

    Attributes:
        poses: (m, 3) poses in the map, meters and radians. Each faces the next pose. The last pose has the goal's
            heading.
    """

    poses: FloatArray

    @property
    def length(self) -> float:
        """Length in meters."""
        return float(elementary_arrays.hypot(*np.diff(self.poses[:, :2], axis=0).T).sum())


@dataclass(frozen=True, slots=True)
class PlanRefusal:
    """Refusal of a plan, because no path exists.

    Attributes:
        code: code of the cause for programs. Codes never change.
        sentence: the cause for people.
    """

    code: PlanRefusalCode
    sentence: str


def plan_refusal(code: PlanRefusalCode) -> PlanRefusal:
    """Make the refusal for this code, with its sentence."""
    return PlanRefusal(code, _SENTENCES[code])


def with_edge(
    refusal: PlanRefusal, shape: tuple[int, ...], frame: CostFrame, start: Pose2, goal: Pose2, radius: float = 0.0
) -> PlanRefusal:
    """Return the refusal. If the start or goal is too near to the map's edge for the planner or body, add a note.

    Args:
        refusal: reason why no path exists.
        shape: rows and columns of the map.
        frame: frame of the map.
        start: pose of the base.
        goal: pose at the end.
        radius: radius of the body, meters. The note is added if a place is nearer to the edge than this. If 0, it
            is added only for the outermost cells.
    """
    if refusal.sentence != _SENTENCES.get(refusal.code) or refusal.code in {"start_outside", "goal_outside"}:
        return refusal
    height, width = shape[0] * frame.resolution, shape[1] * frame.resolution
    for what, place in (("the goal lies", goal), ("the robot stands", start)):
        x, y = place.x - frame.x, place.y - frame.y
        away = min(x, y, width - x, height - y)
        if away < frame.resolution:
            edge = f"{what} {OUTERMOST}"
        elif away < radius:
            edge = f"{what} {away:.2f} m from the map's edge, which is nearer than the body's radius of {radius:.2f} m"
        else:
            continue
        return PlanRefusal(refusal.code, f"{refusal.sentence}; {edge}")
    return refusal


PathSearch = Generator[None, None, Path | PlanRefusal]
"""Search for a path, one portion of work at a time."""


class PathPlanner(Protocol):
    """Planner of paths over a costmap."""

    def search(self, costs: Costs, frame: CostFrame, start: Pose2, goal: Pose2) -> PathSearch:
        """Search for a path between two poses.

        Args:
            costs: (rows, cols). They are not changed.
            frame: frame of the costs in the map.
            start: pose of the base, in the costmap's frame.
            goal: pose at the end.
        """


class RobotPathPlanner(PathPlanner, Protocol):
    """Global planner of a robot. If an installed planner fails, it raises `PartFailed` and no other exception."""

    def plan(self, costs: Costs, frame: CostFrame, start: Pose2, goal: Pose2) -> Path | PlanRefusal:
        """Plan a path at once. See `search`."""

    def reached(self, costs: Costs, frame: CostFrame, start: Pose2) -> NDArray[np.bool_]:
        """Return a (rows, cols) mask of the cells where a path from a start may end. See `search` for the arguments."""


class PlannerFactory(Protocol):
    """Factory of an installed global planner."""

    def __call__(self, parameters: RobotParameters, seed: int, /) -> RobotPathPlanner:
        """Return the planner of a robot with these parameters. `seed` is different for each robot."""
        ...


def headings(points: FloatArray, last: float) -> FloatArray:
    """Return (m, 3) poses on (m, 2) points. Each faces the next pose, and the last pose has the heading `last`."""
    steps = np.diff(points, axis=0)
    return np.column_stack([points, np.append(elementary_arrays.atan2(steps[:, 1], steps[:, 0]), last)])
