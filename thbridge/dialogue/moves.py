"""The values a dialogue is made of: what it is about, who moves how, and what is said.

A dialogue's public record (`Dialogue`) is its topic and its moves. Everything else, whose turn it is, what is legal,
the words, the outcome, is worked out from the record, so the record alone is what is saved and restored.

A new way of talking (arguments, say) adds its moves to `Move`, and a protocol and a strategy that know them.
"""

from dataclasses import dataclass
from enum import StrEnum

from thbridge.hunt.rooms import Room


class Scenario(StrEnum):
    """What a dialogue decides."""

    SPECIFIC_ROOM = "specific-room"
    """Whether to go to the room the person chose."""
    DONT_KNOW = "dont-know"
    """Whether to go to the room the robot suggests, because the person did not know."""
    TAKE_PICTURE = "take-picture"
    """Whether to take a picture of the treasure where the robot stands."""
    TAKE_TREASURE = "take-treasure"
    """Whether to take the treasure where the robot stands, that is, to identify it."""


class Speaker(StrEnum):
    """Who moves."""

    ROBOT = "robot"
    PERSON = "person"


class Author(StrEnum):
    """Who decided what was said."""

    ROBOT = "robot"
    """The robot's strategy."""
    PERSON = "person"
    """The participant."""
    WIZARD = "wizard"
    """A person who spoke in the robot's place, unknown to the participant (Wizard-of-Oz)."""


class DialogueOutcome(StrEnum):
    """How a dialogue ended."""

    CONSENSUS = "consensus"
    """Agreed: what the topic proposes may be done."""
    NO_CONSENSUS = "no-consensus"
    """Not agreed: nothing is done."""
    WITHDRAWN = "withdrawn"
    """Closed from outside, because its topic is no longer to be decided."""


@dataclass(frozen=True, slots=True)
class DialogueTopic:
    """What a dialogue is about, and what its sentences may name; does not change while it is open.

    Attributes:
        scenario: the decision.
        robot: who asks, numbered from 0 as on the wire.
        room: where to go, or where the treasure is.
        cost: energy it will take.
        energy: what the robot has.
        colour: of the treasure as sensed; empty when the robot has not been there.
        footprint: likewise.
    """

    scenario: Scenario
    robot: int
    room: Room
    cost: float
    energy: float
    colour: str = ""
    footprint: str = ""


@dataclass(frozen=True, slots=True)
class Ask:
    """The robot asks its scripted question number `question`, counted from 0."""

    question: int


@dataclass(frozen=True, slots=True)
class Continue:
    """The person agrees so far."""


@dataclass(frozen=True, slots=True)
class Stop:
    """The person does not agree; the dialogue ends."""


Move = Ask | Continue | Stop


@dataclass(frozen=True, slots=True)
class Turn:
    """A move and who made it.

    Attributes:
        speaker: whose turn it was.
        move: what was done.
        author: who decided on it.
        text: what was said instead of the sentence that belongs to the move; empty: that sentence.
    """

    speaker: Speaker
    move: Move
    author: Author
    text: str = ""


@dataclass(frozen=True, slots=True)
class Dialogue:
    """The public record of one dialogue.

    Attributes:
        number: from 1, in order of opening.
        topic: what it is about.
        turns: all moves so far, oldest first.
    """

    number: int
    topic: DialogueTopic
    turns: tuple[Turn, ...] = ()


@dataclass(frozen=True, slots=True)
class DialogueUtterance:
    """One thing said, as it is recorded.

    Attributes:
        dialogue: number of the dialogue.
        index: place of the move in the dialogue, from 0.
        speaker: who said it.
        author: who decided on it.
        move: what it does.
        text: what it says.
        topic: what the dialogue is about.
    """

    dialogue: int
    index: int
    speaker: Speaker
    author: Author
    move: Move
    text: str
    topic: DialogueTopic
