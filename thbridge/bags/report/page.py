"""A session's report as one HTML page that needs nothing but itself: figures are drawn into it as SVG."""

from collections.abc import Sequence
from contextlib import AbstractContextManager
from dataclasses import dataclass
from io import StringIO
from pathlib import Path

import matplotlib as mpl
import numpy as np
from jinja2 import Environment, StrictUndefined
from markupsafe import Markup
from matplotlib.axes import Axes
from matplotlib.colors import ListedColormap
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import FuncFormatter, MaxNLocator, MultipleLocator

from sim.geometry import FloatArray
from sim.grid import OCCUPIED, OccupancyGrid
from thbridge.adapters.bag_reader import messages
from thbridge.bags.report.gathering import read_report
from thbridge.bags.report.values import Leg, Report, Track

COLOURS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#7A5195", "#8C6D31", "#4D4D4D", "#B2182B")
"""A colour a robot, told apart by colour-blind readers too (Okabe and Ito's, then darker ones)."""

_INK = "#1f2933"
_FAINT = "#9aa5b1"
_POINTS = 700
"""Points a curve is drawn with; the page would grow with the session otherwise."""

_OUTCOME_ALPHA = {"arrived": 0.9, "no path": 0.3, "cancelled": 0.3}


def _style(salt: str = "") -> AbstractContextManager[None]:
    """How figures look. Names within the SVG are hashes of this salt and what they name: nothing random."""
    return mpl.rc_context(
        {
            "svg.hashsalt": salt,
            "svg.fonttype": "none",
            "font.family": "DejaVu Sans",  # matplotlib's own, wider than what the page's style puts in its place
            "font.size": 9,
            "axes.edgecolor": _FAINT,
            "axes.labelcolor": _INK,
            "axes.spines.top": False,
            "axes.spines.right": False,
            "axes.grid": True,
            "axes.axisbelow": True,
            "grid.color": "#e4e7eb",
            "grid.linewidth": 0.7,
            "text.color": _INK,
            "xtick.color": _INK,
            "ytick.color": _INK,
        }
    )


def build_report(bag: Path, grid: OccupancyGrid | None = None) -> str:
    """The report of a bag as HTML; the same bag gives the same page.

    Args:
        bag: ours, or another robot's.
        grid: the map, in place of the bag's own.

    Raises:
        BadFile: the bag cannot be read; says what to do.
    """
    return render(read_report(messages(bag), grid), bag.name)


def render(report: Report, name: str) -> str:
    """A report as HTML.

    Args:
        report: what to show.
        name: of the bag, for the title.
    """
    figures = []
    if any(len(track.truth) or len(track.estimate) for track in report.tracks) or report.grid is not None:
        figures.append(_Figure("Paths", _PATHS_CAPTION, _map_figure(report)))
    if any(len(track.errors) for track in report.tracks):
        figures.append(_Figure("Localisation error", _ERROR_CAPTION, _error_figure(report)))
    if any(len(track.energy) for track in report.tracks):
        figures.append(_Figure("Energy", "What each robot had left.", _energy_figure(report)))
    if report.moments or any(track.legs for track in report.tracks):
        figures.append(_Figure("Timeline", _TIMELINE_CAPTION, _timeline_figure(report)))
    environment = Environment(autoescape=True, undefined=StrictUndefined, trim_blocks=True, lstrip_blocks=True)
    template = environment.from_string(Path(__file__).with_name("page.html").read_text(encoding="utf-8"))
    return template.render(
        name=name,
        report=report,
        figures=[{"title": f.title, "caption": f.caption, "svg": _svg(f.figure, f.title)} for f in figures],
        summary=_summary(report),
        robots=[_robot_row(index, track) for index, track in enumerate(report.tracks)],
        points=[moment for moment in report.moments if moment.points is not None],
        clock=_clock,
    )


@dataclass(frozen=True, slots=True)
class _Figure:
    title: str
    caption: str
    figure: Figure


_PATHS_CAPTION = (
    "Broad: where the robot was. Narrow: where it believed itself to be. A ring marks the start, a dot the end. "
    "Yellow: things in the way, where they were first; dotted: where they walked."
)
_ERROR_CAPTION = "Distance and angle between where a robot was and where it believed itself to be."
_TIMELINE_CAPTION = (
    "Bars: under way to a goal; pale ones did not get there. Diamonds: events of the game. "
    "Strokes below: what was said."
)


def _clock(seconds: float) -> str:
    """Minutes and seconds: 75.3 is 1:15."""
    return f"{int(seconds) // 60}:{int(seconds) % 60:02d}"


def _summary(report: Report) -> list[tuple[str, str]]:
    """The figures at the top: label and value."""
    cards = [("Duration", f"{_clock(report.duration)} min"), ("Robots", str(len(report.tracks)))]
    if report.tracks:
        cards.append(("Driven", f"{sum(track.distance for track in report.tracks):.1f} m"))
    if report.score is not None:
        cards.append(("Score", f"{report.score.score}"))
        cards.append(("Rooms visited", f"{report.score.visited} of {report.score.rooms}"))
    errors = [track.errors[:, 1] for track in report.tracks if len(track.errors)]
    if errors:
        cards.append(("Localisation RMSE", f"{100 * _rms(np.concatenate(errors)):.1f} cm"))
    if report.inputs:
        cards.append(("Inputs", str(report.inputs)))
    return cards


def _rms(values: FloatArray) -> float:
    return float(np.sqrt(np.mean(values**2)))


def _robot_row(index: int, track: Track) -> dict[str, str]:
    unknown = "–"
    errors, energy = track.errors, track.energy
    arrived = sum(leg.outcome == "arrived" for leg in track.legs)
    return {
        "name": track.name,
        "colour": _colour(index),
        "distance": f"{track.distance:.1f}",
        "goals": f"{arrived} of {len(track.legs)}" if track.legs else unknown,
        "rmse": f"{100 * _rms(errors[:, 1]):.1f}" if len(errors) else unknown,
        "worst": f"{100 * errors[:, 1].max():.1f}" if len(errors) else unknown,
        "turn": f"{np.degrees(_rms(errors[:, 2])):.2f}" if len(errors) else unknown,
        "energy": f"{energy[0, 1]:.0f} → {energy[-1, 1]:.0f}" if len(energy) else unknown,
    }


def _colour(index: int) -> str:
    return COLOURS[index % len(COLOURS)]


def _svg(figure: Figure, salt: str) -> Markup:
    """The figure as an element for the page; `salt` keeps the names in it apart from those of other figures."""
    text = StringIO()
    with _style(salt):
        figure.savefig(text, format="svg", metadata={"Date": None, "Creator": None}, transparent=True)
    drawn = text.getvalue()
    # Matplotlib made it and it escapes the words in it.
    return Markup(drawn[drawn.index("<svg") :])


def _axes(height: float, rows: int = 1, ratios: Sequence[float] = (1.0,)) -> tuple[Figure, list[Axes]]:
    with _style():
        figure = Figure(figsize=(9.2, height), layout="constrained")
        grid = figure.subplots(rows, 1, sharex=True, squeeze=False, gridspec_kw={"height_ratios": ratios})
    return figure, [row[0] for row in grid]


def _minutes(axes: Axes, duration: float) -> None:
    axes.set_xlim(0.0, max(duration, 1e-3))
    axes.xaxis.set_major_locator(MaxNLocator(9, steps=[1, 1.5, 3, 6, 10]))
    axes.xaxis.set_major_formatter(FuncFormatter(lambda seconds, _: _clock(seconds)))
    axes.set_xlabel("time, min:s")


def _legend(axes: Axes, tracks: Sequence[Track]) -> None:
    handles = [Line2D([], [], color=_colour(index), lw=2.5, label=track.name) for index, track in enumerate(tracks)]
    axes.legend(
        handles=handles,
        loc="lower left",
        bbox_to_anchor=(0.0, 1.0),
        ncols=10,
        borderaxespad=0.2,
        handlelength=1,
        frameon=False,
    )


def _map_figure(report: Report) -> Figure:
    figure, (axes,) = _axes(6.6)
    axes.grid(visible=False)
    if report.grid is not None:
        _draw_grid(axes, report.grid)
    for thing in report.things:
        axes.fill(thing.outline[:, 0], thing.outline[:, 1], fc="#f0b429", ec=_INK, lw=0.8, alpha=0.8, zorder=1)
        way = _simplified(thing.path)
        axes.plot(way[:, 0], way[:, 1], ":", color=_INK, lw=1.0, zorder=1)
        axes.annotate(thing.name, thing.outline[:, :2].max(axis=0), color=_INK, fontsize=7, zorder=4)
    for index, track in enumerate(report.tracks):
        colour = _colour(index)
        for path, width, alpha in ((track.truth, 4.5, 0.35), (track.estimate, 1.1, 1.0)):
            line = _simplified(path[:, 1:3])
            axes.plot(line[:, 0], line[:, 1], color=colour, lw=width, alpha=alpha, solid_capstyle="round", zorder=2)
        path = track.truth if len(track.truth) else track.estimate
        if len(path):
            start, end = path[0, 1:3], path[-1, 1:3]
            axes.plot(*start, "o", ms=7, mfc="white", mec=colour, mew=1.6, zorder=3)
            axes.plot(*end, "o", ms=7, color=colour, mec="white", zorder=3)
    axes.set_aspect("equal")
    for axis in (axes.xaxis, axes.yaxis):
        axis.set_major_locator(MaxNLocator(9, integer=True))
    axes.set_xlabel("x, m")
    axes.set_ylabel("y, m")
    _legend(axes, report.tracks)
    return figure


def _draw_grid(axes: Axes, grid: OccupancyGrid) -> None:
    """Walls dark, free space white, the rest grey; turned with the map's origin."""
    kinds = np.full(grid.cells.shape, 1, dtype=np.uint8)
    kinds[grid.cells == 0] = 0
    kinds[grid.cells == OCCUPIED] = 2
    corners = np.array([[0.0, 0.0], [grid.cols, 0.0], [grid.cols, grid.rows], [0.0, grid.rows]]) * grid.resolution
    placed = grid.origin.transform(corners)
    image = axes.imshow(
        kinds,
        cmap=ListedColormap(["#ffffff", "#e4e7eb", "#52606d"]),
        vmin=0,
        vmax=2,
        origin="lower",
        interpolation="nearest",
        extent=(0.0, grid.cols * grid.resolution, 0.0, grid.rows * grid.resolution),
        zorder=0,
    )
    turned = mpl.transforms.Affine2D().rotate(grid.origin.theta).translate(grid.origin.x, grid.origin.y)
    image.set_transform(turned + axes.transData)
    axes.set_xlim(placed[:, 0].min(), placed[:, 0].max())
    axes.set_ylim(placed[:, 1].min(), placed[:, 1].max())


def _error_figure(report: Report) -> Figure:
    figure, (metres, angle) = _axes(4.4, 2, (2.0, 1.0))
    for index, track in enumerate(report.tracks):
        colour = _colour(index)
        far = _peaks(track.errors[:, :2])
        metres.plot(far[:, 0], 100.0 * far[:, 1], color=colour, lw=1.1)
        turned = _peaks(track.errors[:, ::2])
        angle.plot(turned[:, 0], np.degrees(turned[:, 1]), color=colour, lw=1.1)
    metres.set_ylabel("position, cm")
    angle.set_ylabel("heading, °")
    # From zero, and not so fine that rounding looks like an error.
    metres.set_ylim(0.0, max(1.0, metres.get_ylim()[1]))
    angle.set_ylim(0.0, max(0.5, angle.get_ylim()[1]))
    _minutes(angle, report.duration)
    _legend(metres, report.tracks)
    return figure


def _energy_figure(report: Report) -> Figure:
    figure, (axes,) = _axes(2.8)
    for index, track in enumerate(report.tracks):
        changes = _changes(track.energy)
        axes.step(changes[:, 0], changes[:, 1], where="post", color=_colour(index), lw=1.6)
    axes.axhline(0.0, color=_FAINT, lw=1.0)
    axes.set_ylabel("energy left")
    _minutes(axes, report.duration)
    _legend(axes, report.tracks)
    return figure


def _timeline_figure(report: Report) -> Figure:
    rows = [track.name for track in report.tracks]
    talk = [moment for moment in report.moments if moment.kind == "said"]
    events = [moment for moment in report.moments if moment.kind != "said"]
    labels = [*rows, *(["game"] if any(e.who not in rows for e in events) else []), *(["talk"] if talk else [])]
    figure, (axes,) = _axes(1.0 + 0.36 * len(labels))
    for index, track in enumerate(report.tracks):
        _draw_legs(axes, index, track.legs)
    for event in events:
        row = rows.index(event.who) if event.who in rows else len(rows)
        axes.plot(event.time, row, "D", ms=4.5, color=_INK, mec="white", mew=0.7, zorder=3)
    if talk:
        axes.vlines([said.time for said in talk], len(labels) - 1.3, len(labels) - 0.7, color="#52606d", lw=1.0)
    axes.set_yticks(range(len(labels)), labels)
    axes.set_ylim(len(labels) - 0.4, -0.6)
    axes.grid(visible=False, axis="y")
    axes.tick_params(axis="y", length=0)
    axes.yaxis.set_minor_locator(MultipleLocator(1.0))
    _minutes(axes, report.duration)
    return figure


def _draw_legs(axes: Axes, row: int, legs: Sequence[Leg]) -> None:
    for leg in legs:
        alpha = _OUTCOME_ALPHA.get(leg.outcome, 0.6)
        axes.barh(
            row, leg.end - leg.start, left=leg.start, height=0.46, color=_colour(row), alpha=alpha, ec="white", lw=1
        )


def _simplified(line: FloatArray) -> FloatArray:
    """A path with a point at least every few centimetres only."""
    if len(line) < 3:
        return line
    along = np.concatenate(([0.0], np.cumsum(np.hypot(*np.diff(line, axis=0).T))))
    step = max(0.03, along[-1] / (4 * _POINTS))
    _, first = np.unique((along / step).astype(np.int64), return_index=True)
    kept: FloatArray = line[np.append(first, len(line) - 1)]
    return kept


def _peaks(series: FloatArray) -> FloatArray:
    """(k, 2) of a (n, 2) time series: the greatest value of each of at most `_POINTS` spans."""
    size = -(-len(series) // _POINTS)
    if size <= 1:
        return series
    starts = range(0, len(series), size)
    greatest = [start + int(np.argmax(series[start : start + size, 1])) for start in starts]
    return series[greatest]


def _changes(series: FloatArray) -> FloatArray:
    """A (n, 2) time series without samples that repeat the value before; first and last stay."""
    if len(series) < 3:
        return series
    kept = np.concatenate(([True], np.diff(series[:, 1]) != 0.0))
    kept[-1] = True
    return series[kept]
