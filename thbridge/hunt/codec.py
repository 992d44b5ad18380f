"""Events of a game as JSON, one line each, for the journal and for other programs.

Every line holds the version of the format (`v`) and the kind of event (`event`); rooms are the numbers people use, with
0 for the corridor, because people read journals. Unknown fields are errors: a journal that this version does not
fully understand would fold to a wrong game.
"""

import math
from collections.abc import Callable
from typing import assert_never

from thbridge.hunt.costs import CostMatrix
from thbridge.hunt.events import (
    Agreed,
    Arrived,
    AskedBack,
    Commanded,
    Commander,
    Condition,
    Departed,
    Ended,
    EndReason,
    Event,
    Failed,
    Hidden,
    Identified,
    Left,
    Pictured,
    Reported,
    Sensed,
    Started,
)
from thbridge.hunt.json_fields import Fields, Json, dumps
from thbridge.hunt.rooms import Room
from thbridge.hunt.treasures import TreasureKind

VERSION = 1


def to_json(event: Event) -> str:
    """Return one line of ASCII without its line end. Raises ValueError if a number is NaN or infinite."""
    kind, fields = _encoded(event)
    return dumps({"v": VERSION, "event": kind, **fields})


def from_json(line: str) -> Event:
    """Return the event in a line of `to_json`.

    Raises:
        ValueError: with a sentence about the fault: not JSON, another version, an unknown event or field, a
            missing field, a field of the wrong type or out of its range.
    """
    fields = Fields.of_text(line)
    version = fields.integer("v")
    if version != VERSION:
        raise ValueError(f"the format is version {version}, this program reads version {VERSION}")
    kind = fields.text("event")
    if kind not in _DECODERS:
        raise ValueError(f"unknown event {kind!r}")
    event = _DECODERS[kind](fields)
    fields.end()
    return event


def _encoded(event: Event) -> tuple[str, dict[str, Json]]:
    match event:
        case Started():
            return "started", {
                "seed": event.seed,
                "game": event.game,
                "robots": event.robots,
                "energy": event.energy,
                "picture_cost": event.picture_cost,
                "identify_cost": event.identify_cost,
                "wrong_share": event.wrong_share,
                "costs": [[None if math.isinf(cost) else cost for cost in row] for row in event.costs.rows],
            }
        case Hidden():
            return "hidden", {"treasures": [_treasure_fields(treasure) for treasure in event.treasures]}
        case Agreed():
            return "agreed", {}
        case Departed():
            return "departed", {"robot": event.robot, "room": event.room.people, "cost": event.cost}
        case Arrived():
            return "arrived", {"robot": event.robot, "room": event.room.people}
        case Failed():
            return "failed", {
                "robot": event.robot,
                "room": event.room.people,
                "reason": event.reason,
                "refund": event.refund,
                "at": event.at.people,
            }
        case Reported():
            return "reported", {"robot": event.robot, "condition": event.condition.value}
        case Commanded():
            return "commanded", {"robot": event.robot, "by": event.by.value, "name": event.name}
        case AskedBack():
            return "asked-back", {"robot": event.robot}
        case Sensed():
            return "sensed", {"room": event.room.people, "colour": event.colour, "footprint": event.footprint}
        case Pictured():
            return "pictured", {
                "room": event.room.people,
                "robot": event.robot,
                "image": event.image,
                "cost": event.cost,
            }
        case Identified():
            return "identified", {
                "room": None if event.room is None else event.room.people,
                "robot": event.robot,
                "name": event.name,
                "points": event.points,
                "cost": event.cost,
            }
        case Left():
            return "left", {"room": event.room.people}
        case Ended():
            return "ended", {"reason": event.reason.value, "score": event.score}
        case _:
            assert_never(event)


def _started(fields: Fields) -> Event:
    return Started(
        seed=fields.integer("seed"),
        game=fields.integer("game"),
        robots=fields.integer("robots"),
        energy=fields.number("energy"),
        picture_cost=fields.number("picture_cost"),
        identify_cost=fields.number("identify_cost"),
        wrong_share=fields.number("wrong_share"),
        costs=CostMatrix(fields.number_rows("costs", null=math.inf)),
    )


def _hidden(fields: Fields) -> Event:
    return Hidden(tuple(_treasure(treasure) for treasure in fields.objects("treasures")))


def _agreed(fields: Fields) -> Event:
    return Agreed()


def _departed(fields: Fields) -> Event:
    return Departed(fields.integer("robot"), _room(fields), fields.number("cost"))


def _arrived(fields: Fields) -> Event:
    return Arrived(fields.integer("robot"), _room(fields))


def _failed(fields: Fields) -> Event:
    return Failed(
        fields.integer("robot"), _room(fields), fields.text("reason"), fields.number("refund"), _room(fields, "at")
    )


def _reported(fields: Fields) -> Event:
    return Reported(fields.integer("robot"), Condition(fields.text("condition")))


def _commanded(fields: Fields) -> Event:
    return Commanded(fields.integer("robot"), Commander(fields.text("by")), fields.text("name"))


def _asked_back(fields: Fields) -> Event:
    return AskedBack(fields.integer("robot"))


def _sensed(fields: Fields) -> Event:
    return Sensed(_room(fields), fields.text("colour"), fields.text("footprint"))


def _pictured(fields: Fields) -> Event:
    return Pictured(_room(fields), fields.integer("robot"), fields.text("image"), fields.number("cost"))


def _identified(fields: Fields) -> Event:
    room = fields.optional_integer("room")
    return Identified(
        None if room is None else Room.of_people(room),
        fields.optional_integer("robot"),
        fields.optional_text("name"),
        fields.integer("points"),
        fields.number("cost"),
    )


def _left(fields: Fields) -> Event:
    return Left(_room(fields))


def _ended(fields: Fields) -> Event:
    return Ended(EndReason(fields.text("reason")), fields.integer("score"))


_DECODERS: dict[str, Callable[[Fields], Event]] = {
    "started": _started,
    "hidden": _hidden,
    "agreed": _agreed,
    "departed": _departed,
    "arrived": _arrived,
    "failed": _failed,
    "reported": _reported,
    "commanded": _commanded,
    "asked-back": _asked_back,
    "sensed": _sensed,
    "pictured": _pictured,
    "identified": _identified,
    "left": _left,
    "ended": _ended,
}


def _room(fields: Fields, name: str = "room") -> Room:
    return Room.of_people(fields.integer(name))


def _treasure_fields(treasure: TreasureKind) -> dict[str, Json]:
    return {
        "colour": treasure.colour,
        "footprint": treasure.footprint,
        "points": treasure.points,
        "name": treasure.name,
        "image": treasure.image,
    }


def _treasure(fields: Fields) -> TreasureKind:
    kind = TreasureKind(
        fields.text("colour"),
        fields.text("footprint"),
        fields.integer("points"),
        fields.text("name"),
        fields.optional_text("image"),
    )
    fields.end()
    return kind
