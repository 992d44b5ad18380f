"""Plots over time: errors of position and heading, standard deviations, energy and speed of the robots.

For a recording, all other numbers of its topics can be plotted as well.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
import pyqtgraph as pg
from PySide6.QtCore import Qt, Signal
from PySide6.QtGui import QColor, QFont, QFontMetricsF, QResizeEvent
from PySide6.QtWidgets import QFrame, QScrollArea, QSizePolicy, QVBoxLayout, QWidget

from sim.numerics.float_array import FloatArray
from ui.model.shared.theme import Palette
from ui.windows.look import follow_text, font, label, px
from ui.windows.untrusted_text import shown

LATE = 1.0
"""Seconds after the beginning of a session. A window that connects later counts as connected late."""
LIVE_SECONDS = 60.0
"""Plots of a running session show this number of the latest seconds until a person moves along the time axis."""
_UNBOUNDED = 16_777_215.0
"""Qt's maximum height of a widget."""
LEAST_HEIGHT = 112
"""Smallest height of a plot, `px`. If not all plots fit, the dock scrolls."""
NOTHING = "There are no plots. Open a topic in the Topics pane, and tick its numbers."
MOST_POINTS = 4000
"""Maximum number of points in a drawn curve, which is more than a screen has columns of pixels.

A longer curve is drawn with the smallest and greatest value of each group of neighboring points.
"""


@dataclass(frozen=True, slots=True)
class PlotPanel:
    """Plot of one figure for all robots.

    Attributes:
        name: name of the figure in `RobotCurves`.
        title: title for people, with the unit.
        factor: factor from SI units to the units of the title.
    """

    name: str
    title: str
    factor: float = 1.0


@dataclass(frozen=True, slots=True, eq=False)
class RobotCurves:
    """Figures of one robot over time.

    Attributes:
        robot: index in the team.
        name: name of the robot in the legend.
        figures: curves by the name of a panel; the name "band" is for two standard deviations of position, meters. A
            curve has (n,) seconds since the beginning, ascending, and (n,) values; NaN leaves a gap.
    """

    robot: int
    name: str
    figures: Mapping[str, tuple[FloatArray, FloatArray]]


@dataclass(frozen=True, slots=True, eq=False)
class NumberCurve:
    """Curve of a number in the messages of a topic, over time.

    Attributes:
        plot: title of the plot; curves with the same title share a plot.
        name: name in the legend.
        times: (n,) seconds since the beginning, ascending.
        values: (n,) values; NaN leaves a gap.
    """

    plot: str
    name: str
    times: FloatArray
    values: FloatArray


PANELS = (
    PlotPanel("error", "Position error, m"),
    PlotPanel("heading_error", "Heading error, °", float(np.degrees(1.0))),
    PlotPanel("sigma", "Standard deviation, m"),
    PlotPanel("energy", "Energy"),
    PlotPanel("speed", "Speed, m/s"),
)
BAND = "band"
TimeRange = Literal["all", "end", "free"]
"""Range of the time axis: the whole time, the latest part, or a part that a person chose."""


class Plots(QWidget):
    """One plot for each figure, with a curve for each robot and a shared time axis.

    A band behind the error shows two standard deviations of the selected robot. Plots of topic numbers are below the
    plots of robots. A plot without a curve is hidden.

    A click in a plot selects the time to show. Dragging and the mouse wheel move along the time axis; a double click
    shows the whole time.

    Args:
        palette: the colors.
        live: True for a running session. The end of a running session moves.

    Signals:
        seek: a person wants to go to this time; seconds since the beginning.
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
        self._numbers: dict[tuple[str, str], pg.PlotDataItem] = {}
        self._joined = 0.0
        self.canvas = pg.GraphicsLayoutWidget()
        self.canvas.setAccessibleName("Plots over time")
        self.canvas.viewport().setFocusPolicy(Qt.FocusPolicy.NoFocus)
        self.canvas.ci.layout.setSpacing(2)
        self.nothing = label(NOTHING, muted=True)
        self.nothing.setMargin(12)
        self.nothing.setVisible(not live)
        self._shown: list[_TimePlot] = []
        self._panels = {panel.name: _TimePlot(panel.title) for panel in PANELS}
        self._number_plots: dict[str, _TimePlot] = {}
        for plot in self._panels.values():
            plot.item.getViewBox().sigRangeChangedManually.connect(self._look_around)
        self._band = pg.PlotCurveItem(fillLevel=0.0)
        self._panels[PANELS[0].name].item.addItem(self._band)
        self.canvas.scene().sigMouseClicked.connect(self._clicked)
        area = QScrollArea(widgetResizable=True)
        area.setFrameShape(QFrame.Shape.NoFrame)
        area.setFocusPolicy(Qt.FocusPolicy.NoFocus)
        area.setWidget(self.canvas)
        layout = QVBoxLayout(self)
        layout.setContentsMargins(0, 0, 0, 0)
        layout.addWidget(self.nothing)
        layout.addWidget(area, 1)
        follow_text(self, lambda it: it.set_palette(it._palette))

    @property
    def titles(self) -> list[str]:
        """Titles of the visible plots, from top to bottom."""
        return [plot.title for plot in self._shown]

    def show_curves(self, robots: Sequence[RobotCurves], end: float) -> None:
        """Draw these curves, which replace earlier curves of the same robots.

        Args:
            robots: curves of any robots of the team.
            end: seconds from the beginning to the end of the data.
        """
        self._end = end
        for curves in robots:
            for panel in PANELS:
                if panel.name in curves.figures and len(curves.figures[panel.name][0]):
                    times, values = curves.figures[panel.name]
                    self._curve(panel.name, curves).setData(*thinned(times, values * panel.factor))
            if BAND in curves.figures:
                self._bands[curves.robot] = curves.figures[BAND]
        self._draw_band()
        self._arrange()
        self._range()

    def show_numbers(self, curves: Sequence[NumberCurve], end: float) -> None:
        """Draw these numbers of topics, and remove the curves of all other numbers.

        Args:
            curves: the numbers.
            end: seconds from the beginning to the end of the data.
        """
        self._end = end
        wanted = {(curve.plot, curve.name) for curve in curves}
        for key in [key for key in self._numbers if key not in wanted]:
            self._number_plots[key[0]].item.removeItem(self._numbers.pop(key))
        for title in [title for title in self._number_plots if title not in {plot for plot, _ in wanted}]:
            self._number_plots.pop(title)
        for curve in curves:
            self._number(curve).setData(*thinned(curve.times, curve.values))
        self._arrange()
        self._range()

    def clear(self) -> None:
        """Remove all curves."""
        for (panel, _), curve in self._curves.items():
            self._panels[panel].item.removeItem(curve)
        self._curves, self._bands = {}, {}
        self._name_curves()
        self._draw_band()
        self._arrange()

    def show_time(self, now: float) -> None:
        """Move the cursor to this time."""
        if now != self._now:
            self._now = now
            for plot in self._shown:
                plot.cursor.setValue(now)
            self._range()

    def show_joined(self, time: float) -> None:
        """Mark the time at which the window connected to the session; earlier values are unknown."""
        if time != self._joined:
            self._joined = time
            self._dress()

    def select(self, robot: int) -> None:
        """Draw the curves of this robot with stronger lines, and draw the band of its standard deviation."""
        self._selected = robot
        for (_, number), curve in self._curves.items():
            curve.setPen(self._pen(number))
            curve.setZValue(number == robot)
        self._draw_band()

    def set_palette(self, palette: Palette) -> None:
        """Use these colors."""
        self._palette, self._letters = palette, self._fitting_letters()
        self.canvas.setBackground(palette.panel)
        self._dress()
        for curves in self._of_numbers().values():
            for number, curve in enumerate(curves):
                curve.setPen(pg.mkPen(palette.robot(number), width=1))
        self.select(self._selected)

    def resizeEvent(self, event: QResizeEvent) -> None:
        """Choose a size of letters that fits the new width."""
        super().resizeEvent(event)
        if self._letters.pointSizeF() != self._fitting_letters().pointSizeF():
            self.set_palette(self._palette)

    def points(self, panel: str, robot: int) -> int:
        """Return the number of points in a robot's curve in a panel."""
        curve = self._curves.get((panel, robot))
        times = None if curve is None else curve.getOriginalDataset()[0]
        return 0 if times is None else len(times)

    def _arrange(self) -> None:
        """Show the plots that have curves, one below another. Only the last plot shows the time axis."""
        panels = {panel for panel, _ in self._curves}
        wanted = [plot for name, plot in self._panels.items() if name in panels]
        wanted += [plot for plot in self._number_plots.values() if plot not in wanted]
        if wanted == self._shown:
            return
        for plot in self._shown:
            self.canvas.removeItem(plot.legend)
            self.canvas.removeItem(plot.item)
        self._shown = wanted
        for row, plot in enumerate(wanted):
            self.canvas.addItem(plot.legend, 2 * row, 0)
            self.canvas.addItem(plot.item, 2 * row + 1, 0)
            plot.item.setXLink(wanted[0].item if row else None)
            plot.cursor.setValue(self._now)
        self.nothing.setVisible(not wanted and self._home == "all")
        self._dress()

    def _dress(self) -> None:
        """Set fonts, colors, legends and lines of the visible plots."""
        palette, letters = self._palette, self._letters
        size = f"{letters.pointSizeF():.1f}pt"
        self.canvas.setMinimumHeight(len(self._shown) * px(LEAST_HEIGHT))
        for plot in self._shown:
            last, first = plot is self._shown[-1], plot is self._shown[0]
            item = plot.item
            item.setTitle(plot.title, color=palette.text, size=size, justify="left")
            item.getAxis("left").setWidth(round(48 * letters.pointSizeF() / 9.24))
            item.showGrid(x=True, y=True, alpha=0.15)
            for side in ("left", "bottom"):
                item.getAxis(side).setPen(palette.line)
                item.getAxis(side).setTextPen(palette.muted)
                item.getAxis(side).setTickFont(letters)
            item.getAxis("bottom").setStyle(showValues=last)
            style = {"color": palette.muted, "font-size": size}
            item.setLabel("bottom", "seconds since the beginning" if last else None, **style)
            item.getAxis("bottom").showLabel(last)
            plot.cursor.setPen(pg.mkPen(palette.accent, width=1))
            plot.joined.setPen(pg.mkPen(palette.muted, width=1, style=Qt.PenStyle.DashLine))
            plot.joined.setValue(self._joined)
            plot.joined.setVisible(self._joined > LATE)
            # The first plot explains the line in words. The other plots show only the line.
            plot.joined_words.setVisible(first)
            plot.joined_words.setFormat(f"connected\nat {self._joined:.0f} s")
            plot.joined_words.setColor(palette.muted)
            plot.joined_words.textItem.setFont(letters)
        self._name_curves()

    def _name_curves(self) -> None:
        """Fill the legends.

        The legend of the first robot plot names the robots. In a plot of several numbers, the legend names the numbers.
        """
        robots = next((plot for plot in self._shown if plot in self._panels.values()), None)
        curves = self._of_numbers()
        if robots is not None:
            name = next(name for name, plot in self._panels.items() if plot is robots)
            curves[robots] = [curve for (panel, _), curve in sorted(self._curves.items()) if panel == name]
        letter = QFontMetricsF(self._letters).averageCharWidth()
        for plot in self._shown:
            legend, named = plot.legend, curves.get(plot, ())
            legend.clear()
            legend.setLabelTextSize(f"{self._letters.pointSizeF():.1f}pt")
            legend.setLabelTextColor(self._palette.text)
            legend.setMaximumHeight(_UNBOUNDED if len(named) > 1 else 0.0)
            if len(named) < 2:
                continue
            longest = max(len(curve.name()) for curve in named)
            legend.setColumnCount(max(1, int((self.width() - px(48)) / (letter * longest + px(48)))))
            for curve in named:
                legend.addItem(curve, curve.name())
        # Without this, the legends keep the size of empty legends.
        self.canvas.ci.layout.activate()
        self.canvas.ci.setGeometry(self.canvas.range)

    def _fitting_letters(self) -> QFont:
        """Return the small font, reduced if the widest title does not fit."""
        letters = font("small")
        widest = max(QFontMetricsF(letters).horizontalAdvance(panel.title) for panel in PANELS)
        share = min(1.0, (self.width() - px(48)) / widest)
        letters.setPointSizeF(max(7.0, round(letters.pointSizeF() * share, 1)))
        return letters

    def _curve(self, panel: str, curves: RobotCurves) -> pg.PlotDataItem:
        curve = self._curves.get((panel, curves.robot))
        if curve is None:
            pen, name = self._pen(curves.robot), shown(curves.name)
            curve = pg.PlotDataItem(pen=pen, name=name, connect="finite", antialias=True)
            self._panels[panel].item.addItem(curve)
            self._curves[panel, curves.robot] = curve
            self._name_curves()
        return curve

    def _number(self, wanted: NumberCurve) -> pg.PlotDataItem:
        plot = self._number_plots.get(wanted.plot)
        if plot is None:
            plot = self._number_plots[wanted.plot] = _TimePlot(shown(wanted.plot))
            plot.item.getViewBox().sigRangeChangedManually.connect(self._look_around)
        curve = self._numbers.get((wanted.plot, wanted.name))
        if curve is None:
            curve = pg.PlotDataItem(name=shown(wanted.name), connect="finite", antialias=True)
            plot.item.addItem(curve)
            self._numbers[wanted.plot, wanted.name] = curve
            self._name_curves()
            for number, each in enumerate(self._of_numbers()[plot]):
                each.setPen(pg.mkPen(self._palette.robot(number), width=1))
        return curve

    def _of_numbers(self) -> dict["_TimePlot", list[pg.PlotDataItem]]:
        """Return the curves in each plot of topic numbers."""
        found: dict[_TimePlot, list[pg.PlotDataItem]] = {plot: [] for plot in self._number_plots.values()}
        for (title, _), curve in self._numbers.items():
            found[self._number_plots[title]].append(curve)
        return found

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
        if not self._shown:
            return
        first = self._shown[0].item
        if self._span == "end":
            end = max(self._now, LIVE_SECONDS)
            first.setXRange(end - LIVE_SECONDS, end, padding=0.0)
        elif self._span == "all" and self._end > 0.0:
            first.setXRange(0.0, self._end, padding=0.01)

    def _look_around(self) -> None:
        """Stop following the end, because a person has moved along the time axis."""
        self._span = "free"

    def _clicked(self, event: "pg.GraphicsScene.mouseEvents.MouseClickEvent") -> None:
        if event.button() != Qt.MouseButton.LeftButton:
            return
        if event.double():
            self._span = self._home
            self._range()
            return
        for plot in self._shown:
            box = plot.item.getViewBox()
            if box.sceneBoundingRect().contains(event.scenePos()):
                self.seek.emit(max(0.0, float(box.mapSceneToView(event.scenePos()).x())))
                return


class _TimePlot:
    """Plot over time with a cursor, a legend, and a line at the time at which the window connected.

    Args:
        shown_title: title for people.
    """

    def __init__(self, shown_title: str) -> None:
        self.title = shown_title
        self.item = pg.PlotItem()
        self.item.setMenuEnabled(False)
        self.item.hideButtons()
        self.item.setMouseEnabled(x=True, y=False)
        self.item.setClipToView(True)
        self.item.getViewBox().setAutoVisible(y=True)
        # Put the legend above the plot, because curves fill the whole plot.
        self.legend = pg.LegendItem(size=(0, 0), verSpacing=-8)
        self.legend.setSizePolicy(QSizePolicy.Policy.Preferred, QSizePolicy.Policy.Fixed)
        for side in ("left", "bottom"):
            # Grid lines between the numbers would take longer to paint than all curves together.
            self.item.getAxis(side).setStyle(maxTickLevel=0)
            self.item.getAxis(side).enableAutoSIPrefix(False)
        self.cursor = pg.InfiniteLine(angle=90, movable=False)
        self.joined = pg.InfiniteLine(angle=90, movable=False)
        # Put the words left of the line, where no curve is drawn.
        self.joined_words = pg.InfLineLabel(self.joined, anchors=[(1.0, 0.5), (1.0, 0.5)])
        self.joined.hide()
        for line in (self.cursor, self.joined):
            self.item.addItem(line, ignoreBounds=True)


def thinned(times: FloatArray, values: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return a curve of at most `MOST_POINTS` points that looks like this curve.

    The points are divided into groups of neighbors. Each group keeps its smallest and its greatest value, so that no
    peak disappears. NaN within a group is dropped.
    """
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
