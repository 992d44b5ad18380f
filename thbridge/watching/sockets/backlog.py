"""Bounded queue of complete messages for a slow reader; when the queue is full, old messages are dropped."""

from collections import OrderedDict, defaultdict, deque
from typing import NamedTuple

LIMIT = 8 * 2**20
"""Maximum number of queued bytes."""


class _Waiting(NamedTuple):
    channel: int
    record: bytes


class Backlog:
    """Queue of records of several channels; above the limit, the oldest records of the largest channel are dropped.

    The newest record of a latched channel is never dropped, because it may be the only record for a long time. So the
    size of the queue is at most the limit plus the size of these records.

    Args:
        limit: maximum number of queued bytes.

    Attributes:
        dropped: number of records dropped so far.
        size: number of queued bytes.
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
        """Append a record. If the queue is then above the limit, drop records, possibly also the new record."""
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
        """Remove and return the oldest records, with at least `size` bytes in total, each with its channel."""
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
        """Drop the older half of the largest channel; return False if no record may be dropped."""
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
