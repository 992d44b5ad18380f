"""Ids and states of actionlib's goals."""

from enum import IntEnum
from typing import NamedTuple


class GoalStatusCode(IntEnum):
    """State of a goal, in the codes of actionlib_msgs/GoalStatus."""

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
"""Final states of a goal."""


class GoalId(NamedTuple):
    """actionlib_msgs/GoalID: the id that a client gave to its goal, and the time stamp in nanoseconds of ROS time."""

    id: str
    stamp_ns: int


class GoalStatus(NamedTuple):
    """actionlib_msgs/GoalStatus: the state of a goal, with the reason for people."""

    goal: GoalId
    status: GoalStatusCode
    text: str
