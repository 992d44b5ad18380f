"""Decoding of a log's events from text, with a check of all data that other code uses.

A log with correct digests may come from a later release, another program or an adversary. Unknown kinds and keys are
kept. Data of known kinds and keys must have the right type and must be within bounds.
"""

from collections.abc import Mapping
from datetime import datetime
from typing import Annotated, Literal, cast

import msgspec
from msgspec import UNSET, Meta, Struct, UnsetType

from thbridge.experiment.store.events import (
    WITHDRAWN,
    Actor,
    Clocks,
    EventKind,
    JsonValue,
    NewEvent,
    StepOutcome,
)
from thbridge.hunt.seats import MOST_SEATS

LARGEST_EVENT = 1 << 20
"""Largest size of an event, in bytes. The longest answer, with 20,000 characters, needs at most 120 kB."""
MOST_LEVELS = 16
"""Largest nesting depth of an event's data."""
LONGEST_NAME = 1000
MOST_STEPS = 100_000
MOST_PLACES = 10_000_000
LARGEST_ANSWER = 1e15

_Count = Annotated[int, Meta(ge=0, le=2**63 - 1)]
_Whole = Annotated[int, Meta(ge=-(2**63), le=2**63 - 1)]
_Name = Annotated[str, Meta(max_length=LONGEST_NAME)]
_Number = Annotated[float, Meta(ge=-LARGEST_ANSWER, le=LARGEST_ANSWER)]
_WholeAnswer = Annotated[int, Meta(ge=-int(LARGEST_ANSWER), le=int(LARGEST_ANSWER))]
_GroupId = Annotated[str, Meta(pattern=r"^G-[A-Z0-9]{1,20}\Z")]
_Answer = None | bool | _WholeAnswer | _Number | str | list[str]


class BadEvent(ValueError):  # noqa: N818 - it names the fault
    """Text that is not a valid event. `str()` gives the reason as a clause."""


class _Event(Struct):
    """Fields of an event's text."""

    kind: Annotated[str, Meta(min_length=1, max_length=LONGEST_NAME)]
    actor: Actor
    wall: _Name
    monotonic_ns: _Whole
    simulated: float | None
    participant: _Name
    step: Annotated[int, Meta(ge=0, le=MOST_STEPS)]
    condition: str
    cause: _Count
    data: dict[str, object]
    lsl: float | None = None


# Required data of each kind of event


class _PlaceTaken(Struct):
    place: Annotated[int, Meta(ge=0, le=MOST_PLACES)]


class _StepNamed(Struct):
    name: str | UnsetType = UNSET


class _ItemNamed(Struct):
    item: str


class _ItemDrafted(Struct):
    item: str
    answer: _Answer | UnsetType = UNSET


class _ItemAnswered(Struct):
    item: str
    answer: _Answer


class _TextPasted(Struct):
    item: str
    characters: Annotated[int, Meta(ge=0, le=2**31 - 1)] = 0


class _GamePlayed(Struct):
    bag: str
    sha256: str | UnsetType = UNSET
    score: _Whole | UnsetType = UNSET
    over: str | UnsetType | None = UNSET
    rooms_visited: _Count | UnsetType = UNSET
    identified: _Count | UnsetType = UNSET
    sim_seconds: _Number | UnsetType = UNSET
    energy_left: _Number | UnsetType = UNSET
    wall_seconds: _Number | UnsetType = UNSET
    most_lag_seconds: _Number | UnsetType = UNSET
    late_seconds: _Number | UnsetType = UNSET
    course: list[tuple[_Number, _Number]] | UnsetType = UNSET
    group: _GroupId | UnsetType = UNSET
    seat: _Name | UnsetType = UNSET


class _GroupFormed(Struct):
    group: _GroupId
    seat: _Name
    seats: Annotated[dict[_Name, Literal["person", "program", "empty"]], Meta(min_length=2, max_length=MOST_SEATS)]
    waited_s: _Number = 0.0


class _SeatChanged(Struct):
    group: _GroupId
    seat: _Name


class _RecordingLeft(Struct):
    bag: str | None


class _StepEnded(Struct):
    outcome: StepOutcome


class _RunEnded(Struct):
    outcome: Literal["complete", "declined", "left"]
    reason: str = ""
    code: str = ""
    excluded: str = ""


class _Coded(Struct):
    code: str


class _ConsentAnswered(Struct):
    agrees: bool
    version: str | UnsetType = UNSET


class _Reasoned(Struct):
    reason: str


class _Seeded(Struct):
    seed: _Whole


class _Noted(Struct):
    text: str = ""


class _Withdrawn(Struct):
    sequences: list[_Count]


_DATA: Mapping[str, type[Struct]] = {
    EventKind.RUN_BEGUN: _PlaceTaken,
    EventKind.STEP_BEGUN: _StepNamed,
    EventKind.ITEM_SHOWN: _ItemNamed,
    EventKind.ITEM_TOUCHED: _ItemNamed,
    EventKind.ITEM_CHANGED: _ItemDrafted,
    EventKind.ITEM_GIVEN: _ItemAnswered,
    EventKind.TEXT_PASTED: _TextPasted,
    EventKind.GAME_PLAYED: _GamePlayed,
    EventKind.GAME_BROKEN_OFF: _RecordingLeft,
    EventKind.RECORDING_CUT_OFF: _RecordingLeft,
    EventKind.GROUP_FORMED: _GroupFormed,
    EventKind.SEAT_LEFT: _SeatChanged,
    EventKind.SEAT_FILLED: _SeatChanged,
    EventKind.SEAT_RESUMED: _SeatChanged,
    EventKind.STEP_ENDED: _StepEnded,
    EventKind.RUN_ENDED: _RunEnded,
    EventKind.RUN_EXCLUDED: _Reasoned,
    EventKind.RECRUITING_CODE: _Coded,
    EventKind.CONSENT_ANSWERED: _ConsentAnswered,
    EventKind.REHEARSED: _Seeded,
    EventKind.NOTE: _Noted,
    WITHDRAWN: _Withdrawn,
}
_OF_A_STEP = frozenset(
    {
        EventKind.STEP_BEGUN,
        EventKind.STEP_ENDED,
        EventKind.GROUP_FORMED,
        EventKind.SEAT_LEFT,
        EventKind.SEAT_FILLED,
        EventKind.SEAT_RESUMED,
    }
)
"""Kinds of events that always belong to a step."""

_decoder = msgspec.json.Decoder(_Event)


def decoded(content: str) -> NewEvent:
    """Return the event of a text.

    Raises:
        BadEvent: the text is not a valid event.
    """
    try:
        read = _decoder.decode(content)
        if (shape := _DATA.get(read.kind)) is not None:
            msgspec.convert(read.data, shape)
        levels = _levels(read.data)
    except msgspec.MsgspecError as error:
        raise BadEvent(str(error)) from None
    except RecursionError:
        raise BadEvent("its JSON is nested too deeply") from None
    if levels > MOST_LEVELS:
        raise BadEvent(f"its data is nested in more than {MOST_LEVELS} levels")
    if read.kind in _OF_A_STEP and read.step == 0:
        raise BadEvent("it has no step")
    if not _is_time(read.wall):
        raise BadEvent(f"its time, {read.wall!r}, is not a date and time with a time zone")
    clocks = Clocks(read.wall, read.monotonic_ns, read.simulated, read.lsl)
    data = cast("dict[str, JsonValue]", read.data)
    return NewEvent(read.kind, read.actor, clocks, read.participant, read.step, read.condition, read.cause, data)


def _levels(value: object) -> int:
    """Return the nesting depth of the containers in a value."""
    inner = value.values() if isinstance(value, dict) else value if isinstance(value, list) else None
    return 0 if inner is None else 1 + max(map(_levels, inner), default=0)


def _is_time(wall: str) -> bool:
    try:
        return datetime.fromisoformat(wall).utcoffset() is not None
    except ValueError:
        return False
