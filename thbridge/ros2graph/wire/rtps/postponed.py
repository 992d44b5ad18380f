"""Heartbeats and requests that wait for their answer.

A datagram may contain thousands of them, and an answer takes longer than reading. So participants take turns, and none
can fill the places of the others.
"""

from collections import OrderedDict
from dataclasses import replace
from typing import TypeAlias

from thbridge.ros2graph.wire.rtps.guids import PREFIX_SIZE
from thbridge.ros2graph.wire.rtps.submessages import Acknowledgment, FragmentRequest, Heartbeat, HeartbeatFragment

MOST_POSTPONED, MOST_ANSWERS = 4096, 256
"""Maximum number of submessages that wait for their answer, and of those that are answered at a time."""

PostponedMessage: TypeAlias = Acknowledgment | FragmentRequest | Heartbeat | HeartbeatFragment


class PostponedMessages:
    """Submessages that are answered later: one of each participant in turn, its oldest first."""

    def __init__(self) -> None:
        self._of: OrderedDict[bytes, OrderedDict[tuple[object, ...], PostponedMessage]] = OrderedDict()
        self._count = 0

    def add(self, message: PostponedMessage) -> None:
        """Add a submessage. It replaces an older one of the same endpoints, because each has the whole state."""
        sender = message.reader if isinstance(message, Acknowledgment | FragmentRequest) else message.writer
        own = self._of.setdefault(sender[:PREFIX_SIZE], OrderedDict())
        key = (type(message), message.writer, message.reader, getattr(message, "sequence", 0))
        before = own.get(key)
        if before is None:
            if self._count >= MOST_POSTPONED:
                # What is dropped is repeated by its sender.
                largest = max(self._of.values(), key=len)
                if len(largest) <= len(own):
                    return
                largest.popitem()
                self._count -= 1
            self._count += 1
        elif isinstance(message, Heartbeat) and isinstance(before, Heartbeat) and message.final > before.final:
            message = replace(message, final=False)
        own[key] = message

    def take(self) -> list[PostponedMessage]:
        """Return the submessages that are answered now."""
        taken: list[PostponedMessage] = []
        while self._of and len(taken) < MOST_ANSWERS:
            sender, own = next(iter(self._of.items()))
            self._of.move_to_end(sender)
            if own:
                taken.append(own.popitem(last=False)[1])
            else:
                del self._of[sender]
        self._count -= len(taken)
        return taken
