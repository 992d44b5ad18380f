"""Items of the researcher's map: particles, scans, costmaps, plans, paths, goals, obstacles."""

import math
from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray
from PySide6.QtCore import QPointF, Qt
from PySide6.QtGui import QBrush, QColor, QPainter, QPen, QTransform

from sim.numerics.float_array import FloatArray
from ui.model.watching.scene import NO_POINTS, RobotScene, Scene
from ui.windows.map.box import MapBox
from ui.windows.map.item import Z_ABOVE, Z_FLAT, CellImage, MapItem
from ui.windows.map.points import draw_lines, mapped, pieces, polygon, steps
from ui.windows.researcher.docks.displays import DisplaysPanel, MapDisplay

ARROW = 0.5
"""Length of an arrow, meters."""


class _RobotItem(MapItem):
    """Base class of items that draw the data of each robot in the robot's color.

    Args:
        box: view of the map.
        z: order of painting.
        width: width of dots and lines, pixels.
        opacity: 0 to 1.
        style: style of lines.
    """

    def __init__(
        self, box: MapBox, z: int, width: float, opacity: float = 1.0, style: Qt.PenStyle = Qt.PenStyle.SolidLine
    ) -> None:
        super().__init__(box, z)
        self._width = width
        self._opacity = opacity
        self._style = style
        self._rows: Mapping[int | None, FloatArray] = {}

    def show_rows(self, rows: Mapping[int | None, FloatArray]) -> None:
        """Show (n, 2) or (n, 3) rows by robot. Rows with the key None get the color of text."""
        self._rows = rows
        self.update()

    def draw(self, painter: QPainter, to_pixels: QTransform) -> None:
        """Draw the rows of each robot."""
        for robot, rows in self._rows.items():
            if len(rows):
                colors = self.box.colors
                color = QColor(colors.text if robot is None else colors.robot(robot))
                color.setAlphaF(self._opacity)
                painter.setPen(QPen(color, self._width, self._style))
                self.draw_rows(painter, to_pixels, rows)

    def draw_rows(self, painter: QPainter, to_pixels: QTransform, rows: FloatArray) -> None:
        """Draw the rows of one robot."""
        raise NotImplementedError


class Dots(_RobotItem):
    """Item that draws thousands of dots: particles, or end points of laser beams."""

    def draw_rows(self, painter: QPainter, to_pixels: QTransform, rows: FloatArray) -> None:
        """Draw the dots as squares without smooth edges, which are painted several times faster than discs."""
        painter.setRenderHint(QPainter.RenderHint.Antialiasing, False)
        painter.drawPoints(polygon(mapped(to_pixels, rows)))


class Lines(_RobotItem):
    """Item that draws lines through points, for example plans. A row of NaN separates two pieces of a line."""

    def draw_rows(self, painter: QPainter, to_pixels: QTransform, rows: FloatArray) -> None:
        """Draw the pieces as single lines, which are painted several times faster than polylines."""
        pixels = mapped(to_pixels, rows)
        if self._style == Qt.PenStyle.SolidLine:
            draw_lines(painter, steps(pixels))
        else:
            for piece in pieces(pixels):
                painter.drawPolyline(polygon(piece))


class Arrows(_RobotItem):
    """Item that draws arrows for poses (x, y, theta). Each arrow starts at its pose."""

    def draw_rows(self, painter: QPainter, to_pixels: QTransform, rows: FloatArray) -> None:
        """Draw the arrows."""
        tails, theta = rows[:, :2], rows[:, 2]
        heads = tails + ARROW * np.stack((np.cos(theta), np.sin(theta)), axis=1)
        strokes = [(tails, heads)]
        for side in (math.radians(150.0), -math.radians(150.0)):
            barb = np.stack((np.cos(theta + side), np.sin(theta + side)), axis=1)
            strokes.append((heads, heads + 0.35 * ARROW * barb))
        for one, other in strokes:
            draw_lines(painter, np.concatenate((mapped(to_pixels, one), mapped(to_pixels, other)), axis=1))


class Things(MapItem):
    """Item that draws obstacles that are not on the map, at rest or moving."""

    _outlines: tuple[tuple[str, FloatArray], ...] = ()

    def show_outlines(self, outlines: tuple[tuple[str, FloatArray], ...]) -> None:
        """Show obstacles: their names and (n, 2) corners."""
        self._outlines = outlines
        self.update()

    def draw(self, painter: QPainter, to_pixels: QTransform) -> None:
        """Draw the outlines of the obstacles, hatched, with their names."""
        for name, corners in self._outlines:
            body = polygon(mapped(to_pixels, corners))
            painter.setPen(QPen(QColor(self.box.colors.bad), 2.0))
            painter.setBrush(QBrush(QColor(self.box.colors.bad), Qt.BrushStyle.BDiagPattern))
            painter.drawPolygon(body)
            painter.setPen(QColor(self.box.colors.text))
            painter.drawText(QPointF(body.boundingRect().right() + 4.0, body.boundingRect().center().y()), name)


def _cost_colors() -> NDArray[np.uint8]:
    """Return (256, 4) red, green, blue and opacity for each cost that ROS publishes, read as an unsigned byte.

    Source: the colors of costmaps in rviz. Costs from 1 to 98 are blue to red, inscribed (99) is cyan, lethal (100) is
    magenta, unknown (255) is gray-green, and values without a meaning are green and yellow. Here, unlike in rviz, the
    colors are half transparent.
    """
    colors = np.zeros((256, 4), dtype=np.uint8)
    ramp = np.arange(1, 99) * 255 // 100
    colors[1:99, 0], colors[1:99, 2] = ramp, 255 - ramp
    colors[99, :3] = (0, 255, 255)
    colors[100, :3] = (255, 0, 255)
    colors[101:128, :3] = (0, 255, 0)
    colors[128:255, :3] = (255, 255, 0)
    colors[255, :3] = (0x70, 0x89, 0x86)
    colors[1:, 3] = 150
    return colors


COST_COLORS = _cost_colors()


class Overlays:
    """Items on a map that show the scene. Each item draws all robots, because few items are painted faster than many.

    Args:
        box: view of the map.
    """

    def __init__(self, box: MapBox) -> None:
        self._costs = (CellImage(), CellImage())
        for image in self._costs:
            box.addItem(image, ignoreBounds=True)
        self._shown: list[object] = [None, None]
        self._clouds = Dots(box, Z_FLAT, 2.0, 0.7)
        self._things = Things(box, Z_FLAT)
        self._scans = Dots(box, Z_FLAT, 3.0)
        self._plans = Lines(box, Z_FLAT, 3.0)
        self._true_paths = Lines(box, Z_FLAT, 1.2, style=Qt.PenStyle.DotLine)
        self._odometry = Lines(box, Z_FLAT, 1.2, style=Qt.PenStyle.DashDotLine)
        # Draw these items above the robots, because a body is often larger than the cloud of its particles.
        self._particles = Dots(box, Z_ABOVE, 2.0, 0.6)
        self._goals = Arrows(box, Z_ABOVE, 3.0)
        self._footprints = Lines(box, Z_ABOVE, 1.5)

    def show(self, scene: Scene, selected: int, on: DisplaysPanel) -> None:
        """Show a scene."""
        self._things.show_outlines(
            tuple((t.name, t.outline) for t in scene.things) if on.shows(MapDisplay.THINGS) else ()
        )
        chosen = next((robot for robot in scene.robots if robot.robot == selected), None)
        self._clouds.show_rows({robot.robot: robot.cloud for robot in scene.robots if robot is not chosen})
        self._particles.show_rows({} if chosen is None else {None: chosen.cloud})
        self._scans.show_rows({robot.robot: robot.scan for robot in scene.robots})
        lines: tuple[tuple[_RobotItem, MapDisplay, Mapping[int | None, FloatArray]], ...] = (
            (self._plans, MapDisplay.LOCAL_PLANS, {robot.robot: robot.local_plan for robot in scene.robots}),
            (self._true_paths, MapDisplay.TRUE_PATHS, {robot.robot: robot.truth_path for robot in scene.robots}),
            (self._odometry, MapDisplay.ODOMETRY, {robot.robot: robot.odometry_path for robot in scene.robots}),
            (self._goals, MapDisplay.GOALS, {robot.robot: _goal(robot) for robot in scene.robots}),
            (self._footprints, MapDisplay.FOOTPRINTS, {robot.robot: _closed(robot) for robot in scene.robots}),
        )
        for item, display, rows in lines:
            item.show_rows(rows if on.shows(display) else {})
        maps = (None, None) if chosen is None else (chosen.global_costmap, chosen.local_costmap)
        for place, (image, costmap) in enumerate(zip(self._costs, maps, strict=True)):
            if costmap is not self._shown[place]:
                self._shown[place] = costmap
                image.setVisible(costmap is not None)
                if costmap is not None:
                    image.show_cells(costmap.cells.astype(np.uint8), COST_COLORS, costmap.origin, costmap.resolution)


def _goal(robot: RobotScene) -> FloatArray:
    return NO_POINTS if robot.goal is None else robot.goal.array()[np.newaxis]


def _closed(robot: RobotScene) -> FloatArray:
    """Return the corners of a footprint, with the first corner repeated at the end."""
    return np.concatenate((robot.footprint, robot.footprint[:1]))
