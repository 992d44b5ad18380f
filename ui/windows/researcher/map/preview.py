"""Preview of a tool's effect, drawn on the map while the button is pressed."""

import math

import numpy as np
from PySide6.QtCore import QPointF, Qt
from PySide6.QtGui import QColor, QPainter, QPen, QPolygonF, QTransform

from sim.common.geometry import Pose2
from sim.numerics.float_array import FloatArray
from ui.model.watching.tools import Shape, obstacle
from ui.windows.map.box import MapBox
from ui.windows.map.item import Z_ABOVE, MapItem
from ui.windows.map.points import mapped, pixel, polygon
from ui.windows.researcher.map.tools import Gesture, MapTool

HEAD = 14.0
"""Length of an arrow's head, pixels."""


class ToolPreview(MapItem):
    """Preview of a tool's stroke.

    Attributes:
        gesture: stroke so far. If None, nothing is drawn.
        thing_shape: shape of a new obstacle.
        body: (n, 2) corners of the robot that is moved by hand, in the robot's own frame.
        heading: heading of this robot, radians.
    """

    def __init__(self, box: MapBox) -> None:
        super().__init__(box, Z_ABOVE + 1)
        self.gesture: Gesture | None = None
        self.thing_shape: Shape = "circle"
        self.body: FloatArray | None = None
        self.heading = 0.0

    def draw(self, painter: QPainter, to_pixels: QTransform) -> None:
        """Draw the stroke so far."""
        gesture = self.gesture
        if gesture is None:
            return
        color = QColor(self.box.colors.accent)
        painter.setPen(QPen(color, 2.5))
        color.setAlpha(60)
        painter.setBrush(color)
        match gesture.tool:
            case MapTool.GOAL | MapTool.POSE:
                self._arrow(painter, to_pixels, gesture)
            case MapTool.CARRY:
                self._ghost(painter, to_pixels, gesture)
            case MapTool.OBSTACLE:
                thing = obstacle("", self.thing_shape, Pose2(gesture.x, gesture.y, 0.0), gesture.size)
                corners = thing.base_in_map.transform(np.array(thing.footprint))
                painter.drawPolygon(polygon(mapped(to_pixels, corners)))

    def _arrow(self, painter: QPainter, to_pixels: QTransform, gesture: Gesture) -> None:
        start, end = pixel(to_pixels, gesture.x, gesture.y), pixel(to_pixels, gesture.to_x, gesture.to_y)
        painter.drawEllipse(start, 5.0, 5.0)
        if gesture.is_click:
            return
        painter.drawLine(start, end)
        sides = [
            end + QPointF(-HEAD * math.cos(gesture.heading + turn), HEAD * math.sin(gesture.heading + turn))
            for turn in (0.45, -0.45)
        ]
        painter.setBrush(QColor(self.box.colors.accent))
        painter.drawPolygon(QPolygonF([end, *sides]))

    def _ghost(self, painter: QPainter, to_pixels: QTransform, gesture: Gesture) -> None:
        painter.setPen(QPen(QColor(self.box.colors.accent), 2.0, Qt.PenStyle.DashLine))
        end = pixel(to_pixels, gesture.to_x, gesture.to_y)
        painter.drawLine(pixel(to_pixels, gesture.x, gesture.y), end)
        if self.body is not None:
            corners = Pose2(gesture.to_x, gesture.to_y, self.heading).transform(self.body)
            painter.drawPolygon(polygon(mapped(to_pixels, corners)))
        else:
            painter.drawEllipse(end, 10.0, 10.0)
