"""Shares of the processor for the datagrams of each participant."""

from collections import Counter

PER_TICK_NS, BURST_NS = 2_500_000, 100_000_000
"""Processor time for the datagrams of a participant: per tick of 25 ms, and at once. Discovery of a participant with
hundreds of endpoints takes less."""


class ReadingShares:
    """Processor time that the datagrams of each participant have used.

    A participant that sends too much loses datagrams, and those of others are still processed. Reliable writers and
    readers repeat what was lost.
    """

    def __init__(self) -> None:
        self._spent_ns: Counter[bytes] = Counter()

    def has_time(self, participant: bytes) -> bool:
        """Return True if a datagram of a participant may be processed."""
        return self._spent_ns[participant] < BURST_NS

    def spend(self, participant: bytes, ns: int) -> None:
        """Count processor time, nanoseconds."""
        self._spent_ns[participant] += ns

    def tick(self) -> None:
        """Give each participant the time of a tick."""
        self._spent_ns.subtract(dict.fromkeys(self._spent_ns, PER_TICK_NS))
        self._spent_ns = +self._spent_ns
