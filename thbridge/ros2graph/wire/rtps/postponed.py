"""Heartbeats and requests that wait for their answer.

A datagram may contain thousands of them, and an answer takes longer than reading.
"""

from dataclasses import replace
from itertools import islice
from typing import TypeAlias

from thbridge.ros2graph.wire.rtps.submessages import Acknowledgment, FragmentRequest, Heartbeat, HeartbeatFragment

MOST_POSTPONED, MOST_ANSWERS = 4096, 256
"""Maximum number of submessages that wait for their answer, and of those that are answered at a time."""

PostponedMessage: TypeAlias = Acknowledgment | FragmentRequest | Heartbeat | HeartbeatFragment


class PostponedMessages:
    """Submessages that are answered later, the oldest first."""

    def __init__(self) -> None:
        self._messages: dict[tuple[object, ...], PostponedMessage] = {}

    def add(self, message: PostponedMessage) -> None:
        """Add a submessage. It replaces an older one of the same endpoints, because each has the whole state."""
        key = (type(message), message.writer, message.reader, getattr(message, "sequence", 0))
        before = self._messages.get(key)
        if before is None and len(self._messages) >= MOST_POSTPONED:
            return  # It is repeated by its sender.
        if isinstance(message, Heartbeat) and isinstance(before, Heartbeat) and message.final > before.final:
            message = replace(message, final=False)
        self._messages[key] = message

    def take(self) -> list[PostponedMessage]:
        """Return the submessages that are answered now."""
        return [self._messages.pop(key) for key in list(islice(self._messages, MOST_ANSWERS))]
