"""Robots' labels: small pictures made once, and places for them where they cover neither each other nor a robot."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from PySide6.QtCore import QPointF, QRectF, Qt
from PySide6.QtGui import QColor, QFont, QFontMetricsF, QPainter, QPen, QPixmap, QPolygonF

from sim.geometry import FloatArray
from ui.model.theme import Palette

HEIGHT = 20.0
"""Of a label, pixels."""

TEXT = 12
"""Height of its letters, pixels."""

GAP = 4.0
"""Pixels between a robot and its label."""

_SIDES = np.array([(0, -1), (0, 1), (1, 0), (-1, 0), (1, -1), (-1, -1), (1, 1), (-1, 1)], dtype=np.float64)
_REACHES = (1.0, 1.9, 2.8)
"""Where labels may lie about their robot, best first; and how far off, in heights of a label."""

OVERLAP, COVERS, LESS_GOOD, MOVED = 4.0, 1.0, 6.0, 30.0
"""Weights: square pixels over another label, or over a robot; a less good place; leaving the place it has."""


@dataclass(frozen=True, slots=True)
class Anchor:
    """What a label belongs to: a robot's middle and radius on the screen, and the label's size, pixels."""

    x: float
    y: float
    radius: float
    width: float
    height: float


def placed(anchors: Sequence[Anchor], before: Sequence[int]) -> tuple[FloatArray, list[int]]:
    """Where labels go, first come first served.

    Args:
        anchors: in order of precedence.
        before: for each, the number of the place it had, so that labels do not hop about; -1 for none.

    Returns:
        (n, 2) upper left corners, and the places' numbers.
    """
    corners = np.zeros((len(anchors), 2))
    numbers: list[int] = []
    bodies = np.array([(a.x - a.radius, a.y - a.radius, a.x + a.radius, a.y + a.radius) for a in anchors])
    taken = np.zeros((len(anchors), 4))
    for at, (anchor, had) in enumerate(zip(anchors, before, strict=True)):
        choices = _choices(anchor)
        size = np.array([anchor.width, anchor.height])
        boxes = np.concatenate((choices, choices + size), axis=1)
        cost = LESS_GOOD * np.arange(len(choices), dtype=np.float64)
        cost += OVERLAP * _overlap(boxes, taken[:at]) + COVERS * _overlap(boxes, bodies)
        if had >= 0:
            cost[np.arange(len(cost)) != had] += MOVED
        number = int(np.argmin(cost))
        corners[at], taken[at] = choices[number], boxes[number]
        numbers.append(number)
    return corners, numbers


def _choices(anchor: Anchor) -> FloatArray:
    """(k, 2) upper left corners where a label may lie."""
    half = np.array([anchor.width, anchor.height]) / 2.0
    reach = anchor.radius + GAP + half
    rings = [(anchor.x, anchor.y) + _SIDES * (reach + (ring - 1.0) * anchor.height) - half for ring in _REACHES]
    return np.concatenate(rings)


def _overlap(boxes: FloatArray, others: FloatArray) -> FloatArray:
    """(k,) area that each of (k, 4) boxes shares with (m, 4) others."""
    across = np.minimum(boxes[:, None, 2], others[None, :, 2]) - np.maximum(boxes[:, None, 0], others[None, :, 0])
    down = np.minimum(boxes[:, None, 3], others[None, :, 3]) - np.maximum(boxes[:, None, 1], others[None, :, 1])
    area: FloatArray = np.sum(np.clip(across, 0.0, None) * np.clip(down, 0.0, None), axis=1)
    return area


@dataclass(frozen=True, slots=True)
class Badge:
    """A label's picture and its size in logical pixels."""

    picture: QPixmap
    width: float
    height: float


class Badges:
    """Labels as pictures, each made once."""

    def __init__(self) -> None:
        self._made: dict[tuple[str, str, bool, bool, float, str], Badge] = {}

    def clear(self) -> None:
        """Another palette or font."""
        self._made.clear()

    def of(
        self, label: str, colour: str, selected: bool, trouble: bool, palette: Palette, font: QFont, ratio: float
    ) -> Badge:
        """The picture of a label: filled for the selected robot, with a warning sign for one in trouble."""
        key = (label, colour, selected, trouble, ratio, palette.panel)
        badge = self._made.get(key)
        if badge is None:
            badge = self._made[key] = _made(label, colour, selected, trouble, palette, font, ratio)
        return badge


def _made(label: str, colour: str, selected: bool, trouble: bool, palette: Palette, font: QFont, ratio: float) -> Badge:
    lettering = QFont(font)
    lettering.setPixelSize(TEXT)
    lettering.setWeight(QFont.Weight.Bold)
    metrics = QFontMetricsF(lettering)
    sign = 19.0 if trouble else 0.0
    width = float(round(max(metrics.horizontalAdvance(label) + sign + 13.0, HEIGHT)))
    picture = QPixmap(round(width * ratio), round(HEIGHT * ratio))
    picture.setDevicePixelRatio(ratio)
    picture.fill(Qt.GlobalColor.transparent)
    painter = QPainter(picture)
    painter.setRenderHint(QPainter.RenderHint.Antialiasing)
    painter.setPen(QPen(QColor(palette.panel if selected else colour), 1.5))
    painter.setBrush(QColor(colour if selected else palette.panel))
    pill = QRectF(0.75, 0.75, width - 1.5, HEIGHT - 1.5)
    painter.drawRoundedRect(pill, pill.height() / 2.0, pill.height() / 2.0)
    if trouble:
        _paint_warning(painter, palette, lettering)
    painter.setFont(lettering)
    painter.setPen(QColor(palette.panel if selected else palette.text))
    baseline = (HEIGHT + metrics.capHeight()) / 2.0
    painter.drawText(QPointF(sign + (width - sign - metrics.horizontalAdvance(label)) / 2.0, baseline), label)
    painter.end()
    return Badge(picture, width, HEIGHT)


def _paint_warning(painter: QPainter, palette: Palette, font: QFont) -> None:
    """A triangle with an exclamation mark, in the left of a label."""
    painter.setPen(Qt.PenStyle.NoPen)
    painter.setBrush(QColor(palette.bad))
    painter.drawPolygon(QPolygonF([QPointF(13.0, 2.5), QPointF(20.5, 16.0), QPointF(5.5, 16.0)]))
    painter.setPen(QColor(palette.panel))
    mark = QFont(font)
    mark.setPixelSize(10)
    painter.setFont(mark)
    painter.drawText(QRectF(6.0, 5.0, 14.0, 11.0), Qt.AlignmentFlag.AlignCenter, "!")
