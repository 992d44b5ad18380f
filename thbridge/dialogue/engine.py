"""Dialogue engine without I/O: moves of people in; utterances and outcomes out; state as a value.

A wizard may speak in a robot's place: a dialogue that is held waits where the robot would speak, until `speak` makes
its move or `release` lets the robot itself do so.

The engine knows no kind of dialogue. A protocol determines whose turn it is and which moves are legal, a strategy
chooses the robot's move, a phrasing words it; the person gets the legal moves as sentences and can make no other.
"""

from dataclasses import dataclass, replace
from enum import StrEnum
from typing import Protocol

from sim.common.robot_numbers import robot_name
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


class DialogueReason(StrEnum):
    """Reason of the engine for a refusal."""

    ALREADY_TALKING = "already-talking"
    NO_SUCH_DIALOGUE = "no-such-dialogue"
    NOT_LEGAL = "not-legal"


class Phrasing(Protocol):
    """Wording of moves as sentences."""

    def say(self, dialogue: Dialogue, move: Move) -> str:
        """Return the sentence for a move that is, or may be, the next in this dialogue."""
        ...


@dataclass(frozen=True, slots=True)
class Dialogues:
    """All open dialogues, at most one per robot.

    Attributes:
        opened: number of dialogues opened so far; the next one gets the number after it.
        open: those that wait, for the person or for the wizard in the robot's place, in order of opening.
    """

    opened: int = 0
    open: tuple[Dialogue, ...] = ()

    def numbered(self, number: int) -> Dialogue | None:
        """Return the open dialogue of this number, or None."""
        return next((dialogue for dialogue in self.open if dialogue.number == number), None)

    def of_robot(self, robot: int) -> Dialogue | None:
        """Return the open dialogue of this robot, or None."""
        return next((dialogue for dialogue in self.open if dialogue.topic.robot == robot), None)


@dataclass(frozen=True, slots=True)
class Choice:
    """A legal move and its sentence."""

    move: Move
    text: str


@dataclass(frozen=True, slots=True)
class DialogueStep:
    """Result of opening a dialogue or of a move.

    Attributes:
        dialogues: the state afterwards.
        dialogue: the dialogue moved in, as it now is; no longer among the open ones if it has ended.
        utterances: in order.
        outcome: of the dialogue, or None if it waits.
    """

    dialogues: Dialogues
    dialogue: Dialogue
    utterances: tuple[DialogueUtterance, ...]
    outcome: DialogueOutcome | None


@dataclass(frozen=True, slots=True)
class Engine:
    """Engine for one kind of dialogue. Holds no state: every method takes the dialogues and returns the new ones.

    `open` and `move` raise ValueError if the strategy chooses a move that is not legal.

    Attributes:
        protocol: determines legal moves.
        strategy: chooses the robot's moves.
        phrasing: words moves.
    """

    protocol: DialogueProtocol
    strategy: Strategy
    phrasing: Phrasing

    def open(self, dialogues: Dialogues, topic: DialogueTopic, *, held: bool = False) -> DialogueStep | RequestRefused:
        """Open a dialogue, and unless held let the robot speak until it is the person's turn or the dialogue ends."""
        if dialogues.of_robot(topic.robot) is not None:
            return RequestRefused(DialogueReason.ALREADY_TALKING, f"{_name(topic)} is already talking with you.")
        number = dialogues.opened + 1
        opened = replace(dialogues, opened=number)
        return self._run(opened, Dialogue(number, topic), (), held)

    def move(
        self, dialogues: Dialogues, number: int, move: Move, *, held: bool = False
    ) -> DialogueStep | RequestRefused:
        """Make the person's move, and unless held let the robot answer."""
        dialogue = self._at_turn(dialogues, number, Speaker.PERSON, move)
        if isinstance(dialogue, RequestRefused):
            return dialogue
        dialogue, utterance = self._with_turn(dialogue, Turn(Speaker.PERSON, move, Author.PERSON))
        return self._run(dialogues, dialogue, (utterance,), held)

    def speak(self, dialogues: Dialogues, number: int, move: Move, text: str = "") -> DialogueStep | RequestRefused:
        """Make the move of a robot whose dialogue is held, and keep it held; `text` as for `Turn`."""
        dialogue = self._at_turn(dialogues, number, Speaker.ROBOT, move)
        if isinstance(dialogue, RequestRefused):
            return dialogue
        dialogue, utterance = self._with_turn(dialogue, Turn(Speaker.ROBOT, move, Author.WIZARD, text))
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
        """Return the speaker's legal moves in an open dialogue, most agreeable first; none if it is not their turn."""
        if self.protocol.speaker(dialogue) is not speaker:
            return ()
        return tuple(Choice(move, self.phrasing.say(dialogue, move)) for move in self.protocol.legal(dialogue))

    def utterances(self, dialogue: Dialogue) -> tuple[DialogueUtterance, ...]:
        """Return all utterances of a dialogue so far."""
        so_far = Dialogue(dialogue.number, dialogue.topic)
        utterances: list[DialogueUtterance] = []
        for turn in dialogue.turns:
            so_far, utterance = self._with_turn(so_far, turn)
            utterances.append(utterance)
        return tuple(utterances)

    def _at_turn(self, dialogues: Dialogues, number: int, speaker: Speaker, move: Move) -> Dialogue | RequestRefused:
        """Return the open dialogue of this number, or a refusal if this speaker may not make this move in it now."""
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
            dialogue, utterance = self._with_turn(dialogue, Turn(Speaker.ROBOT, choice, Author.ROBOT))
            utterances = (*utterances, utterance)
        return DialogueStep(_without(dialogues, dialogue), dialogue, utterances, outcome)

    def _with_turn(self, dialogue: Dialogue, turn: Turn) -> tuple[Dialogue, DialogueUtterance]:
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
