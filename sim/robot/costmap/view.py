"""Costmap for readers outside the navigator."""

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
