"""Goals of actionlib: their names, and how they stand."""

from enum import IntEnum
from typing import NamedTuple


class GoalStatusCode(IntEnum):
    """How a goal stands, in the codes of actionlib_msgs/GoalStatus."""

    PENDING = 0
    ACTIVE = 1
    PREEMPTED = 2
    SUCCEEDED = 3
    ABORTED = 4
    REJECTED = 5
    PREEMPTING = 6
    RECALLING = 7
    RECALLED = 8
    LOST = 9


ENDED = frozenset(
    {
        GoalStatusCode.PREEMPTED,
        GoalStatusCode.SUCCEEDED,
        GoalStatusCode.ABORTED,
        GoalStatusCode.REJECTED,
        GoalStatusCode.RECALLED,
        GoalStatusCode.LOST,
    }
)
"""What a goal does not come back from."""


class GoalId(NamedTuple):
    """actionlib_msgs/GoalID: the name that a client gave its goal, and when it did (nanoseconds of ROS time)."""

    id: str
    stamp_ns: int


class GoalStatus(NamedTuple):
    """actionlib_msgs/GoalStatus: how a goal stands, and why, for people."""

    goal: GoalId
    status: GoalStatusCode
    text: str
