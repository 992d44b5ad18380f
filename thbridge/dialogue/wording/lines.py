"""Lines beside the moves of games: how a dialogue begins and ends, what a person may ask, how robots answer."""

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
        speaker: the side that says it.
        meaning: when it is said, or what for.
        values: that it may name, by their reserved words.
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
        Side.ROBOT, "when it was told nothing for a while", {"seconds": ValueKind.NUMBER, **_ROOM}
    ),
    LineKey.GOES: LineMeaning(Side.ROBOT, "tells where it goes, for that was agreed upon", _ROOM),
    LineKey.AGREED: LineMeaning(Side.ROBOT, "tells what is done about a treasure, for that was agreed upon", _CONTENT),
    LineKey.OVERRIDDEN: LineMeaning(Side.ROBOT, "tells what it does, for the person wants it all the same", _CONTENT),
    LineKey.DECIDED: LineMeaning(Side.ROBOT, "tells what it does, for it has the last word", _CONTENT),
    LineKey.STAYS: LineMeaning(Side.ROBOT, "tells that it goes nowhere, for nothing was agreed upon"),
    LineKey.UNDONE: LineMeaning(
        Side.ROBOT, "tells that it does nothing yet about a treasure, for nothing was agreed upon"
    ),
    LineKey.MISHEARD: LineMeaning(
        Side.ROBOT, "tells what it has understood, where that is not what was said", {"heard": ValueKind.NAME}
    ),
    LineKey.HAVE_QUESTION: LineMeaning(Side.HUMAN, "wants to ask something"),
    LineKey.BACK: LineMeaning(Side.HUMAN, "asks nothing after all"),
    LineKey.WHY_ROBOT: LineMeaning(Side.HUMAN, "asks why this robot, and not another one"),
    LineKey.WHY_NOW: LineMeaning(Side.HUMAN, "asks why now"),
    LineKey.KNOWN: LineMeaning(Side.HUMAN, "asks for all that the robot knows of it"),
    LineKey.CHANGE: LineMeaning(Side.HUMAN, "asks what would make the robot change its mind"),
    LineKey.SIMPLER: LineMeaning(Side.HUMAN, "asks the robot to say it again in simpler words"),
    LineKey.BECAUSE: LineMeaning(Side.ROBOT, "answers a question with what it believes", _BECAUSE),
    LineKey.BECAUSE_NOT_KNOWN: LineMeaning(Side.ROBOT, "has no answer"),
    LineKey.CHANGED_BY: LineMeaning(
        Side.ROBOT, "tells what would change its mind, each by itself", {"because": ValueKind.ALTERNATIVES}
    ),
    LineKey.CHANGED_BY_NOTHING: LineMeaning(Side.ROBOT, "knows of nothing that would change its mind"),
}
"""Lines that every language has."""
