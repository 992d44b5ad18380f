"""Limits for clients of the gateway: rates by address or secret, and a log that repeats no warning at once."""

import ipaddress
import logging
import time
from collections.abc import Callable
from dataclasses import dataclass, field

WARNING_PERIOD = 60.0
"""Seconds after which a warning is logged again."""
MOST_REMEMBERED = 4096
"""Maximum number of keys that a limit or a log remembers; then it forgets the key that was used least recently."""


def network_of(host: str) -> str:
    """Return the address of a client, or the network of an IPv6 client: one person has all 2^64 addresses of it."""
    try:
        address = ipaddress.ip_address(host.partition("%")[0])
    except ValueError:
        return host
    if isinstance(address, ipaddress.IPv4Address):
        return str(address)
    if address.ipv4_mapped is not None:
        return str(address.ipv4_mapped)
    return str(ipaddress.ip_network((address, 64), strict=False))


class RateLimit:
    """Limit for each key: `burst` requests at once, then `rate` requests per second.

    Args:
        burst: number of requests without a pause.
        rate: requests per second after the burst.
        clock: monotonic clock, seconds.
    """

    def __init__(self, burst: float, rate: float, clock: Callable[[], float] = time.monotonic) -> None:
        self._burst, self._rate = burst, rate
        self._clock = clock
        self._left: dict[str, tuple[float, float]] = {}
        # For each key, the number of requests that were left at a time. The key used least recently is the first.

    def admits(self, key: str, cost: float = 1.0) -> bool:
        """Count a request; return False if it exceeds the limit. A refused request does not count."""
        if self.delay(key, cost) > 0.0:
            return False
        self.take(key, cost)
        return True

    def delay(self, key: str, cost: float = 1.0) -> float:
        """Return the number of seconds after which a request is within the limit."""
        return max(0.0, (cost - self._now_left(key)) / self._rate)

    def take(self, key: str, cost: float = 1.0) -> None:
        """Count a request, even if it exceeds the limit."""
        left = self._now_left(key) - cost
        self._left.pop(key, None)
        if len(self._left) >= MOST_REMEMBERED:
            del self._left[next(iter(self._left))]
        self._left[key] = (left, self._clock())

    def _now_left(self, key: str) -> float:
        left, at = self._left.get(key, (self._burst, 0.0))
        return min(self._burst, left + (self._clock() - at) * self._rate)


class RefusalLog:
    """Log of refused clients: it repeats a warning about the same client only after a period.

    Args:
        log: receiver of the warnings.
        clock: monotonic clock, seconds.
    """

    def __init__(self, log: logging.Logger, clock: Callable[[], float] = time.monotonic) -> None:
        self._log = log
        self._clock = clock
        self._given: dict[str, float] = {}

    def warn(self, warning: str) -> None:
        """Log a warning. If it was logged within the period, or there were too many warnings, the debug log gets it."""
        now = self._clock()
        self._given = {text: at for text, at in self._given.items() if now - at < WARNING_PERIOD}
        if warning in self._given or len(self._given) >= MOST_REMEMBERED:
            self._log.debug("%s", warning)
            return
        self._given[warning] = now
        self._log.warning("%s", warning)


@dataclass(frozen=True, slots=True)
class ClientLimits:
    """Limits of the gateway. They let a class of 100 people begin at once from one address.

    Attributes:
        pages: loads of pages and files, by address.
        sockets: connected sockets, by address.
        tabs: connected sockets, by secret.
        messages: messages, by secret. The server reads further messages later.
        failures: wrong codes, keys and messages, by address.
        refusals: log of refused clients.
    """

    pages: RateLimit = field(default_factory=lambda: RateLimit(3000.0, 50.0))
    sockets: RateLimit = field(default_factory=lambda: RateLimit(600.0, 20.0))
    tabs: RateLimit = field(default_factory=lambda: RateLimit(30.0, 1.0))
    messages: RateLimit = field(default_factory=lambda: RateLimit(300.0, 60.0))
    failures: RateLimit = field(default_factory=lambda: RateLimit(30.0, 0.2))
    refusals: RefusalLog = field(default_factory=lambda: RefusalLog(logging.getLogger(__name__)))
