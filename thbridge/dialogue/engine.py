"""Dialogue engines: moves of people in; utterances and outcomes out.

A wizard may speak in a robot's place: a dialogue that is held waits where the robot would speak, until `speak` makes
its move or `release` lets the robot itself do so.
"""

from dataclasses import dataclass
from typing import Protocol

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


class Phrasing(Protocol):
    """Wording of moves as sentences."""

    def say(self, dialogue: Dialogue, move: Move, speaker: Speaker) -> str:
        """Return the sentence for a move that is, or may be, the next in this dialogue."""
        ...

    def authored(self, dialogue: Dialogue, move: Move) -> OfferedSentence | None:
        """Return what another author offers for the robot's next move; None where there is none, or it is not asked."""
        ...


@dataclass(frozen=True, slots=True)
class Choice:
    """A legal move and its sentence."""

    move: Move
    text: str


@dataclass(frozen=True, slots=True)
class DialogueStep:
    """Result of opening a dialogue or of a move.

    Attributes:
        dialogue: the dialogue as it now is.
        utterances: in order.
        outcome: of the dialogue; None if it waits, for the person or for the wizard in the robot's place.
    """

    dialogue: Dialogue
    utterances: tuple[DialogueUtterance, ...]
    outcome: DialogueOutcome | None


class DialogueEngine(Protocol):
    """Engine for one way of talking. Holds no state: every method takes a dialogue and returns it as it then is.

    All methods raise ValueError if somebody, or the strategy, makes a move that is not legal.
    """

    @property
    def argues(self) -> bool:
        """True when topics need the robot's facts."""
        ...

    def open(
        self, number: int, topic: DialogueTopic, *, held: bool = False, former: Conversation | None = None
    ) -> DialogueStep:
        """Open a dialogue, and unless held let the robot speak until it is the person's turn or the dialogue ends.

        Args:
            number: of the dialogue.
            topic: of the dialogue.
            held: a wizard speaks in the robot's place.
            former: all that this robot and the participant have said and believed before, where robots argue.
        """
        ...

    def announce(self, number: int, topic: DialogueTopic, move: Move) -> DialogueStep:
        """Let the robot say something that takes no answer; the dialogue ends with it."""
        ...

    def move(self, dialogue: Dialogue, move: Move, *, held: bool = False) -> DialogueStep:
        """Make the person's move, and unless held let the robot answer."""
        ...

    def speak(self, dialogue: Dialogue, move: Move, text: str = "") -> DialogueStep:
        """Make the move of a robot whose dialogue is held, and keep it held; `text` as for `Turn`."""
        ...

    def release(self, dialogue: Dialogue) -> DialogueStep:
        """Let the robot speak in a dialogue that was held."""
        ...

    def retake(self, dialogue: Dialogue, turn: Turn) -> DialogueStep:
        """Take a turn that was taken before the dialogue was restored; nobody answers it."""
        ...

    def choices(self, dialogue: Dialogue, speaker: Speaker = Speaker.PERSON) -> tuple[Choice, ...]:
        """Return the speaker's legal moves in an open dialogue, most agreeable first; none if it is not their turn."""
        ...

    def utterances(self, dialogue: Dialogue) -> tuple[DialogueUtterance, ...]:
        """Return all utterances of a dialogue so far."""
        ...


def announcement(phrasing: Phrasing, number: int, topic: DialogueTopic, move: Move) -> DialogueStep:
    """Return the dialogue in which a robot says one thing that takes no answer."""
    turn = Turn(Speaker.ROBOT, move, Author.ROBOT)
    text = phrasing.say(Dialogue(number, topic), move, Speaker.ROBOT)
    utterance = DialogueUtterance(number, 0, Speaker.ROBOT, Author.ROBOT, move, text, topic)
    return DialogueStep(Dialogue(number, topic, (turn,)), (utterance,), DialogueOutcome.NO_CONSENSUS)
