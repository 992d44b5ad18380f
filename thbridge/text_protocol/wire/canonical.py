"""Canonical content of the commands to SimR and of SimR's answer, as HRTeam defined them in 2015.

Positions are meters in the map frame. Headings are radians here, and degrees on the wire (0 is East, counterclockwise).
Numbers on the wire have three decimals.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from enum import Enum
from typing import TypeAlias

from sim.numerics.elementary import wrap_angle
from thbridge.text_protocol.values.dialect import Dialect
from thbridge.text_protocol.wire import legacy
from thbridge.text_protocol.wire.lines import TextCommand, TextMessage, UnreadableText


class MoveDirection(Enum):
    """Direction of driving by hand. The values are the letters on the wire."""

    FORWARD = "F"
    BACKWARD = "B"
    WIDE_CLOCKWISE = "C"
    WIDE_ANTICLOCKWISE = "A"
    TURN_CLOCKWISE = "c"
    TURN_ANTICLOCKWISE = "a"


@dataclass(frozen=True, slots=True)
class PoseReport:
    """Pose of a robot."""

    robot: int
    x: float
    y: float
    heading: float


@dataclass(frozen=True, slots=True)
class PoseQuery:
    """Request for a robot's pose."""

    robot: int


@dataclass(frozen=True, slots=True)
class GotoPoint:
    """Order to drive to a point. If `heading` is None, any heading is allowed."""

    robot: int
    x: float
    y: float
    heading: float | None = None


@dataclass(frozen=True, slots=True)
class MoveByHand:
    """Order to drive by hand.

    Raises:
        ValueError: the intensity is not 1 to 5.
    """

    robot: int
    drive: MoveDirection
    intensity: int

    def __post_init__(self) -> None:
        if not 1 <= self.intensity <= 5:
            raise ValueError(f"the intensity is 1 to 5, not {self.intensity}")


CanonicalValue: TypeAlias = PoseReport | PoseQuery | GotoPoint | MoveByHand


def encode(value: CanonicalValue, sender: str, receiver: str) -> TextMessage:
    """Return the message that contains a value.

    Raises:
        ValueError: a number is not finite.
    """
    command, parts = _content(value)
    return TextMessage(command, sender, receiver, tuple(parts))


def decode(message: TextMessage) -> CanonicalValue | UnreadableText:
    """Return the value in a message, or the reason why it cannot be read."""
    try:
        value = _value(message)
    except ValueError as error:
        return UnreadableText(message.line(), str(error))
    if value is None:
        return UnreadableText(message.line(), f"its content is not that of {message.command}")
    return value


def decode_goto(message: TextMessage, dialect: Dialect, rooms: int) -> legacy.GotoRoom | GotoPoint | UnreadableText:
    """Return the room or point to which a ``%%goto`` sends a robot.

    In the legacy dialect, the target is a room if x and y are the same whole number below `rooms` and the heading is
    45. In every other case, the target is a point.
    """
    if dialect is Dialect.LEGACY_2016:
        value = legacy.decode(message)
        if isinstance(value, legacy.GotoRoom) and value.room < rooms:
            return value
    point = decode(message)
    if isinstance(point, GotoPoint | UnreadableText):
        return point
    return UnreadableText(message.line(), f"it is not a {TextCommand.GOTO}")


def _content(value: CanonicalValue) -> tuple[TextCommand, list[str]]:
    match value:
        case PoseReport(robot, x, y, heading):
            return TextCommand.POSE, [str(robot), _number(x), _number(y), _degrees(heading)]
        case PoseQuery(robot):
            return TextCommand.WHERE, [str(robot)]
        case GotoPoint(robot, x, y, heading):
            return TextCommand.GOTO, [
                str(robot),
                _number(x),
                _number(y),
                *([] if heading is None else [_degrees(heading)]),
            ]
        case MoveByHand(robot, drive, intensity):
            return TextCommand.MOVE, [str(robot), drive.value, str(intensity)]


def _value(message: TextMessage) -> CanonicalValue | None:
    match message.command, message.content:
        case TextCommand.POSE, (robot, x, y, heading):
            return PoseReport(_robot(robot), _real(x), _real(y), _radians(heading))
        case TextCommand.WHERE, (robot,):
            return PoseQuery(_robot(robot))
        case TextCommand.GOTO, (robot, x, y):
            return GotoPoint(_robot(robot), _real(x), _real(y))
        case TextCommand.GOTO, (robot, x, y, heading):
            return GotoPoint(_robot(robot), _real(x), _real(y), _radians(heading))
        case TextCommand.MOVE, (robot, letter, intensity):
            return MoveByHand(_robot(robot), MoveDirection(letter), _whole(intensity))
        case _:
            return None


def _number(value: float) -> str:
    if not math.isfinite(value):
        raise ValueError(f"{value} is not a number that can be sent")
    # Rounding may return -0.0. Adding 0.0 turns this into 0.0, so that the wire never shows "-0.000".
    return f"{round(value, 3) + 0.0:.3f}"


def _degrees(heading: float) -> str:
    return _number(math.degrees(heading))


def _whole(text: str) -> int:
    # `int` alone would also accept blanks, underscores, other scripts' digits, and numbers of any length.
    if not (text.isascii() and text.removeprefix("-").isdigit() and len(text) <= 10):
        raise ValueError(f"{text!r} is not a whole number")
    return int(text)


def _robot(text: str) -> int:
    number = _whole(text)
    if number < 0:
        raise ValueError(f"{text!r} is not a robot's number")
    return number


def _real(text: str) -> float:
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        raise ValueError(f"{text!r} is not a number")
    return value


def _radians(text: str) -> float:
    return wrap_angle(math.radians(_real(text)))
