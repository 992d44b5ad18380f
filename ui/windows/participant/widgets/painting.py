"""Functions that paint parts of buttons, cards and tiles in the same style everywhere."""

from collections.abc import Sequence
from typing import Literal

from PySide6.QtCore import QPointF, QRectF, Qt
from PySide6.QtGui import QBrush, QColor, QFont, QFontMetricsF, QPainter, QPainterPath, QPen, QPixmap

from sim.common.robot_numbers import number_of
from ui.windows.look import GAP, RADIUS, RING, colours, font, smooth_painter, text_colour_on

Sign = Literal["open", "arrow", "dot", "tick", "cross", "trouble", "busy", "talk", "mast"]
"""Names of signs. Their meanings, in this order: not visited, robot on its way, visited, won, lost, problem, requested
but not done, speech of a person or robot, another commander."""


LEFT = Qt.AlignmentFlag.AlignLeft | Qt.AlignmentFlag.AlignVCenter
WRAPPED = LEFT | Qt.TextFlag.TextWordWrap
"""Alignment of words in an area: on the left, vertically centered, on one line or wrapped to several lines."""


def write(
    painter: QPainter, area: QRectF, words: str, type_: QFont, ink: str | QColor, place: Qt.AlignmentFlag | int = LEFT
) -> None:
    """Write words into an area."""
    painter.setFont(type_)
    painter.setPen(QColor(ink))
    painter.drawText(area, place, words)


def box(
    painter: QPainter,
    rect: QRectF,
    fill: str,
    edge: str,
    *,
    width: float = 1.0,
    dashed: bool = False,
    radius: float = RADIUS - 2,
) -> None:
    """Draw a filled box with round corners. The edge of the box is inside the rectangle."""
    pen = QPen(QColor(edge), width)
    if dashed:
        pen.setStyle(Qt.PenStyle.DashLine)
    half = width / 2.0
    painter.setPen(pen)
    painter.setBrush(QColor(fill))
    painter.drawRoundedRect(rect.adjusted(half, half, -half, -half), radius, radius)


def ring(painter: QPainter, rect: QRectF, colour: str) -> None:
    """Draw the focus ring slightly inside the edge of the widget, so that ring and edge remain distinct."""
    inset = RING / 2.0 + 2.0
    painter.setPen(QPen(QColor(colour), RING))
    painter.setBrush(Qt.BrushStyle.NoBrush)
    painter.drawRoundedRect(rect.adjusted(inset, inset, -inset, -inset), RADIUS - 4, RADIUS - 4)


def chip_size() -> float:
    """Return the diameter of a robot's chip, logical pixels."""
    return QFontMetricsF(font("small", bold=True)).height() + GAP / 2.0


def chip(painter: QPainter, centre: QPointF, robot: int) -> None:
    """Draw a robot's chip, a disc with the robot's color and number."""
    colour = colours().robot(robot)
    size = chip_size()
    around = QRectF(centre.x() - size / 2.0, centre.y() - size / 2.0, size, size)
    painter.setPen(Qt.PenStyle.NoPen)
    painter.setBrush(QColor(colour))
    painter.drawEllipse(around)
    place = Qt.AlignmentFlag.AlignCenter
    write(painter, around, str(number_of(robot)), font("small", bold=True), text_colour_on(colour), place)


def key_size(key: str) -> tuple[float, float]:
    """Return the width and height of a key in the form drawn on buttons; (0, 0) if there is no key."""
    if not key:
        return 0.0, 0.0
    metrics = QFontMetricsF(font("small"))
    height = metrics.height() + 3.0
    return max(metrics.horizontalAdvance(key) + GAP, height), height


def key_cap(painter: QPainter, rect: QRectF, key: str, ink: str) -> None:
    """Draw a key in the form that buttons show."""
    painter.setPen(QPen(QColor(ink), 1.0))
    painter.setBrush(Qt.BrushStyle.NoBrush)
    painter.drawRoundedRect(rect.adjusted(0.5, 0.5, -0.5, -0.5), 4, 4)
    painter.setFont(font("small"))
    painter.drawText(rect, Qt.AlignmentFlag.AlignCenter, key)


def sign(painter: QPainter, rect: QRectF, kind: Sign, ink: str) -> None:
    """Draw a sign that shows a state without color."""
    side = min(rect.width(), rect.height())
    area = QRectF(0.0, 0.0, side, side)
    area.moveCenter(rect.center())
    pen = QPen(QColor(ink), max(1.6, side / 8.0))
    pen.setCapStyle(Qt.PenCapStyle.RoundCap)
    pen.setJoinStyle(Qt.PenJoinStyle.RoundJoin)
    painter.setPen(pen)
    painter.setBrush(Qt.BrushStyle.NoBrush)

    def at(x: float, y: float) -> QPointF:
        return QPointF(area.left() + x * side, area.top() + y * side)

    match kind:
        case "open":
            painter.drawEllipse(area.adjusted(side * 0.2, side * 0.2, -side * 0.2, -side * 0.2))
        case "arrow":
            painter.drawPolyline([at(0.1, 0.5), at(0.9, 0.5)])
            painter.drawPolyline([at(0.6, 0.2), at(0.9, 0.5), at(0.6, 0.8)])
        case "dot":
            painter.setBrush(QColor(ink))
            painter.drawEllipse(area.adjusted(side * 0.32, side * 0.32, -side * 0.32, -side * 0.32))
        case "cross":
            painter.drawPolyline([at(0.2, 0.2), at(0.8, 0.8)])
            painter.drawPolyline([at(0.2, 0.8), at(0.8, 0.2)])
        case "tick":
            painter.drawPolyline([at(0.15, 0.55), at(0.4, 0.8), at(0.88, 0.22)])
        case "trouble":
            painter.drawPolygon([at(0.5, 0.06), at(0.97, 0.92), at(0.03, 0.92)])
            painter.drawLine(at(0.5, 0.4), at(0.5, 0.6))
            painter.drawPoint(at(0.5, 0.77))
        case "busy":
            painter.drawEllipse(area.adjusted(side * 0.08, side * 0.08, -side * 0.08, -side * 0.08))
            painter.drawPolyline([at(0.5, 0.25), at(0.5, 0.5), at(0.7, 0.6)])
        case "mast":
            painter.drawPolyline([at(0.5, 0.36), at(0.5, 0.95)])
            for reach in (0.22, 0.44):
                around = QRectF(at(0.5 - reach, 0.36 - reach), at(0.5 + reach, 0.36 + reach))
                # Qt counts angles in sixteenths of a degree.
                painter.drawArc(around, -45 * 16, 90 * 16)
                painter.drawArc(around, 135 * 16, 90 * 16)
        case "talk":
            bubble = QPainterPath()
            bubble.addRoundedRect(QRectF(at(0.05, 0.1), at(0.95, 0.72)), side * 0.18, side * 0.18)
            painter.drawPath(bubble)
            painter.drawPolyline([at(0.3, 0.74), at(0.3, 0.95), at(0.52, 0.74)])


def hatch(ink: str, ground: str) -> QBrush:
    """Return a brush of slanted lines, which marks an amount that an act would cost."""
    key = (ink, ground)
    if key not in _HATCHES:
        tile = QPixmap(6, 6)
        tile.fill(QColor(ground))
        painter = smooth_painter(tile)
        painter.setPen(QPen(QColor(ink), 1.6))
        for shift in (-6, 0, 6):
            painter.drawLine(shift, 6, shift + 6, 0)
        painter.end()
        _HATCHES[key] = tile
    return QBrush(_HATCHES[key])


_HATCHES: dict[tuple[str, str], QPixmap] = {}


def fitting(texts: Sequence[str], width: float, metrics: QFontMetricsF) -> str:
    """Return the first of these texts that fits. If none fits, return the beginning of the last text."""
    whole = (text for text in texts if metrics.horizontalAdvance(text) <= width)
    return next(whole, None) or elided(texts[-1], width, metrics)


def elided(text: str, width: float, metrics: QFontMetricsF) -> str:
    """Return a text, cut with an ellipsis if it does not fit."""
    return metrics.elidedText(text, Qt.TextElideMode.ElideRight, max(0.0, width))
