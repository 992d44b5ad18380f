"""Team mates that say nothing any more: where they stand by their last word.

A robot that dies in a doorway stays there. The others count with it where it was heard last: for plans as long as the
memory of it is fresh, then only if the laser sees it (it may have been carried away); for braking until the laser looks
through the place where it stood.
"""

import math
from collections.abc import Sequence
from dataclasses import replace
from operator import attrgetter
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sim.common.geometry import FloatArray, Pose2
from sim.common.kernels import njit
from sim.common.observations import STANDSTILL, TICKS_PER_SECOND, Neighbour, Scan

STALE_TIMEOUT = 20.0
"""Seconds that plans reckon with a robot which has fallen silent."""
CORE_RADIUS = 0.15
"""Metres around a robot's centre through which no laser looks while it stands there."""


_ROBOT = attrgetter("robot")


@njit(cache=True)
def _looks_through(angles: FloatArray, ranges: NDArray[np.float32], bearing: float, away: float) -> bool:
    """Whether any of (m,) beams, radians, reaches beyond the heart of a body so many metres away."""
    beyond = np.float32(away + CORE_RADIUS)
    for i in range(angles.shape[0]):
        off = abs((angles[i] - bearing + math.pi) % math.tau - math.pi)
        if off < 0.5 and off * away < CORE_RADIUS and ranges[i] > beyond:
            return True
    return False


class _StaleNeighbour(NamedTuple):
    """A robot that has fallen silent.

    Attributes:
        since: tick of its silence.
        moving: its last word, but for its way.
        standing: the same, had it stood.
    """

    since: int
    moving: Neighbour
    standing: Neighbour


class StaleNeighbours:
    """Keeps the last word of those who have fallen silent."""

    def __init__(self) -> None:
        self._current: Sequence[Neighbour] = ()
        self._robots: list[int] = []
        self._stale: dict[int, _StaleNeighbour] = {}

    def update(self, tick: int, neighbours: Sequence[Neighbour]) -> None:
        """Take note of who spoke last."""
        robots = list(map(_ROBOT, neighbours))
        if robots != self._robots:
            for neighbour in self._current:
                if neighbour.robot not in robots:
                    stays = replace(neighbour, path=neighbour.path[:0], times=neighbour.times[:0], claim=None)
                    self._stale[neighbour.robot] = _StaleNeighbour(tick, stays, replace(stays, twist=STANDSTILL))
            for robot in robots:
                self._stale.pop(robot, None)
            self._robots = robots
        self._current = neighbours

    @property
    def highest_robot(self) -> int:
        """The highest index of those who speak."""
        return max(self._robots, default=0)

    def forget_seen_through(self, laser_in_map: Pose2, scan: Scan) -> None:
        """Forget those through whose place the laser looks."""
        if not self._stale:
            return
        angles = scan.mount.angles()
        for robot, silent in list(self._stale.items()):
            place = silent.moving.base_in_map
            away = math.hypot(place.x - laser_in_map.x, place.y - laser_in_map.y)
            bearing = math.atan2(place.y - laser_in_map.y, place.x - laser_in_map.x) - laser_in_map.theta
            if away > CORE_RADIUS and _looks_through(angles, scan.ranges, bearing, away):
                del self._stale[robot]

    def known(self, tick: int) -> Sequence[Neighbour]:
        """All that plans reckon with: those who speak, and those remembered."""
        return [*self._current, *self.remembered(tick)] if self._stale else self._current

    def remembered(self, tick: int) -> list[Neighbour]:
        """Those that plans reckon with: they stand."""
        fresh = STALE_TIMEOUT * TICKS_PER_SECOND
        return [silent.standing for silent in self._stale.values() if tick - silent.since <= fresh]

    def bodies(self) -> list[Neighbour]:
        """Those that may still stand there, each with the speed it had."""
        return [silent.moving for silent in self._stale.values()]
