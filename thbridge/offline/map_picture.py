"""Picture of a map: its cells, rooms with numbers and names, doors, goals and start poses."""

import math
from contextlib import AbstractContextManager

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import ListedColormap
from matplotlib.figure import Figure
from matplotlib.patches import Polygon as PolygonPatch
from matplotlib.transforms import Affine2D

from sim.common.geometry import Pose2
from sim.common.grid import FREE, OCCUPIED, OccupancyGrid
from sim.numerics.float_array import FloatArray
from thbridge.offline.map_survey import MapSurvey

_SHADES = ListedColormap(["#ffffff", "#1f2933", "#d5dae0"])
"""Colors of free, occupied and unknown cells."""
_TINTS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#7A5195", "#8C6D31")
"""Colors of rooms, used in turn: six colors of Okabe and Ito, then two darker colors."""
_DOOR = "#B2182B"
_INK = "#1f2933"
_WIDTH = 10.0
"""Length of the picture's longer side, inches."""
_SIZE, _SMALLEST = 9.0, 4.5
"""Usual font size, and minimum font size in narrow rooms, points."""
_ARROW = 0.4
"""Length of the arrow along a pose's yaw, meters."""


def picture_settings() -> AbstractContextManager[None]:
    """Return Matplotlib settings that give the same picture on all machines."""
    return mpl.rc_context({"font.family": "DejaVu Sans", "font.size": _SIZE, "svg.hashsalt": "thbridge"})


def map_picture(seen: MapSurvey) -> Figure:
    """Draw a map. The same map gives the same picture."""
    place = seen.place
    grid = place.grid
    with picture_settings():
        figure, axes = map_figure(grid, grid_bounds(grid))
        for index, entry in enumerate(seen.rooms):
            room, tint = entry.room, _TINTS[index % len(_TINTS)]
            outline = PolygonPatch(room.region, facecolor=tint, edgecolor=tint, alpha=0.25, linewidth=1.5)
            axes.add_patch(outline)
            _draw_pose(axes, room.goal, tint, "o")
            label = f"{room.room.people}  {room.name}\n{entry.area:.1f} m²"
            axes.annotate(
                label,
                (room.goal.x, room.goal.y),
                (0, 9),
                textcoords="offset points",
                ha="center",
                color=_INK,
                fontsize=_fitting(label, np.ptp([x for x, _ in room.region]) / np.ptp(axes.get_xlim()) * _WIDTH),
            )
            for door in entry.doors:
                axes.plot(door.x, door.y, "D", color=_DOOR, markersize=5)
        for number, start in enumerate(place.starts, start=1):
            _draw_pose(axes, start, _INK, "s")
            axes.annotate(str(number), (start.x, start.y), (5, -10), textcoords="offset points", color=_INK, fontsize=7)
        axes.set_xlabel("x, m    ● goal   ■ start of a robot   ◆ door")
        axes.set_title(place.name)
    return figure


def _fitting(label: str, width: float) -> float:
    """Return the font size (points) for a label in a room of this width (inches), limited to readable sizes."""
    across = 0.7 * max(len(line) for line in label.splitlines())
    return float(np.clip(72.0 * width / across, _SMALLEST, _SIZE))


def grid_bounds(grid: OccupancyGrid) -> FloatArray:
    """Return (2, 2) minimum and maximum x and y of a map's corners, map frame, meters."""
    width, height = grid.cols * grid.resolution, grid.rows * grid.resolution
    corners = grid.origin.transform(np.array([[0.0, 0.0], [width, 0.0], [width, height], [0.0, height]]))
    return np.array([corners.min(axis=0), corners.max(axis=0)])


def map_figure(grid: OccupancyGrid, view: FloatArray) -> tuple[Figure, Axes]:
    """Return a figure with the cells of a map, and axes in meters, map frame. Call this within `picture_settings`.

    Args:
        grid: the map.
        view: (2, 2) minimum and maximum x and y of the view.
    """
    shown = view[1] - view[0]
    width, height = (shown * _WIDTH / shown.max()).tolist()
    figure = Figure(figsize=(max(4.0, width), max(3.0, height)), layout="constrained", dpi=120)
    axes = figure.add_subplot()
    axes.set_autoscale_on(False)
    shades = np.where(grid.cells == FREE, 0, np.where(grid.cells == OCCUPIED, 1, 2))
    placed = Affine2D().rotate(grid.origin.theta).translate(grid.origin.x, grid.origin.y)
    axes.imshow(
        shades,
        cmap=_SHADES,
        vmin=0,
        vmax=2,
        origin="lower",
        extent=(0.0, grid.cols * grid.resolution, 0.0, grid.rows * grid.resolution),
        interpolation="nearest",
        transform=placed + axes.transData,
    )
    axes.set_xlim(*view[:, 0])
    axes.set_ylim(*view[:, 1])
    axes.set_aspect("equal")
    axes.set_xlabel("x, m")
    axes.set_ylabel("y, m")
    return figure, axes


def _draw_pose(axes: Axes, pose: Pose2, colour: str, marker: str) -> None:
    axes.plot(pose.x, pose.y, marker, color=colour, markersize=5)
    ahead = pose.x + _ARROW * math.cos(pose.theta), pose.y + _ARROW * math.sin(pose.theta)
    axes.plot([pose.x, ahead[0]], [pose.y, ahead[1]], color=colour, linewidth=1.2)
