"""Picture of a localization: the estimated path over the map, with marks where the robot was lost."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from numpy.typing import NDArray

from sim.common.grid import OccupancyGrid
from sim.numerics.float_array import FloatArray
from thbridge.offline.localize import LocalizationResult
from thbridge.offline.map_picture import grid_bounds, map_figure, picture_settings

_TRACKED = "#0072B2"
_LOST = "#D55E00"
_JUMP = 1.0
"""The path has a gap if the distance between two updates is above this, meters. It is then a jump of the pose."""
_MARGIN = 5.0
"""Margin of the map around the path, meters.

The other parts of the map are not shown, because large parts of many maps are unknown.
"""


def localization_picture(result: LocalizationResult, grid: OccupancyGrid, title: str) -> Figure:
    """Draw the path of a localization with at least one update. The same result gives the same picture."""
    poses = np.array([update.base_in_map.array() for update in result.updates])
    lost = np.array([update.lost for update in result.updates])
    jumps = np.abs(np.diff(poses[:, :2], axis=0)).max(axis=1, initial=0.0) > _JUMP
    with picture_settings():
        figure, axes = map_figure(grid, _view(poses[:, :2], grid))
        _draw_path(axes, poses, ~lost[1:] & ~jumps, _TRACKED)
        _draw_path(axes, poses, lost[1:] & ~jumps, _LOST)
        axes.plot(*poses[lost, :2].T, ".", color=_LOST, markersize=5, zorder=3)
        axes.plot(*poses[0, :2], "o", color=_TRACKED, markersize=7, zorder=4)
        axes.plot(*poses[-1, :2], "s", color=_TRACKED, markersize=7, zorder=4)
        keys = [Line2D([], [], color=_TRACKED, label="path")]
        if lost.any():
            keys.append(Line2D([], [], color=_LOST, marker=".", label=f"lost ({lost.sum()} of {len(lost)} updates)"))
        axes.legend(handles=keys, loc="upper right")
        axes.set_xlabel("x, m    ● first update   ■ last update")
        axes.set_title(title)
    return figure


def _view(places: FloatArray, grid: OccupancyGrid) -> FloatArray:
    """Return (2, 2) minimum and maximum x and y of the view: the path with a margin, limited to the map."""
    low, high = grid_bounds(grid)
    least, greatest = places.min(axis=0), places.max(axis=0)
    low = np.maximum(np.minimum(low, least), least - _MARGIN)
    high = np.minimum(np.maximum(high, greatest), greatest + _MARGIN)
    return np.array([low, high])


def _draw_path(axes: Axes, poses: FloatArray, drawn: NDArray[np.bool_], colour: str) -> None:
    """Draw the lines between n poses for which `drawn` (n - 1) is True."""
    lines = np.stack([poses[:-1, :2], poses[1:, :2]], axis=1)[drawn]
    axes.add_collection(LineCollection(list(lines), colors=colour, linewidths=1.4))
