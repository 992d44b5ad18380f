"""Right of way: the order in which robots pass the places that their paths share.

Every robot broadcasts its itinerary: the points that it will pass, each with a time. A robot need not be at its points
at these times. The times define an order: a robot drives to a point only after all robots with an earlier time near
this point have passed. So a delay of one robot makes others wait, but never causes a collision. Times increase along
every itinerary. So the robot with the earliest next time can always drive (no deadlock). Robots need no common clock,
only the received times.

A robot that plans first has the right of way. The itinerary of a robot that plans later keeps its distance from all
received itineraries at every time, with waits and detours where needed (`safe_interval`). A standing robot counts as an
itinerary of one point for all times. Robots plan in turns, one per tick, so each robot knows the plans of all others.

Robots may already stand closer together than this distance. Plans permit this near the robots' starts, but the proof
does not cover this case. So every itinerary is first executed in simulation (`executable`).

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
"""Speed assumed in the times of itineraries, m/s: a robot's average speed, including turns and arrivals."""
POINT_SPACING = 0.1
"""Distance between the points of an itinerary, meters."""
NEAR_START = 0.5
"""Distance from a robot's start, meters. Within it, the robot may remain as close to another robot as it already is."""


@dataclass(frozen=True, slots=True)
class Itinerary:
    """Points that a robot plans to pass, each with a time.

    Attributes:
        points: (m, 2) points in the map, meters. If the robot waits, its point occurs twice.
        times: (m,) ascending, seconds. Before the first time the robot stands at the first point, after the last time
            at the last point.
        unhindered_from: time from which on the robot drives as it would without other robots. Before this time, it
            makes way for other robots.
    """

    points: FloatArray
    times: FloatArray
    unhindered_from: float = -math.inf


class OtherItineraries(NamedTuple):
    """The itineraries of the other robots, for compiled kernels.

    Attributes:
        points: (n, 2) points of all other robots, one robot after another.
        times: (n,) times of the points. -inf for a robot that stands.
        starts: (k + 1,) index of the first point of each robot.
    """

    points: FloatArray
    times: FloatArray
    starts: NDArray[np.int64]


_FOR_GOOD: FloatArray = np.array([-math.inf])


def itineraries_of(neighbours: Sequence[Neighbour]) -> OtherItineraries:
    """Collect the itineraries that neighbors broadcast. A robot that stands has one point for all times."""
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
    """Return all neighbors except those that stand more than `distance` meters away from a place."""
    # The small margin makes sure that rounding excludes no neighbor.
    reach = distance + 1e-6
    return [
        other
        for other in neighbours
        if len(other.times) or (abs(other.base_in_map.x - x) < reach and abs(other.base_in_map.y - y) < reach)
    ]


def itineraries_of_moving(neighbours: Sequence[Neighbour]) -> OtherItineraries:
    """Collect the itineraries of the neighbors that plan to move."""
    return itineraries_of([neighbour for neighbour in neighbours if len(neighbour.times)])


def timed_itinerary(points: FloatArray, start_time: float) -> Itinerary:
    """Make the itinerary of a robot that drives along (m, 2) points without a stop from `start_time` on."""
    steps = elementary_arrays.hypot(*np.diff(points, axis=0).T)
    return Itinerary(points, start_time + np.concatenate([[0.0], np.cumsum(steps)]) / ITINERARY_SPEED)


def densified(itinerary: Itinerary) -> Itinerary:
    """Return the same itinerary with points at most POINT_SPACING apart."""
    steps = elementary_arrays.hypot(*np.diff(itinerary.points, axis=0).T)
    counts = np.maximum(1, np.ceil(steps / POINT_SPACING - 1e-9).astype(np.int64))
    index = np.concatenate([[0.0], np.repeat(np.arange(len(steps)), counts) + _shares(counts)])
    known = np.arange(float(len(itinerary.times)))
    columns = itinerary.points[:, 0], itinerary.points[:, 1], itinerary.times
    x, y, times = (elementary_arrays.interp(index, known, column) for column in columns)
    return replace(itinerary, points=np.column_stack([x, y]), times=times)


def _shares(counts: NDArray[np.int64]) -> FloatArray:
    """Return 1/n, 2/n, ..., 1 for each count n, in the order of the counts."""
    return np.concatenate([np.arange(1, n + 1) / n for n in counts])


@njit(cache=True)
def start_time(now: float, x: float, y: float, others: OtherItineraries, separation: float) -> float:
    """Return the time at which the itinerary of a robot that stands at (x, y) may begin.

    The time is `now`, unless another robot is late and still has to pass here. Then it is the time of that robot's
    present point. So in the order of times, this robot passes here before that robot.
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
    """Return x and y on the itinerary points[begin:end] at a time, by binary search."""
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
    """Return True if an itinerary keeps its distance from all other itineraries at all times.

    Args:
        points: (m, 2) points of the itinerary.
        times: (m,) their times.
        others: itineraries of the other robots.
        separation: minimum distance from center to center, meters. Near the first point (NEAR_START), the
            present distance is enough, even if it is smaller.
    """
    n = points.shape[0]
    for k in range(others.starts.shape[0] - 1):
        begin, end = others.starts[k], others.starts[k + 1]
        ox, oy = _place(others.points, others.times, begin, end, times[0])
        # Near its start, a robot may remain at its present distance, minus 2 cm, because it is never exactly where it
        # planned to be.
        present = elementary.hypot(ox - points[0, 0], oy - points[0, 1]) - 0.02
        # Both robots move straight between points, which are close together. So checks at the points of both are
        # enough.
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
    """Return the first other robot to which an itinerary comes too close, or -1 if there is none.

    Args:
        points: (m, 2) points of the itinerary.
        times: (m,) their times.
        others: itineraries of the other robots.
        separation: minimum distance from center to center, meters. A robot that is nearer at the first point counts
            only where the distance decreases further.
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
    """Find the point up to which a robot may drive now: the last point before a point that others must pass first.

    Args:
        points: (m, 2) points of the robot's itinerary.
        times: (m,) their times.
        index: index of the point that it has reached.
        last: index of the last point to examine.
        x: true position of the robot, with `y`.
        others: itineraries of the other robots, each from the point that it has reached.
        separation: minimum distance from center to center, meters. A robot that is already nearer may drive wherever
            the distance does not decrease further.

    Returns:
        An index from `index` to `last`, the other robot that blocks the next point, or -1, and True if that robot
        stands permanently.
    """
    for i in range(index + 1, last + 1):
        px, py = points[i, 0], points[i, 1]
        for k in range(others.starts.shape[0] - 1):
            for m in range(others.starts[k], others.starts[k + 1]):
                if others.times[m] >= times[i]:
                    # Times increase along an itinerary, so all further points of this other robot are also later.
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
    """Return True if an itinerary can be driven to its end without stopping a robot that could drive if this one stood.

    This is always true for itineraries that keep their distance from each other at every time. But robots that already
    stand closer may plan to remain closer for a while, and could then block each other's next points permanently. So
    the right of way is simulated twice: once with this itinerary, and once with this robot standing where it is.

    A step that is possible remains possible until it is driven. So the order in which robots are moved has no effect.

    Args:
        points: (m, 2) points of the itinerary.
        times: (m,) their times.
        others: itineraries of the other robots, each from the point that it has reached.
        separation: minimum distance from center to center, meters, as in `right_of_way`.
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
    """Return (k + 1,) indices: the last points that this robot and k others reach if all obey the right of way."""
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
    """Return True if a robot at its point at[robot] may drive to its next point while all robots are at points `at`."""
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
            # `right_of_way` has a tolerance of 2 cm. It is not needed here, because simulated robots are exactly where
            # they planned to be.
            distance = elementary.hypot(px - ox, py - oy)
            if distance < separation and distance < elementary.hypot(x - ox, y - oy):
                return False
    return True


@njit(cache=True)
def reached_index(points: FloatArray, index: int, x: float, y: float) -> int:
    """Return the index of the point that a robot at (x, y) has reached: the nearest point not far ahead.

    It never decreases.
    """
    best = index
    best_distance = elementary.hypot(points[index, 0] - x, points[index, 1] - y)
    along = 0.0
    for i in range(index + 1, points.shape[0]):
        along += elementary.hypot(points[i, 0] - points[i - 1, 0], points[i, 1] - points[i - 1, 1])
        # A loop to a waiting place and back is longer than this limit. So the loop is never skipped.
        if along > 0.45:
            break
        distance = elementary.hypot(points[i, 0] - x, points[i, 1] - y)
        if distance <= best_distance:
            best, best_distance = i, distance
    return best
