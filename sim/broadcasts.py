"""Broadcasts of robots in one tick. The other robots receive them one tick later."""

from bisect import bisect_left
from collections.abc import Mapping
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from sim.common.geometry import Pose2
from sim.common.observations import Claim, Neighbour
from sim.numerics.float_array import FloatArray
from sim.numerics.kernels import njit
from sim.snapshot import TeamOutputs


@njit(cache=True)
def _within(places: FloatArray, x: float, y: float, distance: float) -> NDArray[np.int64]:
    """Return the indices of the (k, 2) places within a distance of (x, y) along both axes."""
    out = np.empty(places.shape[0], np.int64)
    count = 0
    for i in range(places.shape[0]):
        if abs(places[i, 0] - x) < distance and abs(places[i, 1] - y) < distance:
            out[count] = i
            count += 1
    return out[:count]


class Broadcasts:
    """Broadcasts of robots in one tick.

    Args:
        outputs: outputs of all robots.
        claims: claim of each robot that broadcasts, by index, in the team's order.
    """

    def __init__(self, outputs: TeamOutputs | None, claims: Mapping[int, Claim | None]) -> None:
        self.claims = claims
        self._robots = list(claims)
        self._outputs = outputs

    @cached_property
    def _all(self) -> tuple[Neighbour, ...]:
        outputs = self._outputs
        return () if outputs is None else tuple(outputs[robot].neighbour for robot in self._robots)

    @cached_property
    def _places(self) -> FloatArray:
        """(k, 2) map positions."""
        return np.empty((0, 2)) if self._outputs is None else self._outputs.believed[self._robots, :2]

    def others(self, robot: int) -> tuple[Neighbour, ...]:
        """Return the broadcasts of the other robots. This is fast, because many robots call it in each tick."""
        heard = self._all
        own = bisect_left(self._robots, robot)
        return heard[:own] + heard[own + 1 :] if robot in self.claims else heard

    def near(self, robot: int, pose: Pose2, distance: float) -> list[Neighbour]:
        """Return at least the broadcasts of the other robots within a distance along x and y, meters."""
        outputs = self._outputs
        if outputs is None:
            return []
        close = (self._robots[index] for index in _within(self._places, pose.x, pose.y, distance).tolist())
        return [outputs[other].neighbour for other in close if other != robot]
