"""Panel of the people in a game of several participants, and their texts to each other."""

from PySide6.QtCore import QEvent, QRectF, Qt, QTimer, Signal
from PySide6.QtGui import QColor, QHideEvent, QKeyEvent, QPaintEvent, QShowEvent, QTextCursor
from PySide6.QtWidgets import QComboBox, QFrame, QHBoxLayout, QLabel, QPlainTextEdit, QScrollArea, QVBoxLayout, QWidget

from thbridge.dialogue.wording.texts import Texts
from ui.model.playing.screen import (
    ChooseAddressee,
    MarkReadAct,
    PeoplePanel,
    PersonRow,
    PersonText,
    SayToPeopleAct,
    WriteText,
)
from ui.windows import look
from ui.windows.look import GAP, colours, follow_text, smooth_painter, spaced
from ui.windows.participant.widgets.buttons import ActionButton, ActionWidget, ButtonFace
from ui.windows.participant.widgets.focus import make_region
from ui.windows.participant.widgets.panels import OpaqueBackground, set_text
from ui.windows.untrusted_text import breakable

_OWN_KEYS = {Qt.Key.Key_Tab, Qt.Key.Key_Backtab, *(getattr(Qt.Key, f"Key_F{number}") for number in range(1, 13))}
"""Keys that belong to the window also while a person writes."""


def _decides_on_key(event: QEvent) -> bool:
    """Decide whether a field needs a key that is also a key of the game. Return False for all other events."""
    if event.type() != QEvent.Type.ShortcutOverride or not isinstance(event, QKeyEvent):
        return False
    held = event.modifiers() & ~(Qt.KeyboardModifier.ShiftModifier | Qt.KeyboardModifier.KeypadModifier)
    if held != Qt.KeyboardModifier.NoModifier:
        return False
    event.setAccepted(event.key() not in _OWN_KEYS)
    return True


class MessageField(QPlainTextEdit):
    """Field for a text. Enter sends the text, and Esc leaves the field.

    Attributes:
        entered: signal: the person has pressed Enter.
        left: signal: the person has pressed Esc.
    """

    entered = Signal()
    left = Signal()

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.setTabChangesFocus(True)
        self.setHorizontalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAlwaysOff)
        follow_text(self, MessageField._fit)

    def _fit(self) -> None:
        self.setFont(look.font())
        self.setFixedHeight(int(2 * self.fontMetrics().lineSpacing() + 2 * self.document().documentMargin() + GAP))

    def event(self, event: QEvent) -> bool:
        """Keep keys of the text from the game."""
        return _decides_on_key(event) or super().event(event)

    def keyPressEvent(self, event: QKeyEvent) -> None:
        """Send the text with Enter, leave the field with Esc, and write with all other keys."""
        enter = event.key() in (Qt.Key.Key_Return, Qt.Key.Key_Enter)
        if enter and not event.modifiers() & Qt.KeyboardModifier.ShiftModifier:
            self.entered.emit()
        elif event.key() == Qt.Key.Key_Escape:
            self.left.emit()
        else:
            super().keyPressEvent(event)


class AddresseeChooser(QComboBox):
    """List of the possible addressees."""

    def event(self, event: QEvent) -> bool:
        """Keep keys of the list from the game."""
        return _decides_on_key(event) or super().event(event)


class TextBubble(QWidget):
    """Text of a person, with its author and time. The participant's own texts are on the right."""

    def __init__(self) -> None:
        super().__init__()
        self._own = self._pending = False
        self._who, self._text = look.label(size="small", bold=True), look.label()
        self._text.setTextInteractionFlags(Qt.TextInteractionFlag.TextSelectableByMouse)
        rows = spaced(QVBoxLayout(self), 2, int(1.5 * GAP), GAP, int(1.5 * GAP), GAP)
        rows.addWidget(self._who)
        rows.addWidget(self._text)

    def show_text(self, text: PersonText, time: str) -> None:
        """Show this text; `time` is its time in words."""
        if (text.own, text.pending) != (self._own, self._pending):
            self._own, self._pending = text.own, text.pending
            self.update()
        # Long words without spaces would widen the panel.
        set_text(self._who, f"{breakable(text.who)} · {time}")
        set_text(self._text, breakable(text.text))
        self.setAccessibleName(f"{text.who}: {text.text}")

    def paintEvent(self, _event: QPaintEvent) -> None:
        """Draw the bubble, with an edge on the side of its author."""
        palette, painter = colours(), smooth_painter(self)
        bubble = QRectF(self.rect()).adjusted(0.5, 0.5, -0.5, -0.5)
        painter.setPen(QColor(palette.line) if self._pending else Qt.PenStyle.NoPen)
        painter.setBrush(QColor(palette.panel if self._pending else palette.track))
        painter.drawRoundedRect(bubble, 10, 10)
        painter.setPen(Qt.PenStyle.NoPen)
        painter.setBrush(QColor(palette.accent if self._own else palette.muted))
        at = bubble.right() - 4.0 if self._own else bubble.left()
        painter.drawRoundedRect(QRectF(at, 7.0, 4.0, bubble.height() - 14.0), 2, 2)


class TextList(QScrollArea):
    """Texts of all people, the newest at the bottom.

    Attributes:
        scrolled: signal: other texts may be visible now.
    """

    scrolled = Signal()

    def __init__(self, texts: Texts, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._texts = texts
        self.setWidgetResizable(True)
        self.setFrameShape(QFrame.Shape.NoFrame)
        self.setFocusPolicy(Qt.FocusPolicy.TabFocus)
        self.setHorizontalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAlwaysOff)
        self.setAccessibleName(texts.text("people.messages"))
        inside = OpaqueBackground()
        self._rows = spaced(QVBoxLayout(inside), GAP, 0)
        self._rows.addStretch(1)
        self.setWidget(inside)
        self._shown: tuple[PersonText, ...] = ()
        self._bubbles: list[tuple[QHBoxLayout, TextBubble]] = []
        self._follows = True
        bar = self.verticalScrollBar()
        bar.rangeChanged.connect(self._keep_end)
        bar.valueChanged.connect(self._note_place)

    @property
    def at_end(self) -> bool:
        """True if the newest text is visible."""
        bar = self.verticalScrollBar()
        return bar.value() >= bar.maximum() - GAP

    def show_texts(self, texts: tuple[PersonText, ...]) -> None:
        """Show these texts."""
        if texts == self._shown:
            return
        self._shown = texts
        while len(self._bubbles) > len(texts):
            row, gone = self._bubbles.pop()
            self._rows.removeItem(row)
            gone.hide()
            gone.deleteLater()
        while len(self._bubbles) < len(texts):
            row, bubble = QHBoxLayout(), TextBubble()
            row.addStretch(1)
            row.addWidget(bubble, 12)
            row.addStretch(1)
            self._rows.addLayout(row)
            self._bubbles.append((row, bubble))
        for text, (row, bubble) in zip(texts, self._bubbles, strict=True):
            # The free space is on the side of the other people.
            row.setStretch(0, 1 if text.own else 0)
            row.setStretch(2, 0 if text.own else 1)
            time = self._texts.text("people.sending") if text.pending else text.time
            bubble.show_text(text, f"{time} · {self._texts.text('people.new')}" if text.new else time)
        if texts and texts[-1].pending:
            self._follows = True
        self._keep_end()

    def to_end(self) -> None:
        """Scroll to the newest text."""
        self._follows = True
        self._keep_end()

    def _keep_end(self) -> None:
        if self._follows:
            bar = self.verticalScrollBar()
            bar.setValue(bar.maximum())

    def _note_place(self) -> None:
        self._follows = self.at_end
        self.scrolled.emit()


class PeopleView(ActionWidget):
    """Panel of the people, with their texts and a field for the next text.

    Attributes:
        field: field for the next text.
        chooser: list of addressees.
        send: button that sends the text.
        list: the texts.
        news: button with the number of new texts; it scrolls to the newest.
    """

    def __init__(self, texts: Texts, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._texts = texts
        look.style_as_panel(self)
        make_region(self, texts.text("people.title"))
        self._panel: PeoplePanel | None = None
        self._restored = -1
        self._reported: MarkReadAct | None = None
        self._title = look.label(texts.text("people.title"), "title", bold=True)
        self.news = ActionButton(texts)
        self.news.clicked.connect(self._to_end)
        self._people = spaced(QVBoxLayout(), 2, 0)
        self._rows: list[QLabel] = []
        self._nothing, self._closed = look.label(muted=True), look.label(muted=True)
        self.list = TextList(texts)
        self.list.scrolled.connect(self._report_read)
        self.chooser, self.field, self.send = AddresseeChooser(), MessageField(), ActionButton(texts, "main")
        self.chooser.setAccessibleName(texts.text("people.to"))
        self.chooser.activated.connect(self._choose)
        self.field.textChanged.connect(self._write)
        self.field.entered.connect(self._send)
        self.send.clicked.connect(self._send)
        self._hint = look.label(size="small")
        top = spaced(QHBoxLayout(), GAP, 0)
        top.addWidget(self._title, 1)
        top.addWidget(self.news)
        self._writing = QWidget()
        rows = spaced(QVBoxLayout(self._writing), GAP, 0)
        rows.addWidget(self.chooser)
        rows.addWidget(self.field)
        rows.addWidget(self._hint)
        rows.addWidget(self.send)
        around = spaced(QVBoxLayout(self), GAP, int(1.5 * GAP))
        around.addLayout(top)
        around.addLayout(self._people)
        around.addWidget(self._nothing)
        around.addWidget(self.list, 1)
        around.addWidget(self._closed)
        around.addWidget(self._writing)
        # A text is read a moment after it was drawn, when the list has its place.
        self._reading = QTimer(self, singleShot=True, interval=0)
        self._reading.timeout.connect(self._report_read)

    def show_people(self, panel: PeoplePanel | None) -> None:
        """Show this panel. If None, show nothing."""
        if panel is None or panel == self._panel:
            self._panel = panel
            return
        self._panel = panel
        self._show_rows((panel.own, *panel.others))
        self.news.setVisible(bool(panel.news))
        self.news.show_face(ButtonFace(panel.news), panel.news)
        _show_if_any(self._nothing, panel.nothing)
        _show_if_any(self._closed, panel.closed if panel.writes else "")
        self.list.show_texts(panel.texts)
        self._writing.setVisible(panel.writes and not panel.closed)
        names = [each.hint for each in panel.addressees]
        if [self.chooser.itemText(at) for at in range(self.chooser.count())] != names:
            self.chooser.clear()
            self.chooser.addItems(names)
        chosen = [at for at, each in enumerate(panel.addressees) if each.act == panel.addressee_act]
        self.chooser.setCurrentIndex(chosen[0] if chosen else -1)
        self.chooser.setVisible(bool(names))
        self.field.setPlaceholderText(panel.prompt)
        self.field.setAccessibleName(panel.prompt)
        # The field belongs to the person, except in a new window and after the game has put a text back.
        if panel.restored > self._restored:
            self._restored = panel.restored
            self._fill(panel.draft)
        _show_if_any(self._hint, panel.send.hint)
        self.send.show_action(panel.send)
        self._reading.start()

    def go_to(self) -> None:
        """Give the focus to the field, or to the texts if no text can be sent."""
        target = self.field if self.field.isVisible() else self.list
        target.setFocus(Qt.FocusReason.ShortcutFocusReason)

    def showEvent(self, event: QShowEvent) -> None:
        """Report the visible texts as read."""
        super().showEvent(event)
        self._reading.start()

    def hideEvent(self, event: QHideEvent) -> None:
        """Report no texts as read while they are not visible."""
        super().hideEvent(event)
        self._reading.stop()

    def event(self, event: QEvent) -> bool:
        """Report the visible texts as read when the window becomes active again."""
        if event.type() == QEvent.Type.WindowActivate:
            self._reading.start()
        return super().event(event)

    def _show_rows(self, people: tuple[PersonRow, ...]) -> None:
        while len(self._rows) < len(people):
            self._rows.append(look.label(size="small"))
            self._people.addWidget(self._rows[-1])
        for person, row in zip(people, self._rows, strict=False):
            name = person.name[:1].upper() + person.name[1:]
            sign = "" if not person.presence else "● " if person.present else "○ "
            parts = filter(None, (f"{sign}{breakable(name)}", person.presence, person.commands))
            set_text(row, " · ".join(parts))
            row.setToolTip(person.may)
        for at, row in enumerate(self._rows):
            row.setVisible(at < len(people))

    def _choose(self, at: int) -> None:
        if self._panel is not None and 0 <= at < len(self._panel.addressees):
            act = self._panel.addressees[at].act
            if isinstance(act, ChooseAddressee):
                self.requested.emit(act)

    def _write(self) -> None:
        self.requested.emit(WriteText(self.field.toPlainText()))

    def _send(self) -> None:
        text = self.field.toPlainText()
        if self._panel is None or not text.strip():
            return
        self._fill("")
        self.requested.emit(SayToPeopleAct(self._panel.to, text))

    def _fill(self, text: str) -> None:
        """Replace the text of the field; the game knows it already."""
        if self.field.toPlainText() != text:
            self.field.blockSignals(True)
            self.field.setPlainText(text)
            self.field.moveCursor(QTextCursor.MoveOperation.End)
            self.field.blockSignals(False)

    def _to_end(self) -> None:
        self.list.to_end()
        self._report_read()

    def _report_read(self) -> None:
        read = None if self._panel is None else self._panel.read
        if read is None or read == self._reported or not (self.list.isVisible() and self.list.at_end):
            return
        if self.window().isActiveWindow() and not self.window().isMinimized():
            self._reported = read
            self.requested.emit(read)


def _show_if_any(label: QLabel, text: str) -> None:
    set_text(label, text)
    label.setVisible(bool(text))
