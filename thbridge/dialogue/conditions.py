"""Conditions of a study.

Conditions determine how robots and participant decide together, and the manner in which robots argue.
"""

from dataclasses import dataclass
from enum import StrEnum

from thbridge.dialogue.games.strategies import Attitude


class DialogueCondition(StrEnum):
    """Method by which robots and participant decide together."""

    SUPERVISOR = "supervisor"
    """Robots do what they are asked to do, without discussion."""
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
        """True if robots have arguments."""
        return self not in {DialogueCondition.SUPERVISOR, DialogueCondition.SCRIPT}


@dataclass(frozen=True, slots=True)
class Manner:
    """Manner in which a robot argues.

    Attributes:
        condition: determines which side has the last word.
        attitude: attitude to statements of the participant.
        persistence: number of dialogues about the same matter in which the robot maintains its position.
        talkative: True if the robot gives its arguments part by part, so that the other side accepts or refuses each
            part. False if the robot gives each argument as a whole.
        gives_reasons: True if the robot answers questions for reasons, and gives reasons when it refuses.
        misheard: probability that the robot mishears the participant's move as another legal move.
    """

    condition: DialogueCondition = DialogueCondition.COLLABORATOR
    attitude: Attitude = Attitude.CAUTIOUS
    persistence: int = 2
    talkative: bool = False
    gives_reasons: bool = True
    misheard: float = 0.0
