"""Changes of real robots that people must know: parts that become silent or send messages again."""

from dataclasses import dataclass, field
from enum import Enum, auto
from typing import Generic, TypeVar

from thbridge.ros.remote.names import RemoteNames

State = TypeVar("State")

SETTLED_NS = 1_000_000_000
"""Time for which a change must last before it is reported. So simultaneous failures appear in one line."""


class RobotPart(Enum):
    """Part of a robot that may become silent."""

    ODOMETRY = auto()
    NAVIGATION = auto()
    LOCALIZATION = auto()


@dataclass(slots=True)
class SettledState(Generic[State]):
    """State whose changes count only after they have lasted for some time.

    Attributes:
        settled: last state that has lasted long enough.
    """

    settled: State
    _newest: State = field(init=False)
    _since_ns: int = field(init=False, default=0)

    def __post_init__(self) -> None:
        self._newest = self.settled

    def take(self, state: State, now_ns: int) -> bool:
        """Update the present state. Return True when a new state has lasted long enough to become the settled state."""
        if state != self._newest:
            self._newest, self._since_ns = state, now_ns
        if state == self.settled or now_ns - self._since_ns < SETTLED_NS:
            return False
        self.settled = state
        return True


def sentence_of_change(robot: str, named: RemoteNames, before: frozenset[RobotPart], now: frozenset[RobotPart]) -> str:
    """Return the sentence about parts of a robot that have become silent or send messages again.

    Args:
        robot: name of the robot for people.
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
