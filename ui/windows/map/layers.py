"""Layers of the map beside its rooms and robots: points, lines, poses and costmaps, in map metres.

Each layer is given its data whenever that changes and is painted with every frame. The data is kept as it is given:
arrays must not be changed afterwards.
"""

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from PySide6.QtCore import QPointF, Qt
from PySide6.QtGui import QColor, QImage, QPainter, QPen, QTransform

from sim.common.geometry import Pose2
from sim.numerics.float_array import FloatArray
from ui.windows.map.points import lines, polygon
from ui.windows.map.view import MapView

ARROW = 0.5
"""Length of an arrow, metres."""


class _RobotLayer:
    """A layer in the colour of a robot.

    Args:
        robot: index of the robot.
        z: order of painting: below the robots when negative.
        width: of dots and lines, pixels.
        opacity: 0 to 1.
    """

    def __init__(self, robot: int, z: int, width: float, opacity: float = 1.0) -> None:
        self.z = z
        self._robot = robot
        self._width = width
        self._opacity = opacity

    def _pen(self, view: MapView) -> QPen:
        colour = QColor(view.colours.robot(self._robot))
        colour.setAlphaF(self._opacity)
        return QPen(colour, self._width)


class PointLayer(_RobotLayer):
    """A layer of thousands of dots: particles, or the ends of a scan's beams."""

    _points: FloatArray = np.empty((0, 2))

    def show(self, points: FloatArray) -> None:
        """Show (n, 2) points."""
        self._points = points

    def paint(self, painter: QPainter, view: MapView) -> None:
        """Draw the dots as squares without smooth edges, which are painted several times faster than discs."""
        painter.setRenderHint(QPainter.RenderHint.Antialiasing, False)
        pen = self._pen(view)
        pen.setCapStyle(Qt.PenCapStyle.SquareCap)
        painter.setPen(pen)
        painter.drawPoints(polygon(view.camera.to_screen(self._points)))


class LineLayer(_RobotLayer):
    """A layer of lines through points, for example plans."""

    _lines: Sequence[FloatArray] = ()

    def show(self, through: Sequence[FloatArray]) -> None:
        """Show lines, each through (n, 2) points of its own."""
        self._lines = through

    def paint(self, painter: QPainter, view: MapView) -> None:
        """Draw the lines."""
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        painter.setPen(self._pen(view))
        for points in self._lines:
            if len(points) > 1:
                pixels = view.camera.to_screen(points)
                painter.drawLines(lines(pixels[:-1], pixels[1:]))


class PoseLayer(_RobotLayer):
    """A layer of poses, drawn as arrows that start there."""

    _poses: FloatArray = np.empty((0, 3))

    def show(self, poses: FloatArray) -> None:
        """Show (n, 3) poses: x, y, theta."""
        self._poses = poses

    def paint(self, painter: QPainter, view: MapView) -> None:
        """Draw the arrows."""
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        painter.setPen(self._pen(view))
        tails, theta = self._poses[:, :2], self._poses[:, 2]
        heads = tails + ARROW * np.stack((np.cos(theta), np.sin(theta)), axis=1)
        strokes = [(tails, heads)]
        for side in (math.radians(150.0), -math.radians(150.0)):
            barb = np.stack((np.cos(theta + side), np.sin(theta + side)), axis=1)
            strokes.append((heads, heads + 0.35 * ARROW * barb))
        for one, other in strokes:
            painter.drawLines(lines(view.camera.to_screen(one), view.camera.to_screen(other)))


def _cost_colours() -> NDArray[np.uint8]:
    """Return (256, 4) red, green, blue, opacity of each cost as published in ROS, read as an unsigned byte.

    Source: rviz's costmap colours: blue to red from 1 to 98, cyan (99) for inscribed, magenta (100) for lethal,
    grey-green (255) for unknown, green and yellow for values without a meaning. Differs: half transparent.
    """
    colours = np.zeros((256, 4), dtype=np.uint8)
    ramp = np.arange(1, 99) * 255 // 100
    colours[1:99, 0], colours[1:99, 2] = ramp, 255 - ramp
    colours[99, :3] = (0, 255, 255)
    colours[100, :3] = (255, 0, 255)
    colours[101:128, :3] = (0, 255, 0)
    colours[128:255, :3] = (255, 255, 0)
    colours[255, :3] = (0x70, 0x89, 0x86)
    colours[1:, 3] = 150
    return colours


_COST_COLOURS = _cost_colours()


class CostmapImageLayer:
    """A layer that shows a costmap as a picture in rviz's colours.

    Args:
        z: below the robots when negative.
    """

    def __init__(self, z: int) -> None:
        self.z = z
        self._image = QImage()
        self._origin = Pose2(0.0, 0.0, 0.0)
        self._resolution = 1.0

    def show(self, costs: NDArray[np.int8], origin: Pose2, resolution: float) -> None:
        """Show costs as nav_msgs/OccupancyGrid has them: (rows, cols), row 0 at the origin; 0 to 100, -1 unknown."""
        rows, cols = costs.shape
        memory = _COST_COLOURS[costs.astype(np.uint8)].tobytes()
        # The image borrows this memory; its converted copy has its own.
        borrowed = QImage(memory, cols, rows, 4 * cols, QImage.Format.Format_RGBA8888)
        self._image = borrowed.convertToFormat(QImage.Format.Format_ARGB32_Premultiplied)
        self._origin, self._resolution = origin, resolution

    def clear(self) -> None:
        """Show nothing."""
        self._image = QImage()

    def paint(self, painter: QPainter, view: MapView) -> None:
        """Draw the picture, cell by cell, without blur."""
        px, py = view.camera.pixel(self._origin.x, self._origin.y)
        cell = self._resolution * view.camera.scale
        turned = QTransform.fromTranslate(px, py).rotateRadians(-self._origin.theta).scale(cell, -cell)
        painter.setTransform(turned, True)
        painter.drawImage(QPointF(0.0, 0.0), self._image)
