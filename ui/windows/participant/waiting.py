"""Strip along the bottom of the window with the pop-ups that wait for the participant."""

import math

from PySide6.QtCore import QEvent, QPointF, QRectF, QSize, Qt
from PySide6.QtGui import QFontMetricsF, QPaintEvent, QResizeEvent, QWheelEvent
from PySide6.QtWidgets import QFrame, QHBoxLayout, QScrollArea, QSizePolicy, QWidget

from thbridge.dialogue.wording.texts import Texts
from ui.model.playing.screen import PeoplePanel, WaitingItem
from ui.windows import look
from ui.windows.look import GAP, RADIUS, colours, follow_text, font, px, smooth_painter, spaced
from ui.windows.participant.widgets.buttons import ActionButton, ActionWidget, ButtonFace, ParticipantButton
from ui.windows.participant.widgets.painting import WRAPPED, box, chip, chip_size, key_cap, key_size, ring, write
from ui.windows.participant.widgets.panels import set_text


class WaitingChip(ParticipantButton):
    """Button of a waiting pop-up, with its robot and a description in two lines.

    Attributes:
        short: True if only the robot is shown; the description remains in the tool tip and for screen readers.
    """

    def __init__(self, texts: Texts, parent: QWidget | None = None) -> None:
        super().__init__(texts, parent)
        self._waiting: WaitingItem | None = None
        self.short = False
        self.setSizePolicy(QSizePolicy.Policy.Fixed, QSizePolicy.Policy.Fixed)

    def show_waiting(self, waiting: WaitingItem) -> None:
        """Show this item."""
        if waiting == self._waiting:
            return
        self._waiting = waiting
        self.bind(waiting.show, waiting.text)
        self.setToolTip(waiting.text)
        self.updateGeometry()
        self.update()

    def shorten(self, short: bool) -> None:
        """Show only the robot if `short` is True; otherwise show the robot and the words."""
        if short != self.short:
            self.short = short
            self.updateGeometry()
            self.update()

    def sizeHint(self) -> QSize:
        """Return the size of the robot with two lines of words, or of the robot alone."""
        return QSize(self.width_of(self.short), self.height_of_two_lines())

    def width_of(self, short: bool) -> int:
        """Return the width, logical pixels: if `short`, of the robot alone, otherwise also of two lines of words."""
        if short:
            return int(chip_size() + 2 * GAP)
        text = self._waiting.text if self._waiting is not None else ""
        return int(max(float(px(90)), _width_of_two_lines(text)) + chip_size() + 3 * GAP + self._key_room())

    @staticmethod
    def height_of_two_lines() -> int:
        """Return the height of two lines of words, logical pixels."""
        return int(2 * QFontMetricsF(font("small")).height() + GAP)

    def paintEvent(self, _event: QPaintEvent) -> None:
        """Draw the robot's chip and the words."""
        if self._waiting is None:
            return
        palette = colours()
        painter = smooth_painter(self)
        rect = QRectF(self.rect())
        box(painter, rect, palette.track if self.pointed_at() else palette.panel, palette.accent, radius=RADIUS)
        if self.hasFocus():
            ring(painter, rect, palette.text)
        chip(painter, QPointF(rect.left() + GAP + chip_size() / 2, rect.center().y()), self._waiting.robot)
        if self.short:
            return
        area = rect.adjusted(1.75 * GAP + chip_size(), 2, -GAP - self._key_room(), -2)
        write(painter, area, self._waiting.text, font("small"), palette.text, WRAPPED)
        if self._shown_key:
            wide, high = key_size(self._shown_key)
            cap = QRectF(rect.right() - GAP - wide, rect.center().y() - high / 2.0, wide, high)
            key_cap(painter, cap, self._shown_key, palette.muted)

    def _key_room(self) -> float:
        """Return the width that the key needs, logical pixels."""
        return key_size(self._shown_key)[0] + GAP / 2.0 if self._shown_key else 0.0


def _width_of_two_lines(text: str) -> float:
    """Return the smallest width at which a text wrapped by `WRAPPED` needs at most two lines, logical pixels."""
    metrics, words = QFontMetricsF(font("small")), text.split()
    lines = ((" ".join(words[:at]), " ".join(words[at:])) for at in range(1, len(words) + 1))
    return math.ceil(min((max(map(metrics.horizontalAdvance, pair)) for pair in lines), default=0.0)) + 1.0


class HorizontalScrollArea(QScrollArea):
    """Scroll area that scrolls sideways, also if a person turns the vertical mouse wheel."""

    def __init__(self) -> None:
        super().__init__()
        self.setWidgetResizable(True)
        self.setFrameShape(QFrame.Shape.NoFrame)
        self.setFocusPolicy(Qt.FocusPolicy.NoFocus)
        self.setVerticalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAlwaysOff)
        self.setHorizontalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAlwaysOff)

    def wheelEvent(self, event: QWheelEvent) -> None:
        """Scroll right when the wheel turns down."""
        turned = event.angleDelta()
        bar = self.horizontalScrollBar()
        bar.setValue(bar.value() - (turned.x() or turned.y()))


class WaitingStrip(ActionWidget):
    """Strip with the pop-ups that wait for the participant, the oldest first.

    The height of the strip never changes, so that nothing else moves.

    Attributes:
        history: button that opens the history.
        people: button that shows the people of the game in a narrow window.
    """

    def __init__(self, texts: Texts, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._texts = texts
        row = self._row = spaced(QHBoxLayout(self), GAP, 0)
        self._count = look.label(size="small", muted=True)
        row.addWidget(self._count)
        area = HorizontalScrollArea()
        inside = QWidget()
        self._chips = spaced(QHBoxLayout(inside), GAP, 0)
        self._chips.addStretch(1)
        area.setWidget(inside)
        self._area = area
        area.hide()
        row.addWidget(area, 1)
        self.history = ActionButton(texts)
        self.history.setCheckable(True)
        self.history.show_face(ButtonFace(texts.text("window.history")), texts.text("window.history_hint"))
        row.addWidget(self.history)
        self.people = ActionButton(texts)
        self.people.setCheckable(True)
        self.people.hide()
        row.addWidget(self.people)
        self.chips: list[WaitingChip] = []
        self._shown: tuple[WaitingItem, ...] | None = None
        follow_text(self, lambda it: it.setFixedHeight(WaitingChip.height_of_two_lines() + 2))

    def resizeEvent(self, _event: QResizeEvent) -> None:
        """Arrange the buttons in the new width."""
        self._make_room()

    def event(self, event: QEvent) -> bool:
        """Arrange the buttons again after a change of the words or their size."""
        if event.type() == QEvent.Type.LayoutRequest:
            self._make_room()
        return super().event(event)

    def _make_room(self) -> None:
        """If there is too little space, hide the number of waiting items, and then shorten the last buttons."""
        shown = [chip for chip in self.chips if not chip.isHidden()]
        widest = max((chip.width_of(short=False) for chip in shown), default=0)
        shown_buttons = [button for button in (self.history, self.people) if not button.isHidden()]
        others = sum(button.sizeHint().width() + GAP for button in shown_buttons)
        counted = self._count.sizeHint().width() + GAP
        self._count.setVisible(not widest or widest + counted + others <= self.width())
        left = self.width() - others - (0 if self._count.isHidden() else counted)
        needed = sum(chip.width_of(short=False) + GAP for chip in shown) - GAP  # of integers
        for at, each in reversed(list(enumerate(shown))):
            each.shorten(short=at > 0 and needed > left)
            needed -= each.width_of(short=False) - each.width_of(short=True) if each.short else 0

    def show_people(self, people: PeoplePanel | None) -> None:
        """Show the number of new texts on the button of the people."""
        if people is not None:
            name = self._texts.text("people.show")
            face = ButtonFace(f"{name} · {people.unread}" if people.unread else name)
            spoken = self._texts.text("people.show_hint")
            self.people.show_face(face, f"{spoken}, {people.news}" if people.news else spoken)

    def show_waiting(self, waiting: tuple[WaitingItem, ...], nothing_waits: str) -> None:
        """Show these items. If there are none, show the sentence `nothing_waits`."""
        set_text(self._count, self._texts.text("window.waiting", count=len(waiting)) if waiting else nothing_waits)
        if waiting == self._shown:
            return
        self._shown = waiting
        # The sentence may use two lines. The number of items is always on one line.
        self._count.setWordWrap(not waiting)
        self._area.setVisible(bool(waiting))
        self._row.setStretchFactor(self._count, 0 if waiting else 1)
        while len(self.chips) < len(waiting):
            made = WaitingChip(self._texts)
            made.requested.connect(self.requested)
            made.focused.connect(self._area.ensureWidgetVisible)
            self._chips.insertWidget(len(self.chips), made)
            self.chips.append(made)
        for shown, one in zip(self.chips, waiting, strict=False):
            shown.show_waiting(one)
            shown.show()
        for spare in self.chips[len(waiting) :]:
            spare.hide()
