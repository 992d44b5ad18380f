"""Values of a dialogue: topic, moves, turns, utterances.

A dialogue's public record (`Dialogue`) is its topic and its moves. Everything else (turn, legal moves, sentences,
outcome) is computed from the record. If robots argue, the beliefs of both sides are stored with the record.

A new kind of dialogue adds its moves to `Move`, and needs an engine for these moves.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import StrEnum

from thbridge.dialogue.argumentation.propositions import Literal
from thbridge.dialogue.games.contents import DialogueMove
from thbridge.dialogue.games.control import Conversation
from thbridge.dialogue.games.dialogue_game import GameUtterance
from thbridge.dialogue.robot_arguments import WhatFacts, WhereFacts
from thbridge.hunt.properties import Properties
from thbridge.hunt.rooms import Room


class Scenario(StrEnum):
    """Decision that a dialogue is about."""

    SPECIFIC_ROOM = "specific-room"
    """The robot may go to the room that the person chose."""
    DONT_KNOW = "dont-know"
    """The robot may go to the room that it suggests, because the person did not know where to go."""
    TAKE_PICTURE = "take-picture"
    """The robot may take a picture of the treasure where it stands."""
    TAKE_TREASURE = "take-treasure"
    """The robot may take the treasure where it stands, that is, identify it."""
    UNSURE_NAME = "unsure-name"
    """Name of the treasure where the robot stands, when the person does not know it; only for robots that argue."""


class Speaker(StrEnum):
    """Side that makes a move."""

    ROBOT = "robot"
    PERSON = "person"


class Author(StrEnum):
    """Author of a move: the person or program that decided on the move."""

    ROBOT = "robot"
    """The robot's strategy."""
    PERSON = "person"
    """The participant."""
    WIZARD = "wizard"
    """A researcher who speaks in the place of a robot or of a participant, unknown to the others (Wizard-of-Oz)."""


class DialogueOutcome(StrEnum):
    """Outcome of a dialogue."""

    CONSENSUS = "consensus"
    """Agreed: the proposal of the topic may be carried out."""
    NO_CONSENSUS = "no-consensus"
    """Not agreed: the proposal is dropped."""


@dataclass(frozen=True, slots=True)
class DialogueTopic:
    """Topic of a dialogue, with the facts for its sentences; it does not change while the dialogue is open.

    Attributes:
        scenario: the decision.
        robot: index of the robot that asks, from 0.
        room: the destination, or the room of the treasure.
        cost: energy of the proposal.
        energy: energy of the robot.
        room_name: name of the room, in the participant's language; empty if the room has only a number.
        other_robot: the other robot that could reach the room for the least energy; None if there is none.
        properties: known properties of the treasure there.
        reason: reason for the robot's suggestion, as part of a sentence; empty without a suggestion.
        confidence: confidence that the robot states in its suggestion, 0 to 1; None if it states no confidence.
        facts: the robot's facts for arguments; None if robots do not argue.
        opener: the side that opens the dialogue; a robot can suggest a room without a request.
        name: proposed name of the treasure; empty if there is none.
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
    """The robot asks its scripted question with index `question`, from 0."""

    question: int


@dataclass(frozen=True, slots=True)
class Continue:
    """The person agrees to continue."""


@dataclass(frozen=True, slots=True)
class Stop:
    """The person does not agree; the dialogue ends."""


class Question(StrEnum):
    """Question of a person about a decision. The robot answers it; nothing else changes."""

    WHY_THIS = "why-this"
    WHY_NOT = "why-not"
    WHY_ROBOT = "why-robot"
    WHY_NOW = "why-now"
    KNOWN = "known"
    CHANGE = "change"
    SIMPLER = "simpler"


@dataclass(frozen=True, slots=True)
class OpenQuestions:
    """The person wants to ask a question."""


@dataclass(frozen=True, slots=True)
class CloseQuestions:
    """The person decides not to ask a question."""


@dataclass(frozen=True, slots=True)
class Enquire:
    """The person asks a question; `about` is the literal in question, or None."""

    question: Question
    about: Literal | None = None


@dataclass(frozen=True, slots=True)
class Explain:
    """The robot answers a question.

    Attributes:
        question: the question that it answers.
        about: as in the question.
        because: beliefs of the robot that form the answer; empty if there are none.
        restates: the question whose earlier answer is repeated in other words; None if this is no repetition.
    """

    question: Question
    about: Literal | None
    because: tuple[Literal, ...]
    restates: Question | None = None


@dataclass(frozen=True, slots=True)
class Echo:
    """The robot repeats the move that it understood, if this is not the move that the person made.

    Attributes:
        heard: sentence of the move that it understood.
    """

    heard: str


class Upshot(StrEnum):
    """Result of the discussion of a decision."""

    AGREED = "agreed"
    OVERRIDDEN = "overridden"
    """The action is carried out because the person insists."""
    DECIDED = "decided"
    """The action is carried out because the robot insists."""
    STAYS = "stays"
    """The robot goes nowhere, because there was no agreement."""
    UNDONE = "undone"
    """Nothing is done about a treasure, because there was no agreement."""


@dataclass(frozen=True, slots=True)
class Conclude:
    """The robot states the result after the person's last move; this does not count as a turn.

    Attributes:
        upshot: the result.
        about: the action that follows; None if there is none.
    """

    upshot: Upshot
    about: Literal | None = None


@dataclass(frozen=True, slots=True)
class DecideAlone:
    """The robot says that it decides alone, because the participant has ignored it for some seconds."""

    waited: float


@dataclass(frozen=True, slots=True)
class Override:
    """The person, who has the last word, insists on the decision."""


@dataclass(frozen=True, slots=True)
class Leave:
    """The person gives up; the dialogue ends."""


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
    """Return the word for a move, for recordings and programs. For a move in a dialogue game, this is the locution."""
    return move.locution if isinstance(move, DialogueMove) else _WORDS[type(move)]


def move_text(move: Move) -> str:
    """Return a move as text for journals; moves that are legal at the same time have different texts."""
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
        author: author of the move.
        text: sentence that replaces the usual sentence for the move; if empty, the usual sentence is said.
        said: the move that the person really made, if the robot understood another move. If None, the robot understood
            correctly.
        fault: reason why the robot's own strategy chose the move instead of the installed strategy; empty otherwise.
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
        number: number of the dialogue, from 1, in order of opening.
        topic: its topic.
        turns: all moves so far, oldest first.
        conversation: statements and beliefs of both sides, if robots argue.
        conclusions: the robot's closing statements, which do not count as turns, each with the number of turns before
            it.
    """

    number: int
    topic: DialogueTopic
    turns: tuple[Turn, ...] = ()
    conversation: Conversation | None = None
    conclusions: tuple[tuple[int, Conclude], ...] = ()


@dataclass(frozen=True, slots=True)
class OfferedSentence:
    """Sentence for a move, with the offer of another author.

    Attributes:
        sentence: the usual sentence for the move.
        offered: sentence that the author offered; None if the author offered no sentence.
        refused: reason why the offer was refused, for programs; empty if the offer was accepted, or there was no offer.
        why: the same reason for people.
    """

    sentence: str
    offered: str | None
    refused: str = ""
    why: str = ""

    @property
    def text(self) -> str:
        """The sentence to say."""
        return self.sentence if self.offered is None or self.refused else self.offered


@dataclass(frozen=True, slots=True)
class DialogueUtterance:
    """One utterance, as it is recorded.

    Attributes:
        dialogue: number of the dialogue.
        index: index of the move in the dialogue, from 0.
        speaker: the side that made the move.
        author: author of the move.
        move: the move.
        text: the sentence.
        topic: topic of the dialogue.
        formal: moves in dialogue games that the utterance made, and the moves that followed automatically.
        heard: sentence of the move that the robot understood instead; empty if the robot understood correctly.
        conversation: statements and beliefs of both sides after the utterance, if robots argue.
        fault: as in `Turn`.
        authored: request to another author of sentences, with its offer; None if there is no such author.
        seat: seat of the participant who made the move; empty for robots, and in games with one participant.
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
    seat: str = ""
