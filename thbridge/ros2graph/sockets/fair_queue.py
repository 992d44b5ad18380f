"""Queue of datagrams in which each sender gets its part of the processor time.

Source: M. Shreedhar, G. Varghese, "Efficient fair queuing using deficit round robin", SIGCOMM 1995. The cost of a
datagram is its processor time, which is known only after it was processed.
"""

from collections import OrderedDict, deque
from dataclasses import dataclass, field
from typing import NamedTuple, TypeAlias

SHARE = 0.4
"""Fraction of a processor for the datagrams of all senders together."""
BURST_NS = 100_000_000
"""Processor time for datagrams at once. Discovery of a participant with hundreds of endpoints takes less."""
MOST_BYTES = 4 << 20
"""Maximum number of bytes that wait, with those that each datagram needs in addition to its content."""
MOST_SENDERS = 128
"""Maximum number of senders with their own turns. Further ones share the turns of one sender."""

_TURN_NS = 1_000_000
_OVERHEAD = 256
_OTHERS = ("", 0)

Sender: TypeAlias = tuple[str, int]
"""Host and port."""


class QueuedDatagram(NamedTuple):
    """Datagram that waits.

    Attributes:
        turn: sender whose turn it uses.
        host: host that sent it.
        content: its bytes.
    """

    turn: Sender
    host: str
    content: bytes


@dataclass(slots=True)
class _Line:
    """Datagrams of a sender, their bytes, and the processor time that is left of its turn."""

    datagrams: deque[QueuedDatagram] = field(default_factory=deque)
    size: int = 0
    left_ns: int = _TURN_NS


class FairQueue:
    """Datagrams that wait until they are processed. The senders take turns of equal processor time.

    A sender gets all the time that others do not need: a busy simulation or a fleet needs it. If a sender sends too
    much, only its own datagrams wait and are lost. Reliable writers and readers repeat what was lost. Senders are
    addresses, because a datagram can contain the id of any participant.
    """

    def __init__(self) -> None:
        self._lines: OrderedDict[Sender, _Line] = OrderedDict()
        self._size = 0
        self._left_ns = BURST_NS
        self._now_ns = 0

    def add(self, sender: Sender, content: bytes) -> str | None:
        """Add a datagram. Return the host whose datagrams were dropped for it, if there were too many."""
        turn = sender if sender in self._lines or len(self._lines) < MOST_SENDERS else _OTHERS
        line = self._lines.setdefault(turn, _Line())
        line.datagrams.append(QueuedDatagram(turn, sender[0], content))
        self._resize(line, len(content) + _OVERHEAD)
        host = None
        while self._size > MOST_BYTES:
            longest = max(self._lines.values(), key=lambda each: each.size)
            host = self._remove(longest, longest.datagrams.pop()).host
        return host

    def take(self) -> QueuedDatagram | None:
        """Remove and return the next datagram. None if none waits, or if there is no time for it now."""
        if not self._lines or self._left_ns <= 0:
            return None
        while (line := next(iter(self._lines.values()))).left_ns <= 0:
            line.left_ns += _TURN_NS
            self._lines.move_to_end(next(iter(self._lines)))
        return self._remove(line, line.datagrams.popleft())

    def spend(self, turn: Sender, ns: int) -> None:
        """Count the processor time of a datagram that was taken, nanoseconds."""
        self._left_ns -= ns
        if turn in self._lines:
            self._lines[turn].left_ns -= ns

    def advance(self, now_ns: int) -> None:
        """Give the senders the time since the last call, even if this program was busy for long."""
        self._left_ns = min(BURST_NS, self._left_ns + int(SHARE * (now_ns - self._now_ns)))
        self._now_ns = now_ns

    def _remove(self, line: _Line, datagram: QueuedDatagram) -> QueuedDatagram:
        self._resize(line, -len(datagram.content) - _OVERHEAD)
        if not line.datagrams:
            del self._lines[datagram.turn]
        return datagram

    def _resize(self, line: _Line, size: int) -> None:
        line.size += size
        self._size += size
