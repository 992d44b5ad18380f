"""A thing: a body that no map shows, and its walking path."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from sim.common.geometry import Pose2
from sim.numerics import elementary, elementary_arrays
from sim.numerics.float_array import FloatArray


@dataclass(frozen=True)
class Thing:
    """A body and its walking path.

    Attributes:
        name: its name for people, unique within a world.
        footprint: corners in its own frame, meters, in order.
        base_in_map: pose at which it appears.
        path: map points to which it walks from there, one after another, facing ahead. Empty if it stands still.
        speed: walking speed, m/s.
        back_and_forth: True if it turns back at the end of the path, False if it stops there.
    """

    name: str
    footprint: tuple[tuple[float, float], ...]
    base_in_map: Pose2
    path: tuple[tuple[float, float], ...] = ()
    speed: float = 0.0
    back_and_forth: bool = False

    def __post_init__(self) -> None:
        """Refuse a thing that has no body or cannot walk.

        Raises:
            ValueError: it has fewer than three corners, or its path has a point twice in a row.
        """
        if len(self.footprint) < 3:
            raise ValueError(f"the body of {self.name} must have at least three corners, not {len(self.footprint)}")
        if (np.diff(self._distances) == 0.0).any():
            raise ValueError(f"the path of {self.name} contains the same point twice in a row")

    @cached_property
    def corners(self) -> FloatArray:
        """(v, 2) footprint, for kernels."""
        return np.array(self.footprint, dtype=np.float64)

    @cached_property
    def _points(self) -> FloatArray:
        """(m, 2) points of its path, beginning with the start."""
        return np.array([(self.base_in_map.x, self.base_in_map.y), *self.path])

    @cached_property
    def _distances(self) -> FloatArray:
        """(m,) meters from the start to each point."""
        return np.concatenate(([0.0], np.cumsum(elementary_arrays.hypot(*np.diff(self._points, axis=0).T))))

    @property
    def length(self) -> float:
        """Length of its path, meters."""
        return float(self._distances[-1])

    def pose_after(self, walked: float) -> Pose2:
        """Return the pose after `walked` meters of its path."""
        if self.length == 0.0:
            return self.base_in_map
        leg = min(int(np.searchsorted(self._distances, walked, side="right")), len(self._distances) - 1)
        (x0, y0), (x1, y1) = self._points[leg - 1 : leg + 1].tolist()
        share = (walked - float(self._distances[leg - 1])) / elementary.hypot(x1 - x0, y1 - y0)
        return Pose2(x0 + share * (x1 - x0), y0 + share * (y1 - y0), elementary.atan2(y1 - y0, x1 - x0))
