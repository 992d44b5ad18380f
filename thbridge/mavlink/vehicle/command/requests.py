"""Common form of the commands in COMMAND_LONG and COMMAND_INT, specifications of commands, and their replies."""

import math
from collections.abc import Callable
from dataclasses import dataclass
from enum import Enum, IntEnum

import numpy as np

from sim.common.geometry import Pose2
from thbridge.mavlink.values.vehicle_interface import DenialKind, Denied, Station
from thbridge.mavlink.vehicle.geodesy import PER_DEGREE, GeoPoint, MapProjection
from thbridge.mavlink.wire.coordinates import GLOBAL, PER_METRE, point_in_map
from thbridge.mavlink.wire.dialect import Message, mav
from thbridge.mavlink.wire.outgoing import LinkId

UNSET = 0x7FFFFFFF
"""Value in COMMAND_INT of a coordinate that is not given."""


class CommandResult(IntEnum):
    """Result of a command: the codes of MAV_RESULT, and two codes that pymavlink's dialect does not have."""

    ACCEPTED = mav.MAV_RESULT_ACCEPTED
    TEMPORARILY_REJECTED = mav.MAV_RESULT_TEMPORARILY_REJECTED
    DENIED = mav.MAV_RESULT_DENIED
    UNSUPPORTED = mav.MAV_RESULT_UNSUPPORTED
    FAILED = mav.MAV_RESULT_FAILED
    IN_PROGRESS = mav.MAV_RESULT_IN_PROGRESS
    CANCELLED = 6
    COMMAND_LONG_ONLY = mav.MAV_RESULT_COMMAND_LONG_ONLY
    COMMAND_INT_ONLY = mav.MAV_RESULT_COMMAND_INT_ONLY
    UNSUPPORTED_MAV_FRAME = 9


@dataclass(frozen=True, slots=True)
class ReceivedCommand:
    """Command as received.

    Attributes:
        link: link on which it arrived.
        station: its sender.
        number: a code of MAV_CMD.
        params: its seven parameters. A parameter that is not given is NaN.
        frame: coordinate frame of its place, a code of MAV_FRAME. None for COMMAND_LONG, which has no frame.
        confirmation: number of earlier transmissions. Always 0 for COMMAND_INT, which does not count them.
    """

    link: LinkId
    station: Station
    number: int
    params: tuple[float, ...]
    frame: int | None
    confirmation: int

    def param(self, place: int) -> float | None:
        """Return a parameter by its number from 1, or None if it is not given."""
        value = self.params[place - 1]
        return None if math.isnan(value) else value

    def whole_param(self, place: int, otherwise: int | None = None) -> int | None:
        """Return a parameter that must be a whole number from 0.

        Args:
            place: number of the parameter, from 1.
            otherwise: result if the parameter is not given.

        Returns:
            The whole number. None if the parameter is invalid.
        """
        value = self.param(place)
        if value is None:
            return otherwise
        return int(value) if value >= 0.0 and value.is_integer() else None


@dataclass(frozen=True, slots=True)
class CommandReply:
    """Reply to a command.

    Attributes:
        result: result in the acknowledgement.
        messages: messages to the sender of the command, sent after the acknowledgement.
        sentence: reason for a refusal, for people.
        leg: number of the drive that the command has started. The command ends with this drive. If None, the command
            ends at once.
    """

    result: CommandResult
    messages: tuple[Message, ...] = ()
    sentence: str = ""
    leg: int | None = None


class CommandCarrier(Enum):
    """Messages that may contain a command."""

    LONG = "COMMAND_LONG"
    INT = "COMMAND_INT"
    BOTH = "both"


class CommandAccess(Enum):
    """Stations that may send a command."""

    ANYBODY = "anybody"
    NO_RIVAL = "anybody, unless another station is in command"
    COMMANDER = "the station in command"


@dataclass(frozen=True, slots=True)
class CommandSpec:
    """Specification of a command that the vehicle supports.

    Attributes:
        do: function that executes the command.
        carrier: messages that may contain the command.
        frames: allowed frames of its place. Empty if the command has no place.
        access: stations that may send the command.
        once: True if each execution of the command has a new effect.
    """

    do: Callable[[ReceivedCommand], CommandReply]
    carrier: CommandCarrier = CommandCarrier.BOTH
    frames: frozenset[int] = frozenset()
    access: CommandAccess = CommandAccess.ANYBODY
    once: bool = False


ACCEPTED = CommandReply(CommandResult.ACCEPTED)
INVALID_PARAM = CommandReply(CommandResult.DENIED)
"""Reply to a command with an invalid parameter."""

_RESULTS = {
    DenialKind.DENIED: CommandResult.DENIED,
    DenialKind.NOT_NOW: CommandResult.TEMPORARILY_REJECTED,
    DenialKind.UNSUPPORTED: CommandResult.UNSUPPORTED,
}


def reply_to(denied: Denied | None) -> CommandReply:
    """Return the reply for a granted or denied command."""
    return ACCEPTED if denied is None else CommandReply(_RESULTS[denied.kind], sentence=denied.sentence)


def parse_command(link: LinkId, station: Station, message: Message) -> ReceivedCommand | None:
    """Return the command in a message, or None if it contains no command."""
    if isinstance(message, mav.MAVLink_command_long_message):
        params = (
            message.param1,
            message.param2,
            message.param3,
            message.param4,
            message.param5,
            message.param6,
            message.param7,
        )
        return ReceivedCommand(link, station, message.command, params, None, message.confirmation)
    if isinstance(message, mav.MAVLink_command_int_message):
        # The coordinates of COMMAND_INT are integers, so they cannot be NaN.
        x, y = (math.nan if value == UNSET else float(value) for value in (message.x, message.y))
        params = (message.param1, message.param2, message.param3, message.param4, x, y, message.z)
        return ReceivedCommand(link, station, message.command, params, message.frame, 0)
    return None


def decimal_of(value: float) -> float:
    """Return the shortest decimal number with the same 32-bit float, such as 0.4 instead of 0.4000000059604645."""
    return float(str(np.float32(value)))


def destination(
    request: ReceivedCommand, base_in_map: Pose2, earth: MapProjection
) -> tuple[float, float] | Denied | None:
    """Return the point of the map in a command, meters east and north.

    A COMMAND_INT uses one of the supported frames. A COMMAND_LONG contains degrees as 32-bit floats, which are accurate
    to some decimeters.

    Returns:
        The point. `Denied` if the latitude or longitude does not exist. None if the command contains no place, or
        (0, 0) in degrees.
    """
    first, second = request.params[4], request.params[5]
    if math.isnan(first) or math.isnan(second):
        return None
    if request.frame is not None and request.frame not in GLOBAL:
        return point_in_map(request.frame, first / PER_METRE, second / PER_METRE, base_in_map)
    scale = PER_DEGREE if request.frame is None else 1
    place = GeoPoint(round(first * scale), round(second * scale))
    if place.is_unset:
        return None
    return earth.map_point(place) if place.is_on_earth else Denied("There is no such place on earth.")
