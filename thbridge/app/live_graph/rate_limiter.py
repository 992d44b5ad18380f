"""Rate limiter, which protects a session, the robots' status lists and the recording from floods of requests."""

import logging
from collections import Counter

from thbridge.sockets.warn_once import WarnOnce

REQUESTS_PER_TICK = 10
"""Maximum number of requests of one client on one topic between two ticks.

This is 500 requests per second. Robots need a tenth of this number.
"""

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
        """Count a request. Return False and log a warning (only once) if the count is above the limit."""
        self._counts[topic, client] += 1
        if self._counts[topic, client] <= REQUESTS_PER_TICK:
            return True
        self._complaints.warn(
            f"{topic}: {client} sends more than {REQUESTS_PER_TICK} requests in a tick; further requests are dropped"
        )
        return False

    def is_first(self, service: str) -> bool:
        """Count a call of a service that must act only once per tick; return True for the first call in a tick."""
        self._counts[service, ""] += 1
        return self._counts[service, ""] == 1
