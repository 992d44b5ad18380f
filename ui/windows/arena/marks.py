"""Marks on the map of an arena: doors, goals, corners of the chosen room, the chosen start pose, boxes and lines."""

import math

from PySide6.QtCore import QPointF, QRectF, Qt
from PySide6.QtGui import QColor, QPainter, QPen, QPolygonF, QTransform

from sim.common.geometry import Pose2
from ui.model.arena.draft import ArenaPointer, ArenaTool
from ui.windows.map.box import MapBox
from ui.windows.map.item import Z_ABOVE, MapItem
from ui.windows.map.points import pixel

GOAL_RADIUS = 5.0
CHOSEN_RADIUS = 16.0
"""Radius of the circle around the chosen start pose, pixels."""
CORNER = QRectF(-4.5, -4.5, 9.0, 9.0)
"""Shape that marks a corner of the chosen room: a square, in pixels."""
DIAMOND = QPolygonF([QPointF(6.0, 0.0), QPointF(0.0, 6.0), QPointF(-6.0, 0.0), QPointF(0.0, -6.0)])
"""Shape that marks a door: a diamond, in pixels."""
AHEAD = 14.0
"""Length of the line that shows a pose's heading, pixels."""


class ArenaMarks(MapItem):
    """Marks of goals, doors, corners and the chosen start pose, and the box or line that a person is drawing."""

    def __init__(self, box: MapBox, pointer: ArenaPointer) -> None:
        super().__init__(box, Z_ABOVE)
        self._pointer = pointer

    def draw(self, painter: QPainter, to_pixels: QTransform) -> None:
        """Draw all marks, and the box or line that a person is drawing."""
        ink, accent = QColor(self.box.colors.text), QColor(self.box.colors.accent)
        arena, pointer = self._pointer.shown, self._pointer
        for room in arena.rooms:
            painter.setPen(QPen(ink, 1.5))
            painter.setBrush(accent if room.room.people == pointer.chosen else QColor(self.box.colors.panel))
            middle = _pixel(to_pixels, room.goal)
            painter.drawLine(middle, _ahead(to_pixels, room.goal))
            painter.drawEllipse(middle, GOAL_RADIUS, GOAL_RADIUS)
        painter.setPen(Qt.PenStyle.NoPen)
        painter.setBrush(QColor(self.box.colors.bad))
        for door in pointer.draft.floor.doors(pointer.draft.arena):
            painter.drawPolygon(DIAMOND.translated(pixel(to_pixels, door.x, door.y)))
        if pointer.chosen is not None and pointer.chosen <= len(arena.rooms):
            painter.setBrush(QColor(self.box.colors.panel))
            painter.setPen(QPen(accent, 2.0))
            for x, y in arena.rooms[pointer.chosen - 1].region:
                painter.drawRect(CORNER.translated(pixel(to_pixels, x, y)))
        painter.setBrush(Qt.BrushStyle.NoBrush)
        if pointer.start is not None and pointer.start < len(arena.starts):
            painter.setPen(QPen(accent, 3.0))
            painter.drawEllipse(_pixel(to_pixels, arena.starts[pointer.start]), CHOSEN_RADIUS, CHOSEN_RADIUS)
        if pointer.stroke is not None:
            one, other = (pixel(to_pixels, *point) for point in pointer.stroke)
            painter.setPen(QPen(accent, 2.0, Qt.PenStyle.DashLine))
            if pointer.tool is ArenaTool.ROOM:
                painter.drawRect(QRectF(one, other).normalized())
            else:
                painter.drawLine(one, other)


def _pixel(to_pixels: QTransform, pose: Pose2) -> QPointF:
    return pixel(to_pixels, pose.x, pose.y)


def _ahead(to_pixels: QTransform, pose: Pose2) -> QPointF:
    middle = _pixel(to_pixels, pose)
    return middle + QPointF(AHEAD * math.cos(pose.theta), -AHEAD * math.sin(pose.theta))
