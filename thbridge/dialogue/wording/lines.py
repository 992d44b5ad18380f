"""Lines that are not moves of games: beginnings and ends of dialogues, questions of a person, answers of robots."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import StrEnum

from thbridge.dialogue.argumentation.cases import Side
from thbridge.dialogue.wording.predicates import ValueKind


class LineKey(StrEnum):
    """Key of a line in the files of a language."""

    WHERE = "where"
    WHERE_THEN = "where_then"
    WHAT_THEN = "what_then"
    LEAVE_IT = "leave_it"
    OVERRIDE = "override"
    OVERRIDE_PICTURE = "override_picture"
    OVERRIDE_NAME = "override_name"
    NEGLECTED = "neglected"
    GOES = "goes"
    AGREED = "agreed"
    OVERRIDDEN = "overridden"
    DECIDED = "decided"
    STAYS = "stays"
    UNDONE = "undone"
    MISHEARD = "misheard"
    HAVE_QUESTION = "have_question"
    BACK = "back"
    WHY_ROBOT = "why_robot"
    WHY_NOW = "why_now"
    KNOWN = "known"
    CHANGE = "change"
    SIMPLER = "simpler"
    BECAUSE = "because"
    BECAUSE_NOT_KNOWN = "because_not_known"
    CHANGED_BY = "changed_by"
    CHANGED_BY_NOTHING = "changed_by_nothing"


@dataclass(frozen=True, slots=True)
class LineMeaning:
    """Meaning of a line, for people who write it.

    Attributes:
        speaker: the side that says the line.
        meaning: purpose of the line, or the situation in which the line is said.
        values: values that the line may contain, by their reserved words.
    """

    speaker: Side
    meaning: str
    values: Mapping[str, ValueKind] = field(default_factory=dict)


_ROOM = {"room": ValueKind.ROOM}
_CONTENT = {"content": ValueKind.CLAUSE}
_BECAUSE = {"because": ValueKind.CLAUSES}

LINES: Mapping[LineKey, LineMeaning] = {
    LineKey.WHERE: LineMeaning(Side.HUMAN, "does not know, and asks where the robot would go"),
    LineKey.WHERE_THEN: LineMeaning(Side.HUMAN, "asks where the robot would go instead"),
    LineKey.WHAT_THEN: LineMeaning(Side.HUMAN, "asks what the robot would do about a treasure"),
    LineKey.LEAVE_IT: LineMeaning(Side.HUMAN, "ends the dialogue"),
    LineKey.OVERRIDE: LineMeaning(Side.HUMAN, "has the last word, and sends the robot to a room", _ROOM),
    LineKey.OVERRIDE_PICTURE: LineMeaning(Side.HUMAN, "has the last word, and wants a picture"),
    LineKey.OVERRIDE_NAME: LineMeaning(Side.HUMAN, "has the last word, and names the treasure"),
    LineKey.NEGLECTED: LineMeaning(
        Side.ROBOT, "has received no request for a while", {"seconds": ValueKind.NUMBER, **_ROOM}
    ),
    LineKey.GOES: LineMeaning(Side.ROBOT, "says where it goes, because both sides agreed", _ROOM),
    LineKey.AGREED: LineMeaning(Side.ROBOT, "says what is done about a treasure, because both sides agreed", _CONTENT),
    LineKey.OVERRIDDEN: LineMeaning(Side.ROBOT, "says what it does, because the person insists", _CONTENT),
    LineKey.DECIDED: LineMeaning(Side.ROBOT, "says what it does, because it has the last word", _CONTENT),
    LineKey.STAYS: LineMeaning(Side.ROBOT, "says that it goes nowhere, because there was no agreement"),
    LineKey.UNDONE: LineMeaning(
        Side.ROBOT, "says that it does nothing about a treasure for now, because there was no agreement"
    ),
    LineKey.MISHEARD: LineMeaning(
        Side.ROBOT, "repeats the move that it understood, if it misheard", {"heard": ValueKind.NAME}
    ),
    LineKey.HAVE_QUESTION: LineMeaning(Side.HUMAN, "wants to ask a question"),
    LineKey.BACK: LineMeaning(Side.HUMAN, "asks no question after all"),
    LineKey.WHY_ROBOT: LineMeaning(Side.HUMAN, "asks why this robot should go, and not another robot"),
    LineKey.WHY_NOW: LineMeaning(Side.HUMAN, "asks why now, and not later"),
    LineKey.KNOWN: LineMeaning(Side.HUMAN, "asks for everything that the robot knows about the subject"),
    LineKey.CHANGE: LineMeaning(Side.HUMAN, "asks what would make the robot change its mind"),
    LineKey.SIMPLER: LineMeaning(Side.HUMAN, "asks the robot to say it again in simpler words"),
    LineKey.BECAUSE: LineMeaning(Side.ROBOT, "answers a question with its beliefs", _BECAUSE),
    LineKey.BECAUSE_NOT_KNOWN: LineMeaning(Side.ROBOT, "has no answer"),
    LineKey.CHANGED_BY: LineMeaning(
        Side.ROBOT,
        "says what would change its mind; each of these facts is enough",
        {"because": ValueKind.ALTERNATIVES},
    ),
    LineKey.CHANGED_BY_NOTHING: LineMeaning(Side.ROBOT, "knows of nothing that would change its mind"),
}
"""Lines that every language has."""
