"""The pop-up about something that a robot found."""

from PySide6.QtCore import QEvent, QModelIndex, QRectF, QSize, Qt, Signal
from PySide6.QtGui import QColor, QFocusEvent, QFontMetricsF, QKeyEvent, QPainter, QPaintEvent, QPixmap
from PySide6.QtWidgets import (
    QAbstractItemView,
    QFrame,
    QHBoxLayout,
    QListWidget,
    QSizePolicy,
    QVBoxLayout,
    QWidget,
)

from ui.model.keys import typed_name
from ui.model.screen import PickName, TreasurePop
from ui.windows import look
from ui.windows.look import GAP, RADIUS, colours, font
from ui.windows.participant import focus
from ui.windows.participant.buttons import ActionButton
from ui.windows.participant.painting import sign
from ui.windows.participant.panels import Panel

_PICTURE = QSize(224, 168)
"""Logical pixels."""


class Picture(QWidget):
    """The picture, or a frame for it with a word about why it is empty; beside nothing else, so that it is seen."""

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._data: bytes | None = None
        self._note = ""
        self._pixmap = QPixmap()
        self.setMinimumSize(_PICTURE.width(), _PICTURE.height() // 2)
        self.setSizePolicy(QSizePolicy.Policy.Fixed, QSizePolicy.Policy.Preferred)

    def sizeHint(self) -> QSize:
        """Of a small photograph."""
        return _PICTURE

    def show_picture(self, data: bytes | None, note: str) -> None:
        """Show this file's picture, or say the note."""
        if (data, note) == (self._data, self._note):
            return
        if data != self._data:
            self._pixmap = QPixmap()
            if data is not None and not self._pixmap.loadFromData(data):
                note = "This picture cannot be shown."
        self._data, self._note = data, note
        self.setAccessibleName("Picture of what was found" if not self._pixmap.isNull() else f"No picture. {note}")
        self.update()

    def paintEvent(self, _event: QPaintEvent) -> None:
        """Draw it as large as fits."""
        worn = colours()
        painter = QPainter(self)
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        painter.setRenderHint(QPainter.RenderHint.SmoothPixmapTransform)
        rect = QRectF(self.rect()).adjusted(0.5, 0.5, -0.5, -0.5)
        painter.setPen(QColor(worn.line))
        painter.setBrush(QColor(worn.track))
        painter.drawRoundedRect(rect, RADIUS - 2, RADIUS - 2)
        if self._pixmap.isNull():
            painter.setFont(font("small"))
            painter.setPen(QColor(worn.muted))
            text = self._note or "No picture yet"
            wrap = Qt.AlignmentFlag.AlignCenter | Qt.TextFlag.TextWordWrap
            painter.drawText(rect.adjusted(GAP, GAP, -GAP, -GAP), wrap, text)
            return
        size = (
            self._pixmap.size().toSizeF().scaled(rect.adjusted(2, 2, -2, -2).size(), Qt.AspectRatioMode.KeepAspectRatio)
        )
        target = QRectF(0.0, 0.0, size.width(), size.height())
        target.moveCenter(rect.center())
        painter.drawPixmap(target, self._pixmap, QRectF(self._pixmap.rect()))


class Facts(QWidget):
    """What the robot sensed: a patch of the colour beside its word, a drawing of the footprint beside its words."""

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._colour = self._footprint = ""
        self.setSizePolicy(QSizePolicy.Policy.Fixed, QSizePolicy.Policy.Fixed)

    def sizeHint(self) -> QSize:
        """Two lines."""
        return QSize(_PICTURE.width(), int(2 * self._line()) + GAP)

    def show_facts(self, colour: str, footprint: str) -> None:
        """Show these words; empty ones are still being looked for."""
        if (colour, footprint) == (self._colour, self._footprint):
            return
        self._colour, self._footprint = colour, footprint
        known = f"Colour: {colour}. Footprint: {footprint}." if colour else "The robot is still looking."
        self.setAccessibleName(known)
        self.update()

    def _line(self) -> float:
        return QFontMetricsF(font()).height() + GAP

    def paintEvent(self, _event: QPaintEvent) -> None:
        """Draw the two lines."""
        worn = colours()
        painter = QPainter(self)
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        painter.setFont(font())
        if not self._colour:
            painter.setPen(QColor(worn.muted))
            painter.drawText(self.rect(), Qt.AlignmentFlag.AlignLeft | Qt.AlignmentFlag.AlignVCenter, "Looking at it …")
            return
        for row, words in enumerate((self._colour, self._footprint)):
            line = QRectF(0.0, row * (self._line() + GAP / 2), self.width(), self._line())
            side = line.height() - 4.0
            patch = QRectF(line.left() + 1, line.top() + 2, side, side)
            painter.setPen(QColor(worn.line))
            if row == 0:
                swatch = QColor(words.casefold().replace(" ", ""))
                painter.setBrush(swatch if swatch.isValid() else QColor(worn.track))
                painter.drawRoundedRect(patch, 4, 4)
            else:
                self._shape(painter, patch, words.casefold())
            painter.setPen(QColor(worn.text))
            area = line.adjusted(side + 1.5 * GAP, 0, 0, 0)
            painter.drawText(area, Qt.AlignmentFlag.AlignLeft | Qt.AlignmentFlag.AlignVCenter, words)

    @staticmethod
    def _shape(painter: QPainter, patch: QRectF, words: str) -> None:
        """Round or square, large or small, as far as the words say so."""
        inset = 0.28 * patch.width() if "small" in words else 0.04 * patch.width()
        shape = patch.adjusted(inset, inset, -inset, -inset)
        painter.setPen(QColor(colours().text))
        painter.setBrush(Qt.BrushStyle.NoBrush)
        if "round" in words:
            painter.drawEllipse(shape)
        elif "square" in words:
            painter.drawRect(shape)


class Names(QListWidget):
    """What it may be. Nothing is picked until somebody picks.

    Attributes:
        picked: a name, by the person.
    """

    picked = Signal(str)

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.setAccessibleName("What it may be")
        self.setSelectionMode(QAbstractItemView.SelectionMode.SingleSelection)
        self.setFrameShape(QFrame.Shape.NoFrame)
        self.setUniformItemSizes(True)
        self.setProperty("roomy", True)
        self.setFocusPolicy(Qt.FocusPolicy.TabFocus)
        self._names: tuple[str, ...] = ()
        self.itemClicked.connect(lambda item: self.picked.emit(item.text()))

    def show_names(self, names: tuple[str, ...], picked: str | None) -> None:
        """Show these, with this one picked."""
        if names != self._names:
            self._names = names
            self.clear()
            self.addItems(list(names))
            self.updateGeometry()
        row = names.index(picked) if picked in names else -1
        if row != self.currentRow() or (row < 0) == bool(self.selectedIndexes()):
            if row < 0:
                self.setCurrentIndex(QModelIndex())
                self.clearSelection()
            else:
                self.setCurrentRow(row)
        self.setAccessibleDescription(f"Picked: {picked}" if picked else "Nothing is picked")

    def sizeHint(self) -> QSize:
        """All names, up to eight."""
        row = max(self.sizeHintForRow(0), 24)
        return QSize(220, row * min(max(len(self._names), 3), 8) + 2 * GAP)

    def minimumSizeHint(self) -> QSize:
        """Three names."""
        return QSize(150, max(self.sizeHintForRow(0), 24) * 3 + 2 * GAP)

    def event(self, event: QEvent) -> bool:
        """Keep the keys that pick a name, which the window's shortcuts would take."""
        if event.type() == QEvent.Type.ShortcutOverride and isinstance(event, QKeyEvent) and self._wanted(event):
            event.accept()
            return True
        return super().event(event)

    def keyPressEvent(self, event: QKeyEvent) -> None:
        """Arrows go up and down the list and leave it sideways, letters go to the next name that begins so."""
        name = self._wanted(event)
        if name is not None:
            self.picked.emit(name)
        elif event.key() in focus.ARROWS:
            focus.move(self, event.key())
        else:
            event.ignore()

    def focusInEvent(self, event: QFocusEvent) -> None:
        """Having the focus picks nothing, which Qt's own lists do."""
        current = self.currentIndex()
        super().focusInEvent(event)
        if not current.isValid():
            self.setCurrentIndex(QModelIndex())
        self.viewport().update()

    def _wanted(self, event: QKeyEvent) -> str | None:
        """The name that a key picks."""
        if not self._names or event.modifiers() not in (
            Qt.KeyboardModifier.NoModifier,
            Qt.KeyboardModifier.ShiftModifier,
        ):
            return None
        row = self.currentRow()
        last = len(self._names) - 1
        rows: dict[int, int] = {
            Qt.Key.Key_Up: max(row - 1, 0) if row >= 0 else last,
            Qt.Key.Key_Down: min(row + 1, last),
            Qt.Key.Key_Home: 0,
            Qt.Key.Key_End: last,
        }
        if event.key() in rows:
            return self._names[rows[event.key()]]
        letter = event.text().strip()
        if not letter.isalpha():
            return None
        return typed_name(letter, self._names, self._names[row] if row >= 0 else None)


class Verdict(QWidget):
    """What came of a name, and the points."""

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._text = ""
        self._points: int | None = None
        self.setSizePolicy(QSizePolicy.Policy.Preferred, QSizePolicy.Policy.Preferred)

    def sizeHint(self) -> QSize:
        """A sign, the points, some lines."""
        return QSize(220, 150)

    def show_verdict(self, text: str, points: int | None) -> None:
        """Show this."""
        self._text, self._points = text, points
        self.setAccessibleName(text)
        self.update()

    def paintEvent(self, _event: QPaintEvent) -> None:
        """Draw a tick and what was won, or a warning and what was lost."""
        worn = colours()
        painter = QPainter(self)
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        rect = QRectF(self.rect())
        won = (self._points or 0) > 0
        ink = worn.good if won else worn.bad if (self._points or 0) < 0 else worn.text
        hero = font("hero", bold=True)
        high = QFontMetricsF(hero).height()
        words = f"{self._points:+d}".replace("-", "−") if self._points is not None else ""
        wide = QFontMetricsF(hero).horizontalAdvance(words)
        top = rect.top() + max(0.0, (rect.height() - high - 60) / 2)
        left = rect.center().x() - (wide + high) / 2
        sign(painter, QRectF(left, top, high * 0.8, high), "tick" if won else "trouble", ink)
        painter.setFont(hero)
        painter.setPen(QColor(ink))
        painter.drawText(QRectF(left + high, top, wide + 4, high), Qt.AlignmentFlag.AlignVCenter, words)
        painter.setFont(font())
        painter.setPen(QColor(worn.text))
        wrap = Qt.AlignmentFlag.AlignHCenter | Qt.AlignmentFlag.AlignTop | Qt.TextFlag.TextWordWrap
        painter.drawText(
            QRectF(rect.left(), top + high + GAP, rect.width(), rect.bottom() - top - high - GAP), wrap, self._text
        )


class TreasurePanel(Panel):
    """What was sensed and its picture at the left, what it may be at the right.

    Attributes:
        asked: the `Act` of what was pressed or picked.
    """

    asked = Signal(object)

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__("Treasure", parent)
        self._pop: TreasurePop | None = None
        self.aside = ActionButton("quiet")
        self.top.addWidget(self.aside)
        columns = QHBoxLayout()
        columns.setSpacing(2 * GAP)
        self.rows.addLayout(columns, 1)
        left, right = QVBoxLayout(), QVBoxLayout()
        left.setSpacing(int(1.5 * GAP))
        right.setSpacing(GAP)
        columns.addLayout(left)
        columns.addLayout(right, 1)
        self.facts, self.picture, self.names, self.verdict = Facts(), Picture(), Names(), Verdict()
        self.take_picture = ActionButton(hints=True)
        left.addWidget(self.facts)
        left.addWidget(self.picture)
        left.addWidget(self.take_picture)
        left.addStretch(1)
        self._asking = look.label("What is it?", bold=True)
        self.name_it, self.leave = ActionButton("main", hints=True), ActionButton("plain", hints=True)
        for widget, stretch in (
            (self._asking, 0),
            (self.names, 1),
            (self.verdict, 1),
            (self.name_it, 0),
            (self.leave, 0),
        ):
            right.addWidget(widget, stretch)
        for button in (self.aside, self.take_picture, self.name_it, self.leave):
            button.asked.connect(self.asked)
        self.names.picked.connect(lambda name: self.asked.emit(PickName(name)))

    def show_pop(self, pop: TreasurePop) -> None:
        """Show this; nothing is done when it is shown already."""
        if pop == self._pop:
            return
        self._pop = pop
        self.entitle(pop.title, pop.robot)
        self.aside.show_action(pop.aside)
        self.facts.show_facts(pop.colour, pop.footprint)
        self.picture.show_picture(pop.picture, pop.picture_note)
        self.take_picture.setVisible(pop.take_picture is not None)
        if pop.take_picture is not None:
            self.take_picture.show_action(pop.take_picture)
        decided = pop.verdict is not None
        self.names.show_names(pop.names, pop.picked)
        self.names.setVisible(not decided)
        self._asking.setVisible(not decided)
        self.verdict.setVisible(decided)
        if pop.verdict is not None:
            self.verdict.show_verdict(pop.verdict, pop.points)
        for button, action in ((self.name_it, pop.name_it), (self.leave, pop.leave)):
            button.show_action(action)
            button.setVisible(not decided)
