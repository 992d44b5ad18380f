"""Line between two words, on which a person marks a position.

At first, the line has no mark, because a mark would be an answer.
"""

from PySide6.QtCore import QPointF, QRectF, QSize, Qt
from PySide6.QtGui import QColor, QKeyEvent, QMouseEvent, QPaintEvent, QPen
from PySide6.QtWidgets import QHBoxLayout, QSizePolicy, QSlider, QVBoxLayout, QWidget

from thbridge.dialogue.wording.texts import Texts
from ui.model.kiosk import Answer, FormItem
from ui.windows import look
from ui.windows.kiosk.items.field import AnswerField
from ui.windows.look import GAP, RING, colours, px, smooth_painter, spaced

_FINE = 1000
"""Number of possible positions of a mark on a line without steps."""
_MOST_TICKS = 21


class MarkedLine(QSlider):
    """Line for a mark. A click sets the mark. Arrow keys first set the mark in the middle, and then move it.

    Args:
        field: field that contains the line.
        places: highest position of a mark, counted from 0.
    """

    def __init__(self, field: AnswerField, places: int) -> None:
        super().__init__(Qt.Orientation.Horizontal)
        self._field = field
        self.marked = False
        self.setRange(0, places)
        self.setPageStep(max(places // 10, 1))
        self.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Fixed)
        self.setFocusPolicy(Qt.FocusPolicy.TabFocus)

    def mark(self, place: int) -> None:
        """Set the mark at this position, and report that a person set it."""
        self._field.touched.emit()
        before = self.value() if self.marked else None
        self.marked = True
        self.setValue(place)
        if self.value() != before:
            self._field.typed.emit()
        self.update()

    def sizeHint(self) -> QSize:
        """Return a size that is easy to click."""
        return QSize(px(300), px(40))

    def mousePressEvent(self, event: QMouseEvent) -> None:
        """Set the mark at the pointer."""
        if event.button() is Qt.MouseButton.LeftButton:
            self.mark(self._place(event.position().x()))

    def mouseMoveEvent(self, event: QMouseEvent) -> None:
        """Move the mark with the pointer."""
        if event.buttons() & Qt.MouseButton.LeftButton:
            self.mark(self._place(event.position().x()))

    def mouseReleaseEvent(self, event: QMouseEvent) -> None:
        """Report the mark as the answer."""
        if event.button() is Qt.MouseButton.LeftButton:
            self.setFocus(Qt.FocusReason.MouseFocusReason)
            self._field.changed.emit()

    def keyPressEvent(self, event: QKeyEvent) -> None:
        """Move the mark when a key is pressed, or go to the next item when Enter is pressed."""
        whole = self.maximum()
        at = self.value() if self.marked else whole // 2
        first = 0 if not self.marked else 1
        match event.key():
            case Qt.Key.Key_Left | Qt.Key.Key_Down:
                self.mark(at - first)
            case Qt.Key.Key_Right | Qt.Key.Key_Up:
                self.mark(at + first)
            case Qt.Key.Key_PageDown:
                self.mark(at - first * self.pageStep())
            case Qt.Key.Key_PageUp:
                self.mark(at + first * self.pageStep())
            case Qt.Key.Key_Home:
                self.mark(0)
            case Qt.Key.Key_End:
                self.mark(whole)
            case Qt.Key.Key_Return | Qt.Key.Key_Enter if self.marked and not event.isAutoRepeat():
                self._field.passed.emit()
            case _:
                event.ignore()

    def paintEvent(self, _event: QPaintEvent) -> None:
        """Draw the line, its ticks, and the mark."""
        painter, palette = smooth_painter(self), colours()
        middle, left, right = self.height() / 2.0, self._margin(), self.width() - self._margin()
        painter.setPen(QPen(QColor(palette.muted), 2.0))
        painter.drawLine(QPointF(left, middle), QPointF(right, middle))
        places = self.maximum()
        ticks = places if places < _MOST_TICKS else 1
        for tick in range(ticks + 1):
            x = left + (right - left) * tick / ticks
            high = px(9) if tick in (0, ticks) else px(5)
            painter.drawLine(QPointF(x, middle - high), QPointF(x, middle + high))
        if self.marked:
            x = left + (right - left) * self.value() / places
            painter.setPen(QPen(QColor(palette.panel), 2.0))
            painter.setBrush(QColor(palette.accent))
            painter.drawRoundedRect(QRectF(x - px(5), middle - px(13), px(10), px(26)), 4, 4)
        if self.hasFocus():
            painter.setBrush(Qt.BrushStyle.NoBrush)
            painter.setPen(QPen(QColor(palette.accent), RING))
            painter.drawRoundedRect(QRectF(self.rect()).adjusted(1, 1, -1, -1), 6, 6)

    def _place(self, x: float) -> int:
        left, right = self._margin(), self.width() - self._margin()
        return round(self.maximum() * min(max((x - left) / (right - left), 0.0), 1.0))

    @staticmethod
    def _margin() -> float:
        return float(px(14))


class LineField(AnswerField):
    """Field with a line on which a person marks a value."""

    def __init__(self, item: FormItem, texts: Texts) -> None:
        super().__init__(item, texts)
        span = item.maximum - item.minimum
        places = max(round(span / item.step), 1) if item.step > 0.0 else _FINE
        rows = spaced(QVBoxLayout(self), 0, 0)
        self.line = MarkedLine(self, places)
        rows.addWidget(self.line)
        ends = spaced(QHBoxLayout(), 2 * GAP, GAP, 0, GAP, 0)
        low, high = look.label(item.low, "small", muted=True), look.label(item.high, "small", muted=True)
        high.setAlignment(Qt.AlignmentFlag.AlignRight | Qt.AlignmentFlag.AlignTop)
        ends.addWidget(low, 1)
        ends.addWidget(high, 1)
        rows.addLayout(ends)
        self.changed.connect(self._name)
        self.typed.connect(self._name)
        self._name()

    @property
    def answer(self) -> Answer:
        """See `AnswerField`."""
        item, whole = self.item, self.line.maximum()
        if not self.line.marked:
            return None
        if item.step > 0.0:
            return min(item.minimum + self.line.value() * item.step, item.maximum)
        return item.minimum + (item.maximum - item.minimum) * self.line.value() / whole

    def show_answer(self, answer: Answer) -> None:
        """See `AnswerField`."""
        item = self.item
        self.line.marked = isinstance(answer, float)
        if isinstance(answer, float):
            share = (answer - item.minimum) / (item.maximum - item.minimum)
            self.line.setValue(round(share * self.line.maximum()))
        self._name()
        self.line.update()

    def focus_target(self) -> QWidget:
        """See `AnswerField`."""
        return self.line

    def _name(self) -> None:
        item, answer = self.item, self.answer
        name = self.texts.text(
            "forms.line_marked" if isinstance(answer, float) else "forms.line_open",
            question=item.text,
            place=self.told(answer),
            least=self.number(item.minimum),
            low=item.low,
            greatest=self.number(item.maximum),
            high=item.high,
        )
        self.line.setAccessibleName(name)
        self.line.setAccessibleDescription(self.texts.text("forms.line_keys"))
