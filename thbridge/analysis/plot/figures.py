"""Figures of a recording: paths, localization error, covariance, energy, velocity, timeline."""

from collections.abc import Callable, Mapping, Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from matplotlib.ticker import FuncFormatter, LogLocator, MultipleLocator, NullFormatter

from sim.common.robot_colors import robot_color
from sim.numerics.float_array import FloatArray
from thbridge.analysis.plot.kinds import FigureKind
from thbridge.analysis.plot.paths import paths
from thbridge.analysis.plot.style import FAINT, INK, FigureStyle, clock, label_above, robot_handles
from thbridge.analysis.plot.thinning import changes, peaks
from thbridge.analysis.report.report import Report, TimelineEntry, Track
from thbridge.hunt.refusals import RequestRefused

SIGMAS = 2.0
"""Half width of a band in standard deviations; it covers 95 % of normal errors if the covariance is right."""
_OUTCOME_ALPHA = {"arrived": 0.9, "no path": 0.3, "cancelled": 0.3}
_BAND_ALPHA = 0.2
LETTER_WIDTH = 0.65
"""Average width of a letter divided by its height, including spacing."""
_CLOCK_STEPS = (1.0, 2.0, 5.0, 10.0, 15.0, 30.0, 60.0, 120.0, 300.0, 600.0, 900.0, 1800.0, 3600.0, 7200.0)
"""Possible distances between labels of the time axis, seconds."""


def draw(what: FigureKind, report: Report, style: FigureStyle) -> Figure | RequestRefused:
    """Draw a figure; if the recording lacks data for it, return what is missing."""
    with style.settings():
        drawn = _FIGURES[what](report, style)
    return RequestRefused("nothing-to-plot", f"Nothing to plot: {_MISSING[what]}.") if drawn is None else drawn


def error(report: Report, style: FigureStyle) -> Figure | None:
    """Draw the error of the estimated pose on top of the localizer's standard deviation; one row per robot."""
    shown = [(index, track) for index, track in enumerate(report.tracks) if len(track.errors)]
    if not shown:
        return None
    figure, rows = _panels(style, len(shown), ("position error, cm", "heading error, °"))
    for (index, track), panels in zip(shown, rows, strict=True):
        for axes, column, scale, least in zip(panels, (1, 2), (100.0, 180.0 / np.pi), (1.0, 0.5), strict=True):
            curve = peaks(track.errors[:, (0, column)])
            axes.plot(curve[:, 0], scale * curve[:, 1], color=robot_color(index))
            if len(track.deviations):
                admitted = _until(track.deviations, track.errors[-1, 0])
                band = SIGMAS * scale * admitted[:, column]
                axes.fill_between(
                    admitted[:, 0], band, step="post", color=robot_color(index), alpha=_BAND_ALPHA, lw=0, zorder=1
                )
            # The axis begins at zero, and is coarse enough that rounding does not look like an error.
            axes.set_ylim(0.0, max(least, axes.get_ylim()[1]))
    _time_below(rows, report.duration, style)
    handles: list[object] = robot_handles(report.tracks, [index for index, _ in shown])
    if any(len(track.deviations) for _, track in shown):
        handles.append(Patch(color=FAINT, alpha=2 * _BAND_ALPHA, lw=0, label=f"{SIGMAS:g}σ reported"))
    label_above(rows[0][0], handles, 3 if style.narrow else 10)
    return figure


def covariance(report: Report, style: FigureStyle) -> Figure | None:
    """Draw the standard deviations that the localizer reports."""
    shown = [(index, track) for index, track in enumerate(report.tracks) if len(track.deviations)]
    if not shown:
        return None
    figure, rows = _panels(style, 1, ("position σ, cm", "heading σ, °"))
    for index, track in shown:
        admitted = _until(track.deviations, track.estimate[-1, 0] if len(track.estimate) else report.duration)
        for axes, column, scale in zip(rows[0], (1, 2), (100.0, 180.0 / np.pi), strict=True):
            axes.step(admitted[:, 0], scale * admitted[:, column], where="post", color=robot_color(index))
    for axes in rows[0]:
        # The values are meters during global localization, and centimeters during tracking.
        axes.set_yscale("log", nonpositive="mask")
        axes.yaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
        axes.yaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
        axes.yaxis.set_minor_formatter(NullFormatter())
    _time_below(rows, report.duration, style)
    label_above(rows[0][0], robot_handles(report.tracks, [index for index, _ in shown]), 3 if style.narrow else 10)
    return figure


def energy(report: Report, style: FigureStyle) -> Figure | None:
    """Draw the energy left of each robot."""
    shown = [index for index, track in enumerate(report.tracks) if len(track.energy)]
    if not shown:
        return None
    figure, ((axes,),) = style.figure((0.6 if style.narrow else 0.3) * style.width)
    for index in shown:
        left = changes(report.tracks[index].energy)
        axes.step(left[:, 0], left[:, 1], where="post", color=robot_color(index), lw=1.5 * style.line)
    axes.axhline(0.0, color=FAINT, lw=0.8)
    axes.set_ylabel("energy left")
    _time_below([[axes]], report.duration, style)
    label_above(axes, robot_handles(report.tracks, shown), 3 if style.narrow else 10)
    return figure


def velocity(report: Report, style: FigureStyle) -> Figure | None:
    """Draw the speeds from odometry, and the commanded speeds over them; one row per robot."""
    shown = [(index, track) for index, track in enumerate(report.tracks) if len(track.speeds) or len(track.commands)]
    if not shown:
        return None
    figure, rows = _panels(style, len(shown), ("speed, m/s", "turning, rad/s"))
    for (index, track), panels in zip(shown, rows, strict=True):
        for axes, column in zip(panels, (1, 2), strict=True):
            if len(track.speeds):
                measured = track.speeds
                axes.plot(
                    measured[:, 0], measured[:, column], color=robot_color(index), alpha=0.55, lw=0.7 * style.line
                )
            if len(track.commands):
                commands = track.commands
                axes.step(commands[:, 0], commands[:, column], where="post", color=INK, lw=0.7 * style.line)
    _time_below(rows, report.duration, style)
    commanded = [Line2D([], [], color=INK, lw=style.line, label="commanded")]
    label_above(rows[0][0], [*robot_handles(report.tracks, [index for index, _ in shown]), *commanded], 4)
    return figure


def timeline(report: Report, style: FigureStyle) -> Figure | None:
    """Draw drives to goals with their rooms, events of the game, and utterances."""
    if not report.timeline and not any(track.attempts for track in report.tracks):
        return None
    names = [track.label for track in report.tracks]
    utterances = [entry for entry in report.timeline if entry.kind == "said"]
    events = [entry for entry in report.timeline if entry.kind != "said"]
    ways_made = any(track.ways_made for track in report.tracks)
    labels = [*names, *(["game"] if any(e.who not in names for e in events) else []), *(["talk"] if utterances else [])]
    line = 3.0 * style.font / 72.0
    figure, ((axes,),) = style.figure(4.5 * style.font / 72.0 + line * max(len(labels), 2))
    for index, track in enumerate(report.tracks):
        _draw_attempts(axes, index, track, events, report, style)
        _draw_ways_made(axes, index, track, report.tracks)
    for event in events:
        row = names.index(event.who) if event.who in names else len(names)
        axes.plot(event.time, row, "D", ms=0.45 * style.font, color=INK, mec="white", mew=0.5, zorder=3)
    if utterances:
        times = [utterance.time for utterance in utterances]
        axes.vlines(times, len(labels) - 1.3, len(labels) - 0.7, color="#52606d", lw=style.line)
    axes.set_yticks(range(len(labels)), labels)
    axes.set_ylim(len(labels) - 0.4, -0.6)
    axes.grid(visible=False, axis="y")
    axes.tick_params(axis="y", length=0)
    axes.yaxis.set_minor_locator(MultipleLocator(1.0))
    label_above(
        axes,
        [
            *(
                [Patch(color=robot_color(0), lw=0, label="goal reached")]
                if any(t.attempts for t in report.tracks)
                else []
            ),
            *([Patch(color=robot_color(0), alpha=0.3, lw=0, label="goal not reached")] if _failed(report) else []),
            *([Patch(color=FAINT, lw=0, label="makes way for the robot of that color")] if ways_made else []),
            *([Line2D([], [], color=INK, marker="D", ms=0.45 * style.font, lw=0, label="event")] if events else []),
            *([Line2D([], [], color="#52606d", marker="|", ms=style.font, lw=0, label="said")] if utterances else []),
        ],
        2 if style.narrow else 4,
    )
    _time_below([[axes]], report.duration, style)
    return figure


_FIGURES: Mapping[FigureKind, Callable[[Report, FigureStyle], Figure | None]] = {
    FigureKind.PATHS: paths,
    FigureKind.ERROR: error,
    FigureKind.COVARIANCE: covariance,
    FigureKind.ENERGY: energy,
    FigureKind.VELOCITY: velocity,
    FigureKind.TIMELINE: timeline,
}
_MISSING: Mapping[FigureKind, str] = {
    FigureKind.PATHS: "the bag has neither a map nor poses of a robot",
    FigureKind.ERROR: "there is no robot whose true and estimated paths are both in the bag",
    FigureKind.COVARIANCE: "there is no amcl_pose and no other pose on the map with a covariance",
    FigureKind.ENERGY: "there is no topic of type sensor_msgs/BatteryState",
    FigureKind.VELOCITY: "there is neither odometry nor a topic cmd_vel",
    FigureKind.TIMELINE: "there are no goals of move_base, no events of a game, and no utterances",
}


def _failed(report: Report) -> bool:
    return any(attempt.outcome in {"no path", "cancelled"} for track in report.tracks for attempt in track.attempts)


def _panels(style: FigureStyle, robots: int, labels: tuple[str, str]) -> tuple[Figure, list[list[Axes]]]:
    """Create a pair of panels for each robot: side by side, or one below the other in narrow figures."""
    height = 3.0 * style.font / 72.0
    if not style.narrow:
        figure, rows = style.figure(height + robots * max(1.1, 0.19 * style.width), robots, 2)
        pairs = rows
    else:
        figure, rows = style.figure(height + 2 * robots * 0.85, 2 * robots)
        pairs = [[rows[2 * robot][0], rows[2 * robot + 1][0]] for robot in range(robots)]
    for pair in pairs:
        for axes, label in zip(pair, labels, strict=True):
            axes.set_ylabel(label.replace(" ", "\n", 1) if style.narrow else label)
    figure.align_ylabels()
    return figure, pairs


def _time_below(rows: Sequence[Sequence[Axes]], duration: float, style: FigureStyle) -> None:
    """Label the time axis of the lowest panels in minutes and seconds."""
    for axes in (axes for row in rows for axes in row):
        axes.set_xlim(0.0, max(duration, 1e-3))
        axes.xaxis.set_major_locator(MultipleLocator(_tick(duration, 5 if style.narrow else 7)))
        axes.xaxis.set_major_formatter(FuncFormatter(lambda seconds, _: clock(seconds)))
    for axes in rows[-1] if not style.narrow else rows[-1][-1:]:
        axes.set_xlabel("time, min:s")


def _tick(duration: float, most: int) -> float:
    """Return the distance between labels of the time axis: a round number of seconds, minutes or hours."""
    return next((step for step in _CLOCK_STEPS if duration / step <= most), duration / most)


def _until(series: FloatArray, end: float) -> FloatArray:
    """Return a step series with its last value extended to the end."""
    return np.vstack((series, [[end, *series[-1, 1:]]]))


def _draw_ways_made(axes: Axes, row: int, track: Track, tracks: Sequence[Track]) -> None:
    """Draw a thin bar below a robot's drives for each time in which it makes way, in the color of the other robot."""
    colours = {other.name: robot_color(index) for index, other in enumerate(tracks)}
    for made in track.ways_made:
        seconds = made.end - made.start
        axes.barh(row + 0.33, seconds, left=made.start, height=0.14, color=colours.get(made.robot, FAINT), lw=0)


def _draw_attempts(
    axes: Axes,
    row: int,
    track: Track,
    events: Sequence[TimelineEntry],
    report: Report,
    style: FigureStyle,
) -> None:
    letter = report.duration * style.font / 72.0 / style.width
    departures = [event for event in events if event.who == track.label and event.kind == "departed"]
    for attempt in track.attempts:
        alpha = _OUTCOME_ALPHA.get(attempt.outcome, 0.6)
        axes.barh(
            row,
            attempt.end - attempt.start,
            left=attempt.start,
            height=0.46,
            color=robot_color(row),
            alpha=alpha,
            ec="white",
            lw=0.8,
        )
        room = next((event.room for event in departures if abs(event.time - attempt.start) < 1.0), None)
        # The name of a room, or even its number, is omitted if it does not fit into the bar.
        seconds = attempt.end - attempt.start
        if room is not None and seconds > letter:
            middle = 0.5 * (attempt.start + attempt.end)
            named = report.rooms.numbered(room)
            axes.annotate(
                named if seconds > LETTER_WIDTH * len(named) * letter else str(room),
                (middle, row),
                color="white" if alpha > 0.7 else INK,
                fontsize=style.font - 1,
                ha="center",
                va="center_baseline",
            )
