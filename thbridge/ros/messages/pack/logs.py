"""Messages for people who supervise the robots: clock, log, diagnostics."""

from collections.abc import Mapping, Sequence
from enum import IntEnum
from typing import NamedTuple

from thbridge.ros.messages.pack.fields import UINT32, header, name, stamp, string
from thbridge.ros.messages.records import LogLine
from thbridge.ros.messages.stamps import stamp_ns


class DiagnosticLevel(IntEnum):
    """Severity of a diagnostic, in the codes of diagnostic_msgs/DiagnosticStatus."""

    OK = 0
    WARN = 1
    ERROR = 2
    STALE = 3


class DiagnosticStatus(NamedTuple):
    """diagnostic_msgs/DiagnosticStatus: the state of one part of a robot.

    Attributes:
        level: severity.
        name: name of the part, for example "robot1: energy".
        message: its state in one or two words.
        hardware_id: name of the robot.
        values: measured values as text, by name.
    """

    level: DiagnosticLevel
    name: str
    message: str
    hardware_id: str
    values: Mapping[str, str]


def clock(tick: int) -> bytes:
    """Encode rosgraph_msgs/Clock."""
    return stamp(stamp_ns(tick))


def log(tick: int, line: LogLine) -> bytes:
    """Encode rosgraph_msgs/Log. The fields file, function, line and topics are empty."""
    return b"".join(
        (
            header(tick),
            bytes((line.level,)),
            string(line.name),
            string(line.text),
            string(""),
            string(""),
            UINT32.pack(0),
            UINT32.pack(0),
        )
    )


def diagnostic_array(tick: int, entries: Sequence[DiagnosticStatus]) -> bytes:
    """Encode diagnostic_msgs/DiagnosticArray."""
    return header(tick) + UINT32.pack(len(entries)) + b"".join(map(_diagnosis, entries))


def _diagnosis(entry: DiagnosticStatus) -> bytes:
    values = [name(key) + string(value) for key, value in entry.values.items()]
    return b"".join(
        (
            bytes((entry.level,)),
            name(entry.name),
            name(entry.message),
            name(entry.hardware_id),
            UINT32.pack(len(values)),
            *values,
        )
    )
