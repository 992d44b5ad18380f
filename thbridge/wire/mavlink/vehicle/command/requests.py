"""Commands as they come in, whichever message carries them, who may give which, and what is answered."""

import math
from collections.abc import Callable
from dataclasses import dataclass
from enum import Enum, IntEnum

import numpy as np

from sim.common.geometry import Pose2
from thbridge.wire.mavlink.coordinates import GLOBAL, PER_METRE, point_in_map
from thbridge.wire.mavlink.dialect import Message, mav
from thbridge.wire.mavlink.outgoing import LinkId
from thbridge.wire.mavlink.vehicle.geodesy import PER_DEGREE, GeoPoint, MapProjection
from thbridge.wire.mavlink.vehicle_interface import DenialKind, Denied, Station

UNSET = 0x7FFFFFFF
"""A coordinate of COMMAND_INT that is not given."""


class CommandResult(IntEnum):
    """How a command ends: MAV_RESULT, with those numbers that pymavlink's dialect lacks."""

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
    """A command from somebody.

    Attributes:
        link: where it came in.
        station: who sent it.
        number: of MAV_CMD.
        params: the seven of them; NaN where one is not given.
        frame: of its place; None where COMMAND_LONG carried it, which has no frame.
        confirmation: how often it was sent before; always 0 of COMMAND_INT, which does not count.
    """

    link: LinkId
    station: Station
    number: int
    params: tuple[float, ...]
    frame: int | None
    confirmation: int

    def given(self, place: int) -> float | None:
        """A parameter by its number from 1; None where it is not given."""
        value = self.params[place - 1]
        return None if math.isnan(value) else value

    def whole(self, place: int, otherwise: int | None = None) -> int | None:
        """A parameter that is to be a whole number, not below zero; `otherwise` where none is given, None where it is
        none such."""
        value = self.given(place)
        if value is None:
            return otherwise
        return int(value) if value >= 0.0 and value.is_integer() else None


@dataclass(frozen=True, slots=True)
class CommandReply:
    """What is answered to a command.

    Attributes:
        result: in the acknowledgement.
        messages: what follows it, to whoever asked.
        sentence: for people, why not.
        way: the number of the way at whose end it is over; None when it is over at once.
    """

    result: CommandResult
    messages: tuple[Message, ...] = ()
    sentence: str = ""
    way: int | None = None


class CommandCarrier(Enum):
    """Which messages may carry a command."""

    LONG = "COMMAND_LONG"
    INT = "COMMAND_INT"
    BOTH = "both"


class CommandAccess(Enum):
    """Who may give a command."""

    ANYBODY = "anybody"
    NO_RIVAL = "anybody, unless another station is in command"
    COMMANDER = "the station in command"


@dataclass(frozen=True, slots=True)
class CommandSpec:
    """A command that the vehicle knows.

    Attributes:
        do: does it.
        carrier: which messages may carry it.
        frames: in which its place may be; empty where it has no place.
        who: may give it.
        once: each time it does something anew.
    """

    do: Callable[[ReceivedCommand], CommandReply]
    carrier: CommandCarrier = CommandCarrier.BOTH
    frames: frozenset[int] = frozenset()
    who: CommandAccess = CommandAccess.ANYBODY
    once: bool = False


ACCEPTED = CommandReply(CommandResult.ACCEPTED)
MALFORMED = CommandReply(CommandResult.DENIED)
"""A parameter is none that this command can have."""

_RESULTS = {
    DenialKind.DENIED: CommandResult.DENIED,
    DenialKind.NOT_NOW: CommandResult.TEMPORARILY_REJECTED,
    DenialKind.UNSUPPORTED: CommandResult.UNSUPPORTED,
}


def reply_to(denied: Denied | None) -> CommandReply:
    """What is answered when a robot does what it is told, or why it does not."""
    return ACCEPTED if denied is None else CommandReply(_RESULTS[denied.refusal], sentence=denied.sentence)


def order_of(link: LinkId, station: Station, message: Message) -> ReceivedCommand | None:
    """The command in a message; None where it carries none."""
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
        x, y = (math.nan if value == UNSET else float(value) for value in (message.x, message.y))
        params = (message.param1, message.param2, message.param3, message.param4, x, y, message.z)
        return ReceivedCommand(link, station, message.command, params, message.frame, 0)
    return None


def decimal_of(value: float) -> float:
    """What somebody meant whose decimal number came as a float of 32 bits: 0.4, and not 0.4000000059604645."""
    return float(str(np.float32(value)))


def destination(
    order: ReceivedCommand, base_in_map: Pose2, earth: MapProjection
) -> tuple[float, float] | Denied | None:
    """The point of the map that a command means, metres east and north.

    A COMMAND_INT is in one of our frames; COMMAND_LONG has degrees, as 32-bit floats good to some decimetres.

    Returns:
        `Denied` where there is no such latitude or longitude; None where the command names no place, by leaving it out
        or by (0, 0) in degrees.
    """
    first, second = order.params[4], order.params[5]
    if math.isnan(first) or math.isnan(second):
        return None
    if order.frame is not None and order.frame not in GLOBAL:
        return point_in_map(order.frame, first / PER_METRE, second / PER_METRE, base_in_map)
    scale = PER_DEGREE if order.frame is None else 1
    place = GeoPoint(round(first * scale), round(second * scale))
    if place.is_none:
        return None
    return earth.point(place) if place.is_on_earth else Denied("There is no such place on earth.")
