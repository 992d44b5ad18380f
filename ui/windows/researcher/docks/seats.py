"""Dock of the seats of a game: who plays them, their robots and dialogues, and the texts and votes of the people."""

from collections.abc import Sequence

from PySide6.QtCore import QRectF, Qt, Signal
from PySide6.QtGui import QColor, QPaintEvent
from PySide6.QtWidgets import QFrame, QHBoxLayout, QPushButton, QScrollArea, QVBoxLayout, QWidget

from ui.model.watching.seat_rows import PRESENCE_WORDS, SeatRow, TeamLine
from ui.windows.look import GAP, colours, follow_text, label, px, smooth_painter, spaced, style_as_panel
from ui.windows.untrusted_text import breakable

MOST_LINES = 200
"""Maximum number of texts and votes that the dock shows; the lists below the map have all of them."""
LIST_HEIGHT = 150
"""Smallest height of the list of texts and votes, `px`. If it does not fit below the seats, the dock scrolls."""


class SeatsDock(QWidget):
    """Dock with a card for each seat, and with the texts and votes of the people, the latest at the bottom.

    Args:
        live: True for a running session, in which the researcher can take a seat.

    Signals:
        wanted: the researcher wants to play the seat with this name.
    """

    wanted = Signal(str)

    def __init__(self, live: bool) -> None:
        super().__init__()
        self._live = live
        self._seats: tuple[SeatRow, ...] = ()
        self._lines: tuple[TeamLine, ...] = ()
        self.cards: list[SeatCard] = []
        self._cards = spaced(QVBoxLayout(), GAP // 2, 0)
        self.list = _LineList()
        inside = QWidget()
        column = spaced(QVBoxLayout(inside), GAP, GAP)
        column.addLayout(self._cards)
        column.addWidget(label("Texts and votes", bold=True))
        column.addWidget(self.list, 1)
        follow_text(self.list, lambda it: it.setMinimumHeight(px(LIST_HEIGHT)))
        area = QScrollArea(widgetResizable=True)
        area.setHorizontalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAlwaysOff)
        area.setWidget(inside)
        area.setAccessibleName("Seats of the game")
        spaced(QVBoxLayout(self), 0, 0).addWidget(area)

    def show_seats(self, seats: Sequence[SeatRow], lines: Sequence[TeamLine], no_seat: str) -> None:
        """Show the seats, and the texts and votes of their people.

        Args:
            seats: the seats.
            lines: texts and votes, oldest first.
            no_seat: reason why the researcher cannot take any seat; empty if they can.
        """
        if len(seats) != len(self.cards):
            for gone in self.cards:
                gone.deleteLater()
            self.cards = [SeatCard() for _ in seats]
            for card in self.cards:
                card.take.clicked.connect(lambda _, card=card: self.wanted.emit(card.name))
                self._cards.addWidget(card)
        for card, seat in zip(self.cards, seats, strict=True):
            card.show_seat(seat, live=self._live, no_seat=no_seat)
        self.list.show_lines(tuple(lines[-MOST_LINES:]))


class SeatCard(QFrame):
    """Seat of a game.

    Attributes:
        name: name of the seat.
        take: button with which the researcher takes the seat.
    """

    def __init__(self) -> None:
        super().__init__()
        style_as_panel(self)
        self.name = ""
        self._shown: tuple[SeatRow, str] | None = None
        self._title, self._presence = label(bold=True), label("", "small")
        self._presence.setWordWrap(False)
        self._robots, self._rights = label("", "small"), label("", "small", muted=True)
        self.take = QPushButton("Take this seat")
        rows = spaced(QVBoxLayout(self), 2, GAP, GAP // 2, GAP, GAP // 2)
        top = spaced(QHBoxLayout(), GAP, 0)
        top.addWidget(self._title, 1)
        top.addWidget(self._presence)
        rows.addLayout(top)
        rows.addWidget(self._robots)
        rows.addWidget(self._rights)
        rows.addWidget(self.take, 0, Qt.AlignmentFlag.AlignLeft)

    def show_seat(self, seat: SeatRow, *, live: bool, no_seat: str) -> None:
        """Show this seat. `no_seat` is the reason why the researcher cannot take any seat."""
        if self._shown == (seat, no_seat):
            return
        self._shown, self.name = (seat, no_seat), seat.name
        self._title.setText(breakable(seat.label))
        self._title.setToolTip(f"Name in the study: {seat.name}")
        self._presence.setText(f"{_DOTS[seat.presence]} {PRESENCE_WORDS[seat.presence]}")
        self._presence.setProperty("bad", seat.presence == "away")
        self._presence.style().polish(self._presence)
        commands = f"Commands {seat.robots}"
        talks = f" · talks with {seat.talks}" if seat.talks else ""
        self._robots.setText(commands + talks)
        self._rights.setText(seat.rights)
        self._rights.setVisible(bool(seat.rights))
        why_not = no_seat or seat.why_not_played
        self.take.setVisible(live and not seat.why_not_played)
        self.take.setEnabled(not why_not)
        self.take.setToolTip(why_not or "Play this seat in the participant's window until its person comes back")
        self.take.setAccessibleName(f"Take the seat {seat.name}")
        self._presence.setToolTip(seat.why_not_played if live else "")
        self.setAccessibleName(f"{seat.label}: {PRESENCE_WORDS[seat.presence]}. {commands}{talks}. {seat.rights}")


_DOTS = {"person": "●", "program": "◆", "researcher": "▲", "away": "○", "not taken": "○"}


class _LineList(QScrollArea):
    """Texts and votes; the list stays at the latest unless a person scrolls."""

    def __init__(self) -> None:
        super().__init__(widgetResizable=True)
        self.setHorizontalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAlwaysOff)
        self.setAccessibleName("Texts and votes of the people")
        inside = QWidget()
        self._rows = spaced(QVBoxLayout(inside), GAP // 2, 0)
        self._nothing = label("No texts and votes so far.", "small", muted=True)
        self._rows.addWidget(self._nothing)
        self._rows.addStretch(1)
        self.setWidget(inside)
        self._shown: list[_LineCard] = []
        self._at_end = True
        bar = self.verticalScrollBar()
        bar.rangeChanged.connect(lambda *_: bar.setValue(bar.maximum()) if self._at_end else None)
        bar.valueChanged.connect(lambda value: setattr(self, "_at_end", value >= bar.maximum() - GAP))

    @property
    def lines(self) -> list[str]:
        """Texts of the cards."""
        return [card.accessibleName() for card in self._shown]

    def show_lines(self, lines: tuple[TeamLine, ...]) -> None:
        """Show these texts and votes."""
        while len(self._shown) > len(lines):
            self._shown.pop().deleteLater()
        while len(self._shown) < len(lines):
            card = _LineCard()
            self._rows.insertWidget(self._rows.count() - 1, card)
            self._shown.append(card)
        for card, line in zip(self._shown, lines, strict=True):
            card.show_line(line)
        self._nothing.setVisible(not lines)


class _LineCard(QWidget):
    """Text or vote, with an edge in the accent color while it is open or unread."""

    def __init__(self) -> None:
        super().__init__()
        self._shown: TeamLine | None = None
        self._title, self._body = label("", "small", bold=True), label()
        self._state = label("", "small", muted=True)
        self._body.setTextInteractionFlags(Qt.TextInteractionFlag.TextSelectableByMouse)
        rows = spaced(QVBoxLayout(self), 1, GAP + 4, GAP // 2, GAP, GAP // 2)
        for part in (self._title, self._body, self._state):
            rows.addWidget(part)

    def show_line(self, line: TeamLine) -> None:
        """Show this text or vote."""
        if line == self._shown:
            return
        self._shown = line
        self._title.setText(f"{line.time}  {line.title}")
        self._body.setText(breakable(line.body))
        self._state.setText(line.state)
        self.setAccessibleName(f"{line.time} {line.title}. {line.body}. {line.state}")
        self.update()

    def paintEvent(self, _event: QPaintEvent) -> None:
        """Draw the ground and the edge."""
        palette, painter = colours(), smooth_painter(self)
        painter.setPen(Qt.PenStyle.NoPen)
        painter.setBrush(QColor(palette.track))
        painter.drawRoundedRect(QRectF(self.rect()), 6, 6)
        is_open = self._shown is not None and self._shown.is_open
        painter.setBrush(QColor(palette.accent if is_open else palette.muted))
        painter.drawRoundedRect(QRectF(2.0, 5.0, 4.0, self.height() - 10.0), 2, 2)
