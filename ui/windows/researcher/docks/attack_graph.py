"""Picture of arguments and their attacks: numbered boxes and arrows."""

import math

from PySide6.QtCore import QEvent, QLineF, QPointF, QRectF, QSize, Qt
from PySide6.QtGui import QColor, QFontMetrics, QHelpEvent, QPainter, QPaintEvent, QPen, QPolygonF
from PySide6.QtWidgets import QToolTip, QWidget

from thbridge.dialogue.portrait import DialoguePortrait
from ui.model.watching.dialogue_rows import describe_attacks, holders
from ui.windows.look import GAP, colours, font, px, smooth_painter

HEAD, SPREAD = 9.0, 0.42
"""Length of an arrowhead, logical pixels, and angle between its axis and its edges, radians."""
STANDS = "✓"


class AttackGraph(QWidget):
    """Picture of arguments as numbered boxes on an ellipse, and of attacks as arrows.

    An argument in the grounded extension has a check mark and a double edge.
    """

    def __init__(self) -> None:
        super().__init__()
        self._portrait = DialoguePortrait()
        self.setAccessibleName("Attacks between arguments")

    def show_portrait(self, portrait: DialoguePortrait) -> None:
        """Show these arguments and attacks."""
        self._portrait = portrait
        self.setAccessibleDescription(describe_attacks(portrait) or "There are no arguments.")
        self.update()

    def minimumSizeHint(self) -> QSize:
        """Return a size that is large enough to distinguish a few arguments."""
        return QSize(px(120), px(90))

    def boxes(self) -> list[QRectF]:
        """Return the boxes of the arguments, in their order, clockwise from the top."""
        count = len(self._portrait.arguments)
        if count == 0:
            return []
        metrics = QFontMetrics(font(bold=True))
        box = QRectF(0.0, 0.0, metrics.horizontalAdvance(f"00 {STANDS}") + 2.0 * GAP, metrics.height() + GAP)
        middle = QRectF(self.rect()).center()
        wide = max(0.0, self.width() / 2.0 - box.width() / 2.0 - GAP)
        high = max(0.0, self.height() / 2.0 - box.height() / 2.0 - GAP)
        if count == 1:
            wide = high = 0.0
        found = []
        for place in range(count):
            angle = 2.0 * math.pi * place / count - math.pi / 2.0
            # Place two arguments side by side, because there is more space.
            angle -= math.pi / 2.0 if count == 2 else 0.0
            box.moveCenter(middle + QPointF(wide * math.cos(angle), high * math.sin(angle)))
            found.append(QRectF(box))
        return found

    def paintEvent(self, event: QPaintEvent) -> None:
        """Draw the attacks, and then the arguments on top of the attacks."""
        painter, palette, boxes = smooth_painter(self), colours(), self.boxes()
        standing = set(self._portrait.grounded)
        for one, other in self._portrait.attacks:
            if one != other:
                colour = palette.text if one in standing else palette.line
                _draw_arrow(painter, QColor(colour), boxes[one], boxes[other])
        painter.setFont(font(bold=True))
        for place, box in enumerate(boxes):
            stands = place in standing
            painter.setBrush(QColor(palette.panel))
            painter.setPen(QPen(QColor(palette.good if stands else palette.line), 1.5))
            painter.drawRect(box)
            if stands:
                painter.drawRect(box.adjusted(3.0, 3.0, -3.0, -3.0))
            painter.setPen(QColor(palette.text))
            text = f"{place + 1} {STANDS}" if stands else str(place + 1)
            painter.drawText(box, Qt.AlignmentFlag.AlignCenter, text)
        painter.end()

    def event(self, event: QEvent) -> bool:
        """Show the argument under the pointer in a tool tip."""
        if isinstance(event, QHelpEvent) and event.type() == QEvent.Type.ToolTip:
            pointed = (place for place, box in enumerate(self.boxes()) if box.contains(QPointF(event.pos())))
            place = next(pointed, None)
            if place is None:
                QToolTip.hideText()
            else:
                argument = self._portrait.arguments[place]
                because = f", because {', '.join(argument.support)}" if argument.support else ""
                QToolTip.showText(event.globalPos(), f"{argument.conclusion}{because} ({holders(argument)})", self)
            return True
        return super().event(event)


def _draw_arrow(painter: QPainter, colour: QColor, start: QRectF, end: QRectF) -> None:
    line = QLineF(start.center(), end.center())
    tip = edge_point(end, line)
    painter.setPen(QPen(colour, 1.5))
    painter.drawLine(QLineF(line.p1(), tip))
    angle = math.atan2(line.p1().y() - tip.y(), line.p1().x() - tip.x())
    wings = [tip + QPointF(HEAD * math.cos(angle + turn), HEAD * math.sin(angle + turn)) for turn in (-SPREAD, SPREAD)]
    painter.setBrush(colour)
    painter.drawPolygon(QPolygonF([tip, *wings]))


def edge_point(box: QRectF, line: QLineF) -> QPointF:
    """Return the point where a line toward the center of a box crosses its edge."""
    along = line.p1() - box.center()
    reach = [half / abs(part) for half, part in ((box.width() / 2, along.x()), (box.height() / 2, along.y())) if part]
    return box.center() + along * min([*reach, 1.0])
