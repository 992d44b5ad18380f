"""Values of a dialogue: topic, moves, turns, utterances.

A dialogue's public record (`Dialogue`) is its topic and its moves. Everything else (turn, legal moves, sentences,
outcome) is computed from the record; where robots argue, what both sides believe is kept beside it.

A new way of talking adds its moves to `Move`, and an engine for them.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import StrEnum

from thbridge.dialogue.argumentation.propositions import Literal
from thbridge.dialogue.evidence import WhatFacts, WhereFacts
from thbridge.dialogue.games.contents import DialogueMove
from thbridge.dialogue.games.control import Conversation
from thbridge.dialogue.games.dialogue_game import GameUtterance
from thbridge.hunt.properties import Properties
from thbridge.hunt.rooms import Room


class Scenario(StrEnum):
    """Decision that a dialogue is about."""

    SPECIFIC_ROOM = "specific-room"
    """To go to the room that the person chose, or not."""
    DONT_KNOW = "dont-know"
    """To go to the room that the robot suggests because the person did not know, or not."""
    TAKE_PICTURE = "take-picture"
    """To take a picture of the treasure where the robot stands, or not."""
    TAKE_TREASURE = "take-treasure"
    """To take the treasure where the robot stands, that is, to identify it, or not."""
    UNSURE_NAME = "unsure-name"
    """What the treasure is where the robot stands, which the person does not know; only robots that argue are asked."""


class Speaker(StrEnum):
    """Side that makes a move."""

    ROBOT = "robot"
    PERSON = "person"


class Author(StrEnum):
    """Author of a move: the one who decided on it."""

    ROBOT = "robot"
    """The robot's strategy."""
    PERSON = "person"
    """The participant."""
    WIZARD = "wizard"
    """A person who spoke in the robot's place, unknown to the participant (Wizard-of-Oz)."""


class DialogueOutcome(StrEnum):
    """Outcome of a dialogue."""

    CONSENSUS = "consensus"
    """Agreed: the topic's proposal may be carried out."""
    NO_CONSENSUS = "no-consensus"
    """Not agreed: the proposal is dropped."""


@dataclass(frozen=True, slots=True)
class DialogueTopic:
    """Topic of a dialogue, with the facts that its sentences may name; it does not change while the dialogue is open.

    Attributes:
        scenario: the decision.
        robot: the robot that asks, from 0 as on the wire.
        room: the destination, or the room of the treasure.
        cost: energy of the proposal.
        energy: of the robot.
        room_name: of the room, in the participant's language; empty where it has none of its own.
        other_robot: the robot that could get to the room for the least energy besides this one; None without one.
        properties: known of the treasure there.
        reason: of the robot's suggestion, as part of a sentence; empty for what it did not suggest.
        confidence: stated in its suggestion, 0 to 1; None where it states none.
        facts: the robot's, for arguments; None where robots do not argue.
        opener: the side that brings it up; a robot suggests a room without being asked.
        name: that the treasure is to be given; empty where none was said.
    """

    scenario: Scenario
    robot: int
    room: Room
    cost: float
    energy: float
    room_name: str = ""
    other_robot: int | None = None
    properties: Properties = field(default_factory=dict)
    reason: str = ""
    confidence: float | None = None
    facts: WhereFacts | WhatFacts | None = None
    opener: Speaker = Speaker.PERSON
    name: str = ""


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


class Question(StrEnum):
    """Question of a person about a decision, which the robot answers without anything else changing."""

    WHY_THIS = "why-this"
    WHY_NOT = "why-not"
    WHY_ROBOT = "why-robot"
    WHY_NOW = "why-now"
    KNOWN = "known"
    CHANGE = "change"
    SIMPLER = "simpler"


@dataclass(frozen=True, slots=True)
class OpenQuestions:
    """The person wants to ask something."""


@dataclass(frozen=True, slots=True)
class CloseQuestions:
    """The person does not want to ask anything after all."""


@dataclass(frozen=True, slots=True)
class Enquire:
    """The person asks a question; `about` is the literal that it is about, or None."""

    question: Question
    about: Literal | None = None


@dataclass(frozen=True, slots=True)
class Explain:
    """The robot answers a question.

    Attributes:
        question: that it answers.
        about: as in the question.
        because: beliefs of the robot that are its answer; none where it knows of nothing.
        restates: the question whose answer it says again; None where it says none again.
    """

    question: Question
    about: Literal | None
    because: tuple[Literal, ...]
    restates: Question | None = None


@dataclass(frozen=True, slots=True)
class Echo:
    """The robot says what it has understood, where that is not what she said.

    Attributes:
        heard: sentence of the move that it has understood.
    """

    heard: str


class Upshot(StrEnum):
    """Upshot of what was said about a decision."""

    AGREED = "agreed"
    OVERRIDDEN = "overridden"
    """It is done because the person wants it all the same."""
    DECIDED = "decided"
    """It is done because the robot wants it all the same."""
    STAYS = "stays"
    """The robot goes nowhere, as nothing was agreed upon."""
    UNDONE = "undone"
    """Nothing is done about a treasure, as nothing was agreed upon."""


@dataclass(frozen=True, slots=True)
class Conclude:
    """The robot tells what comes of what was said, where the person had the last word; it is no turn of the dialogue.

    Attributes:
        upshot: what comes of it.
        about: what is done; None where nothing is.
    """

    upshot: Upshot
    about: Literal | None = None


@dataclass(frozen=True, slots=True)
class DecideAlone:
    """The robot, which nobody has attended to for so many seconds, tells that it decides by itself."""

    waited: float


@dataclass(frozen=True, slots=True)
class Override:
    """The person, who has the last word, wants it done all the same."""


@dataclass(frozen=True, slots=True)
class Leave:
    """The person leaves it at that; the dialogue ends."""


Move = (
    Ask
    | Continue
    | Stop
    | DialogueMove
    | OpenQuestions
    | CloseQuestions
    | Enquire
    | Explain
    | Echo
    | Conclude
    | DecideAlone
    | Override
    | Leave
)

_WORDS: Mapping[type[Move], str] = {
    Ask: "ask",
    Continue: "continue",
    Stop: "stop",
    OpenQuestions: "open-questions",
    CloseQuestions: "close-questions",
    Enquire: "enquire",
    Explain: "explain",
    Echo: "echo",
    Conclude: "conclude",
    DecideAlone: "decide-alone",
    Override: "override",
    Leave: "leave",
}


def word_of(move: Move) -> str:
    """Return the word for a move in recordings and for programs; that of a move in a dialogue game is its locution."""
    return move.locution if isinstance(move, DialogueMove) else _WORDS[type(move)]


def move_text(move: Move) -> str:
    """Return a move as journals write it; moves that are legal at the same time are written differently."""
    match move:
        case Ask(question):
            return f"ask({question})"
        case Enquire(question, None):
            return f"enquire({question})"
        case Enquire(question, about):
            return f"enquire({question}, {about})"
        case DialogueMove():
            return str(move)
        case _:
            return word_of(move)


@dataclass(frozen=True, slots=True)
class Turn:
    """A move with its speaker and author.

    Attributes:
        speaker: the side that made it.
        move: the move.
        author: decided on it.
        text: replaces the sentence that belongs to the move; empty: that sentence.
        said: the move that was really made, where another one was heard; None: the same.
        fault: why the robot's own strategy chose it in place of the study's; empty where it did not.
    """

    speaker: Speaker
    move: Move
    author: Author
    text: str = ""
    said: Move | None = None
    fault: str = ""


@dataclass(frozen=True, slots=True)
class Dialogue:
    """The public record of one dialogue.

    Attributes:
        number: from 1, in order of opening.
        topic: of the dialogue.
        turns: all moves so far, oldest first.
        conversation: what both sides have said and believe, where robots argue.
        conclusions: what the robot has told beside its turns, each with the number of turns before it.
    """

    number: int
    topic: DialogueTopic
    turns: tuple[Turn, ...] = ()
    conversation: Conversation | None = None
    conclusions: tuple[tuple[int, Conclude], ...] = ()


@dataclass(frozen=True, slots=True)
class OfferedSentence:
    """Sentence of another author, who was asked to word a move.

    Attributes:
        sentence: that would be said otherwise.
        offered: by the author; None where it offered none.
        refused: reason for which the offer was not taken, for programs; empty where it was, or there was none.
        why: the same for people.
    """

    sentence: str
    offered: str | None
    refused: str = ""
    why: str = ""

    @property
    def text(self) -> str:
        """The sentence to be said."""
        return self.sentence if self.offered is None or self.refused else self.offered


@dataclass(frozen=True, slots=True)
class DialogueUtterance:
    """One utterance, as it is recorded.

    Attributes:
        dialogue: number of the dialogue.
        index: place of the move in the dialogue, from 0.
        speaker: the side that made the move.
        author: decided on it.
        move: the move.
        text: the sentence.
        topic: of the dialogue.
        formal: moves in dialogue games that it made, those that followed by themselves among them.
        heard: sentence of the move that the robot took it for; empty where it heard right.
        conversation: what both sides have said and believe after it, where robots argue.
        fault: as in `Turn`.
        authored: what another author of sentences was asked, and offered; None where there is none.
    """

    dialogue: int
    index: int
    speaker: Speaker
    author: Author
    move: Move
    text: str
    topic: DialogueTopic
    formal: tuple[GameUtterance, ...] = ()
    heard: str = ""
    conversation: Conversation | None = None
    fault: str = ""
    authored: OfferedSentence | None = None
