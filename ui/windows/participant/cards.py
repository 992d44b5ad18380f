"""Cards of the robots, next to the map."""

from PySide6.QtCore import QPointF, QRect, QRectF, QSize, Qt, Signal
from PySide6.QtGui import QColor, QFontMetricsF, QPainter, QPaintEvent, QPen, QResizeEvent
from PySide6.QtWidgets import QApplication, QSizePolicy, QVBoxLayout, QWidget

from thbridge.dialogue.wording.texts import Texts
from ui.model.playing.screen import Action, RobotCard
from ui.model.playing.spoken import energy_words, spoken_act, spoken_card, spoken_request
from ui.windows.look import GAP, RADIUS, colours, follow_text, font, px, smooth_painter, spaced
from ui.windows.participant.widgets.buttons import ActionButton, ActionWidget, ParticipantButton
from ui.windows.participant.widgets.painting import (
    Sign,
    box,
    chip,
    chip_size,
    elided,
    fitting,
    hatch,
    key_cap,
    key_size,
    ring,
    sign,
    write,
)

PAD = 1.25 * GAP
EDGE = 6.0
"""Distance above the first line and below the last line of a card when there is little space, logical pixels."""
BAR = 7.0
CLOSE, FAR = 3.0, 7.0
"""Distance between the energy bar and the lines, with little space and with enough space, logical pixels."""
BETWEEN = 3.0
"""Distance between the line of another commander and the line of the robot's activity, logical pixels."""


class CardFace(ParticipantButton):
    """Card of a robot without its buttons. A press on the card selects the robot."""

    def __init__(self, texts: Texts, parent: QWidget) -> None:
        super().__init__(texts, parent)
        self.setCheckable(True)
        self._card: RobotCard | None = None
        self._button_width = 0

    def nextCheckState(self) -> None:
        """Do nothing, because only the game decides whether the card is checked."""

    def show_card(self, card: RobotCard, button_width: int) -> None:
        """Show this robot's card; keep `button_width` free for the button in the first line below the bar."""
        if (card, button_width) == (self._card, self._button_width):
            return
        if self._card is None or _parts(self._card) != _parts(card):
            self.updateGeometry()
        self._card, self._button_width = card, button_width
        self.setChecked(card.selected)
        self.bind(card.select, spoken_card(self._texts, card))
        self.update()

    def sizeHint(self) -> QSize:
        """Return the size of the lines and the bar with the usual distances."""
        return QSize(px(300), int(self._high(FAR)))

    def minimumSizeHint(self) -> QSize:
        """Return the size of the lines and the bar with small distances."""
        return QSize(px(200), int(self._high(CLOSE)))

    def paintEvent(self, _event: QPaintEvent) -> None:
        """Draw the name and energy, the bar, another commander, the activity and place, and the progress."""
        card = self._card
        if card is None:
            return
        palette = colours()
        painter = smooth_painter(self)
        rect = QRectF(self.rect())
        edge = palette.accent if card.selected else palette.line
        ground = palette.track if self.pointed_at() and not card.selected else palette.panel
        box(painter, rect, ground, edge, width=2.5 if card.selected else 1.0, radius=RADIUS)
        if self.hasFocus():
            ring(painter, rect, palette.text if card.selected else palette.accent)
        space = min(FAR, CLOSE + max(0.0, rect.height() - self._high(CLOSE)) / 4.0)
        left, right = rect.left() + PAD, rect.right() - PAD
        middle = rect.top() + EDGE + space - CLOSE + self._line() / 2.0
        self._top_line(painter, card, left, right, middle)
        below = middle + self._line() / 2.0 + space
        if card.energy is not None:
            draw_energy(painter, QRectF(left, below, right - left, BAR), card, card.energy)
            below += BAR + space
        line = QRectF(left, below, right - left - self._button_width, self._line())
        if card.shown_commander:
            ink = palette.accent if card.asked_for else palette.text
            words = card.shown_commander[:1].upper() + card.shown_commander[1:]
            marked: Sign | None = "talk" if card.asked_for else "mast" if card.commander else None
            _draw_line(painter, line, marked, ink, words)
            line.translate(0.0, self.commander_high())
            line.setRight(right)
        if card.warning:
            _draw_line(painter, line, "trouble", palette.bad, card.warning, card.state)
        else:
            ink = palette.bad if card.trouble else palette.text
            _draw_line(painter, line, "trouble" if card.trouble else None, ink, card.state, card.place)
        if card.progress is not None:
            self._progress(painter, rect, card.progress, palette.robot(card.robot))

    def button_place(self, size: QSize) -> QRect:
        """Return the place for a button of this size, at the right end of the first line below the bar."""
        above = EDGE + max(0.0, self.height() - self._high(CLOSE)) / 4.0 + self._line() + 1.0
        if self._card is not None and self._card.shown_commander:
            above += self.commander_high()
        return QRect(int(self.width() - PAD - size.width()), int(self.height() - above), size.width(), size.height())

    @classmethod
    def commander_high(cls) -> int:
        """Return the extra height of a card that shows another commander, logical pixels."""
        return round(cls._line() + BETWEEN)

    @staticmethod
    def _line() -> float:
        """Return the height of a line, which is also the height of its button."""
        return key_size("X")[1] + 4.0

    def _high(self, space: float) -> float:
        lines = 2.0 * self._line()
        if self._card is not None and self._card.shown_commander:
            lines += self.commander_high()
        bar = 0.0 if self._card is not None and self._card.energy is None else BAR + space
        return 2.0 * (EDGE + space - CLOSE) + lines + bar + space + 2.0

    def _top_line(self, painter: QPainter, card: RobotCard, left: float, right: float, middle: float) -> None:
        palette = colours()
        size = chip_size()
        chip(painter, QPointF(left + size / 2.0, middle), card.robot)
        bold = font("body", bold=True)
        metrics = QFontMetricsF(bold)
        at = left + size + GAP
        key_wide, key_high = key_size(self._shown_key)
        energy = energy_words(self._texts, card)
        room = right - at - metrics.horizontalAdvance(card.name) - GAP - (px(40) if card.waits else 0.0)
        if key_wide and metrics.horizontalAdvance(energy[-1]) <= room - key_wide - GAP:
            room -= key_wide + GAP
        else:
            key_wide = 0.0
        words = fitting(energy, room, metrics)
        wide = metrics.horizontalAdvance(words)
        row = QRectF(at, middle - size, right - at, 2.0 * size)
        right_end = Qt.AlignmentFlag.AlignRight | Qt.AlignmentFlag.AlignVCenter
        write(painter, row, words, bold, palette.text if card.affordable else palette.bad, right_end)
        if not card.affordable:
            side = metrics.height() * 0.85
            sign(painter, QRectF(right - wide - side - 4, middle - side / 2, side, side), "trouble", palette.bad)
        write(painter, row, card.name, bold, palette.text)
        at += metrics.horizontalAdvance(card.name) + GAP
        if key_wide:
            key_cap(painter, QRectF(at, middle - key_high / 2.0, key_wide, key_high), self._shown_key, palette.muted)
            at += key_wide + GAP
        if card.waits:
            self._waits(painter, card.waits, at, middle)

    @staticmethod
    def _waits(painter: QPainter, waits: int, left: float, middle: float) -> None:
        """Draw the number of the robot's items that wait for an answer."""
        palette, face = colours(), font("small", bold=True)
        metrics = QFontMetricsF(face)
        text, side = str(waits), metrics.height()
        pill = QRectF(left, middle - side / 2 - 1, side + metrics.horizontalAdvance(text) + GAP + 2, side + 2)
        painter.setPen(Qt.PenStyle.NoPen)
        painter.setBrush(QColor(palette.accent))
        painter.drawRoundedRect(pill, pill.height() / 2, pill.height() / 2)
        icon = QRectF(pill.left() + 5, pill.top() + 1, side, side).adjusted(2, 2, -2, -2)
        sign(painter, icon, "talk", palette.on_accent)
        write(painter, pill.adjusted(side + 4, 0, 0, 0), text, face, palette.on_accent)

    @staticmethod
    def _progress(painter: QPainter, rect: QRectF, share: float, colour: str) -> None:
        """Draw a thin line along the lower edge; its length shows the driven share of the path."""
        y = rect.bottom() - 5.0
        reach = rect.left() + PAD + (rect.width() - 2.0 * PAD) * min(1.0, max(0.0, share))
        pen = QPen(QColor(colours().track), 3.0)
        pen.setCapStyle(Qt.PenCapStyle.RoundCap)
        painter.setPen(pen)
        painter.drawLine(QPointF(rect.left() + PAD, y), QPointF(rect.right() - PAD, y))
        pen.setColor(QColor(colour))
        painter.setPen(pen)
        painter.drawLine(QPointF(rect.left() + PAD, y), QPointF(reach, y))


class Card(ActionWidget):
    """Card of a robot, with its buttons.

    A button stops a driving robot, hands over a robot, asks another commander for the robot, or resumes the decision
    about a treasure that was left in the robot's room. In a game with one participant, there is at most one button.
    """

    def __init__(self, texts: Texts, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._texts = texts
        self.face = CardFace(texts, self)
        self.stop = ActionButton(texts, "small", parent=self)
        self.hand_over = ActionButton(texts, "small", parent=self)
        self.ask_back = ActionButton(texts, "small", parent=self)
        self.take_up = ActionButton(texts, "small", parent=self)
        self._buttons = {
            "stop": self.stop,
            "hand_over": self.hand_over,
            "ask_back": self.ask_back,
            "take_up": self.take_up,
        }
        for part in (self.face, *self._buttons.values()):
            part.requested.connect(self.requested)
        self.setSizePolicy(QSizePolicy.Policy.Preferred, QSizePolicy.Policy.Preferred)
        self._card: RobotCard | None = None
        follow_text(self, Card._fit)

    def show_card(self, card: RobotCard) -> None:
        """Show this robot's card; do nothing if the card has not changed."""
        if card == self._card:
            return
        self._card = card
        self.setAccessibleName(card.name)
        self._fit()

    def _fit(self) -> None:
        """Lay out the card and its button according to their texts."""
        card = self._card
        if card is None:
            return
        offered = dict(card.buttons)
        wide = sum(
            self._offer(button, offered.get(name), spoken_act(self._texts, card, name))
            for name, button in self._buttons.items()
        )
        self.face.show_card(card, wide)
        self.setMaximumHeight(self.sizeHint().height())
        self._place()

    def _offer(self, button: ActionButton, action: Action | None, spoken: str) -> int:
        """Show an action on a button, or hide the button if there is none. Return the width that the button needs."""
        if action is not None:
            button.show_action(action)
            button.setAccessibleName(spoken_request(self._texts, spoken, action))
        elif button.hasFocus():
            self.face.setFocus()
        button.setVisible(action is not None)
        return 0 if action is None else button.sizeHint().width() + GAP

    def sizeHint(self) -> QSize:
        """Return the size hint of the card without buttons."""
        return self.face.sizeHint()

    def minimumSizeHint(self) -> QSize:
        """Return the minimum size hint of the card without buttons."""
        return self.face.minimumSizeHint()

    def resizeEvent(self, _event: QResizeEvent) -> None:
        """Put the buttons on the right side of the card."""
        self._place()

    def _place(self) -> None:
        self.face.setGeometry(self.rect())
        offset = 0
        for button in reversed(self._buttons.values()):
            place = self.face.button_place(button.sizeHint()).translated(-offset, 0)
            button.setGeometry(place)
            offset += 0 if button.isHidden() else place.width() + GAP // 2


class Cards(ActionWidget):
    """Cards of all robots, in the order of the team.

    Attributes:
        reveal: signal with a card that should be scrolled into view.
    """

    reveal = Signal(object)

    def __init__(self, texts: Texts, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._texts = texts
        self._rows = spaced(QVBoxLayout(self), GAP - 2, 0)
        self._shown: tuple[RobotCard, ...] = ()
        self._others_command = False
        self.cards: list[Card] = []

    def height_to_come(self) -> int:
        """Return the height by which the cards may grow later, logical pixels.

        After another commander has taken one robot, this commander may take every robot. The layout keeps this height
        free below the cards, so that the rooms below never move while the pointer is on them.
        """
        own = sum(not card.shown_commander for card in self._shown) if self._others_command else 0
        return own * CardFace.commander_high()

    def show_cards(self, cards: tuple[RobotCard, ...]) -> None:
        """Show these cards; do nothing if they are already shown."""
        if cards == self._shown:
            return
        selected = [card.robot for card in self._shown if card.selected]
        self._shown = cards
        self._others_command |= any(card.shown_commander for card in cards)
        while len(self.cards) < len(cards):
            self.cards.append(self._made())
        while len(self.cards) > len(cards):
            gone = self.cards.pop()
            self._rows.removeWidget(gone)
            gone.deleteLater()
        for shown, card in zip(self.cards, cards, strict=True):
            shown.show_card(card)
        chosen = [card.robot for card in cards if card.selected]
        if chosen and chosen != selected:
            self.reveal.emit(self.cards[chosen[0]])
            focused = QApplication.focusWidget()
            if focused is not None and self.isAncestorOf(focused):
                self.focus_selected()

    def focus_selected(self) -> None:
        """Give the focus to the card of the selected robot.

        Otherwise two cards would have a frame, and both robots would look selected.
        """
        for shown, card in zip(self.cards, self._shown, strict=True):
            if card.selected:
                shown.face.setFocus(Qt.FocusReason.OtherFocusReason)

    def _made(self) -> Card:
        card = Card(self._texts, self)
        card.requested.connect(self.requested)
        card.face.focused.connect(lambda _face: self.reveal.emit(card))
        self._rows.addWidget(card)
        return card


def _draw_line(painter: QPainter, line: QRectF, marked: Sign | None, ink: str, words: str, beside: str = "") -> None:
    """Draw a line of a card. It begins with a sign and bold words, or with plain words, and more words may follow."""
    small = QFontMetricsF(font("small"))
    left = line.left()
    if marked is not None:
        side = small.height() * 0.9
        sign(painter, QRectF(left, line.center().y() - side / 2, side, side), marked, ink)
        left += side + GAP / 2.0
    face = font("small", bold=marked is not None)
    shown = elided(words, line.right() - left, QFontMetricsF(face))
    write(painter, QRectF(left, line.top(), line.right() - left, line.height()), shown, face, ink)
    left += QFontMetricsF(face).horizontalAdvance(shown)
    if beside:
        space = QRectF(left, line.top(), line.right() - left, line.height())
        write(painter, space, fitting((f" · {beside}", ""), space.width(), small), font("small"), colours().muted)


def _parts(card: RobotCard) -> tuple[bool, bool]:
    """Return which parts a card has that change its height: the line of the commander, and the bar."""
    return bool(card.shown_commander), card.energy is not None


def draw_energy(painter: QPainter, rect: QRectF, card: RobotCard, energy: float) -> None:
    """Draw the remaining energy in the robot's color, with the cost of the considered move hatched."""
    palette = colours()
    colour = palette.robot(card.robot)
    full = max(card.energy_at_start, energy, 1e-9)
    painter.setPen(Qt.PenStyle.NoPen)
    painter.setBrush(QColor(palette.track))
    half = rect.height() / 2.0
    painter.drawRoundedRect(rect, half, half)
    left = rect.width() * energy / full
    kept = rect.width() * max(0.0, energy - (card.cost or 0.0)) / full
    painter.save()
    painter.setClipRect(QRectF(rect.left(), rect.top(), left, rect.height()))
    painter.setBrush(hatch(colour if card.affordable else palette.bad, palette.panel))
    painter.setPen(QPen(QColor(colour if card.affordable else palette.bad), 1.0))
    if card.cost:
        painter.drawRoundedRect(
            QRectF(rect.left(), rect.top(), left, rect.height()).adjusted(0.5, 0.5, -0.5, -0.5), half, half
        )
        painter.setClipRect(QRectF(rect.left(), rect.top(), kept, rect.height()))
    painter.setPen(Qt.PenStyle.NoPen)
    painter.setBrush(QColor(colour))
    painter.drawRoundedRect(QRectF(rect.left(), rect.top(), left, rect.height()), half, half)
    painter.restore()
