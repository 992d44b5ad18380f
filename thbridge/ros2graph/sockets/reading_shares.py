"""Shares of the processor for the datagrams of each participant."""

from collections import Counter

SHARE, SHARE_OF_ALL = 0.1, 0.4
"""Fractions of a processor: for the datagrams of each participant, and for those of all together."""
BURST_NS = 100_000_000
"""Processor time for the datagrams of a participant at once, and of all. Discovery of a participant with hundreds of
endpoints takes less."""

_STEP_NS = 5_000_000


class ReadingShares:
    """Processor time that the datagrams of each participant have used.

    A participant gets more than its share while all together use less than theirs: a busy simulation or a fleet needs
    it. If participants send too much, they lose datagrams, and those of others are still processed. Reliable writers
    and readers repeat what was lost.
    """

    def __init__(self) -> None:
        self._spent_ns: Counter[bytes] = Counter()
        self._spent_by_all_ns = 0
        self._now_ns = 0

    def has_time(self, participant: bytes) -> bool:
        """Return True if a datagram of a participant may be processed."""
        return self._spent_by_all_ns < BURST_NS or self._spent_ns[participant] < BURST_NS

    def spend(self, participant: bytes, ns: int) -> None:
        """Count processor time, nanoseconds."""
        self._spent_ns[participant] = min(self._spent_ns[participant] + ns, BURST_NS)
        self._spent_by_all_ns = min(self._spent_by_all_ns + ns, BURST_NS)

    def advance(self, now_ns: int) -> None:
        """Give all participants the time since the last call, even if this program was busy for long."""
        elapsed_ns = now_ns - self._now_ns
        if elapsed_ns >= _STEP_NS:
            self._now_ns = now_ns
            self._spent_ns.subtract(dict.fromkeys(self._spent_ns, int(SHARE * elapsed_ns)))
            self._spent_ns = +self._spent_ns
            self._spent_by_all_ns = max(self._spent_by_all_ns - int(SHARE_OF_ALL * elapsed_ns), 0)
