"""Messages of a bag or of a running session."""

from collections.abc import Mapping, Sequence
from typing import Protocol

from thbridge.ros.messages import types

TF_TYPES = frozenset({types.TFMESSAGE, "tf/tfMessage"})
"""Types of messages with frames; the second is the name in tf, before tf2."""


class WatchedMessage(Protocol):
    """Message of a topic."""

    @property
    def topic(self) -> str:
        """Its topic, with a leading slash."""

    @property
    def msgtype(self) -> str:
        """Its type, for example "nav_msgs/Odometry"."""

    @property
    def stamp_ns(self) -> int:
        """Its time, nanoseconds of ROS time."""

    @property
    def data(self) -> bytes:
        """Its bytes."""


class TopicSnapshot(Protocol):
    """Last message of each topic at one moment."""

    @property
    def at_ns(self) -> int:
        """Moment, nanoseconds of ROS time."""

    @property
    def topics(self) -> Mapping[str, str]:
        """Type of each topic, by its name; topics without a message can be included."""

    def newest(self, topic: str) -> WatchedMessage | None:
        """Return the last message of a topic."""

    def frames(self, at_ns: int) -> Sequence[WatchedMessage]:
        """Return tf messages with the frames at a time that is not later than this moment, oldest first."""
