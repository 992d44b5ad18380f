"""Conditions of a study: how robots and participant decide together, and the manner in which robots argue."""

from dataclasses import dataclass
from enum import StrEnum

from thbridge.dialogue.games.strategies import Attitude


class DialogueCondition(StrEnum):
    """Way in which robots and participant decide together."""

    SUPERVISOR = "supervisor"
    """Robots do what they are told, without a word."""
    SCRIPT = "script"
    """Robots ask the scripted questions of 2016."""
    COLLABORATOR = "collaborator"
    """Robots argue; nothing happens before both agree."""
    ADVISER = "adviser"
    """Robots argue; the participant has the last word."""
    AUTONOMOUS = "autonomous"
    """Robots argue, and have the last word."""

    @property
    def argues(self) -> bool:
        """True where robots have arguments."""
        return self not in {DialogueCondition.SUPERVISOR, DialogueCondition.SCRIPT}


@dataclass(frozen=True, slots=True)
class Manner:
    """Manner in which a robot argues.

    Attributes:
        condition: who has the last word.
        attitude: towards what the participant says.
        persistence: number of dialogues about the same matter in which it holds out.
        talkative: gives its arguments part by part, each to be accepted or not; else each as a whole.
        gives_reasons: answers a question for reasons, and gives them where it refuses.
        misheard: probability that it takes the participant to have made another legal move.
    """

    condition: DialogueCondition = DialogueCondition.COLLABORATOR
    attitude: Attitude = Attitude.CAUTIOUS
    persistence: int = 2
    talkative: bool = False
    gives_reasons: bool = True
    misheard: float = 0.0
