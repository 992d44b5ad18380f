"""Events of a game as JSON, one line each, for the journal and for other programs.

Every line has the version of the format (`v`) and the kind of event (`event`). Rooms have the numbers for people, with
0 for the corridor, because people read journals. Unknown fields are errors: if a program did not fully understand a
journal, it would compute a wrong game from it. The properties of a treasure are fields next to its other fields, so
their names must differ from those (`TAKEN`). The properties of 2016 are written without their declaration, as in old
journals.
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
TAKEN = _OF_A_KIND.union({"v", "event"}, *(event.__struct_fields__ for event in get_args(Event)))
"""Names that no property of a treasure may have: the fields of events, which are also columns of tables."""


def to_json(event: JournalEntry) -> str:
    """Return one line of ASCII without its line end. Raises ValueError if a number is NaN or infinite."""
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
    return json.dumps({"v": VERSION, **fields}, separators=(",", ":"), allow_nan=False)


def from_json(line: str) -> JournalEntry:
    """Return the event in a line from `to_json`.

    Raises:
        ValueError: with a sentence about the fault: not JSON, another version, an unknown event or field, a missing
            field, or a field with a wrong type or out of its range.
    """
    # msgspec's decoder uses the last of two equal fields, and refuses lone surrogates, which names may contain.
    try:
        fields = json.loads(line, object_pairs_hook=_unique)
    except RecursionError:
        raise ValueError("JSON nested too deeply") from None
    if not isinstance(fields, dict):
        raise ValueError("expected a JSON object")
    version: object = fields.pop("v", None)
    if version != VERSION or not isinstance(version, int) or isinstance(version, bool):
        raise ValueError(f"the format is version {version!r}, this program reads version {VERSION}")
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
    """Return a treasure as JSON fields."""
    return {**kind.properties, "points": kind.points, "name": kind.name, "image": kind.image}


def treasure_of(fields: Mapping[str, object]) -> TreasureKind:
    """Return the treasure of the fields from `treasure_fields`. Raises ValueError for anything else."""
    try:
        return msgspec.convert(_gathered(fields, _OF_A_KIND), TreasureKind)
    except msgspec.ValidationError as error:
        raise ValueError(str(error)) from None


def kind_of(event_class: type[Event]) -> str:
    """Return the kind of a class of events in recordings: its kind in journals, without hyphens."""
    return str(event_class.__struct_config__.tag).replace("-", "")


def _without_words(declared: TreasureProperty) -> dict[str, object]:
    """Return the fields of a property's declaration, without the texts for participants."""
    fields: dict[str, object] = msgspec.to_builtins(declared)
    del fields["words"]
    return fields


def _encode_value(value: object) -> object:
    match value:
        case Room():
            return value.people
        case CostMatrix():
            return [[None if math.isinf(cost) else cost for cost in row] for row in value.rows]
    raise NotImplementedError(f"no event holds a {type(value).__name__}")


def _decode_value(kind: type, value: object) -> object:
    try:
        if kind is Room:
            return Room(msgspec.convert(value, int))
        rows = msgspec.convert(value, tuple[tuple[Number | None, ...], ...])
    except msgspec.ValidationError as error:
        # msgspec adds the place in the line only to a ValueError.
        raise ValueError(str(error)) from None
    return CostMatrix(tuple(tuple(math.inf if cost is None else cost for cost in row) for row in rows))


def _spread(fields: Mapping[str, object]) -> dict[str, object]:
    """Return the fields with each property as a field of its own."""
    spread: dict[str, object] = {}
    for name, value in fields.items():
        spread.update(value if name == "properties" and isinstance(value, dict) else {name: value})
    return spread


def _gathered(fields: Mapping[str, object], others: Collection[str]) -> dict[str, object]:
    """Return the fields. Those that are not among `others` are collected as properties."""
    properties = {name: value for name, value in fields.items() if name not in others}
    return {name: value for name, value in fields.items() if name in others} | {"properties": properties}


def _unique(pairs: list[tuple[str, object]]) -> dict[str, object]:
    fields = dict(pairs)
    if len(fields) != len(pairs):
        raise ValueError("a field is given twice")
    return fields
