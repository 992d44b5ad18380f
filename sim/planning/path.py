"""A way through the map, or why there is none."""

from dataclasses import dataclass
from typing import Literal

import numpy as np

from sim.geometry import FloatArray

RefusalCode = Literal[
    "goal_occupied",
    "goal_outside",
    "start_occupied",
    "start_outside",
    "no_way",
    "robots_in_the_way",
    "blocked_by_obstacle",
]


@dataclass(frozen=True, slots=True)
class Path:
    """Poses from start to goal.

    Attributes:
        poses: (m, 3) in the map, metres and radians; each heads for the next, the last has the goal's own heading.
    """

    poses: FloatArray

    @property
    def length(self) -> float:
        """Metres."""
        return float(np.hypot(*np.diff(self.poses[:, :2], axis=0).T).sum())


@dataclass(frozen=True, slots=True)
class Refused:
    """There is no path.

    Attributes:
        code: the cause, stable for programs.
        sentence: the cause for people.
    """

    code: RefusalCode
    sentence: str


def headings(points: FloatArray, last: float) -> FloatArray:
    """(m, 3) poses on (m, 2) points: each heads for the next, the last has the heading given."""
    steps = np.diff(points, axis=0)
    return np.column_stack([points, np.append(np.arctan2(steps[:, 1], steps[:, 0]), last)])


def thinned(points: FloatArray, spacing: float) -> FloatArray:
    """(k, 2) of (m, 2) points: both ends, and those at least `spacing` metres apart."""
    kept = [0]
    for i in range(1, len(points) - 1):
        dx, dy = points[i] - points[kept[-1]]
        if dx * dx + dy * dy >= spacing * spacing:
            kept.append(i)
    kept.append(len(points) - 1)
    return points[kept]
