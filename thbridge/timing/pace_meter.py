"""Real time of a game: the times of its ticks, and the lag of simulated time behind real time."""

import math
import time
from bisect import bisect_left
from collections.abc import Callable, Iterable, Sequence
from dataclasses import astuple, dataclass
from itertools import pairwise

from sim.common.observations import TICK
from thbridge.timing.pacer import Pacer

LATE = 0.1
"""Seconds after which a tick is late: people notice a delay of a tenth of a second."""

TOLERANCE = 0.05
"""Largest difference of times in a `GamePace` from the measured times, in seconds."""


@dataclass(frozen=True, slots=True)
class PaceState:
    """Real time of a game up to a tick, in seconds.

    Attributes:
        wall: real time since the first tick. If another program resumed the game, the time in between is left out.
        step: part of `wall` since the previous tick.
        lag: lag of simulated time behind real time. A pause is no lag.
        most_lag: largest lag so far.
        late: real time in which ticks came more than `LATE` after they were due.
    """

    wall: float = 0.0
    step: float = 0.0
    lag: float = 0.0
    most_lag: float = 0.0
    late: float = 0.0

    def rounded(self) -> list[float]:
        """Return the attributes in order, in seconds with three decimals."""
        return [round(each, 3) for each in astuple(self)]


@dataclass(frozen=True, slots=True)
class GamePace:
    """Pace of a game, in seconds.

    Attributes:
        wall: real time from its first to its last tick.
        most_lag: largest lag of simulated time behind real time.
        late: real time in which ticks came more than `LATE` after they were due.
        course: pairs of simulated and real time; between two pairs, interpolate linearly.
    """

    wall: float
    most_lag: float
    late: float
    course: tuple[tuple[float, float], ...]


class PaceMeter:
    """Meter of the pace of one game, tick by tick.

    Args:
        clock: monotonic clock, seconds.

    Attributes:
        state: state after the last measured tick.
    """

    def __init__(self, clock: Callable[[], float] = time.monotonic) -> None:
        self.state = PaceState()
        self._clock = clock
        self._now: float | None = None
        self._tick = 0
        self._carried = 0.0
        self._points: dict[int, float] = {}

    def go_on(self, measured: Iterable[tuple[int, PaceState]]) -> None:
        """Continue the measurement of an earlier program in the same game, given its ticks and their numbers."""
        for self._tick, self.state in measured:
            self.keep()
        # The pacer of this program starts without a lag, so the earlier lag is never made up for.
        self._carried = self.state.lag

    def measure(self, tick: int, pacer: Pacer) -> PaceState:
        """Measure the present tick; return the state after it."""
        now, before = self._clock(), self.state
        # The first tick of a program that resumes a game has no previous tick to measure from, so it counts one period.
        first = pacer.period if self._points else 0.0
        step = first if self._now is None else now - self._now
        self._now, self._tick = now, tick
        lag = self._carried + pacer.lag
        # The pacer drops delays that it does not make up for, so these show only as growth of the lag.
        late = before.late + (step if max(pacer.delay, lag - before.lag) > LATE else 0.0)
        self.state = PaceState(before.wall + step, step, lag, max(before.most_lag, lag), late)
        return self.state

    def keep(self) -> None:
        """Store the times of the last measured tick and of the tick before it."""
        if self._tick > 0:
            self._points.setdefault(self._tick - 1, self.state.wall - self.state.step)
        self._points[self._tick] = self.state.wall

    def pace(self) -> GamePace:
        """Return the pace of the game up to the last measured tick."""
        self.keep()
        points = [(round(tick * TICK, 2), round(wall, 3)) for tick, wall in sorted(self._points.items())]
        state = self.state
        return GamePace(round(state.wall, 3), round(state.most_lag, 3), round(state.late, 3), _simplified(points))


def real_time(course: Sequence[Sequence[float]], simulated: float) -> float | None:
    """Return the real time of a simulated time in a `GamePace.course`; None outside of it. All times are in seconds."""
    after = bisect_left(course, simulated, key=lambda point: point[0])
    if after == len(course) or (after == 0 and course[0][0] != simulated):
        return None
    if course[after][0] == simulated:
        return course[after][1]
    (start, begin), (stop, end) = course[after - 1 : after + 1]
    return begin + (end - begin) * (simulated - start) / (stop - start)


def _simplified(points: Sequence[tuple[float, float]]) -> tuple[tuple[float, float], ...]:
    """Return a subset of the points. Straight lines between them deviate from all other points by at most `TOLERANCE`.

    Source: Bristol, Swinging door trending: adaptive trend recording (1990).
    """
    kept = list(points[:1])
    low, high = -math.inf, math.inf
    for before, (simulated, wall) in pairwise(points):
        start, begin = kept[-1]
        if not low <= (wall - begin) / (simulated - start) <= high:
            kept.append(before)
            (start, begin), low, high = before, -math.inf, math.inf
        low = max(low, (wall - TOLERANCE - begin) / (simulated - start))
        high = min(high, (wall + TOLERANCE - begin) / (simulated - start))
    return (*kept, *points[max(len(points) - 1, 1) :])
