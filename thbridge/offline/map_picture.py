"""Picture of a map: its cells, rooms with numbers and names, doors, goals and start poses."""

import math

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import ListedColormap
from matplotlib.figure import Figure
from matplotlib.patches import Polygon as PolygonPatch
from matplotlib.transforms import Affine2D

from sim.common.geometry import Pose2
from sim.common.grid import FREE, OCCUPIED, OccupancyGrid
from thbridge.offline.map_survey import MapSurvey

_SHADES = ListedColormap(["#ffffff", "#1f2933", "#d5dae0"])
"""Of free, occupied and unknown cells."""
_TINTS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#7A5195", "#8C6D31")
"""Of rooms, in turn; Okabe and Ito's, then two darker ones."""
_DOOR = "#B2182B"
_INK = "#1f2933"
_WIDTH = 10.0
"""Inches of the longer side."""
_ARROW = 0.4
"""Length of the arrow along a pose's yaw, metres."""


def map_picture(seen: MapSurvey) -> Figure:
    """Draw a map. The same map gives the same picture."""
    place = seen.place
    grid = place.grid
    width, height = grid.cols * grid.resolution, grid.rows * grid.resolution
    scale = _WIDTH / max(width, height)
    with mpl.rc_context({"font.family": "DejaVu Sans", "font.size": 9}):
        figure = Figure(figsize=(max(4.0, width * scale), max(3.0, height * scale)), layout="constrained", dpi=120)
        axes = figure.add_subplot()
        axes.set_autoscale_on(False)
        _draw_cells(axes, grid)
        for index, entry in enumerate(seen.rooms):
            room, tint = entry.room, _TINTS[index % len(_TINTS)]
            outline = PolygonPatch(room.region, facecolor=tint, edgecolor=tint, alpha=0.25, linewidth=1.5)
            axes.add_patch(outline)
            _draw_pose(axes, room.goal, tint, "o")
            label = f"{room.room.people}  {room.name}\n{entry.area:.1f} m²"
            axes.annotate(
                label, (room.goal.x, room.goal.y), (0, 9), textcoords="offset points", ha="center", color=_INK
            )
            for door in entry.doors:
                axes.plot(door.x, door.y, "D", color=_DOOR, markersize=5)
        for number, start in enumerate(place.starts, start=1):
            _draw_pose(axes, start, _INK, "s")
            axes.annotate(str(number), (start.x, start.y), (5, -10), textcoords="offset points", color=_INK, fontsize=7)
        axes.set_aspect("equal")
        axes.set_xlabel("x, m    ● goal   ■ start of a robot   ◆ door")
        axes.set_ylabel("y, m")
        axes.set_title(place.name)
    return figure


def _draw_cells(axes: Axes, grid: OccupancyGrid) -> None:
    shades = np.where(grid.cells == FREE, 0, np.where(grid.cells == OCCUPIED, 1, 2))
    width, height = grid.cols * grid.resolution, grid.rows * grid.resolution
    placed = Affine2D().rotate(grid.origin.theta).translate(grid.origin.x, grid.origin.y)
    axes.imshow(
        shades,
        cmap=_SHADES,
        vmin=0,
        vmax=2,
        origin="lower",
        extent=(0.0, width, 0.0, height),
        interpolation="nearest",
        transform=placed + axes.transData,
    )
    corners = grid.origin.transform(np.array([[0.0, 0.0], [width, 0.0], [width, height], [0.0, height]]))
    (left, low), (right, high) = corners.min(axis=0), corners.max(axis=0)
    axes.set_xlim(left, right)
    axes.set_ylim(low, high)


def _draw_pose(axes: Axes, pose: Pose2, colour: str, marker: str) -> None:
    axes.plot(pose.x, pose.y, marker, color=colour, markersize=5)
    ahead = pose.x + _ARROW * math.cos(pose.theta), pose.y + _ARROW * math.sin(pose.theta)
    axes.plot([pose.x, ahead[0]], [pose.y, ahead[1]], color=colour, linewidth=1.2)
