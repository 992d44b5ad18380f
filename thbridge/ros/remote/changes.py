"""Changes of real robots that people must know about: parts that become silent or come back."""

from dataclasses import dataclass, field
from enum import Enum, auto
from typing import Generic, TypeVar

from thbridge.ros.remote.names import RemoteNames

State = TypeVar("State")

SETTLED_NS = 1_000_000_000
"""Time for which a change must last before it is reported, so that simultaneous failures appear in one line."""


class RobotPart(Enum):
    """Part of a robot that may become silent."""

    ODOMETRY = auto()
    NAVIGATION = auto()
    LOCALIZATION = auto()


@dataclass(slots=True)
class SettledState(Generic[State]):
    """A state. A change of it counts only after it has lasted for some time.

    Attributes:
        settled: the last state that has lasted long enough.
    """

    settled: State
    _newest: State = field(init=False)
    _since_ns: int = field(init=False, default=0)

    def __post_init__(self) -> None:
        self._newest = self.settled

    def take(self, state: State, now_ns: int) -> bool:
        """Update the current state; return True once it differs from the settled state and has lasted long enough."""
        if state != self._newest:
            self._newest, self._since_ns = state, now_ns
        if state == self.settled or now_ns - self._since_ns < SETTLED_NS:
            return False
        self.settled = state
        return True


def sentence_of_change(robot: str, named: RemoteNames, before: frozenset[RobotPart], now: frozenset[RobotPart]) -> str:
    """Return the sentence about a robot with parts that have become silent or come back.

    Args:
        robot: the robot in words.
        named: its topics and frames.
        before: its silent parts before.
        now: its silent parts now.
    """
    status = named.action("status")
    words = {
        RobotPart.ODOMETRY: ("it is silent: no more odometry", "its odometry is back"),
        RobotPart.NAVIGATION: (
            f"its navigation is silent: no more messages on {status}",
            f"its navigation is back on {status}",
        ),
        RobotPart.LOCALIZATION: ("it no longer knows where it is", "it knows where it is again"),
    }
    gone = [words[part][0] for part in RobotPart if part in now - before]
    back = [words[part][1] for part in RobotPart if part in before - now]
    return f"{robot}: {'; '.join([*gone, *back])}"
