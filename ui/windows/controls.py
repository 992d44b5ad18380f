"""Combo boxes and check boxes whose edges and signs everybody can see; Qt's own are too faint on dark ground.

The style sheet of `look` gives them their edges. Qt then leaves out the signs inside, so they are painted here.
"""

from PySide6.QtCore import QPointF, Qt
from PySide6.QtGui import QColor, QPainter, QPaintEvent, QPen
from PySide6.QtWidgets import QCheckBox, QComboBox, QStyle, QStyleOptionButton

from ui.windows.look import GAP, colours, px


class ChoiceBox(QComboBox):
    """A combo box with a visible arrow."""

    def paintEvent(self, event: QPaintEvent) -> None:
        """Draw the box and its arrow."""
        super().paintEvent(event)
        x, y = self.width() - 2.0 * GAP, self.height() / 2.0
        colour = self.palette().text().color() if self.isEnabled() else QColor(colours().muted)
        side = px(4)
        arrow = [QPointF(x - side, y - side / 2), QPointF(x, y + side / 2), QPointF(x + side, y - side / 2)]
        _stroke(QPainter(self), colour, 1.5, arrow)


class CheckBox(QCheckBox):
    """A check box with a visible tick."""

    def paintEvent(self, event: QPaintEvent) -> None:
        """Draw the box and its tick."""
        super().paintEvent(event)
        if not self.isChecked():
            return
        option = QStyleOptionButton()
        self.initStyleOption(option)
        box = self.style().subElementRect(QStyle.SubElement.SE_CheckBoxIndicator, option, self)
        middle = QPointF(box.center()) + QPointF(0.5, 0.5)
        tick = [middle + QPointF(px(x), px(y)) for x, y in ((-4, 0), (-1, 3), (4, -3))]
        _stroke(QPainter(self), QColor(colours().on_accent if self.isEnabled() else colours().panel), 2.0, tick)


def _stroke(painter: QPainter, colour: QColor, width: float, points: list[QPointF]) -> None:
    painter.setRenderHint(QPainter.RenderHint.Antialiasing)
    pen = QPen(colour, width)
    pen.setCapStyle(Qt.PenCapStyle.RoundCap)
    painter.setPen(pen)
    painter.drawPolyline(points)
    painter.end()
