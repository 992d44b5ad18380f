"""Scale bar of the map."""

from PySide6.QtCore import QLineF, QPointF, QRectF, Qt
from PySide6.QtGui import QColor, QFontMetricsF, QPainter, QPen, QTransform

from ui.windows.map.item import MapItem
from ui.windows.map.lettering import sized, text_scale

LENGTHS = (0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 50.0)
"""Possible lengths of a bar, meters."""

SHORTEST = 60.0
"""Smallest length of a bar, pixels at the usual size of text."""

LONGEST = 2.5 * SHORTEST
"""Maximum length of a bar, pixels at the usual size of text. Each length is at most 2.5 times the next shorter length.
"""


class ScaleBar(MapItem):
    """Scale bar in the lower right corner. Its length is a round number of meters.

    The length of pyqtgraph's own bar is fixed.
    """

    def boundingRect(self) -> QRectF:
        """Return the lower right corner, with space for the longest bar."""
        scale, whole = text_scale(self.box.letters), self.box.rect()
        wide, high = LONGEST * scale + 30.0, 12.0 + 11.0 * scale + 6.0
        return QRectF(whole.width() - wide, whole.height() - high, wide, high)

    def draw(self, painter: QPainter, to_pixels: QTransform) -> None:
        """Draw the bar."""
        font, palette = self.box.letters, self.box.colors
        scale = text_scale(font)
        meters = next((length for length in LENGTHS if length * to_pixels.m11() >= SHORTEST * scale), LENGTHS[-1])
        length = meters * to_pixels.m11()
        right, bottom = self.box.rect().width() - 14.0, self.box.rect().height() - 8.0
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
        words = f"{meters:g} m"
        width = QFontMetricsF(lettering).horizontalAdvance(words)
        painter.setFont(lettering)
        painter.drawText(QPointF((left + right - width) / 2.0, bottom - 5.0), words)
