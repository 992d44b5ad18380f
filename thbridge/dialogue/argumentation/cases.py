"""The nine cases of dialogues that follow from two sides' opinions on a proposition.

Source: Sklar and Azhar 2015, table 1.
"""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from enum import StrEnum


class Stance(StrEnum):
    """Opinion of a side on a proposition."""

    BELIEVES = "believes"
    DISBELIEVES = "disbelieves"
    UNKNOWN = "unknown"


class DialogueKind(StrEnum):
    """Kind of a dialogue (Walton and Krabbe 1995); two sides that agree need no dialogue."""

    AGREEMENT = "agreement"
    PERSUASION = "persuasion"
    INFORMATION_SEEKING = "information-seeking"
    INQUIRY = "inquiry"


class Side(StrEnum):
    """A side of a dialogue."""

    ROBOT = "robot"
    HUMAN = "human"


@dataclass(frozen=True, slots=True)
class DialogueCase:
    """Consequence of two stances.

    Attributes:
        number: number of the case in the paper.
        kind: kind of the dialogue.
        openers: sides that may open it.
    """

    number: int
    kind: DialogueKind
    openers: frozenset[Side]


def case_of(robot: Stance, human: Stance) -> DialogueCase:
    """Return the case for two opinions on a proposition: the robot's, and the one that it attributes to the human."""
    return _CASES[robot, human]


def case_of_choices(robot: Iterable[str], human: Iterable[str], choices: Iterable[str]) -> DialogueKind:
    """Return the kind of dialogue that follows from two choices among the same things.

    A side believes the things that it chose and disbelieves all other things. A side without a choice does not know.
    Choices that agree only partly count as disagreement.
    """
    mine, theirs = frozenset(robot), frozenset(human)
    kinds = {case_of(_stance(mine, each), _stance(theirs, each)).kind for each in choices}
    return DialogueKind.PERSUASION if DialogueKind.PERSUASION in kinds else next(iter(kinds))


def _stance(chosen: frozenset[str], one: str) -> Stance:
    if not chosen:
        return Stance.UNKNOWN
    return Stance.BELIEVES if one in chosen else Stance.DISBELIEVES


_BOTH = frozenset(Side)
_CASES: Mapping[tuple[Stance, Stance], DialogueCase] = {
    (robot, human): DialogueCase(number, kind, openers)
    for number, robot, human, kind, openers in (
        (1, Stance.BELIEVES, Stance.BELIEVES, DialogueKind.AGREEMENT, frozenset[Side]()),
        (2, Stance.DISBELIEVES, Stance.BELIEVES, DialogueKind.PERSUASION, _BOTH),
        (3, Stance.UNKNOWN, Stance.BELIEVES, DialogueKind.INFORMATION_SEEKING, frozenset({Side.ROBOT})),
        (4, Stance.BELIEVES, Stance.DISBELIEVES, DialogueKind.PERSUASION, _BOTH),
        (5, Stance.DISBELIEVES, Stance.DISBELIEVES, DialogueKind.AGREEMENT, frozenset[Side]()),
        (6, Stance.UNKNOWN, Stance.DISBELIEVES, DialogueKind.INFORMATION_SEEKING, frozenset({Side.ROBOT})),
        (7, Stance.BELIEVES, Stance.UNKNOWN, DialogueKind.INFORMATION_SEEKING, frozenset({Side.HUMAN})),
        (8, Stance.DISBELIEVES, Stance.UNKNOWN, DialogueKind.INFORMATION_SEEKING, frozenset({Side.HUMAN})),
        (9, Stance.UNKNOWN, Stance.UNKNOWN, DialogueKind.INQUIRY, _BOTH),
    )
}
