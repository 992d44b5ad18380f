"""Scale bar of the map."""

from PySide6.QtCore import QLineF, QPointF, QRectF, Qt
from PySide6.QtGui import QColor, QFont, QFontMetricsF, QPainter, QPen

from ui.model.theme import Palette
from ui.windows.map.camera import Camera
from ui.windows.map.lettering import sized, text_scale

LENGTHS = (0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 50.0)
"""Lengths that a bar may have, metres."""

SHORTEST = 60.0
"""Least length of a bar, pixels at the usual size of text."""


def paint_scale_bar(painter: QPainter, camera: Camera, palette: Palette, font: QFont) -> None:
    """Paint a bar of a round number of metres in the lower right corner."""
    scale = text_scale(font)
    metres = next((length for length in LENGTHS if length * camera.scale >= SHORTEST * scale), LENGTHS[-1])
    length = metres * camera.scale
    right, bottom = camera.width - 14.0, camera.height - 8.0
    left = right - length
    backing = QColor(palette.panel)
    backing.setAlpha(215)
    painter.setPen(Qt.PenStyle.NoPen)
    painter.setBrush(backing)
    high = 12.0 + 11.0 * scale
    painter.drawRoundedRect(QRectF(left - 8.0, bottom + 4.0 - high, length + 16.0, high), 6.0, 6.0)
    painter.setPen(QPen(QColor(palette.muted), 2.0))
    ends = [QLineF(x, bottom - 4.0, x, bottom) for x in (left, right)]
    painter.drawLines([QLineF(left, bottom, right, bottom), *ends])
    lettering = sized(font, 11.0 * scale, font.weight())
    words = f"{metres:g} m"
    width = QFontMetricsF(lettering).horizontalAdvance(words)
    painter.setFont(lettering)
    painter.drawText(QPointF((left + right - width) / 2.0, bottom - 5.0), words)
