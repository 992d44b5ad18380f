"""Words for people for the codes in recorded events of a game. Recordings contain only codes and file names."""

from collections.abc import Mapping
from typing import TypeGuard, get_args

from thbridge.hunt.codec import kind_of
from thbridge.hunt.events import EndReason, Event, HandbackRequested, TeamEntry
from thbridge.hunt.treasures import name_in_words

ENDS = {
    EndReason.ALL_VISITED: "every room is visited",
    EndReason.NO_MOVE_LEFT: "no robot has a move left",
    EndReason.GIVEN_UP: "the participant has ended it",
}
"""Words for the reasons for the end of a game."""

_KINDS = {
    kind_of(event): str(event.__struct_config__.tag).replace("-", " ")
    for event in (*get_args(Event), *get_args(TeamEntry))
}
_WHOLE = {kind_of(HandbackRequested): "the participant asks for it"}
"""Texts for events whose only field is the robot."""
_NOT_TOLD = frozenset({"v", "event", "robot", "room", "image"})
"""Fields that the text omits: fields that are shown elsewhere, and the file of a picture."""


def kind_in_words(kind: str) -> str:
    """Return a recorded kind of event in words. For example, `takenup` becomes `taken up`."""
    return _KINDS.get(kind, kind)


def event_in_words(kind: str, fields: Mapping[str, object], besides: str = "") -> str:
    """Return the texts and numbers in an event's fields, for example `name beer bottle, points -20`.

    Args:
        kind: recorded kind of the event.
        fields: JSON fields of the event.
        besides: name of a further field to omit, because it is shown elsewhere.
    """
    parts = (
        f"{name.replace('_', ' ')} {_value_in_words(kind, name, value)}"
        for name, value in fields.items()
        if name not in _NOT_TOLD and name != besides and _is_plain(value)
    )
    return ", ".join(parts) or _WHOLE.get(kind, "")


def _value_in_words(kind: str, name: str, value: str | float) -> str:
    """Return a value for a list in a sentence: a text without final periods, or a number with at most six digits."""
    if not isinstance(value, str):
        return f"{value:g}"
    match kind, name:
        case ("ended", "reason") if value in ENDS:
            return ENDS[EndReason(value)]
        case ("identified", "name"):
            return name_in_words(value)
        case _:
            return value.rstrip(".")


def _is_plain(value: object) -> TypeGuard[str | float]:
    return isinstance(value, str | int | float) and not isinstance(value, bool) and value != ""
