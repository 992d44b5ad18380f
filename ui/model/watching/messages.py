"""Messages as they are watched, whether they come from a bag or from a session that runs."""

from collections.abc import Mapping, Sequence
from typing import Protocol

from thbridge.ros.messages import types

TF_TYPES = frozenset({types.TFMESSAGE, "tf/tfMessage"})
"""Messages of frames; the second is tf's name for them, before tf2."""


class WatchedMessage(Protocol):
    """A message."""

    @property
    def topic(self) -> str:
        """Its topic, with a leading slash."""

    @property
    def msgtype(self) -> str:
        """Its type, for example "nav_msgs/Odometry"."""

    @property
    def stamp_ns(self) -> int:
        """When it was said, nanoseconds of ROS time."""

    @property
    def data(self) -> bytes:
        """Its bytes."""


class TopicSnapshot(Protocol):
    """How things stand at one moment: of each topic the last message that was said until then."""

    @property
    def at_ns(self) -> int:
        """The moment, nanoseconds of ROS time."""

    @property
    def topics(self) -> Mapping[str, str]:
        """The type of each topic, by its name; those on which nothing has been said yet may be among them."""

    def newest(self, topic: str) -> WatchedMessage | None:
        """The last message of a topic."""

    def frames(self, at_ns: int) -> Sequence[WatchedMessage]:
        """Of the frames of tf that held at a time not later than this moment: messages that say them, oldest first."""
