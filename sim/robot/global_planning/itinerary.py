"""Right of way: the order in which robots pass the places that their paths share.

Every robot broadcasts its itinerary: the points it will pass, each with a time. These times are not promises. They are
an order: no robot drives to a point before all those with an earlier time near there have gone by. So a delay of one
makes others wait, but never makes two meet. And since times run forward along every itinerary, the robot whose next
point has the earliest time can always go (no deadlock). Robots need not share a clock, only the times they receive.

A robot that plans first has the right of way: a newcomer's itinerary keeps clear, time for time, of all that it has
received, and waits or makes detours where it must (`safe_interval`). A robot that stands is an itinerary of one point
for all times. So that no two plan at once, not yet knowing of each other, planning goes round
the team tick by tick.

Robots that stand nearer together than plans may come break that distance by standing there, and plans allow it near
their starts. The proof does not hold then, so every itinerary is first executed in simulation (`executable`).

Source: Cap, Gregoire, Frazzoli, Provably Safe and Deadlock-Free Execution of Multi-Robot Plans under Delaying
Disturbances (IROS 2016), the control law RMTRACK; Cap, Vokrinek, Kleiner, Complete Decentralized Method for On-Line
Multi-Robot Trajectory Planning in Well-Formed Infrastructures (ICAPS 2015).
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import accumulate
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sim.common.observations import Neighbour
from sim.numerics import elementary, elementary_arrays
from sim.numerics.float_array import FloatArray
from sim.numerics.kernels import njit

ITINERARY_SPEED = 0.5
"""Meters a second by which itineraries are timed: what is left of a robot's speed after turns and arrivals."""
POINT_SPACING = 0.1
"""Meters between the points of an itinerary."""
NEAR_START = 0.5
"""Meters from its place within which a robot may stay as near to another as it is already."""


@dataclass(frozen=True, slots=True)
class Itinerary:
    """Points that a robot means to pass, each with a time.

    Attributes:
        points: (m, 2) map, meters; a wait is the same point twice.
        times: (m,) ascending, seconds; before the first it stands at the first point, after the last at the last.
        unhindered_from: time from which it leads on as it would without other robots; before, it makes way for them.
    """

    points: FloatArray
    times: FloatArray
    unhindered_from: float = -math.inf


class OtherItineraries(NamedTuple):
    """The itineraries of the other robots, in the form that compiled kernels take.

    Attributes:
        points: (n, 2) all their points, one robot after the other.
        times: (n,) with them; -inf for a robot that stands.
        starts: (k + 1,) where each robot's points begin.
    """

    points: FloatArray
    times: FloatArray
    starts: NDArray[np.int64]


_FOR_GOOD: FloatArray = np.array([-math.inf])


def itineraries_of(neighbours: Sequence[Neighbour]) -> OtherItineraries:
    """Gather the itineraries that neighbors broadcast; one that stands has one point for all times."""
    if not neighbours:
        return OtherItineraries(np.empty((0, 2)), np.empty(0), np.zeros(1, dtype=np.int64))
    points = [
        other.path if len(other.times) else np.array([[other.base_in_map.x, other.base_in_map.y]])
        for other in neighbours
    ]
    times = [other.times if len(other.times) else _FOR_GOOD for other in neighbours]
    starts = np.array([*accumulate(map(len, times), initial=0)])
    return OtherItineraries(np.concatenate(points), np.concatenate(times), starts)


def relevant_neighbours(neighbours: Sequence[Neighbour], x: float, y: float, distance: float) -> list[Neighbour]:
    """Return the neighbors that may come within `distance` meters of a place: all but those standing farther away."""
    # A hair more than that: none is left out because of rounding.
    reach = distance + 1e-6
    return [
        other
        for other in neighbours
        if len(other.times) or (abs(other.base_in_map.x - x) < reach and abs(other.base_in_map.y - y) < reach)
    ]


def itineraries_of_moving(neighbours: Sequence[Neighbour]) -> OtherItineraries:
    """Gather the itineraries of those neighbors that mean to move."""
    return itineraries_of([neighbour for neighbour in neighbours if len(neighbour.times)])


def timed_itinerary(points: FloatArray, start_time: float) -> Itinerary:
    """Make the itinerary of (m, 2) points driven without a stop from `start_time` on."""
    steps = elementary_arrays.hypot(*np.diff(points, axis=0).T)
    return Itinerary(points, start_time + np.concatenate([[0.0], np.cumsum(steps)]) / ITINERARY_SPEED)


def densified(itinerary: Itinerary) -> Itinerary:
    """Return the same itinerary with points no farther apart than POINT_SPACING."""
    steps = elementary_arrays.hypot(*np.diff(itinerary.points, axis=0).T)
    counts = np.maximum(1, np.ceil(steps / POINT_SPACING - 1e-9).astype(np.int64))
    index = np.concatenate([[0.0], np.repeat(np.arange(len(steps)), counts) + _shares(counts)])
    known = np.arange(float(len(itinerary.times)))
    columns = itinerary.points[:, 0], itinerary.points[:, 1], itinerary.times
    x, y, times = (elementary_arrays.interp(index, known, column) for column in columns)
    return replace(itinerary, points=np.column_stack([x, y]), times=times)


def _shares(counts: NDArray[np.int64]) -> FloatArray:
    """For every count n in turn: 1/n, 2/n, ... 1."""
    return np.concatenate([np.arange(1, n + 1) / n for n in counts])


@njit(cache=True)
def start_time(now: float, x: float, y: float, others: OtherItineraries, separation: float) -> float:
    """Return the time at which the itinerary of a robot that stands at (x, y) may begin.

    It is now, unless another robot that is late has yet to come by: to that one, the robot has been here before.
    """
    earliest = now
    for k in range(others.starts.shape[0] - 1):
        begin, end = others.starts[k], others.starts[k + 1]
        if others.times[begin] >= earliest or others.times[begin] == -math.inf:
            continue
        for i in range(begin, end):
            if (
                others.times[i] < now
                and elementary.hypot(others.points[i, 0] - x, others.points[i, 1] - y) < separation
            ):
                earliest = others.times[begin]
                break
    return earliest


@njit(cache=True)
def _place(points: FloatArray, times: FloatArray, begin: int, end: int, time: float) -> tuple[float, float]:
    """Return the place of the itinerary points[begin:end] at a time, x and y."""
    if end - begin == 1 or time <= times[begin]:
        return points[begin, 0], points[begin, 1]
    if time >= times[end - 1]:
        return points[end - 1, 0], points[end - 1, 1]
    i, after = begin, end - 1
    while after - i > 1:
        middle = (i + after) // 2
        if times[middle] < time:
            i = middle
        else:
            after = middle
    span = times[i + 1] - times[i]
    share = (time - times[i]) / span if span > 0.0 else 1.0
    return (
        points[i, 0] + share * (points[i + 1, 0] - points[i, 0]),
        points[i, 1] + share * (points[i + 1, 1] - points[i, 1]),
    )


@njit(cache=True)
def keeps_separation(points: FloatArray, times: FloatArray, others: OtherItineraries, separation: float) -> bool:
    """Return True if an itinerary keeps its distance, time for time, from all others.

    Args:
        points: (m, 2) of the itinerary.
        times: (m,) with them.
        others: the other robots'.
        separation: meters from center to center. Within NEAR_START of the first point a smaller distance that exists
            already may stay.
    """
    n = points.shape[0]
    for k in range(others.starts.shape[0] - 1):
        begin, end = others.starts[k], others.starts[k + 1]
        ox, oy = _place(others.points, others.times, begin, end, times[0])
        # Near its start a robot may keep the distance that it has, less 2 cm, for it is never just where it planned.
        present = elementary.hypot(ox - points[0, 0], oy - points[0, 1]) - 0.02
        # Both move straight between points, so the distance is checked at the points of either, which lie close.
        for i in range(n):
            x, y = points[i, 0], points[i, 1]
            ox, oy = _place(others.points, others.times, begin, end, times[i])
            needed = separation
            if elementary.hypot(x - points[0, 0], y - points[0, 1]) < NEAR_START:
                needed = min(needed, present)
            if elementary.hypot(x - ox, y - oy) < needed:
                return False
        for i in range(begin, end):
            if others.times[i] < times[0]:
                continue
            x, y = _place(points, times, 0, n, others.times[i])
            needed = separation
            if elementary.hypot(x - points[0, 0], y - points[0, 1]) < NEAR_START:
                needed = min(needed, present)
            if elementary.hypot(x - others.points[i, 0], y - others.points[i, 1]) < needed:
                return False
    return True


@njit(cache=True)
def first_met(points: FloatArray, times: FloatArray, others: OtherItineraries, separation: float) -> int:
    """Return the other robot that an itinerary comes too near to first, -1 where none.

    Args:
        points: (m, 2) of the itinerary.
        times: (m,) with them.
        others: the other robots'.
        separation: meters from center to center. A robot that is nearer at the first point is met where it comes nearer
            still.
    """
    for i in range(points.shape[0]):
        for k in range(others.starts.shape[0] - 1):
            begin, end = others.starts[k], others.starts[k + 1]
            x, y = _place(others.points, others.times, begin, end, times[0])
            present = elementary.hypot(points[0, 0] - x, points[0, 1] - y) - 0.02
            x, y = _place(others.points, others.times, begin, end, times[i])
            if elementary.hypot(points[i, 0] - x, points[i, 1] - y) < min(separation, present):
                return k
    return -1


@njit(cache=True)
def right_of_way(
    points: FloatArray,
    times: FloatArray,
    index: int,
    last: int,
    x: float,
    y: float,
    others: OtherItineraries,
    separation: float,
) -> tuple[int, int, bool]:
    """Find the point up to which a robot may drive now: the last before one that others are to pass first.

    Args:
        points: (m, 2) of its itinerary.
        times: (m,) with them.
        index: that of the point it has reached.
        last: index of the last point that is looked at.
        x: its true place; so y.
        others: the other robots', each from the point it has reached.
        separation: meters from center to center. A robot that is nearer already may go where it does not come nearer
            still.

    Returns:
        An index from `index` to `last`; the other robot that bars the next point, -1 when none does; and whether that
        one stands for good.
    """
    for i in range(index + 1, last + 1):
        px, py = points[i, 0], points[i, 1]
        for k in range(others.starts.shape[0] - 1):
            for m in range(others.starts[k], others.starts[k + 1]):
                if others.times[m] >= times[i]:
                    break
                ox, oy = others.points[m, 0], others.points[m, 1]
                if abs(px - ox) >= separation or abs(py - oy) >= separation:
                    continue
                distance = elementary.hypot(px - ox, py - oy)
                if distance < separation and distance < elementary.hypot(x - ox, y - oy) - 0.02:
                    return i - 1, k, others.times[m] == -math.inf
    return last, -1, False


@njit(cache=True)
def executable(points: FloatArray, times: FloatArray, others: OtherItineraries, separation: float) -> bool:
    """Return True if an itinerary can be driven to its end, and no other robot is worse off than if it stayed.

    Itineraries that keep their distance at equal times always can. But robots that stand nearer than that already may
    plan to stay so for a while, and then could bar each other's next points for good. So the right of way is simulated,
    twice: all robots with this itinerary, and all with this robot standing where it is.

    A step that is open stays open until it is taken, so the order in which robots are moved does not matter.

    Args:
        points: (m, 2) of the itinerary.
        times: (m,) with them.
        others: the other robots', each from the point it has reached.
        separation: meters from center to center, as in `right_of_way`.
    """
    own = points.shape[0]
    count = others.starts.shape[0]
    ends = np.empty(count, np.int64)
    ends[0] = own - 1
    for robot in range(1, count):
        ends[robot] = own + others.starts[robot] - 1
    at = _driven(points, times, others, separation)
    if at[0] < ends[0]:
        return False
    if (at == ends).all():
        return True
    stays = _driven(points[:1], np.full(1, -np.inf), others, separation)
    return bool((at[1:] - own >= stays[1:] - 1).all())


@njit(cache=True)
def _driven(points: FloatArray, times: FloatArray, others: OtherItineraries, separation: float) -> NDArray[np.int64]:
    """Return (k + 1,) points that a robot and k others reach by right of way: indices into the points of all, in a row."""
    own = points.shape[0]
    count = others.starts.shape[0]
    all_points = np.concatenate((points, others.points))
    all_times = np.concatenate((times, others.times))
    at, last = np.empty(count, np.int64), np.empty(count, np.int64)
    at[0], last[0] = 0, own - 1
    for k in range(1, count):
        at[k], last[k] = own + others.starts[k - 1], own + others.starts[k] - 1
    moved = True
    while moved:
        moved = False
        for k in range(count):
            while at[k] < last[k] and _open(all_points, all_times, at, last, k, separation):
                at[k] += 1
                moved = True
    return at


@njit(cache=True)
def _open(
    points: FloatArray,
    times: FloatArray,
    at: NDArray[np.int64],
    last: NDArray[np.int64],
    robot: int,
    separation: float,
) -> bool:
    """Return True if a robot at its point at[robot] may drive to the next one, the others being at theirs."""
    x, y = points[at[robot], 0], points[at[robot], 1]
    px, py, time = points[at[robot] + 1, 0], points[at[robot] + 1, 1], times[at[robot] + 1]
    for k in range(at.shape[0]):
        if k == robot:
            continue
        for m in range(at[k], last[k] + 1):
            if times[m] >= time:
                break
            ox, oy = points[m, 0], points[m, 1]
            if abs(px - ox) >= separation or abs(py - oy) >= separation:
                continue
            # Unlike in `right_of_way` no 2 cm are given: in simulation robots are just where they planned to be.
            distance = elementary.hypot(px - ox, py - oy)
            if distance < separation and distance < elementary.hypot(x - ox, y - oy):
                return False
    return True


@njit(cache=True)
def reached_index(points: FloatArray, index: int, x: float, y: float) -> int:
    """Return the index of the point that a robot at (x, y) has reached: of those just ahead the nearest; it never goes back."""
    best = index
    best_distance = elementary.hypot(points[index, 0] - x, points[index, 1] - y)
    along = 0.0
    for i in range(index + 1, points.shape[0]):
        along += elementary.hypot(points[i, 0] - points[i - 1, 0], points[i, 1] - points[i - 1, 1])
        # A loop to a place to wait and back again is longer than this: it must not be skipped.
        if along > 0.45:
            break
        distance = elementary.hypot(points[i, 0] - x, points[i, 1] - y)
        if distance <= best_distance:
            best, best_distance = i, distance
    return best
