"""Maps with a rotated origin: a robot plans in the frame of the grid.

The sides of cells are parallel to the axes of this frame, so all parts of a navigator use it. Only this module converts
poses between the two frames. If the origin is not rotated, nothing changes.
"""

from collections.abc import Sequence
from dataclasses import replace

from sim.common.geometry import IDENTITY, Pose2
from sim.common.grid import OccupancyGrid
from sim.common.observations import Neighbour
from sim.numerics.float_array import FloatArray


class RotatedMap:
    """Converter of poses from the map's frame to a frame along the axes of the map's cells, and back.

    Args:
        static: the map.

    Attributes:
        grid: the same cells in the second frame.
    """

    def __init__(self, static: OccupancyGrid) -> None:
        self._turned = static.origin.theta != 0.0
        self._grid_in_map = static.origin
        self._map_in_grid = static.origin.inverse()
        self.grid = OccupancyGrid(static.cells, static.resolution, IDENTITY) if self._turned else static

    def pose_in_grid(self, in_map: Pose2) -> Pose2:
        """Convert a pose from the map's frame to the grid's frame."""
        return self._map_in_grid.compose(in_map) if self._turned else in_map

    def neighbours_in_grid(self, in_map: Sequence[Neighbour]) -> Sequence[Neighbour]:
        """Convert the broadcasts of other robots from the map's frame to the grid's frame."""
        if not self._turned:
            return in_map
        return [
            replace(
                other, base_in_map=self.pose_in_grid(other.base_in_map), path=self._map_in_grid.transform(other.path)
            )
            for other in in_map
        ]

    def poses_in_map(self, in_grid: FloatArray) -> FloatArray:
        """Convert (m, 3) poses from the grid's frame to the map's frame."""
        if not self._turned:
            return in_grid
        out = in_grid.copy()
        out[:, :2] = self._grid_in_map.transform(in_grid[:, :2])
        out[:, 2] += self._grid_in_map.theta
        return out
