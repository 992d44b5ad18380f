"""Costmap for readers outside the navigator."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from sim.common.geometry import Pose2

CostmapName = Literal["global_costmap", "local_costmap"]
"""Name of one of a robot's costmaps."""


@dataclass(frozen=True, slots=True, eq=False)
class CostmapView:
    """The costs of a grid at one moment.

    Attributes:
        tick: time of the costs.
        origin: pose of the grid's first corner, map frame.
        resolution: side of a cell, meters.
        costs: (rows, cols) uint8, read-only, see `sim.robot.costmap.costs`. Row 0 is the lowest.
    """

    tick: int
    origin: Pose2
    resolution: float
    costs: NDArray[np.uint8]


class ShownCostmap:
    """A costmap that is published in a tick. It is computed when it is first read, because most are never read.

    Args:
        compute: function that returns the costmap. It is called before the costmap changes, or never.
    """

    def __init__(self, compute: Callable[[], CostmapView]) -> None:
        self._compute: Callable[[], CostmapView] | None = compute
        self._view: CostmapView | None = None

    def read(self) -> CostmapView:
        """Return the costmap. It must be read for the first time before the robot's next step.

        Raises:
            RuntimeError: the costmap has changed, and it was not read before.
        """
        if self._view is None:
            if self._compute is None:
                raise RuntimeError("the costmap has changed. Read it before the robot's next step.")
            self._view = self._compute()
        return self._view

    def expire(self) -> None:
        """Record that the costmap changes now. If it has not been read, it can no longer be read."""
        self._compute = None
