"""Stale neighbors: robots of the team that no longer broadcast, at their last reported poses.

A robot that dies in a doorway stays there. The others remember its last known pose. Plans avoid this pose until
STALE_TIMEOUT. Later, they avoid the robot only if the laser sees it, because it may have been removed. Braking avoids
the pose until laser beams pass through the place where the robot stood.
"""

import math
from collections.abc import Sequence
from dataclasses import replace
from operator import attrgetter
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sim.common.geometry import Pose2
from sim.common.observations import STANDSTILL, TICKS_PER_SECOND, Neighbour, Scan
from sim.numerics import elementary
from sim.numerics.float_array import FloatArray
from sim.numerics.kernels import njit

STALE_TIMEOUT = 20.0
"""Seconds for which plans keep clear of a robot that no longer broadcasts."""
CORE_RADIUS = 0.15
"""Distance around a robot's center that no laser looks through while the robot stands there, meters."""


_ROBOT = attrgetter("robot")


@njit(cache=True)
def _looks_through(angles: FloatArray, ranges: NDArray[np.float32], bearing: float, away: float) -> bool:
    """Return True if one of (m,) beams passes through the core of a body that would be `away` meters away."""
    beyond = np.float32(away + CORE_RADIUS)
    for i in range(angles.shape[0]):
        off = abs((angles[i] - bearing + math.pi) % math.tau - math.pi)
        if off < 0.5 and off * away < CORE_RADIUS and ranges[i] > beyond:
            return True
    return False


class _StaleNeighbour(NamedTuple):
    """A robot that no longer broadcasts.

    Attributes:
        since: first tick without a broadcast.
        moving: last state of the robot, without its path.
        standing: the same state with velocity 0.
    """

    since: int
    moving: Neighbour
    standing: Neighbour


class StaleNeighbours:
    """The team as this robot knows it: robots that broadcast, and last states of robots that no longer broadcast."""

    def __init__(self) -> None:
        self._current: Sequence[Neighbour] = ()
        self._robots: list[int] = []
        self._stale: dict[int, _StaleNeighbour] = {}

    def update(self, tick: int, neighbours: Sequence[Neighbour]) -> None:
        """Process the broadcasts of this tick.

        Robots that broadcast in the last tick, but not in this tick, become stale.
        """
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
    def any(self) -> bool:
        """True if a robot is remembered that no longer broadcasts."""
        return bool(self._stale)

    @property
    def highest_robot(self) -> int:
        """The highest index of the robots that broadcast."""
        return max(self._robots, default=0)

    def forget_seen_through(self, laser_in_map: Pose2, scan: Scan) -> None:
        """Forget the stale robots if laser beams pass through their places."""
        if not self._stale:
            return
        angles = scan.mount.angles()
        for robot, stale in list(self._stale.items()):
            place = stale.moving.base_in_map
            away = elementary.hypot(place.x - laser_in_map.x, place.y - laser_in_map.y)
            bearing = elementary.atan2(place.y - laser_in_map.y, place.x - laser_in_map.x) - laser_in_map.theta
            if away > CORE_RADIUS and _looks_through(angles, scan.ranges, bearing, away):
                del self._stale[robot]

    def known(self, tick: int) -> Sequence[Neighbour]:
        """Return all robots that plans keep clear of: robots that broadcast, and remembered robots."""
        return [*self._current, *self.remembered(tick)] if self._stale else self._current

    def remembered(self, tick: int) -> list[Neighbour]:
        """Return the stale robots that plans keep clear of, with velocity 0."""
        fresh = STALE_TIMEOUT * TICKS_PER_SECOND
        return [stale.standing for stale in self._stale.values() if tick - stale.since <= fresh]

    def bodies(self) -> list[Neighbour]:
        """Return the stale robots that may still be there, each with its last velocity."""
        return [stale.moving for stale in self._stale.values()]
