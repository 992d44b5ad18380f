"""Exact computation of the cheapest open tour of the remaining rooms.

Method: the subset dynamic program of Bellman (1962) and Held and Karp (1962), in its cost-to-go form. `to_go[S, j]` is
the least energy for visiting all rooms of the set S from place j. The table is filled in the order of the size of S, so
that one array operation computes all sets of a size. If the energy is not sufficient for all rooms, the table gives the
best tour of fewer rooms.
"""

import math
from collections.abc import Collection, Sequence
from dataclasses import dataclass
from enum import StrEnum

import numpy as np
from numpy.typing import NDArray

from thbridge.hunt.costs import CostMatrix, energy_text
from thbridge.hunt.refusals import RequestRefused
from thbridge.hunt.rooms import Room

MOST_ROOMS = 18
"""Maximum number of rooms for one robot's best tour. The table needs 8 bytes x 2^n x (n + 1), or 40 MB for 18 rooms."""


class NoTour(StrEnum):
    """Reason why there is no suggestion."""

    NOTHING_LEFT = "nothing-left"
    NOT_REACHABLE = "not-reachable"
    NOT_ENOUGH_ENERGY = "not-enough-energy"
    TOO_MANY_ROOMS = "too-many-rooms"


@dataclass(frozen=True, slots=True)
class Tour:
    """Rooms in the order of visits, and the energy of all moves. The tour ends in its last room."""

    rooms: tuple[Room, ...]
    cost: float


def best_tour(
    costs: CostMatrix, at: Room, unvisited: Collection[Room], energy: float = math.inf, visit: float = 0.0
) -> Tour | RequestRefused:
    """Return the best tour from `at`: it visits the largest possible number of rooms, for the least energy.

    If several tours are equally good, the tour with the lowest room numbers first is returned. So only the arguments
    determine the result.

    Args:
        costs: energy of moves between places.
        at: place of the robot. It does not count as unvisited, even if it is in `unvisited`.
        unvisited: rooms to visit, in any order.
        energy: energy of the robot. A tour may use all of this energy.
        visit: energy that the robot spends in each room before the next move. It reduces the robot's energy, but is not
            part of the tour's cost.

    Returns:
        A tour of at least one room, or a refusal with a reason from `NoTour`.

    Raises:
        IndexError: a place is not in the matrix.
    """
    rooms = sorted(set(unvisited) - {at})
    if len(rooms) > MOST_ROOMS:
        return RequestRefused(
            NoTour.TOO_MANY_ROOMS, f"I can compare tours of at most {MOST_ROOMS} rooms, and {len(rooms)} are left."
        )
    refused = why_no_tour(costs.rows[at.people], at, rooms, energy)
    if refused is not None:
        return refused
    step = np.array([[costs.cost(start, goal) for goal in rooms] for start in (*rooms, at)])
    to_go, sizes = cost_to_go(step)
    from_start = to_go[:, -1]
    spent = from_start + visit * np.maximum(sizes - 1, 0)
    sizes[~np.isfinite(spent) | (spent > energy)] = 0
    most = np.flatnonzero(sizes == sizes.max())
    cheapest = most[from_start[most] == from_start[most].min()]
    order = first_order(step, to_go, len(rooms), cheapest)
    return Tour(tuple(rooms[room] for room in order), float(from_start[cheapest[0]]))


def why_no_tour(
    row: Sequence[float], at: Room, unvisited: Collection[Room], energy: float = math.inf
) -> RequestRefused | None:
    """Return the reason why a robot cannot go to any room, or None. Any number of rooms is possible.

    Args:
        row: energy from the place of the robot to each place, as in a row of `CostMatrix`.
        at: place of the robot, as in `best_tour`.
        unvisited: rooms to visit.
        energy: energy of the robot.
    """
    rooms = sorted(set(unvisited) - {at})
    if not rooms:
        return RequestRefused(NoTour.NOTHING_LEFT, "Every room has been visited.")
    nearest = min(rooms, key=lambda room: row[room.people])
    least = row[nearest.people]
    if math.isinf(least):
        return RequestRefused(NoTour.NOT_REACHABLE, f"There is no way from {at} to any room that is left.")
    if energy < least:
        return RequestRefused(
            NoTour.NOT_ENOUGH_ENERGY,
            f"The cheapest room left is {nearest} and costs {energy_text(least)}, "
            f"but only {energy_text(energy)} is left.",
        )
    return None


def cost_to_go(step: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """Compute the cost-to-go of all subsets.

    Args:
        step: (n + s, n) energy from each place to each room. The first n rows are rooms, the other rows are starts.

    Returns:
        (2^n, n + s) least energy for visiting all rooms of subset S from place j, infinite if impossible (bit k of S is
        room k). And (2^n,) sizes of the subsets. Entries with j in S are not used.
    """
    places, count = step.shape
    subsets = np.arange(1 << count)
    sizes = np.zeros(1 << count, dtype=np.int64)
    for room in range(count):
        sizes += (subsets >> room) & 1
    to_go = np.full((1 << count, places), np.inf)
    to_go[0] = 0.0
    for size in range(1, count + 1):
        of_size = subsets[sizes == size]
        for room in range(count):
            having = of_size[(of_size >> room) & 1 == 1]
            by_room_first = step[:, room] + to_go[having ^ (1 << room), room, np.newaxis]
            to_go[having] = np.minimum(to_go[having], by_room_first)
    return to_go, sizes


def first_order(
    step: NDArray[np.float64], to_go: NDArray[np.float64], place: int, subsets: NDArray[np.int64]
) -> tuple[int, ...]:
    """Return the cheapest order of rooms from this place, for the best of these subsets. All must have the same size.

    If several orders are equally cheap, the order with the lowest room numbers first is returned.
    """
    order: list[int] = []
    while subsets.any():
        for room in range(step.shape[1]):
            having = subsets[(subsets >> room) & 1 == 1]
            without = having ^ (1 << room)
            # These sums are bit-identical to the sums in the table, so an exact comparison is possible.
            going_on = without[step[place, room] + to_go[without, room] == to_go[having, place]]
            if going_on.size:
                order.append(room)
                place, subsets = room, going_on
                break
    return tuple(order)
