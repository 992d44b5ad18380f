"""Dock for a Wizard of Oz: the researcher speaks in place of a robot, and the recording marks these sentences."""

from functools import partial
from textwrap import fill

from PySide6.QtCore import QSize, Qt, Signal
from PySide6.QtGui import QFontMetrics, QResizeEvent
from PySide6.QtWidgets import (
    QCheckBox,
    QFrame,
    QGridLayout,
    QLabel,
    QLineEdit,
    QPushButton,
    QScrollArea,
    QVBoxLayout,
    QWidget,
)

from sim.common.robot_numbers import robot_name
from thbridge.hunt.costs import energy_text
from thbridge.hunt.rooms import RoomNames
from ui.model.watching.scene import PendingAdvice, PendingTurn, Wizard
from ui.windows.flow import FlowLayout
from ui.windows.look import follow_text, font, px
from ui.windows.untrusted_text import PlainLabel, button_text

NO_NAMES = RoomNames()
"""Room names before the names are known."""
PUPPETS_PER_ROW = 5
"""Maximum number of robots in a row of check boxes."""

WIDEST = 480
"""Maximum width of a sentence on a button, logical pixels. Longer sentences are wrapped."""

HEIGHT, REST = 248, 190
"""Height of the list of waiting turns, and height that this list leaves to the other parts of a low window, `px`."""


class WizardDock(QWidget):
    """Dock with check boxes of the robots that the wizard speaks for, and with the turns that wait for the wizard.

    Signals:
        puppeteered: the wizard wants to start or stop speaking for this robot.
        spoke: the wizard chose a move: the waiting turn, the index of the legal move, and own words or an empty text.
        advised: the wizard chose the room that this robot should suggest.
    """

    puppeteered = Signal(int, bool)
    spoke = Signal(object, int, str)
    advised = Signal(int, int)

    def __init__(self) -> None:
        super().__init__()
        self._puppets: list[QCheckBox] = []
        self._shown: Wizard | None = None
        self._reason = ""
        self._note = PlainLabel("Ticked robots say only what you choose. The recording marks these sentences as yours.")
        self._note.setWordWrap(True)
        self._boxes = QGridLayout()
        self._boxes.addWidget(PlainLabel("Speak for"), 0, 0)
        self._boxes.setColumnStretch(PUPPETS_PER_ROW + 1, 1)
        self._cards = QVBoxLayout()
        self._cards.setAlignment(Qt.AlignmentFlag.AlignTop)
        inside = QWidget()
        rows = QVBoxLayout(inside)
        rows.addWidget(self._note)
        rows.addLayout(self._boxes)
        rows.addLayout(self._cards)
        rows.addStretch(1)
        self._area = area = _SteadyArea()
        area.setWidget(inside)
        area.setAccessibleName("Waiting turns")
        layout = QVBoxLayout(self)
        layout.setContentsMargins(8, 8, 8, 8)
        layout.addWidget(area)
        self.show_wizard(Wizard(), 0)

    def refuse(self, reason: str) -> None:
        """Disable the panel, and show this reason."""
        self._reason = reason
        self._area.steady = False
        self._note.setText(reason)
        for box in self._puppets:
            box.setEnabled(False)

    def fit_window(self) -> None:
        """Adapt to the height of the window."""
        self._area.updateGeometry()

    def show_wizard(self, wizard: Wizard, robots: int, rooms: RoomNames = NO_NAMES) -> None:
        """Show the robots that the wizard speaks for, and the waiting turns.

        Words that the wizard typed remain while the turns do not change.

        Args:
            wizard: the robots that the wizard speaks for, and the waiting turns.
            robots: number of robots in the team.
            rooms: names of the rooms of the map.
        """
        self._rooms = rooms
        self._show_puppets(robots, wizard.puppets)
        before, self._shown = self._shown, wizard
        if before is not None and (before.turns, before.advice) == (wizard.turns, wizard.advice):
            return
        while (item := self._cards.takeAt(0)) is not None:
            if (old := item.widget()) is not None:
                old.deleteLater()
        for turn in wizard.turns:
            self._cards.addWidget(self._turn(turn))
        for pending in wizard.advice:
            self._cards.addWidget(self._advice(pending))
        waits = bool(wizard.turns or wizard.advice)
        # Hide the note, because the waiting turns need its space. By then, the wizard has read the note.
        self._note.setVisible(not waits or bool(self._reason))
        if not waits:
            self._cards.addWidget(PlainLabel("No robot waits for you."))

    def _show_puppets(self, robots: int, puppets: tuple[int, ...]) -> None:
        while len(self._puppets) < robots:
            robot = len(self._puppets)
            box = QCheckBox(robot_name(robot))
            box.setAccessibleName(f"Speak for {robot_name(robot)}")
            box.setEnabled(not self._reason)
            box.clicked.connect(lambda on, robot=robot: self.puppeteered.emit(robot, on))
            self._puppets.append(box)
            self._boxes.addWidget(box, robot // PUPPETS_PER_ROW, 1 + robot % PUPPETS_PER_ROW)
        for robot, box in enumerate(self._puppets):
            box.setVisible(robot < robots)
            box.setChecked(robot in puppets)

    def _turn(self, turn: PendingTurn) -> QWidget:
        about = "" if turn.room is None else f" about {self._rooms.titled(turn.room)}"
        card, column = _card()
        words = QLineEdit(placeholderText="Optional: type your own words, then press the sentence of the same meaning")
        words.setToolTip(words.placeholderText())
        words.setAccessibleName(f"Your own words for {robot_name(turn.robot)}")
        top = FlowLayout()
        top.addWidget(_heading(f"{robot_name(turn.robot).capitalize()} waits to speak{about}"))
        top.addWidget(words)
        column.addLayout(top)
        moves = FlowLayout()
        for number, sentence in enumerate(turn.sentences):
            button = follow_text(QPushButton(), partial(_show_sentence, sentence))
            button.clicked.connect(partial(self._speak, turn, number, words))
            moves.addWidget(button)
        column.addLayout(moves)
        if len(turn.sentences) == 1:
            words.returnPressed.connect(partial(self._speak, turn, 0, words))
        return card

    def _speak(self, turn: PendingTurn, move: int, words: QLineEdit) -> None:
        self.spoke.emit(turn, move, words.text().strip())

    def _advise(self, robot: int, room: int) -> None:
        self.advised.emit(robot, room)

    def _advice(self, pending: PendingAdvice) -> QWidget:
        card, column = _card()
        rooms = FlowLayout()
        rooms.addWidget(_heading(f"{robot_name(pending.robot).capitalize()} waits to suggest a room"))
        for room, cost in pending.costs:
            own = "its own choice" if room == pending.suggestion else ""
            notes = "; ".join(part for part in (self._rooms.name(room), energy_text(cost), own) if part)
            button = QPushButton(button_text(f"Room {room} ({notes})"))
            button.clicked.connect(partial(self._advise, pending.robot, room))
            rooms.addWidget(button)
        column.addLayout(rooms)
        return card


class _SteadyArea(QScrollArea):
    """Scroll area with a height that does not depend on waiting turns, so new turns never move the map.

    Attributes:
        steady: False if the contents never change. The area then has the height of its contents.
    """

    steady = True

    def __init__(self) -> None:
        super().__init__()
        self.setWidgetResizable(True)

    def minimumSizeHint(self) -> QSize:
        """Return the fixed height, limited to the space in the window."""
        hint, contents, high = super().minimumSizeHint(), self.widget(), px(HEIGHT)
        if not self.steady and contents is not None:
            high = contents.heightForWidth(self.viewport().width()) + 2 * self.frameWidth()
        return QSize(hint.width(), min(high, self.window().height() - px(REST)))

    def resizeEvent(self, event: QResizeEvent) -> None:
        """Adapt the height to the new width."""
        super().resizeEvent(event)
        self.updateGeometry()


def _show_sentence(sentence: str, button: QPushButton) -> None:
    button.setText(button_text(fill(sentence, WIDEST // QFontMetrics(font()).averageCharWidth())))


def _card() -> tuple[QFrame, QVBoxLayout]:
    card = QFrame()
    card.setProperty("panel", True)
    column = QVBoxLayout(card)
    column.setContentsMargins(8, 6, 8, 6)
    return card, column


def _heading(title: str) -> QLabel:
    return follow_text(PlainLabel(title), lambda it: it.setFont(font(bold=True)))
