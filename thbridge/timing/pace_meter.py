"""Real time of a game: times of ticks, and lag of simulated time behind real time."""

import math
import time
from bisect import bisect_left
from collections.abc import Callable, Iterable, Sequence
from dataclasses import astuple, dataclass
from itertools import pairwise

from sim.common.observations import TICK
from thbridge.timing.pacer import Pacer

LATE = 0.1
"""A tick counts as late if its delay is above this, seconds. People notice a delay of 0.1 s."""

TOLERANCE = 0.05
"""Largest difference in seconds between times in a `GamePace` and measured times."""


@dataclass(frozen=True, slots=True)
class PaceState:
    """Real time of a game up to a tick, in seconds.

    Attributes:
        wall: real time since the first tick. If another program resumed the game, the time between the programs does
            not count.
        step: part of `wall` since the previous tick.
        lag: lag of simulated time behind real time. A pause does not count as lag.
        most_lag: largest lag so far.
        late: real time in which ticks were late by more than `LATE`.
    """

    wall: float = 0.0
    step: float = 0.0
    lag: float = 0.0
    most_lag: float = 0.0
    late: float = 0.0

    def rounded(self) -> list[float]:
        """Return the attributes in their order, in seconds with three decimals."""
        return [round(each, 3) for each in astuple(self)]


@dataclass(frozen=True, slots=True)
class GamePace:
    """Pace of a game, in seconds.

    Attributes:
        wall: real time from the first tick to the last tick.
        most_lag: largest lag of simulated time behind real time.
        late: real time in which ticks were late by more than `LATE`.
        course: pairs of simulated and real time. Times between two pairs follow by linear interpolation.
    """

    wall: float
    most_lag: float
    late: float
    course: tuple[tuple[float, float], ...]


class PaceMeter:
    """Measurement of the pace of one game, tick by tick.

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
        """Continue the measurement of an earlier program in the same game.

        `measured` has the earlier program's tick numbers and the states after these ticks.
        """
        self._now = None
        for self._tick, self.state in measured:
            self.keep()
        # The pacer of this program starts without a lag, so the lag of the earlier program remains.
        self._carried = self.state.lag

    def measure(self, tick: int, pacer: Pacer) -> PaceState:
        """Measure the present tick, and return the state after this tick."""
        now, before = self._clock(), self.state
        # When a program resumes a game, its first tick has no previous tick, so one period is used.
        first = pacer.period if self._points else 0.0
        step = first if self._now is None else now - self._now
        self._now, self._tick = now, tick
        lag = self._carried + pacer.lag
        # `pacer.delay` does not include delays that became permanent lag, so the growth of the lag is also checked.
        late = before.late + (step if max(pacer.delay, lag - before.lag) > LATE else 0.0)
        self.state = PaceState(before.wall + step, step, lag, max(before.most_lag, lag), late)
        return self.state

    def keep(self) -> None:
        """Store the times of the last measured tick and of the previous tick."""
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
    """Return the real time at a simulated time, from a `GamePace.course`; None outside the course. Unit: seconds."""
    after = bisect_left(course, simulated, key=lambda point: point[0])
    if after == len(course) or (after == 0 and course[0][0] != simulated):
        return None
    if course[after][0] == simulated:
        return course[after][1]
    (start, begin), (stop, end) = course[after - 1 : after + 1]
    return begin + (end - begin) * (simulated - start) / (stop - start)


def _simplified(points: Sequence[tuple[float, float]]) -> tuple[tuple[float, float], ...]:
    """Return a subset of points whose connecting lines deviate from all other points by at most `TOLERANCE`.

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
