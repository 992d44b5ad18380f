"""Mission items: their encoding, and a check whether a robot can execute them.

Source: the MAVLink developer guide, "Mission Protocol" and the enumerations MAV_CMD and MAV_FRAME.
"""

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from types import MappingProxyType

from thbridge.mavlink.values.vehicle_interface import Denied, Station
from thbridge.mavlink.vehicle.command.requests import UNSET
from thbridge.mavlink.vehicle.geodesy import PER_DEGREE, GeoPoint
from thbridge.mavlink.wire.coordinates import GLOBAL, PER_METRE
from thbridge.mavlink.wire.dialect import mav

_LARGEST = 2**31 - 1
_FRAMES = GLOBAL | {mav.MAV_FRAME_LOCAL_NED, mav.MAV_FRAME_MISSION}
"""Frames of items. Items without a place have the frame MAV_FRAME_MISSION."""


@dataclass(frozen=True, slots=True)
class MissionItem:
    """Item of a mission. Its command determines the meaning of the other fields.

    Attributes:
        command: a code of MAV_CMD.
        frame: a code of MAV_FRAME.
        params: the first four parameters. Unused parameters are NaN.
        x: the fifth parameter in the form of MISSION_ITEM_INT: 1e-7 degrees of latitude, 1e-4 meters, or a number.
        y: the sixth parameter, in the same form.
        z: the seventh parameter.
        autocontinue: True if the mission continues automatically after the item.
    """

    command: int
    frame: int
    params: tuple[float, float, float, float] = (0.0, 0.0, 0.0, 0.0)
    x: int = 0
    y: int = 0
    z: float = 0.0
    autocontinue: bool = True

    @property
    def has_place(self) -> bool:
        """True if it has a place. (0, 0) in degrees does not count as a place."""
        return _takes_place(self.command) and not (self.frame in GLOBAL and GeoPoint(self.x, self.y).is_unset)

    @property
    def is_here(self) -> bool:
        """True if it sets the home position to the robot's position at that time."""
        return self.command == mav.MAV_CMD_DO_SET_HOME and (self.params[0] == 1.0 or not self.has_place)


@dataclass(frozen=True, slots=True)
class InvalidItem:
    """Reason why an item cannot be part of a mission.

    Attributes:
        result: a code of MAV_MISSION_RESULT.
        sentence: reason for people.
    """

    result: int
    sentence: str


def item_of(
    message: mav.MAVLink_mission_item_message | mav.MAVLink_mission_item_int_message,
) -> MissionItem | InvalidItem:
    """Return the item in a message. Return `InvalidItem` if its place does not fit into 32 bits."""
    if isinstance(message, mav.MAVLink_mission_item_int_message):
        x, y = message.x, message.y
    else:
        scale = _scale(message.command, message.frame)
        for value, result in (
            (message.x, mav.MAV_MISSION_INVALID_PARAM5_X),
            (message.y, mav.MAV_MISSION_INVALID_PARAM6_Y),
        ):
            # This condition is also True for NaN.
            if not abs(value * scale) < _LARGEST:
                return InvalidItem(result, "its place is not a number")
        x, y = round(message.x * scale), round(message.y * scale)
    params = (_number(message.param1), _number(message.param2), _number(message.param3), _number(message.param4))
    return MissionItem(message.command, message.frame, params, x, y, _number(message.z), bool(message.autocontinue))


def message_of(item: MissionItem, seq: int, current: bool, station: Station) -> mav.MAVLink_mission_item_int_message:
    """Return the item as MISSION_ITEM_INT."""
    places = (item.x, item.y, item.z)
    head = (station.system, station.component, seq, item.frame, item.command, int(current), int(item.autocontinue))
    return mav.MAVLink_mission_item_int_message(*head, *item.params, *places)


def old_message_of(item: MissionItem, seq: int, current: bool, station: Station) -> mav.MAVLink_mission_item_message:
    """Return the item as MISSION_ITEM. Its degrees are 32-bit floats, which are accurate to some decimeters."""
    scale = _scale(item.command, item.frame)
    places = (item.x / scale, item.y / scale, item.z)
    head = (station.system, station.component, seq, item.frame, item.command, int(current), int(item.autocontinue))
    return mav.MAVLink_mission_item_message(*head, *item.params, *places)


def unfit(item: MissionItem, count: int) -> InvalidItem | None:
    """Return the reason why the item cannot be in a mission of `count` items, or None."""
    rules = _COMMANDS.get(item.command)
    if rules is None:
        known = ", ".join(map(str, sorted(_COMMANDS)))
        sentence = f"command {_named(item.command)} is not for these robots, whose commands are {known}"
        return InvalidItem(mav.MAV_MISSION_UNSUPPORTED, sentence)
    if (invalid := _off_earth(item)) is not None:
        return invalid
    for number, (fits, sentence) in rules.items():
        if not fits(item.params[number - 1], count):
            return InvalidItem(_INVALID_PARAM[number], f"parameter {number} {sentence}")
    return None


def misplaced(denied: Denied) -> InvalidItem:
    """Return the reason why an item with a denied place cannot be in a mission. In the items, x is north."""
    result = {
        "y": mav.MAV_MISSION_INVALID_PARAM5_X,
        "x": mav.MAV_MISSION_INVALID_PARAM6_Y,
        None: mav.MAV_MISSION_INVALID,
    }[denied.axis]
    return InvalidItem(result, denied.sentence[:1].lower() + denied.sentence[1:].removesuffix("."))


def _named(command: int) -> str:
    """Return a command's number and name. The dialect has no names for commands of other autopilots."""
    entry = mav.enums["MAV_CMD"].get(command)
    return f"{command} (no command of the dialect)" if entry is None else f"{command} ({entry.name})"


def _off_earth(item: MissionItem) -> InvalidItem | None:
    if item.frame not in _FRAMES:
        return InvalidItem(mav.MAV_MISSION_UNSUPPORTED_FRAME, f"frame {item.frame} is not known")
    if not _takes_place(item.command) or item.is_here:
        return None
    if item.frame == mav.MAV_FRAME_MISSION:
        return InvalidItem(mav.MAV_MISSION_UNSUPPORTED_FRAME, "its place needs a frame")
    if item.x == UNSET or (item.frame in GLOBAL and abs(item.x) > 90 * PER_DEGREE):
        return InvalidItem(mav.MAV_MISSION_INVALID_PARAM5_X, "its latitude is beyond the poles")
    if item.y == UNSET or (item.frame in GLOBAL and abs(item.y) > 180 * PER_DEGREE):
        return InvalidItem(mav.MAV_MISSION_INVALID_PARAM6_Y, "its longitude is beyond 180 degrees")
    if item.command == mav.MAV_CMD_NAV_WAYPOINT and not item.has_place:
        return InvalidItem(mav.MAV_MISSION_INVALID_PARAM5_X, "a waypoint needs a place")
    return None


_Rule = tuple[Callable[[float, int], bool], str]
"""Predicate that is true for valid parameters, and message about invalid parameters. The predicate's arguments are
the parameter and the number of items in the mission."""

_SECONDS: _Rule = (lambda value, _: value >= 0.0 and math.isfinite(value), "has to be seconds, 0 or more")
_SECONDS_IF_ANY: _Rule = (lambda value, _: math.isnan(value) or 0.0 <= value < math.inf, _SECONDS[1])
_LENGTH: _Rule = (lambda value, _: math.isnan(value) or 0.0 <= value < math.inf, "has to be metres, 0 or more")
_ANGLE: _Rule = (lambda value, _: not math.isinf(value), "has to be degrees or NaN")
_ITEM: _Rule = (lambda value, count: value in range(count), "is not an item of the mission")
_REPEATS: _Rule = (lambda value, _: value >= -1 and value.is_integer(), "has to be a number of repeats, or -1")
_HERE_OR_THERE: _Rule = (lambda value, _: value in (0, 1), "has to be 1: where the robot is, or 0: the place")
_SPEED_TYPE: _Rule = (lambda value, _: math.isnan(value) or value in (0, 1), "has to be 1: speed over ground")
_SPEED: _Rule = (lambda value, _: math.isnan(value) or value in (-1, -2) or 0.0 < value < math.inf, "is no speed")
_ONE_PICTURE: _Rule = (lambda value, _: value == 1, "has to be 1: one picture")
_ORDINAL: _Rule = (lambda value, _: value >= 1 and value.is_integer(), "has to be a number from 1")

_COMMANDS: Mapping[int, Mapping[int, _Rule]] = MappingProxyType(
    {
        mav.MAV_CMD_NAV_WAYPOINT: {1: _SECONDS_IF_ANY, 2: _LENGTH, 4: _ANGLE},
        mav.MAV_CMD_NAV_LOITER_UNLIM: {4: _ANGLE},
        mav.MAV_CMD_NAV_LOITER_TIME: {1: _SECONDS},
        mav.MAV_CMD_NAV_RETURN_TO_LAUNCH: {},
        mav.MAV_CMD_NAV_DELAY: {1: _SECONDS},
        mav.MAV_CMD_CONDITION_DELAY: {1: _SECONDS},
        mav.MAV_CMD_DO_JUMP: {1: _ITEM, 2: _REPEATS},
        mav.MAV_CMD_DO_SET_HOME: {1: _HERE_OR_THERE},
        mav.MAV_CMD_DO_CHANGE_SPEED: {1: _SPEED_TYPE, 2: _SPEED},
        mav.MAV_CMD_IMAGE_START_CAPTURE: {3: _ONE_PICTURE},
        mav.MAV_CMD_USER_1: {1: _ORDINAL},
        mav.MAV_CMD_USER_2: {},
    }
)
"""Commands in missions, each with the rules for its first four parameters."""

_PLACES = frozenset(
    (
        mav.MAV_CMD_NAV_WAYPOINT,
        mav.MAV_CMD_NAV_LOITER_UNLIM,
        mav.MAV_CMD_NAV_LOITER_TIME,
        mav.MAV_CMD_DO_SET_HOME,
    )
)

_INVALID_PARAM = MappingProxyType(
    {
        1: mav.MAV_MISSION_INVALID_PARAM1,
        2: mav.MAV_MISSION_INVALID_PARAM2,
        3: mav.MAV_MISSION_INVALID_PARAM3,
        4: mav.MAV_MISSION_INVALID_PARAM4,
    }
)


def _takes_place(command: int) -> bool:
    return command in _PLACES


def _scale(command: int, frame: int) -> float:
    """Return the factor that converts a coordinate to an integer."""
    if not _takes_place(command):
        return 1.0
    return PER_METRE if frame == mav.MAV_FRAME_LOCAL_NED else PER_DEGREE


def _number(value: float) -> float:
    """Replace any NaN by one shared object. Tuples treat an object as equal to itself, so items can be compared."""
    return math.nan if math.isnan(value) else value
