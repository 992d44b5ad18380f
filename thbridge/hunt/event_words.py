"""Words for the recorded events of a game; the recordings themselves keep their codes and file names."""

from collections.abc import Mapping
from typing import TypeGuard, get_args

from thbridge.hunt.codec import kind_of
from thbridge.hunt.events import EndReason, Event, HandbackRequested
from thbridge.hunt.treasures import name_in_words

ENDS = {
    EndReason.ALL_VISITED: "every room is visited",
    EndReason.NO_MOVE_LEFT: "no robot has a move left",
    EndReason.GIVEN_UP: "the participant has ended it",
}
"""Reasons for the end of a game."""

_KINDS = {kind_of(event): str(event.__struct_config__.tag).replace("-", " ") for event in get_args(Event)}
_WHOLE = {kind_of(HandbackRequested): "the participant asks for it"}
"""Texts of events whose only field is the robot."""
_NOT_TOLD = frozenset({"v", "event", "robot", "room", "image"})
"""Fields that are shown elsewhere, and the file of a picture."""


def kind_in_words(kind: str) -> str:
    """Return a recorded kind of event in words: `takenup` is `taken up`."""
    return _KINDS.get(kind, kind)


def event_in_words(kind: str, fields: Mapping[str, object], besides: str = "") -> str:
    """Return the plain values among an event's fields: `name beer bottle, points -20`.

    Args:
        kind: the recorded kind.
        fields: fields of the event's JSON.
        besides: name of a field that is shown elsewhere.
    """
    parts = (
        f"{name.replace('_', ' ')} {_value_in_words(kind, name, value)}"
        for name, value in fields.items()
        if name not in _NOT_TOLD and name != besides and _is_plain(value)
    )
    return ", ".join(parts) or _WHOLE.get(kind, "")


def _value_in_words(kind: str, name: str, value: str | float) -> str:
    """Return a value for use in a list: a sentence without its full stop, a number with at most six digits."""
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
