"""Preview of a tool's effect, drawn on the map while the button is down."""

import math

from PySide6.QtCore import QPointF, QRectF, Qt
from PySide6.QtGui import QColor, QPainter, QPen, QPolygonF

from sim.common.geometry import Pose2
from sim.numerics.float_array import FloatArray
from ui.model.watching.tools import Shape, obstacle
from ui.windows.map import MapView
from ui.windows.researcher.map.tools import Gesture, MapTool

HEAD = 14.0
"""Length of an arrow's head, pixels."""


class ToolPreview:
    """A layer with the stroke of a tool.

    Attributes:
        gesture: the stroke so far; None draws nothing.
        shape: of an obstacle.
        body: (n, 2) corners of the robot that is carried, in its own frame.
        heading: of that robot, radians.
    """

    z = 100

    def __init__(self) -> None:
        self.gesture: Gesture | None = None
        self.shape: Shape = "circle"
        self.body: FloatArray | None = None
        self.heading = 0.0

    def paint(self, painter: QPainter, view: MapView) -> None:
        """Draw the stroke so far."""
        gesture = self.gesture
        if gesture is None:
            return
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        colour = QColor(view.colours.accent)
        painter.setPen(QPen(colour, 2.5))
        colour.setAlpha(60)
        painter.setBrush(colour)
        match gesture.tool:
            case MapTool.GOAL | MapTool.POSE:
                self._arrow(painter, view, gesture)
            case MapTool.CARRY:
                self._ghost(painter, view, gesture)
            case MapTool.OBSTACLE:
                thing = obstacle("", self.shape, Pose2(gesture.x, gesture.y, 0.0), gesture.size)
                painter.drawPolygon(
                    QPolygonF(
                        [
                            QPointF(*view.camera.pixel(thing.base_in_map.x + x, thing.base_in_map.y + y))
                            for x, y in thing.footprint
                        ]
                    )
                )

    def _arrow(self, painter: QPainter, view: MapView, gesture: Gesture) -> None:
        start = QPointF(*view.camera.pixel(gesture.x, gesture.y))
        end = QPointF(*view.camera.pixel(gesture.to_x, gesture.to_y))
        painter.drawEllipse(start, 5.0, 5.0)
        if gesture.is_click:
            return
        painter.drawLine(start, end)
        sides = [
            end + QPointF(-HEAD * math.cos(gesture.heading + turn), HEAD * math.sin(gesture.heading + turn))
            for turn in (0.45, -0.45)
        ]
        painter.setBrush(QColor(view.colours.accent))
        painter.drawPolygon(QPolygonF([end, *sides]))

    def _ghost(self, painter: QPainter, view: MapView, gesture: Gesture) -> None:
        pen = QPen(QColor(view.colours.accent), 2.0, Qt.PenStyle.DashLine)
        painter.setPen(pen)
        painter.drawLine(
            QPointF(*view.camera.pixel(gesture.x, gesture.y)), QPointF(*view.camera.pixel(gesture.to_x, gesture.to_y))
        )
        if self.body is not None:
            corners = Pose2(gesture.to_x, gesture.to_y, self.heading).transform(self.body)
            painter.drawPolygon(QPolygonF([QPointF(*view.camera.pixel(x, y)) for x, y in corners.tolist()]))
        else:
            x, y = view.camera.pixel(gesture.to_x, gesture.to_y)
            painter.drawEllipse(QRectF(x - 10.0, y - 10.0, 20.0, 20.0))
