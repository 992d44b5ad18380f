"""Rooms on the map: a state is told by sign, pattern and colour; what can be chosen has an edge that invites."""

from collections.abc import Sequence

import numpy as np
from PySide6.QtCore import QLineF, QPointF, QRectF, Qt
from PySide6.QtGui import QBrush, QColor, QFont, QFontMetricsF, QPainter, QPainterPath, QPen

from sim.geometry import FloatArray
from ui.model.scene import RoomMark
from ui.model.theme import Palette
from ui.windows.map.camera import Camera
from ui.windows.map.plan import room_box
from ui.windows.map.points import polygon

HATCH = 11.0
"""Pixels between two lines of the pattern of a reserved room."""

DOTS = 16.0
"""Pixels between two dots of the pattern of a visited room."""

SIGN = 11.0
"""Radius of a room's sign, pixels."""

PATTERN_ALPHA = 46
"""Of a pattern: seen, yet not in the way of what drives over it."""

NUMBER_LEAST, NUMBER_MOST = 15.0, 40.0
"""Height of a room's number, pixels."""

NAME = 13.0
"""Height of a room's name, pixels."""


def paint_floors(painter: QPainter, camera: Camera, rooms: Sequence[RoomMark], palette: Palette) -> None:
    """The floors of the rooms and their patterns; walls are painted over their edges."""
    for mark in rooms:
        outline = polygon(camera.to_screen(mark.region))
        colours = {"unvisited": palette.unvisited, "reserved": palette.reserved, "visited": palette.visited}
        painter.setPen(Qt.PenStyle.NoPen)
        painter.setBrush(QColor(colours[mark.state]))
        painter.drawPolygon(outline)
        if mark.state != "unvisited":
            path = QPainterPath()
            path.addPolygon(outline)
            painter.save()
            painter.setClipPath(path)
            if mark.state == "reserved":
                _hatch(painter, outline.boundingRect(), _faint(palette.text))
            else:
                _dot(painter, outline.boundingRect(), _faint(palette.text))
            painter.restore()


def paint_signs(painter: QPainter, camera: Camera, rooms: Sequence[RoomMark], palette: Palette, font: QFont) -> None:
    """Edges, numbers, names, signs of state and what was found: over walls, under robots."""
    painter.save()
    painter.setRenderHint(QPainter.RenderHint.Antialiasing)
    for mark in sorted(rooms, key=lambda mark: (mark.considered, mark.choosable)):
        _paint_edge(painter, camera, mark, palette)
        left, bottom, right, top = room_box(mark.region)
        corner, opposite = camera.pixel(left, top), camera.pixel(right, bottom)
        _paint_words(painter, QRectF(QPointF(*corner), QPointF(*opposite)), mark, palette, font)
    painter.restore()


def _paint_edge(painter: QPainter, camera: Camera, mark: RoomMark, palette: Palette) -> None:
    if not mark.choosable and not mark.considered:
        return
    width = 4.0 if mark.considered else 2.0
    pen = QPen(QColor(palette.accent), width)
    pen.setJoinStyle(Qt.PenJoinStyle.MiterJoin)
    if not mark.choosable:
        pen.setStyle(Qt.PenStyle.DotLine)
    painter.setPen(pen)
    glow = QColor(palette.accent)
    glow.setAlpha(38)
    painter.setBrush(QBrush(glow) if mark.considered else Qt.BrushStyle.NoBrush)
    painter.drawPolygon(polygon(camera.to_screen(mark.region)))


def _paint_words(painter: QPainter, box: QRectF, mark: RoomMark, palette: Palette, font: QFont) -> None:
    small = min(box.width(), box.height())
    number = min(max(small * 0.2, NUMBER_LEAST), NUMBER_MOST)
    inset = min(max(small * 0.07, 6.0), 16.0)
    inner = box.adjusted(inset, inset, -inset, -inset)
    if inner.width() < number or inner.height() < number * 0.8:
        return
    text = str(mark.room)
    painter.setPen(QColor(palette.text))
    painter.setFont(_sized(font, number, QFont.Weight.DemiBold))
    metrics = QFontMetricsF(painter.font())
    height = metrics.capHeight()
    painter.drawText(QPointF(inner.left(), inner.top() + height), text)
    beside = inner.left() + metrics.horizontalAdvance(text)
    if inner.right() - beside < 2.0 * SIGN + 6.0:
        return
    sign = QPointF(inner.right() - SIGN, inner.top() + max(height / 2.0, SIGN))
    _paint_sign(painter, sign, mark, palette)
    below = inner.top() + height
    painter.setFont(_sized(font, NAME, QFont.Weight.Normal))
    metrics = QFontMetricsF(painter.font())
    line = metrics.height()
    if inner.bottom() - below < 1.4 * line:
        return
    painter.setPen(QColor(palette.muted))
    name = metrics.elidedText(mark.name, Qt.TextElideMode.ElideRight, inner.width())
    painter.drawText(QPointF(inner.left(), below + 0.35 * line + metrics.ascent()), name)
    if mark.found and inner.bottom() - below > 2.9 * line:
        _paint_found(painter, inner, mark.found, palette, font)


def _paint_found(painter: QPainter, inner: QRectF, found: str, palette: Palette, font: QFont) -> None:
    painter.setFont(_sized(font, NAME, QFont.Weight.Medium))
    metrics = QFontMetricsF(painter.font())
    words = metrics.elidedText(found, Qt.TextElideMode.ElideRight, inner.width() - 16.0)
    pill = QRectF(0.0, 0.0, metrics.horizontalAdvance(words) + 16.0, metrics.height() + 6.0)
    pill.moveBottomLeft(inner.bottomLeft())
    painter.setPen(QPen(QColor(palette.line), 1.0))
    painter.setBrush(QColor(palette.panel))
    painter.drawRoundedRect(pill, pill.height() / 2.0, pill.height() / 2.0)
    painter.setPen(QColor(palette.text))
    painter.drawText(pill, Qt.AlignmentFlag.AlignCenter, words)


def _paint_sign(painter: QPainter, centre: QPointF, mark: RoomMark, palette: Palette) -> None:
    """An open circle: not visited; arrows in the robot's colour: a robot is coming; a tick: visited."""
    x, y = centre.x(), centre.y()
    colour = QColor(palette.line if mark.robot is None else palette.robot(mark.robot))
    if mark.state == "unvisited":
        painter.setPen(QPen(QColor(palette.line), 2.0))
        painter.setBrush(Qt.BrushStyle.NoBrush)
        painter.drawEllipse(centre, SIGN - 3.0, SIGN - 3.0)
        return
    if mark.state == "reserved":
        painter.setPen(QPen(colour, 2.0))
        painter.setBrush(QColor(palette.panel))
        painter.drawEllipse(centre, SIGN, SIGN)
        strokes = [[(-5.0, -4.5), (-0.5, 0.0), (-5.0, 4.5)], [(0.5, -4.5), (5.0, 0.0), (0.5, 4.5)]]
    else:
        painter.setPen(Qt.PenStyle.NoPen)
        painter.setBrush(colour)
        painter.drawEllipse(centre, SIGN, SIGN)
        colour = QColor(palette.panel)
        strokes = [[(-5.0, 0.5), (-1.5, 4.0), (5.0, -3.5)]]
    pen = QPen(colour, 2.4)
    pen.setCapStyle(Qt.PenCapStyle.RoundCap)
    pen.setJoinStyle(Qt.PenJoinStyle.RoundJoin)
    painter.setPen(pen)
    for stroke in strokes:
        painter.drawPolyline(polygon(np.array(stroke) + np.array([x, y])))


def _hatch(painter: QPainter, rect: QRectF, colour: QColor) -> None:
    painter.setRenderHint(QPainter.RenderHint.Antialiasing)
    painter.setPen(QPen(colour, 1.5))
    height = rect.height()
    starts = np.arange(rect.left() - height, rect.right(), HATCH)
    painter.drawLines([QLineF(x, rect.bottom(), x + height, rect.top()) for x in starts.tolist()])


def _dot(painter: QPainter, rect: QRectF, colour: QColor) -> None:
    painter.setRenderHint(QPainter.RenderHint.Antialiasing)
    pen = QPen(colour, 2.5)
    pen.setCapStyle(Qt.PenCapStyle.RoundCap)
    painter.setPen(pen)
    xs, ys = np.arange(rect.left(), rect.right(), DOTS), np.arange(rect.top(), rect.bottom(), DOTS)
    grid: FloatArray = np.stack(np.meshgrid(xs, ys), axis=-1).reshape(-1, 2)
    painter.drawPoints(polygon(grid))


def _faint(colour: str) -> QColor:
    faint = QColor(colour)
    faint.setAlpha(PATTERN_ALPHA)
    return faint


def _sized(font: QFont, pixels: float, weight: QFont.Weight) -> QFont:
    sized = QFont(font)
    sized.setPixelSize(round(pixels))
    sized.setWeight(weight)
    return sized
