"""Runs dialogues, sans-IO: moves of people in; utterances and outcomes out; state as a value.

Somebody may speak in a robot's place: a dialogue that is held waits where the robot would speak, until `speak` makes
its move or `go_on` lets the robot itself do so.

The engine knows no way of talking. It asks a protocol whose turn it is and what is legal, a strategy for the robot's
choice, and a phrasing for the words; the person gets the legal moves as sentences and can make no other.
"""

from dataclasses import dataclass, replace
from enum import StrEnum
from typing import Protocol

from thbridge.dialogue.moves import (
    Author,
    Dialogue,
    DialogueOutcome,
    DialogueTopic,
    DialogueUtterance,
    Move,
    Speaker,
    Turn,
)
from thbridge.dialogue.protocols import DialogueProtocol
from thbridge.dialogue.strategies import Strategy, StrategyInput
from thbridge.hunt.refusals import RequestRefused
from thbridge.hunt.rules import robot_name


class DialogueReason(StrEnum):
    """Why the engine refuses."""

    ALREADY_TALKING = "already-talking"
    NO_SUCH_DIALOGUE = "no-such-dialogue"
    NOT_LEGAL = "not-legal"


class Phrasing(Protocol):
    """Turns moves into sentences."""

    def say(self, dialogue: Dialogue, move: Move) -> str:
        """The sentence for a move that is, or may be, the next in this dialogue."""
        ...


@dataclass(frozen=True, slots=True)
class Dialogues:
    """All open dialogues, at most one per robot.

    Attributes:
        opened: how many were ever opened; the next one gets the number after it.
        open: those that wait, for the person or for whoever speaks in the robot's place, in order of opening.
    """

    opened: int = 0
    open: tuple[Dialogue, ...] = ()

    def numbered(self, number: int) -> Dialogue | None:
        """The open dialogue of this number, or None."""
        return next((dialogue for dialogue in self.open if dialogue.number == number), None)

    def of_robot(self, robot: int) -> Dialogue | None:
        """The open dialogue of this robot, or None."""
        return next((dialogue for dialogue in self.open if dialogue.topic.robot == robot), None)


@dataclass(frozen=True, slots=True)
class Choice:
    """A move that may be made now, and how to offer it."""

    move: Move
    text: str


@dataclass(frozen=True, slots=True)
class DialogueStep:
    """What an opening or a move brought about.

    Attributes:
        dialogues: the state afterwards.
        dialogue: the dialogue moved in, as it now is; no longer among the open ones if it has ended.
        utterances: what was said, in order.
        outcome: how the dialogue ended, or None if it waits.
    """

    dialogues: Dialogues
    dialogue: Dialogue
    utterances: tuple[DialogueUtterance, ...]
    outcome: DialogueOutcome | None


@dataclass(frozen=True, slots=True)
class Engine:
    """A way of talking, ready to run. Holds no state: every method takes the dialogues and gives the new ones.

    `open` and `move` raise ValueError if the strategy breaks its promise and chooses a move that is not legal.

    Attributes:
        protocol: what is legal.
        strategy: chooses the robot's moves.
        phrasing: words for moves.
    """

    protocol: DialogueProtocol
    strategy: Strategy
    phrasing: Phrasing

    def open(self, dialogues: Dialogues, topic: DialogueTopic, *, held: bool = False) -> DialogueStep | RequestRefused:
        """Open a dialogue and let the robot speak until it is the person's turn, or all is decided; not if held."""
        if dialogues.of_robot(topic.robot) is not None:
            return RequestRefused(DialogueReason.ALREADY_TALKING, f"{_name(topic)} is already talking with you.")
        number = dialogues.opened + 1
        opened = replace(dialogues, opened=number)
        return self._run(opened, Dialogue(number, topic), (), held)

    def move(
        self, dialogues: Dialogues, number: int, move: Move, *, held: bool = False
    ) -> DialogueStep | RequestRefused:
        """Make the person's move, and let the robot answer, unless held."""
        dialogue = self._at_turn(dialogues, number, Speaker.PERSON, move)
        if isinstance(dialogue, RequestRefused):
            return dialogue
        dialogue, utterance = self._said(dialogue, Turn(Speaker.PERSON, move, Author.PERSON))
        return self._run(dialogues, dialogue, (utterance,), held)

    def speak(self, dialogues: Dialogues, number: int, move: Move, text: str = "") -> DialogueStep | RequestRefused:
        """Make the move of a robot whose dialogue is held, in its place, and hold on; `text` as for `Turn`."""
        dialogue = self._at_turn(dialogues, number, Speaker.ROBOT, move)
        if isinstance(dialogue, RequestRefused):
            return dialogue
        dialogue, utterance = self._said(dialogue, Turn(Speaker.ROBOT, move, Author.WIZARD, text))
        return self._run(dialogues, dialogue, (utterance,), held=True)

    def release(self, dialogues: Dialogues, number: int) -> DialogueStep | RequestRefused:
        """Let the robot speak in a dialogue that was held."""
        dialogue = dialogues.numbered(number)
        return _no_such(number) if dialogue is None else self._run(dialogues, dialogue, (), held=False)

    def withdraw(self, dialogues: Dialogues, number: int) -> DialogueStep | RequestRefused:
        """Close a dialogue whose topic is no longer to be decided, e.g. because the game has ended."""
        dialogue = dialogues.numbered(number)
        if dialogue is None:
            return _no_such(number)
        return DialogueStep(_without(dialogues, dialogue), dialogue, (), DialogueOutcome.WITHDRAWN)

    def choices(self, dialogue: Dialogue, speaker: Speaker = Speaker.PERSON) -> tuple[Choice, ...]:
        """What the speaker may say now in an open dialogue, most agreeable first; nothing if it is not their turn."""
        if self.protocol.speaker(dialogue) is not speaker:
            return ()
        return tuple(Choice(move, self.phrasing.say(dialogue, move)) for move in self.protocol.legal(dialogue))

    def utterances(self, dialogue: Dialogue) -> tuple[DialogueUtterance, ...]:
        """Everything said in a dialogue so far, e.g. to show a restored one again."""
        said = Dialogue(dialogue.number, dialogue.topic)
        spoken: list[DialogueUtterance] = []
        for turn in dialogue.turns:
            said, utterance = self._said(said, turn)
            spoken.append(utterance)
        return tuple(spoken)

    def _at_turn(self, dialogues: Dialogues, number: int, speaker: Speaker, move: Move) -> Dialogue | RequestRefused:
        """The open dialogue of this number, if this speaker may make this move in it now."""
        dialogue = dialogues.numbered(number)
        if dialogue is None:
            return _no_such(number)
        if self.protocol.speaker(dialogue) is not speaker or move not in self.protocol.legal(dialogue):
            return RequestRefused(DialogueReason.NOT_LEGAL, "That cannot be said at this point of the dialogue.")
        return dialogue

    def _run(
        self, dialogues: Dialogues, dialogue: Dialogue, utterances: tuple[DialogueUtterance, ...], held: bool
    ) -> DialogueStep:
        while (outcome := self.protocol.outcome(dialogue)) is None:
            if held or self.protocol.speaker(dialogue) is Speaker.PERSON:
                return DialogueStep(_with(dialogues, dialogue), dialogue, utterances, None)
            legal = self.protocol.legal(dialogue)
            choice = self.strategy.choose(StrategyInput(Speaker.ROBOT, dialogue), legal)
            if choice not in legal:
                raise ValueError(f"the strategy chose {choice}, which is not among the legal moves {legal}")
            dialogue, utterance = self._said(dialogue, Turn(Speaker.ROBOT, choice, Author.ROBOT))
            utterances = (*utterances, utterance)
        return DialogueStep(_without(dialogues, dialogue), dialogue, utterances, outcome)

    def _said(self, dialogue: Dialogue, turn: Turn) -> tuple[Dialogue, DialogueUtterance]:
        text = turn.text or self.phrasing.say(dialogue, turn.move)
        index, topic = len(dialogue.turns), dialogue.topic
        utterance = DialogueUtterance(dialogue.number, index, turn.speaker, turn.author, turn.move, text, topic)
        return replace(dialogue, turns=(*dialogue.turns, turn)), utterance


def _with(dialogues: Dialogues, changed: Dialogue) -> Dialogues:
    if dialogues.numbered(changed.number) is None:
        return replace(dialogues, open=(*dialogues.open, changed))
    return replace(
        dialogues,
        open=tuple(changed if dialogue.number == changed.number else dialogue for dialogue in dialogues.open),
    )


def _without(dialogues: Dialogues, ended: Dialogue) -> Dialogues:
    return replace(dialogues, open=tuple(dialogue for dialogue in dialogues.open if dialogue.number != ended.number))


def _no_such(number: int) -> RequestRefused:
    return RequestRefused(DialogueReason.NO_SUCH_DIALOGUE, f"Dialogue {number} is not open.")


def _name(topic: DialogueTopic) -> str:
    return robot_name(topic.robot).capitalize()
