"""Layer over the map of an arena: doors, goals, corners of the chosen room, the chosen start, boxes and lines."""

import math

from PySide6.QtCore import QPointF, QRectF, Qt
from PySide6.QtGui import QColor, QPainter, QPen

from sim.common.geometry import Pose2
from ui.model.arena_draft import ArenaPointer, ArenaTool
from ui.windows.map.view import MapView

GOAL_RADIUS = 5.0
CORNER_SIDE = 9.0
CHOSEN_RADIUS = 16.0
"""Pixels."""
DOOR = 6.0
"""Half a door's diamond, pixels."""
_DIAMOND = ((1, 0), (0, 1), (-1, 0), (0, -1))
AHEAD = 14.0
"""Length of the line along a pose's yaw, pixels."""


class ArenaLayer:
    """Layer of handles and strokes."""

    z = 1

    def __init__(self, pointer: ArenaPointer) -> None:
        self._pointer = pointer

    def paint(self, painter: QPainter, view: MapView) -> None:
        """Draw as the pointer stands now."""
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        ink, accent = QColor(view.colours.text), QColor(view.colours.accent)
        arena, pointer = self._pointer.shown, self._pointer
        for room in arena.rooms:
            painter.setPen(QPen(ink, 1.5))
            painter.setBrush(accent if room.room.people == pointer.chosen else QColor(view.colours.panel))
            middle = _pixel(view, room.goal)
            painter.drawLine(middle, _ahead(view, room.goal))
            painter.drawEllipse(middle, GOAL_RADIUS, GOAL_RADIUS)
        painter.setPen(Qt.PenStyle.NoPen)
        painter.setBrush(QColor(view.colours.bad))
        for door in pointer.draft.doors():
            px, py = view.camera.pixel(door.x, door.y)
            painter.drawPolygon([QPointF(px + dx * DOOR, py + dy * DOOR) for dx, dy in _DIAMOND])
        if pointer.chosen is not None and pointer.chosen <= len(arena.rooms):
            painter.setBrush(QColor(view.colours.panel))
            painter.setPen(QPen(accent, 2.0))
            for x, y in arena.rooms[pointer.chosen - 1].region:
                px, py = view.camera.pixel(x, y)
                painter.drawRect(QRectF(px - CORNER_SIDE / 2, py - CORNER_SIDE / 2, CORNER_SIDE, CORNER_SIDE))
        painter.setBrush(Qt.BrushStyle.NoBrush)
        if pointer.start is not None and pointer.start < len(arena.starts):
            painter.setPen(QPen(accent, 3.0))
            painter.drawEllipse(_pixel(view, arena.starts[pointer.start]), CHOSEN_RADIUS, CHOSEN_RADIUS)
        if pointer.stroke is not None:
            one, other = (QPointF(*view.camera.pixel(*point)) for point in pointer.stroke)
            painter.setPen(QPen(accent, 2.0, Qt.PenStyle.DashLine))
            if pointer.tool is ArenaTool.ROOM:
                painter.drawRect(QRectF(one, other).normalized())
            else:
                painter.drawLine(one, other)


def _pixel(view: MapView, pose: Pose2) -> QPointF:
    return QPointF(*view.camera.pixel(pose.x, pose.y))


def _ahead(view: MapView, pose: Pose2) -> QPointF:
    middle = _pixel(view, pose)
    return middle + QPointF(AHEAD * math.cos(pose.theta), -AHEAD * math.sin(pose.theta))
