"""Combo boxes with a clearly visible arrow.

The style sheet of `look` sets the edges of combo boxes. Qt then omits its own arrow, so this module paints an arrow.
Qt's arrow would also be too faint on dark backgrounds.
"""

from PySide6.QtCore import QPointF, Qt
from PySide6.QtGui import QColor, QPainter, QPaintEvent, QPen
from PySide6.QtWidgets import QComboBox

from ui.windows.look import GAP, colours, px


class ChoiceBox(QComboBox):
    """Combo box with a visible arrow."""

    def paintEvent(self, event: QPaintEvent) -> None:
        """Draw the box and its arrow."""
        super().paintEvent(event)
        x, y = self.width() - 2.0 * GAP, self.height() / 2.0
        side = px(4)
        painter = QPainter(self)
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        pen = QPen(self.palette().text().color() if self.isEnabled() else QColor(colours().muted), 1.5)
        pen.setCapStyle(Qt.PenCapStyle.RoundCap)
        painter.setPen(pen)
        painter.drawPolyline(
            [QPointF(x - side, y - side / 2), QPointF(x, y + side / 2), QPointF(x + side, y - side / 2)]
        )
