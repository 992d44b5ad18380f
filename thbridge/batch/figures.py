"""Figures of a sweep: the mean of a measure over a factor, with confidence bands. Equal games give bit-identical
files."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import pyarrow as pa
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from scipy import stats

from sim.numerics.float_array import FloatArray
from sim.numerics.noise_arrays import NoiseStream
from thbridge.analysis.plot.style import INK, FigureStyle
from thbridge.batch.bands import BandKind

RESAMPLES = 2000
"""Number of bootstrap samples for a band."""
CONFIDENCE = 0.95
_BAND_ALPHA = 0.18
COLORS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#7A5195", "#8C6D31", "#4D4D4D", "#B2182B")
"""Line colors that color-blind people can distinguish (Okabe and Ito's colors, then darker colors)."""
MARK_SIZE = 3.5
MARKS = ("o", "s", "^", "D", "v", "P", "X", "*")


@dataclass(frozen=True, slots=True)
class MeanBand:
    """Mean of a measure over some games.

    Attributes:
        level: level of the factor on the x axis.
        games: number of games.
        mean: mean of the measure.
        low: lower end of the mean's 95 % confidence interval. For a single game, equal to the mean.
        high: upper end of the interval. For a single game, equal to the mean.
    """

    level: str | float | int
    games: int
    mean: float
    low: float
    high: float


Curves = Mapping[tuple[str, str], Sequence[MeanBand]]
"""Points of each curve, by the level of its panel and the level of its line. Without a factor, the level is ""."""


@dataclass(frozen=True, slots=True)
class FigureAxes:
    """Contents of a figure.

    Attributes:
        measure: measure on the y axis.
        x: the factor on the x axis.
        lines: factor with one line for each level. If None, there is only one line.
        panels: factor with one panel for each level. If None, there is only one panel.
        band: method for confidence intervals.
        is_log: True for a logarithmic x axis.
    """

    measure: str
    x: str
    lines: str | None = None
    panels: str | None = None
    band: BandKind = BandKind.T
    is_log: bool = False


def curves_of(table: pa.Table, axes: FigureAxes) -> Curves:
    """Return means and confidence intervals. Ignore games without the measure.

    Levels have the order of the conditions. Games of conditions that differ only in other factors are pooled.
    """
    names = [name for name in (axes.panels, axes.lines, axes.x, axes.measure) if name is not None]
    groups: dict[tuple[str, str], dict[str | float | int, list[float]]] = {}
    for row in table.select(list(dict.fromkeys(names))).to_pylist():
        value, level = row[axes.measure], row[axes.x]
        place = tuple("" if name is None else str(row[name]) for name in (axes.panels, axes.lines))
        if value is not None and level is not None:
            groups.setdefault((place[0], place[1]), {}).setdefault(level, []).append(float(value))
    return {
        place: [
            _band(level, np.array(values), axes.band, f"{axes.measure} {place} {level}")
            for level, values in (sorted(levels.items()) if _are_numbers(levels) else levels.items())
        ]
        for place, levels in groups.items()
    }


def _are_numbers(levels: Mapping[str | float | int, object]) -> bool:
    return not any(isinstance(level, str) for level in levels)


def _band(level: str | float | int, values: FloatArray, kind: BandKind, stream: str) -> MeanBand:
    mean, games = float(values.mean()), len(values)
    if games < 2:
        return MeanBand(level, games, mean, mean, mean)
    if kind is BandKind.T:
        half = float(stats.t.ppf(0.5 + CONFIDENCE / 2, games - 1)) * float(values.std(ddof=1)) / math.sqrt(games)
        return MeanBand(level, games, mean, mean - half, mean + half)
    low, high = np.quantile(_resampled_means(values, stream), (0.5 - CONFIDENCE / 2, 0.5 + CONFIDENCE / 2))
    return MeanBand(level, games, mean, float(low), float(high))


def _resampled_means(values: FloatArray, stream: str) -> FloatArray:
    """Return the means of bootstrap samples. `stream` is the name of the stream of random numbers."""
    drawn = NoiseStream.named(0, "bootstrap", stream).uniforms(0, RESAMPLES * len(values))
    samples: FloatArray = values[(drawn * len(values)).astype(int)].reshape(RESAMPLES, len(values))
    return np.asarray(samples.mean(axis=1), dtype=float)


def draw_curves(curves: Curves, axes: FigureAxes, style: FigureStyle) -> Figure:
    """Draw the curves. Use bands for numeric levels, and error bars for other levels."""
    panels = list(dict.fromkeys(panel for panel, _ in curves))
    lines = list(dict.fromkeys(line for _, line in curves))
    words = list(dict.fromkeys(point.level for points in curves.values() for point in points))
    are_words = any(isinstance(word, str) for word in words)
    columns = min(len(panels), 2 if style.narrow else 4)
    rows = math.ceil(len(panels) / columns)
    with style.settings():
        figure = Figure(
            figsize=(style.width, (0.75 * style.width / columns + 0.15) * rows + 0.35), layout="constrained"
        )
        grid = figure.subplots(rows, columns, sharex=True, sharey=True, squeeze=False)
        flat: list[Axes] = list(grid.flat)
        for place, panel in zip(flat, panels, strict=False):
            for index, line in enumerate(lines):
                points = curves.get((panel, line), ())
                offset = (index - (len(lines) - 1) / 2) * min(0.12, 0.5 / len(lines)) if are_words else 0.0
                at = [words.index(point.level) + offset if are_words else float(point.level) for point in points]
                _draw_curve(place, at, points, index, line, are_words)
            if axes.panels is not None:
                place.set_title(f"{axes.panels} = {panel}")
            if are_words:
                place.set_xticks(range(len(words)), [str(word) for word in words])
                place.margins(x=0.12)
            elif axes.is_log:
                place.set_xscale("log")
                place.minorticks_off()
            if not are_words and len(words) <= MOST_TICKS:
                place.set_xticks([float(word) for word in words], [f"{word:g}" for word in words])
        for place in flat[len(panels) :]:
            place.set_visible(False)
        for row in grid:
            row[0].set_ylabel(axes.measure.replace("_", " "))
        figure.supxlabel(axes.x, fontsize=style.font, color=INK)
        if axes.lines is not None:
            handles, labels = flat[0].get_legend_handles_labels()
            figure.legend(
                handles,
                labels,
                loc="outside upper left",
                ncols=2 if style.narrow else 5,
                title=axes.lines,
                frameon=False,
                alignment="left",
            )
    return figure


MOST_TICKS = 8
"""Maximum number of numeric levels for which each level has a tick."""


def _draw_curve(
    place: Axes, at: Sequence[float], points: Sequence[MeanBand], index: int, label: str, are_words: bool
) -> None:
    means, lows, highs = ([getattr(point, name) for point in points] for name in ("mean", "low", "high"))
    shade, mark = COLORS[index % len(COLORS)], MARKS[index % len(MARKS)]
    if are_words:
        reach = np.array([np.subtract(means, lows), np.subtract(highs, means)])
        place.errorbar(
            at,
            means,
            reach,
            capsize=2.0,
            elinewidth=0.9,
            linestyle="none",
            label=label,
            color=shade,
            marker=mark,
            markersize=MARK_SIZE,
        )
    else:
        place.plot(at, means, label=label, color=shade, marker=mark, markersize=MARK_SIZE)
        place.fill_between(at, lows, highs, color=shade, alpha=_BAND_ALPHA, lw=0)
