"""Clock that plays back a simulation's telemetry slightly behind the newest sample."""

import math
from collections import deque

WINDOW = 1.0
"""Seconds of the past from which rate and lateness are estimated."""

MIN_RATE_WINDOW = 0.2
"""Seconds that samples must span before a rate is estimated."""

FIRST_DELAY = 0.05
"""Delay in seconds before the network is known."""

CATCH_UP_BURST = 0.1
"""Seconds after a standstill in which the network may deliver all delayed samples at once."""

MAX_SAMPLES = 128
"""Largest number of kept samples, at any rate."""

MAX_DELAY = 0.06
"""Largest delay of the clock, seconds; with the latency of a network, the total stays below 0.1 s."""

EXTRAPOLATED_SHARE = 0.5
"""Share of the time between two samples for which robots are extrapolated without the next sample.

At 25 samples a second, this causes errors of millimeters, and draws robots 20 ms earlier.
"""

STANDSTILL = 0.25
"""Seconds without a sample after which simulated time or the network counts as stopped; such a pause does not affect
the rate."""

HORIZON = 0.25
"""Seconds of real time for which simulated time is assumed to continue without a sample."""

CATCH_UP = 0.15
"""Time constant for following a changed estimate, seconds."""


class PlaybackClock:
    """Clock of the simulated time to show: monotonic, smooth, and with the least delay that the network's jitter
    allows.

    Each sample has a simulated time s and the moment a of its arrival. The present time of the simulation is estimated
    as the greatest s + rate (now - a) of all samples, which is that of the samples with the shortest travel times. The
    clock's delay follows from the lateness of the slowest sample in the last second and from the time between samples,
    so that robots are not extrapolated for long.

    Attributes:
        rate: simulated seconds per second.
    """

    def __init__(self) -> None:
        self.rate = 1.0
        self._samples: deque[tuple[float, float]] = deque(maxlen=MAX_SAMPLES)
        self._delay = FIRST_DELAY
        self._time: float | None = None
        self._asked = 0.0
        self._stood_until = -math.inf

    def receive(self, time: float, now: float) -> None:
        """Add a sample with this simulated time that arrived now; its time must be later than that of the previous
        sample."""
        if self._samples and now - self._samples[-1][1] > STANDSTILL:
            self._stood_until = now
        if now < self._stood_until + CATCH_UP_BURST:
            self._samples.clear()
        while self._samples and now - self._samples[0][1] > WINDOW:
            self._samples.popleft()
        self._samples.append((time, now))
        first_time, first_now = self._samples[0]
        if now - first_now >= MIN_RATE_WINDOW:
            self.rate = (time - first_time) / (now - first_now)
            spacing = (now - first_now) / (len(self._samples) - 1)
            front = self._front(now)
            lateness = max(front - heard - self.rate * (now - at) for heard, at in self._samples) / self.rate
            self._delay = min((1.0 - EXTRAPOLATED_SHARE) * spacing + lateness, MAX_DELAY)

    def at(self, now: float) -> float:
        """Return the simulated time to show."""
        if not self._samples:
            return 0.0
        front = self._front(now)
        target = front - self.rate * self._delay
        if self._time is None:
            self._time, self._asked = target, now
            return self._time
        passed = max(now - self._asked, 0.0)
        self._asked = max(self._asked, now)
        expected = self._time + self.rate * passed
        caught_up = expected + min(passed / CATCH_UP, 1.0) * (target - expected)
        self._time = max(self._time, min(caught_up, front))
        return self._time

    def _front(self, now: float) -> float:
        """Return the simulated time reached by now, estimated from the samples with the shortest travel times."""
        front = max(time + self.rate * (now - at) for time, at in self._samples)
        newest = self._samples[-1][0]
        return min(front, newest + self.rate * HORIZON)
