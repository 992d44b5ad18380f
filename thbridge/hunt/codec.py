"""Events of a game as JSON, one line each, for the journal and for other programs.

Every line holds the version of the format (`v`) and the kind of event (`event`); rooms are the numbers people use, with
0 for the corridor, because people read journals. Unknown fields are errors: a journal that this version does not
fully understand would fold to a wrong game.
"""

import json
import math

import msgspec

from thbridge.hunt.costs import CostMatrix
from thbridge.hunt.events import Event, Number, TreasuresHidden
from thbridge.hunt.rooms import Room

VERSION = 1


def to_json(event: Event) -> str:
    """Return one line of ASCII without its line end. Raises ValueError if a number is NaN or infinite."""
    fields: dict[str, object] = msgspec.to_builtins(event, enc_hook=_encode_value)
    return json.dumps({"v": VERSION, **fields}, separators=(",", ":"), allow_nan=False)


def from_json(line: str) -> Event:
    """Return the event in a line of `to_json`.

    Raises:
        ValueError: with a sentence about the fault: not JSON, another version, an unknown event or field, a
            missing field, a field of the wrong type or out of its range.
    """
    # The decoder of msgspec takes the last of two equal fields, and refuses lone surrogates, which a name may hold.
    try:
        fields = json.loads(line, object_pairs_hook=_unique)
    except RecursionError:
        raise ValueError("JSON nested too deeply") from None
    if not isinstance(fields, dict):
        raise ValueError("expected a JSON object")
    version: object = fields.pop("v", None)
    if version != VERSION or not isinstance(version, int) or isinstance(version, bool):
        raise ValueError(f"the format is version {version!r}, this program reads version {VERSION}")
    try:
        event: Event = msgspec.convert(fields, Event, dec_hook=_decode_value)
    except msgspec.ValidationError as error:
        raise ValueError(str(error)) from None
    # Notices hold treasures too, and those of other releases may have more fields; a journal may not.
    if isinstance(event, TreasuresHidden) and [*msgspec.to_builtins(event.treasures)] != fields["treasures"]:
        raise ValueError("a treasure has an unknown or missing field")
    return event


def kind_of(event_class: type[Event]) -> str:
    """Return the kind of a class of events in recordings: its kind in journals without hyphens."""
    return str(event_class.__struct_config__.tag).replace("-", "")


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
        # msgspec adds the place in the line to a ValueError alone.
        raise ValueError(str(error)) from None
    return CostMatrix(tuple(tuple(math.inf if cost is None else cost for cost in row) for row in rows))


def _unique(pairs: list[tuple[str, object]]) -> dict[str, object]:
    fields = dict(pairs)
    if len(fields) != len(pairs):
        raise ValueError("a field is given twice")
    return fields
