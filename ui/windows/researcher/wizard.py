"""Wizard-of-Oz: the researcher speaks in a robot's place; the record says so."""

from collections.abc import Sequence
from dataclasses import dataclass

from PySide6.QtCore import Qt, Signal
from PySide6.QtWidgets import (
    QCheckBox,
    QFrame,
    QHBoxLayout,
    QLabel,
    QLineEdit,
    QPushButton,
    QScrollArea,
    QVBoxLayout,
    QWidget,
)

from thbridge.hunt.costs import spoken_energy
from thbridge.hunt.rules import robot_name
from thbridge.roles.requests import AdviseFor, Puppeteer, SpeakFor


@dataclass(frozen=True, slots=True)
class PendingTurn:
    """A robot's turn in a dialogue that waits for the wizard.

    Attributes:
        dialogue: its number.
        turn: place of the move in the dialogue, from 0.
        robot: who shall speak.
        room: about which, or None.
        sentences: the legal moves, as the robot would say them.
    """

    dialogue: int
    turn: int
    robot: int
    room: int | None
    sentences: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class PendingAdvice:
    """A participant's "don't know" that waits for the wizard.

    Attributes:
        robot: who shall advise.
        rooms: that it can go to, with the energy that costs.
        suggestion: what it would say itself.
    """

    robot: int
    rooms: tuple[tuple[int, float], ...]
    suggestion: int | None


class Wizard(QWidget):
    """Who is a puppet, and what waits for the wizard.

    Signals:
        asked: a `Puppeteer`, `SpeakFor` or `AdviseFor`.
    """

    asked = Signal(object)

    def __init__(self) -> None:
        super().__init__()
        self._puppets: list[QCheckBox] = []
        self._waiting: tuple[tuple[PendingTurn, ...], tuple[PendingAdvice, ...]] | None = None
        self._reason = ""
        self._note = QLabel("Robots that are ticked speak only what you let them say. The recording marks it as yours.")
        self._note.setWordWrap(True)
        self._row = QHBoxLayout()
        self._row.addWidget(QLabel("Speak for"))
        self._row.addStretch(1)
        self._cards = QVBoxLayout()
        self._cards.setAlignment(Qt.AlignmentFlag.AlignTop)
        inside = QWidget()
        inside.setLayout(self._cards)
        area = QScrollArea()
        area.setWidgetResizable(True)
        area.setWidget(inside)
        area.setAccessibleName("What waits for you")
        layout = QVBoxLayout(self)
        layout.setContentsMargins(12, 12, 12, 12)
        layout.addWidget(self._note)
        layout.addLayout(self._row)
        layout.addWidget(area, 1)
        self.show_waiting((), ())

    def refuse(self, reason: str) -> None:
        """Nobody can be spoken for, for this reason."""
        self._reason = reason
        self._note.setText(reason)
        for box in self._puppets:
            box.setEnabled(False)

    def show_puppets(self, robots: int, puppets: Sequence[int]) -> None:
        """How many robots there are, and which are puppets."""
        while len(self._puppets) < robots:
            robot = len(self._puppets)
            box = QCheckBox(robot_name(robot))
            box.setAccessibleName(f"Speak for {robot_name(robot)}")
            box.setEnabled(not self._reason)
            box.clicked.connect(lambda on, robot=robot: self.asked.emit(Puppeteer(robot, on)))
            self._puppets.append(box)
            self._row.insertWidget(self._row.count() - 1, box)
        for robot, box in enumerate(self._puppets):
            box.setVisible(robot < robots)
            box.setChecked(robot in puppets)

    def show_waiting(self, turns: Sequence[PendingTurn], advice: Sequence[PendingAdvice]) -> None:
        """What waits; what was typed stays where nothing changed."""
        waiting = tuple(turns), tuple(advice)
        if waiting == self._waiting:
            return
        self._waiting = waiting
        while (item := self._cards.takeAt(0)) is not None:
            if (old := item.widget()) is not None:
                old.deleteLater()
        for turn in turns:
            self._cards.addWidget(self._turn(turn))
        for wish in advice:
            self._cards.addWidget(self._advice(wish))
        if not turns and not advice:
            self._cards.addWidget(QLabel("Nothing waits for you."))

    def _turn(self, turn: PendingTurn) -> QWidget:
        about = "" if turn.room is None else f" about room {turn.room}"
        card, column = _card(f"{robot_name(turn.robot).capitalize()} is to speak{about}")
        words = QLineEdit(placeholderText="In other words (optional), then choose what it means")
        words.setAccessibleName(f"Other words for {robot_name(turn.robot)}")
        for number, sentence in enumerate(turn.sentences):
            button = QPushButton(sentence)
            button.clicked.connect(
                lambda _, move=number: self.asked.emit(SpeakFor(turn.dialogue, turn.turn, move, words.text().strip()))
            )
            column.addWidget(button)
        column.addWidget(words)
        return card

    def _advice(self, wish: PendingAdvice) -> QWidget:
        card, column = _card(f"{robot_name(wish.robot).capitalize()} is asked where to go")
        for room, cost in wish.rooms:
            own = "; its own suggestion" if room == wish.suggestion else ""
            button = QPushButton(f"Room {room} ({spoken_energy(cost)}{own})")
            button.clicked.connect(lambda _, room=room: self.asked.emit(AdviseFor(wish.robot, room)))
            column.addWidget(button)
        return card


def _card(title: str) -> tuple[QFrame, QVBoxLayout]:
    card = QFrame()
    card.setProperty("panel", True)
    column = QVBoxLayout(card)
    heading = QLabel(title)
    font = heading.font()
    font.setBold(True)
    heading.setFont(font)
    column.addWidget(heading)
    return card, column
