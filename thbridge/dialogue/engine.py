"""Dialogue engines: they receive moves of people, and return utterances and outcomes.

A wizard may speak in a robot's place. A dialogue that is held waits at the robot's turn. Then either `speak` makes the
robot's move, or `release` lets the robot choose its move.
"""

from dataclasses import dataclass
from typing import Protocol, Self

from thbridge.dialogue.games.control import Conversation
from thbridge.dialogue.moves import (
    Author,
    Dialogue,
    DialogueOutcome,
    DialogueTopic,
    DialogueUtterance,
    Move,
    OfferedSentence,
    Speaker,
    Turn,
)
from thbridge.dialogue.sentences import numbers_in


class Phrasing(Protocol):
    """Sentences for moves."""

    @property
    def names_energy(self) -> bool:
        """True if sentences may contain amounts of energy."""
        ...

    def without_energy(self) -> "Phrasing":
        """Return the phrasing for people who do not see energy: the same sentences without amounts of energy."""
        ...

    def say(self, dialogue: Dialogue, move: Move, speaker: Speaker) -> str:
        """Return the sentence for the next move, or a possible next move, of this dialogue."""
        ...

    def authored(self, dialogue: Dialogue, move: Move) -> OfferedSentence | None:
        """Return the offer of another author for the robot's next move.

        The result is None if there is no author, or the author is not asked.
        """
        ...


@dataclass(frozen=True, slots=True)
class Choice:
    """A legal move and its sentence."""

    move: Move
    text: str


@dataclass(frozen=True, slots=True)
class DialogueStep:
    """Result of an opening or a move.

    Attributes:
        dialogue: the dialogue in its new state.
        utterances: the new utterances, in order.
        outcome: outcome of the dialogue; None while it waits for the person, or for the wizard in the robot's place.
    """

    dialogue: Dialogue
    utterances: tuple[DialogueUtterance, ...]
    outcome: DialogueOutcome | None


class DialogueEngine(Protocol):
    """Engine for one kind of dialogue. It has no state: every method receives a dialogue and returns its new state.

    All methods raise ValueError if a person, a wizard or the strategy makes an illegal move.
    """

    @property
    def argues(self) -> bool:
        """True if topics must contain the robot's facts."""
        ...

    def without_energy(self) -> Self:
        """Return the engine for people who do not see energy: its sentences contain no amounts of energy."""
        ...

    def open(
        self, number: int, topic: DialogueTopic, *, held: bool = False, former: Conversation | None = None
    ) -> DialogueStep:
        """Open a dialogue; unless it is held, let the robot speak until the person's turn or the end of the dialogue.

        Args:
            number: number of the dialogue.
            topic: topic of the dialogue.
            held: True if a wizard speaks in the robot's place.
            former: earlier statements and beliefs of this robot and the participant, if robots argue.
        """
        ...

    def announce(self, number: int, topic: DialogueTopic, move: Move) -> DialogueStep:
        """Let the robot say something that needs no answer; then the dialogue ends."""
        ...

    def move(self, dialogue: Dialogue, move: Move, *, held: bool = False) -> DialogueStep:
        """Make the person's move; unless the dialogue is held, let the robot answer."""
        ...

    def speak(self, dialogue: Dialogue, move: Move, text: str = "") -> DialogueStep:
        """Make the move of a robot in a held dialogue. The dialogue remains held. `text` is as in `Turn`."""
        ...

    def release(self, dialogue: Dialogue) -> DialogueStep:
        """Let the robot speak in a held dialogue."""
        ...

    def retake(self, dialogue: Dialogue, turn: Turn) -> DialogueStep:
        """Repeat a turn from before the dialogue was restored; the robot does not answer this turn."""
        ...

    def choices(self, dialogue: Dialogue, speaker: Speaker = Speaker.PERSON) -> tuple[Choice, ...]:
        """Return the speaker's legal moves in an open dialogue, most agreeable first.

        There are no moves if it is not the speaker's turn.
        """
        ...

    def utterances(self, dialogue: Dialogue) -> tuple[DialogueUtterance, ...]:
        """Return all utterances of a dialogue so far."""
        ...


def text_of(phrasing: Phrasing, dialogue: Dialogue, turn: Turn) -> str:
    """Return the sentence of the next turn of a dialogue.

    The text of another author, such as a wizard, replaces the sentence of the phrasing. If no amount of energy may be
    named, this text may contain only numbers that the sentence also contains, for example of rooms.
    """
    if turn.text and phrasing.names_energy:
        return turn.text
    said = phrasing.say(dialogue, turn.said or turn.move, turn.speaker)
    return turn.text if turn.text and numbers_in(turn.text) <= numbers_in(said) else said


def announcement(phrasing: Phrasing, number: int, topic: DialogueTopic, move: Move) -> DialogueStep:
    """Return the dialogue in which a robot makes one statement that needs no answer."""
    turn = Turn(Speaker.ROBOT, move, Author.ROBOT)
    text = phrasing.say(Dialogue(number, topic), move, Speaker.ROBOT)
    utterance = DialogueUtterance(number, 0, Speaker.ROBOT, Author.ROBOT, move, text, topic)
    return DialogueStep(Dialogue(number, topic, (turn,)), (utterance,), DialogueOutcome.NO_CONSENSUS)
