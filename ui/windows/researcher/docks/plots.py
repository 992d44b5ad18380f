"""Plots over time: the robots' errors of position and heading, their standard deviations, energy and speed."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
import pyqtgraph as pg
from PySide6.QtCore import Qt, Signal
from PySide6.QtGui import QColor, QFont, QFontMetricsF, QResizeEvent
from PySide6.QtWidgets import QVBoxLayout, QWidget

from sim.numerics.float_array import FloatArray
from ui.model.theme import Palette
from ui.windows.look import follow_text, font, px

LATE = 1.0
"""Seconds after the beginning of a session from which on a window has joined late."""
LIVE_SECONDS = 60.0
"""Seconds of a running session that the plots show until somebody looks elsewhere."""
MOST_POINTS = 4000
"""Most points of a curve, more than a screen has columns; beyond, runs of neighbours are drawn by their extremes."""


@dataclass(frozen=True, slots=True)
class PlotPanel:
    """One of the plots.

    Attributes:
        name: of the figure in `RobotCurves`.
        title: for people, with its unit.
        factor: converts SI units to that of the title.
    """

    name: str
    title: str
    factor: float = 1.0


@dataclass(frozen=True, slots=True, eq=False)
class RobotCurves:
    """Figures of one robot over time.

    Attributes:
        robot: index in the team.
        figures: by the name of a panel (or "band": two standard deviations of position, metres): (n,) seconds since
            the beginning, ascending, and (n,) values; NaN leaves a gap.
    """

    robot: int
    figures: Mapping[str, tuple[FloatArray, FloatArray]]


PANELS = (
    PlotPanel("error", "Position error, m"),
    PlotPanel("heading_error", "Heading error, °", float(np.degrees(1.0))),
    PlotPanel("sigma", "Standard deviation, m"),
    PlotPanel("energy", "Energy"),
    PlotPanel("speed", "Speed, m/s"),
)
BAND = "band"
TimeRange = Literal["all", "end", "free"]
"""Time on view: all of it, its moving end, or wherever somebody went."""


class Plots(QWidget):
    """One plot for each figure, one curve for each robot, one axis of time; behind the error a band of two standard
    deviations of the selected robot.

    A click seeks that time; dragging and the wheel move along the time, a double click shows all of it again.

    Args:
        palette: the colours.
        live: a running session, whose end moves.

    Signals:
        seek: a person wants to see this time, seconds since the beginning.
    """

    seek = Signal(float)

    def __init__(self, palette: Palette, live: bool) -> None:
        super().__init__()
        self._palette = palette
        self._home: TimeRange = "end" if live else "all"
        self._span: TimeRange = self._home
        self._now = 0.0
        self._end = 0.0
        self._selected = 0
        self._bands: dict[int, tuple[FloatArray, FloatArray]] = {}
        self._curves: dict[tuple[str, int], pg.PlotDataItem] = {}
        self.canvas = pg.GraphicsLayoutWidget()
        self.canvas.setAccessibleName("Plots over time")
        self.canvas.viewport().setFocusPolicy(Qt.FocusPolicy.NoFocus)
        self.canvas.ci.layout.setSpacing(2)
        self._plots: dict[str, pg.PlotItem] = {}
        self._cursors: list[pg.InfiniteLine] = []
        for number, panel in enumerate(PANELS):
            plot = self.canvas.addPlot(row=number, col=0)
            plot.setMenuEnabled(False)
            plot.hideButtons()
            plot.setMouseEnabled(x=True, y=False)
            plot.setClipToView(True)
            plot.getViewBox().setAutoVisible(y=True)
            plot.getViewBox().sigRangeChangedManually.connect(self._look_around)
            for side in ("left", "bottom"):
                # Lines of the grid between the numbers cost more than all curves.
                plot.getAxis(side).setStyle(maxTickLevel=0)
                plot.getAxis(side).enableAutoSIPrefix(False)
            if number < len(PANELS) - 1:
                plot.getAxis("bottom").setStyle(showValues=False)
            if number:
                plot.setXLink(self._plots[PANELS[0].name])
            cursor = pg.InfiniteLine(angle=90, movable=False)
            plot.addItem(cursor, ignoreBounds=True)
            self._cursors.append(cursor)
            self._plots[panel.name] = plot
        # The first says in words what the others only mark.
        self._joined = [pg.InfiniteLine(angle=90, movable=False) for _ in PANELS]
        # Left of the line, where nothing is drawn.
        self._joined_words = pg.InfLineLabel(self._joined[0], anchors=[(1.0, 0.5), (1.0, 0.5)])
        for plot, line in zip(self._plots.values(), self._joined, strict=True):
            line.hide()
            plot.addItem(line, ignoreBounds=True)
        self._band = pg.PlotCurveItem(fillLevel=0.0)
        self._plots[PANELS[0].name].addItem(self._band)
        self.canvas.scene().sigMouseClicked.connect(self._clicked)
        layout = QVBoxLayout(self)
        layout.setContentsMargins(0, 0, 0, 0)
        layout.addWidget(self.canvas)
        follow_text(self, lambda it: it.set_palette(it._palette))

    def show_curves(self, robots: Sequence[RobotCurves], end: float) -> None:
        """Draw these curves in place of the same robots' earlier ones.

        Args:
            robots: curves of any robots of the team.
            end: seconds from the beginning to the end of the data.
        """
        self._end = end
        for curves in robots:
            for panel in PANELS:
                if panel.name in curves.figures:
                    times, values = curves.figures[panel.name]
                    self._curve(panel.name, curves.robot).setData(*thinned(times, values * panel.factor))
            if BAND in curves.figures:
                self._bands[curves.robot] = curves.figures[BAND]
        self._draw_band()
        self._range()

    def clear(self) -> None:
        """Remove all curves."""
        for (panel, _), curve in self._curves.items():
            self._plots[panel].removeItem(curve)
        self._curves, self._bands = {}, {}
        self._draw_band()

    def show_time(self, now: float) -> None:
        """Move the cursor to this time."""
        if now != self._now:
            self._now = now
            for cursor in self._cursors:
                cursor.setValue(now)
            self._range()

    def show_joined(self, time: float) -> None:
        """Mark the time before which nothing is shown because the window joined the session then."""
        if time == self._joined[0].value():
            return
        for line in self._joined:
            line.setValue(time)
            line.setVisible(time > LATE)
        self._joined_words.setFormat(f"window joined\nat {time:.0f} s")

    def select(self, robot: int) -> None:
        """Draw this robot's curves stronger, and the band of its standard deviation."""
        self._selected = robot
        for (_, number), curve in self._curves.items():
            curve.setPen(self._pen(number))
            curve.setZValue(number == robot)
        self._draw_band()

    def set_palette(self, palette: Palette) -> None:
        """Use other colours."""
        self._palette, self._letters = palette, self._fitting_letters()
        size = f"{self._letters.pointSizeF():.1f}pt"
        self.canvas.setBackground(palette.panel)
        for panel in PANELS:
            plot = self._plots[panel.name]
            plot.setTitle(panel.title, color=palette.text, size=size, justify="left")
            plot.getAxis("left").setWidth(round(48 * self._letters.pointSizeF() / 9.24))
            plot.showGrid(x=True, y=True, alpha=0.15)
            for side in ("left", "bottom"):
                plot.getAxis(side).setPen(palette.line)
                plot.getAxis(side).setTextPen(palette.muted)
                plot.getAxis(side).setTickFont(self._letters)
        style = {"color": palette.muted, "font-size": size}
        self._plots[PANELS[-1].name].setLabel("bottom", "seconds since the beginning", **style)
        for cursor in self._cursors:
            cursor.setPen(pg.mkPen(palette.accent, width=1))
        for line in self._joined:
            line.setPen(pg.mkPen(palette.muted, width=1, style=Qt.PenStyle.DashLine))
        self._joined_words.setColor(palette.muted)
        self._joined_words.textItem.setFont(self._letters)
        self.select(self._selected)

    def resizeEvent(self, event: QResizeEvent) -> None:
        """Use letters that fit."""
        super().resizeEvent(event)
        if self._letters.pointSizeF() != self._fitting_letters().pointSizeF():
            self.set_palette(self._palette)

    def _fitting_letters(self) -> QFont:
        """Return small letters, or smaller ones where the widest title would not fit."""
        letters = font("small")
        widest = max(QFontMetricsF(letters).horizontalAdvance(panel.title) for panel in PANELS)
        share = min(1.0, (self.width() - px(48)) / widest)
        letters.setPointSizeF(max(7.0, round(letters.pointSizeF() * share, 1)))
        return letters

    def points(self, panel: str, robot: int) -> int:
        """Return the number of points of a robot's curve in a panel."""
        curve = self._curves.get((panel, robot))
        times = None if curve is None else curve.getOriginalDataset()[0]
        return 0 if times is None else len(times)

    def _curve(self, panel: str, robot: int) -> pg.PlotDataItem:
        curve = self._curves.get((panel, robot))
        if curve is None:
            curve = self._plots[panel].plot(pen=self._pen(robot), connect="finite", antialias=True)
            self._curves[panel, robot] = curve
        return curve

    def _pen(self, robot: int) -> object:
        colour = QColor(self._palette.robot(robot))
        if robot != self._selected:
            colour.setAlphaF(0.55)
        pen: object = pg.mkPen(colour, width=1)
        return pen

    def _draw_band(self) -> None:
        times, values = self._bands.get(self._selected, (np.empty(0), np.empty(0)))
        colour = QColor(self._palette.robot(self._selected))
        colour.setAlphaF(0.18)
        self._band.setData(*thinned(times, values), pen=None, brush=pg.mkBrush(colour), connect="finite")

    def _range(self) -> None:
        first = self._plots[PANELS[0].name]
        if self._span == "end":
            end = max(self._now, LIVE_SECONDS)
            first.setXRange(end - LIVE_SECONDS, end, padding=0.0)
        elif self._span == "all" and self._end > 0.0:
            first.setXRange(0.0, self._end, padding=0.01)

    def _look_around(self) -> None:
        """Stop following the end, since somebody moved along the time."""
        self._span = "free"

    def _clicked(self, event: "pg.GraphicsScene.mouseEvents.MouseClickEvent") -> None:
        if event.button() != Qt.MouseButton.LeftButton:
            return
        if event.double():
            self._span = self._home
            self._range()
            return
        for plot in self._plots.values():
            if plot.getViewBox().sceneBoundingRect().contains(event.scenePos()):
                self.seek.emit(max(0.0, float(plot.getViewBox().mapSceneToView(event.scenePos()).x())))
                return


def thinned(times: FloatArray, values: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return a curve of at most `MOST_POINTS` points that looks the same.

    Each run of neighbours keeps its least and its greatest value, so that no peak disappears. NaN within a run is
    dropped."""
    run = -(-2 * len(times) // MOST_POINTS)
    if run <= 2:
        return times, values
    runs = len(times) // run
    table = values[: runs * run].reshape(runs, run)
    filled = np.where(np.isnan(table), np.inf, table), np.where(np.isnan(table), -np.inf, table)
    low, high = filled[0].argmin(axis=1), filled[1].argmax(axis=1)
    first, second = np.minimum(low, high), np.maximum(low, high)
    chosen = (np.arange(runs) * run)[:, None] + np.column_stack((first, second))
    picked = np.concatenate((chosen.ravel(), np.arange(runs * run, len(times))))
    return times[picked], values[picked]
