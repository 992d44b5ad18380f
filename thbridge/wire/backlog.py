"""What waits for a reader that is slower than what it reads: whole messages, so many bytes of them, and no more."""

from collections import OrderedDict, defaultdict, deque
from typing import NamedTuple

LIMIT = 8 * 2**20
"""Bytes that may wait."""


class _Waiting(NamedTuple):
    channel: int
    record: bytes


class Backlog:
    """Records of several channels in order. Of what is too much, the heaviest channel's oldest are dropped.

    The newest record of a latched channel is never dropped: it may be the only one for a long time. So what waits is
    bounded by the limit and these.

    Args:
        limit: bytes that may wait.

    Attributes:
        dropped: records so far.
        size: bytes that wait.
    """

    def __init__(self, limit: int = LIMIT) -> None:
        self.dropped = 0
        self.size = 0
        self._limit = limit
        self._waiting: OrderedDict[int, _Waiting] = OrderedDict()
        self._of_channel: defaultdict[int, deque[int]] = defaultdict(deque)
        self._weights: defaultdict[int, int] = defaultdict(int)
        self._latched: set[int] = set()
        self._number = 0

    def put(self, channel: int, record: bytes, latched: bool) -> None:
        """Let a record wait; it may be one of those that are dropped for it."""
        self._number += 1
        self._waiting[self._number] = _Waiting(channel, record)
        self._of_channel[channel].append(self._number)
        self._weights[channel] += len(record)
        self.size += len(record)
        if latched:
            self._latched.add(channel)
        while self.size > self._limit and self._drop_from_heaviest():
            pass

    def take(self, size: int) -> list[tuple[int, bytes]]:
        """The oldest records, by channel, until they are as many bytes as this or more."""
        taken: list[tuple[int, bytes]] = []
        while self._waiting and size > 0:
            _, (channel, record) = self._waiting.popitem(last=False)
            self._of_channel[channel].popleft()
            self._weights[channel] -= len(record)
            self.size -= len(record)
            size -= len(record)
            taken.append((channel, record))
        return taken

    def _drop_from_heaviest(self) -> bool:
        """Drop the older half of a channel; whether there was one to drop from."""
        channel = max(self._of_channel, key=self._droppable_bytes)
        droppable = self._droppable(channel)
        for _ in range((droppable + 1) // 2):
            record = self._waiting.pop(self._of_channel[channel].popleft()).record
            self._weights[channel] -= len(record)
            self.size -= len(record)
            self.dropped += 1
        return droppable > 0

    def _droppable(self, channel: int) -> int:
        return max(len(self._of_channel[channel]) - (channel in self._latched), 0)

    def _droppable_bytes(self, channel: int) -> int:
        of_channel = self._of_channel[channel]
        if not of_channel or channel not in self._latched:
            return self._weights[channel]
        return self._weights[channel] - len(self._waiting[of_channel[-1]].record)
