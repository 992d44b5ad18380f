"""Clock that plays back a simulation's telemetry with a short delay."""

import math
from collections import deque

WINDOW = 1.0
"""Duration in seconds of the past samples from which rate and lateness are estimated."""

MIN_RATE_WINDOW = 0.2
"""Duration in seconds that the samples must cover before a rate is estimated."""

FIRST_DELAY = 0.05
"""Delay in seconds that is used until the latency of the network is known."""

CATCH_UP_BURST = 0.1
"""Time after a standstill within which the network may deliver all delayed samples at once, seconds."""

MAX_SAMPLES = 128
"""Maximum number of stored samples."""

MAX_DELAY = 0.06
"""Largest delay of the clock, seconds. Together with the latency of a network, it stays below 0.1 s."""

EXTRAPOLATED_SHARE = 0.5
"""Robots are extrapolated during this share of the time between two samples, until the next sample arrives.

At 25 samples per second, robots are drawn 20 ms earlier because of this, with errors of some millimeters.
"""

STANDSTILL = 0.25
"""If no sample arrives for this number of seconds, simulated time or the network counts as stopped.

The estimate of the rate ignores longer pauses.
"""

HORIZON = 0.25
"""Longest real time in seconds for which simulated time is assumed to continue without a sample."""

CATCH_UP = 0.15
"""Time constant with which the clock approaches a changed estimate, seconds."""


class PlaybackClock:
    """Monotonic and smooth clock of the simulated time to show, with the least delay that the network's jitter allows.

    Each sample has a simulated time s and a time of arrival a. The present time of the simulation is estimated as the
    greatest s + rate (now - a) of all samples. The samples with the shortest travel times have this value. The clock's
    delay depends on the lateness of the slowest sample in the last second and on the time between samples. So robots
    are extrapolated only for a short time.

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
        """Add a sample that arrives now; its simulated time must be later than the time of the previous sample."""
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
        """Return the simulation's present time, estimated from the samples with the shortest travel times."""
        front = max(time + self.rate * (now - at) for time, at in self._samples)
        newest = self._samples[-1][0]
        return min(front, newest + self.rate * HORIZON)
