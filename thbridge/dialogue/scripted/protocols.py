"""Dialogue protocols: turn, legal moves and outcome, computed only from a dialogue's record."""

from dataclasses import dataclass
from typing import Protocol

from thbridge.dialogue.moves import Ask, Continue, Dialogue, DialogueOutcome, Move, Speaker, Stop
from thbridge.dialogue.scripted.templates import Template


class DialogueProtocol(Protocol):
    """Rules of one kind of dialogue. All methods are functions of the record, which both sides may know."""

    def outcome(self, dialogue: Dialogue) -> DialogueOutcome | None:
        """Return the outcome of the dialogue, or None while it continues."""
        ...

    def speaker(self, dialogue: Dialogue) -> Speaker:
        """Return the side whose turn it is, while the dialogue continues."""
        ...

    def legal(self, dialogue: Dialogue) -> tuple[Move, ...]:
        """Return the legal moves of the side whose turn it is: at least one, most agreeable first."""
        ...


@dataclass(frozen=True, slots=True)
class TemplateProtocol:
    """The 2016 dialogue: the robot asks the scripted questions in order, the person continues or stops.

    There is consensus if the person answered every question with Continue; without questions, there is consensus at
    once.
    """

    template: Template

    def outcome(self, dialogue: Dialogue) -> DialogueOutcome | None:
        """Return the outcome: no consensus after Stop, consensus after the last Continue."""
        if dialogue.turns and dialogue.turns[-1].move == Stop():
            return DialogueOutcome.NO_CONSENSUS
        agreed = sum(turn.move == Continue() for turn in dialogue.turns)
        return DialogueOutcome.CONSENSUS if agreed == len(self.template.of(dialogue.topic.scenario)) else None

    def speaker(self, dialogue: Dialogue) -> Speaker:
        """Return the side whose turn it is: the robot begins, then turns alternate."""
        return Speaker.ROBOT if len(dialogue.turns) % 2 == 0 else Speaker.PERSON

    def legal(self, dialogue: Dialogue) -> tuple[Move, ...]:
        """Return the next question for the robot; Continue and Stop for the person."""
        if self.speaker(dialogue) is Speaker.ROBOT:
            return (Ask(len(dialogue.turns) // 2),)
        return (Continue(), Stop())
