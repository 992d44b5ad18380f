"""How much clients may ask of a session: none of them can flood it, its robots' status lists, or its recording."""

import logging
from collections import Counter

from thbridge.sockets.rosgraph.connections import WarnOnce

REQUESTS_PER_TICK = 10
"""What one client may ask by one topic between two ticks: 500 commands a second, ten times what a robot can obey."""

_log = logging.getLogger(__name__)


class RateLimiter:
    """Counts what comes in between two ticks."""

    def __init__(self) -> None:
        self._asked: Counter[tuple[str, str]] = Counter()
        self._complaints = WarnOnce(_log)

    def tick(self) -> None:
        """What came in so far is taken; count anew."""
        self._asked.clear()

    def admits(self, topic: str, client: str) -> bool:
        """Whether a client may ask once more; the log says once that it may not."""
        self._asked[topic, client] += 1
        if self._asked[topic, client] <= REQUESTS_PER_TICK:
            return True
        self._complaints.tell(
            f"{topic}: {client} asks more than {REQUESTS_PER_TICK} times in a tick; what is more is dropped"
        )
        return False

    def is_first(self, service: str) -> bool:
        """Whether something is asked for the first time; for what is the same once and more often in a tick."""
        self._asked[service, ""] += 1
        return self._asked[service, ""] == 1
