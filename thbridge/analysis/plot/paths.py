"""Figure of the robots' paths on the map."""

from collections.abc import Sequence

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import ListedColormap, NoNorm
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import MaxNLocator

from sim.common.grid import OCCUPIED, UNKNOWN, OccupancyGrid
from sim.common.robot_colors import robot_color
from sim.numerics.float_array import FloatArray
from thbridge.analysis.plot.style import FAINT, INK, FigureStyle, label_above, robot_handles
from thbridge.analysis.plot.thinning import simplified
from thbridge.analysis.report.paths import pieces
from thbridge.analysis.report.report import Report

_THING = "#f0b429"


def paths(report: Report, style: FigureStyle) -> Figure | None:
    """Draw the map with obstacles and paths: true paths are broad, estimated paths narrow.

    If no poses on the map are known, draw the odometry paths without the map, because each path has its own origin.
    """
    placed = any(len(track.truth) or len(track.estimate) for track in report.tracks)
    counted = not placed and any(len(track.odometry) for track in report.tracks)
    grid = None if counted else report.grid
    robot_paths = [(track.odometry,) if counted else (track.truth, track.estimate) for track in report.tracks]
    robot_cuts = [(track.reset,) if counted else (track.carried, track.relocated) for track in report.tracks]
    seen = [path[:, 1:3] for own_paths in robot_paths for path in own_paths if len(path)]
    if not seen and grid is None:
        return None
    left, right, bottom, top = _extent(grid, seen)
    # The legend of the robots needs one line, and the axis labels need another.
    height = style.width * (top - bottom) / (right - left) + 6.0 * style.font / 72.0
    figure, ((axes,),) = style.figure(min(max(height, 0.3 * style.width), 1.4 * style.width))
    axes.grid(visible=False)
    if grid is not None:
        _draw_grid(axes, grid)
    for thing in () if counted else report.things:
        axes.fill(thing.outline[:, 0], thing.outline[:, 1], fc=_THING, ec=INK, lw=0.6, alpha=0.8, zorder=1)
        walk = simplified(thing.path)
        axes.plot(walk[:, 0], walk[:, 1], ":", color=INK, lw=0.8, zorder=1)
        axes.annotate(thing.name, thing.outline[:, :2].max(axis=0), color=INK, fontsize=style.font - 2, zorder=4)
    styles = (
        (("odometry", style.line, 1.0, "--"),)
        if counted
        else (("true", 4.0 * style.line, 0.35, "-"), ("estimated", style.line, 1.0, "-"))
    )
    mark = 0.75 * style.font
    for index, own_paths in enumerate(robot_paths):
        tint = robot_color(index)
        for path, cuts, (_, width, alpha, line) in zip(own_paths, robot_cuts[index], styles, strict=True):
            for piece in pieces(path, cuts):
                x, y = simplified(piece[:, 1:3]).T
                axes.plot(x, y, line, color=tint, lw=width, alpha=alpha, solid_capstyle="round", zorder=2)
        best = next((path for path in own_paths if len(path)), None)
        if best is not None:
            axes.plot(*best[0, 1:3], "o", ms=mark, mfc="white", mec=tint, mew=1.2, zorder=3)
            axes.plot(*best[-1, 1:3], "o", ms=mark, color=tint, mec="white", zorder=3)
    axes.set_aspect("equal")
    axes.set_xlim(left, right)
    axes.set_ylim(bottom, top)
    for axis in (axes.xaxis, axes.yaxis):
        axis.set_major_locator(MaxNLocator(5 if style.narrow else 9, integer=True))
    axes.set_xlabel("x, m")
    axes.set_ylabel("y, m")
    kinds = [
        Line2D([], [], color=FAINT, lw=width, alpha=max(alpha, 0.6), label=name, ls=line)
        for kind, (name, width, alpha, line) in enumerate(styles)
        if any(len(own_paths[kind]) for own_paths in robot_paths)
    ]
    label_above(axes, [*robot_handles(report.tracks), *kinds], 3 if style.narrow else 8)
    return figure


def _extent(grid: OccupancyGrid | None, seen: Sequence[FloatArray]) -> tuple[float, float, float, float]:
    """Return left, right, bottom, top of the figure: the known part of the map, and the paths."""
    known = [] if grid is None else [_corners(grid)]
    points = np.vstack([*known, *seen])
    low, high = points.min(axis=0), points.max(axis=0)
    # The map includes a margin. Even short paths need a margin.
    margin = 0.0 if known else 0.5 + 0.05 * float((high - low).max())
    return (
        float(low[0]) - margin,
        float(high[0]) + margin,
        float(low[1]) - margin,
        float(high[1]) + margin,
    )


def _corners(grid: OccupancyGrid) -> FloatArray:
    """Return the corners of the known part of the map: mapping programs add much unknown space around it."""
    rows, cols = (np.flatnonzero((grid.cells != UNKNOWN).any(axis=axis)) for axis in (1, 0))
    if not len(rows):
        rows, cols = np.arange(grid.rows), np.arange(grid.cols)
    left, right, bottom, top = cols[0], cols[-1] + 1, rows[0], rows[-1] + 1
    unit = np.array([[left, bottom], [right, bottom], [right, top], [left, top]], dtype=np.float64)
    return grid.origin.transform(unit * grid.resolution)


def _draw_grid(axes: Axes, grid: OccupancyGrid) -> None:
    """Draw walls dark, free space white, unknown space gray, rotated by the map's origin."""
    kinds = np.full(grid.cells.shape, 1, dtype=np.uint8)
    kinds[grid.cells == 0] = 0
    kinds[grid.cells == OCCUPIED] = 2
    image = axes.imshow(
        kinds,
        cmap=ListedColormap(["#ffffff", "#e4e7eb", "#52606d"]),
        norm=NoNorm(),
        origin="lower",
        interpolation="nearest",
        extent=(0.0, grid.cols * grid.resolution, 0.0, grid.rows * grid.resolution),
        zorder=0,
    )
    turned = mpl.transforms.Affine2D().rotate(grid.origin.theta).translate(grid.origin.x, grid.origin.y)
    image.set_transform(turned + axes.transData)
