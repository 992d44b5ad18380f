"""Events of a game as lines of JSON, for the journal and for other programs.

Every line has the version of the format (`v`) and the kind of event (`event`). People read journals, so rooms have the
numbers for people, with 0 for the corridor. Unknown fields are errors, because a program that does not understand all
fields would compute a wrong game. Properties of a treasure are fields of the same object as its other fields, so their
names must be different (`TAKEN`). The declaration of the properties of 2016 is omitted, as in old journals.
"""

import json
import math
from collections.abc import Collection, Mapping
from typing import get_args

import msgspec

from thbridge.hunt.costs import CostMatrix
from thbridge.hunt.events import Event, GameStarted, JournalEntry, Number, TreasureSensed, TreasuresHidden
from thbridge.hunt.properties import OF_2016, TreasureProperty
from thbridge.hunt.rooms import Room
from thbridge.hunt.treasures import TreasureKind

VERSION = 1

_OF_A_KIND = frozenset(TreasureKind.__dataclass_fields__) - {"properties"}
_OF_A_SENSED = frozenset(TreasureSensed.__struct_fields__) - {"properties"} | {"event"}
_ONLY_WITH_SEATS = frozenset({"seat", "seats"})
"""Fields that are omitted if they are empty."""
TAKEN = _OF_A_KIND.union({"v", "event"}, *(event.__struct_fields__ for event in get_args(Event)))
"""Names that properties of treasures must not have: names of event fields, which are columns of tables, too."""


def to_json(event: JournalEntry) -> str:
    """Return an event as a line of ASCII, without a line end. Raises ValueError if a number is NaN or infinite."""
    fields: dict[str, object] = msgspec.to_builtins(event, enc_hook=_encode_value)
    match event:
        case TreasureSensed():
            fields = _spread(fields)
        case TreasuresHidden():
            fields["treasures"] = [treasure_fields(kind) for kind in event.treasures]
        case GameStarted() if event.properties == OF_2016:
            del fields["properties"]
        case GameStarted():
            fields["properties"] = [_without_words(each) for each in event.properties]
    # Journals of games with one participant are the same as before there were seats.
    fields = {name: value for name, value in fields.items() if value or name not in _ONLY_WITH_SEATS}
    return json.dumps({"v": VERSION, **fields}, separators=(",", ":"), allow_nan=False)


def from_json(line: str) -> JournalEntry:
    """Return the event in a line from `to_json`.

    Raises:
        ValueError: the line is not JSON or has another version, an unknown event or field, a missing field, or a field
            with a wrong type or value. The text describes the fault.
    """
    # Do not use msgspec's decoder: it accepts repeated fields, and refuses lone surrogates, which names may contain.
    try:
        fields = json.loads(line, object_pairs_hook=_unique)
    except RecursionError:
        raise ValueError("the JSON is nested too deeply") from None
    if not isinstance(fields, dict):
        raise ValueError("the line is not a JSON object")
    version: object = fields.pop("v", None)
    if version != VERSION or not isinstance(version, int) or isinstance(version, bool):
        raise ValueError(f"the line has version {version!r}, but this program reads version {VERSION}")
    if fields.get("event") == "sensed":
        fields = _gathered(fields, _OF_A_SENSED)
    treasures = fields.get("treasures")
    if isinstance(treasures, list):
        fields["treasures"] = [_gathered(kind, _OF_A_KIND) if isinstance(kind, dict) else kind for kind in treasures]
    try:
        event: JournalEntry = msgspec.convert(fields, JournalEntry, dec_hook=_decode_value)
    except msgspec.ValidationError as error:
        raise ValueError(str(error)) from None
    if isinstance(event, TreasuresHidden) and [*map(treasure_fields, event.treasures)] != treasures:
        raise ValueError("a treasure lacks a field")
    return event


def treasure_fields(kind: TreasureKind) -> dict[str, str | int | None]:
    """Return the JSON fields of a treasure."""
    return {**kind.properties, "points": kind.points, "name": kind.name, "image": kind.image}


def treasure_of(fields: Mapping[str, object]) -> TreasureKind:
    """Return the treasure with these JSON fields; see `treasure_fields`. Raises ValueError for invalid fields."""
    try:
        return msgspec.convert(_gathered(fields, _OF_A_KIND), TreasureKind)
    except msgspec.ValidationError as error:
        raise ValueError(str(error)) from None


def kind_of(event_class: type[JournalEntry]) -> str:
    """Return the kind of an event class in recordings: its kind in journals, with the hyphens removed."""
    return str(event_class.__struct_config__.tag).replace("-", "")


def _without_words(declared: TreasureProperty) -> dict[str, object]:
    """Return the fields of a property's declaration without the texts for participants."""
    fields: dict[str, object] = msgspec.to_builtins(declared)
    del fields["words"]
    return fields


def _encode_value(value: object) -> object:
    match value:
        case Room():
            return value.people
        case CostMatrix():
            return [[None if math.isinf(cost) else cost for cost in row] for row in value.rows]
    raise NotImplementedError(f"events cannot contain a {type(value).__name__}")


def _decode_value(kind: type, value: object) -> object:
    try:
        if kind is Room:
            return Room(msgspec.convert(value, int))
        rows = msgspec.convert(value, tuple[tuple[Number | None, ...], ...])
    except msgspec.ValidationError as error:
        # msgspec adds the path of the field only to a ValueError.
        raise ValueError(str(error)) from None
    return CostMatrix(tuple(tuple(math.inf if cost is None else cost for cost in row) for row in rows))


def _spread(fields: Mapping[str, object]) -> dict[str, object]:
    """Return the fields after replacing `properties` by one field for each property."""
    spread: dict[str, object] = {}
    for name, value in fields.items():
        spread.update(value if name == "properties" and isinstance(value, dict) else {name: value})
    return spread


def _gathered(fields: Mapping[str, object], others: Collection[str]) -> dict[str, object]:
    """Return the fields named in `others`, and the field `properties` with all other fields."""
    properties = {name: value for name, value in fields.items() if name not in others}
    return {name: value for name, value in fields.items() if name in others} | {"properties": properties}


def _unique(pairs: list[tuple[str, object]]) -> dict[str, object]:
    fields = dict(pairs)
    if len(fields) != len(pairs):
        raise ValueError("a field occurs twice")
    return fields
