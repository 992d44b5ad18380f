"""Messages of a bag or of a running session."""

from collections.abc import Mapping, Sequence
from typing import Protocol

from thbridge.ros.messages import types

TF_TYPES = frozenset({types.TFMESSAGE, "tf/tfMessage"})
"""Types of messages with frames, as named in tf2 and in the older tf."""


class WatchedMessage(Protocol):
    """Message of a topic."""

    @property
    def topic(self) -> str:
        """Topic of the message, with a leading slash."""

    @property
    def msgtype(self) -> str:
        """Type of the message, for example "nav_msgs/Odometry"."""

    @property
    def stamp_ns(self) -> int:
        """Time of the message, nanoseconds of ROS time."""

    @property
    def data(self) -> bytes:
        """Serialized content of the message."""


class TopicSnapshot(Protocol):
    """Last message of each topic at one moment."""

    @property
    def at_ns(self) -> int:
        """Time of the snapshot, nanoseconds of ROS time."""

    @property
    def topics(self) -> Mapping[str, str]:
        """Types of topics by topic name; topics without a message can be included."""

    def newest(self, topic: str) -> WatchedMessage | None:
        """Return the last message of a topic."""

    def frames(self, at_ns: int) -> Sequence[WatchedMessage]:
        """Return the tf messages that are valid at a time up to the time of the snapshot, oldest first."""
