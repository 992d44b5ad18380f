"""Rate limiter, so that no client can flood a session, its robots' status lists, or its recording."""

import logging
from collections import Counter

from thbridge.sockets.warn_once import WarnOnce

REQUESTS_PER_TICK = 10
"""Largest number of requests of one client on one topic between two ticks. It allows 500 per second, ten times the rate
that robots need."""

_log = logging.getLogger(__name__)


class RateLimiter:
    """Counter of requests between two ticks."""

    def __init__(self) -> None:
        self._counts: Counter[tuple[str, str]] = Counter()
        self._complaints = WarnOnce(_log)

    def tick(self) -> None:
        """Reset the counts, because the session has processed the requests so far."""
        self._counts.clear()

    def admits(self, topic: str, client: str) -> bool:
        """Count a request; return False above the limit, which is logged once."""
        self._counts[topic, client] += 1
        if self._counts[topic, client] <= REQUESTS_PER_TICK:
            return True
        self._complaints.warn(
            f"{topic}: {client} sends more than {REQUESTS_PER_TICK} requests in a tick; the rest are dropped"
        )
        return False

    def is_first(self, service: str) -> bool:
        """Count a call; return True for the first in a tick. For services that need to act only once per tick."""
        self._counts[service, ""] += 1
        return self._counts[service, ""] == 1
