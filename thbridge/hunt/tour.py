"""The exact cheapest open tour of the rooms that are left.

The subset dynamic program of Bellman (1962) and Held and Karp (1962), in its cost-to-go form: `to_go[S, j]` is the
least energy that visits every room of the set S starting at place j. It is filled by the size of S, so that all sets of
one size are one array operation, and it also answers for every subset what a robot with too little energy can still do.
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
"""Greatest number of rooms of one robot's best tour: the table takes 8 bytes x 2^n x (n + 1), 40 MB for 18."""


class NoTour(StrEnum):
    """Reason for no suggestion."""

    NOTHING_LEFT = "nothing-left"
    NOT_REACHABLE = "not-reachable"
    NOT_ENOUGH_ENERGY = "not-enough-energy"
    TOO_MANY_ROOMS = "too-many-rooms"


@dataclass(frozen=True, slots=True)
class Tour:
    """Rooms in the order of visiting them, and the energy of all moves. Ends in its last room."""

    rooms: tuple[Room, ...]
    cost: float


def best_tour(
    costs: CostMatrix, at: Room, unvisited: Collection[Room], energy: float = math.inf, visit: float = 0.0
) -> Tour | RequestRefused:
    """Return the cheapest of the tours from `at` that visit most of `unvisited` within `energy`.

    With energy enough for all of them this is the cheapest tour of all. Among equals the tour with the lowest room
    numbers first is taken, so the result depends on the arguments alone.

    Args:
        costs: energy from place to place.
        at: place of the robot; not counted as unvisited even if it is among `unvisited`.
        unvisited: rooms still to visit, in any order.
        energy: of the robot; a tour may use all of it.
        visit: energy that is spent in each room before the next move; counted against `energy`, and not part of the
            tour's cost.

    Returns:
        A tour of at least one room, or a refusal with a reason (`NoTour`).

    Raises:
        IndexError: a place that the matrix does not know.
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
    """Return why a robot can go to none of any number of rooms, or None, without comparing any tours.

    Args:
        row: energy from where the robot stands to each place, as a row of `CostMatrix`.
        at: as for `best_tour`, and so the others.
        unvisited: rooms still to visit.
        energy: of the robot.
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
        step: (n + s, n) energy from place to room; the rows after the rooms' own are starts.

    Returns:
        (2^n, n + s) least energy to visit all of subset S from place j, infinite when impossible (bit k of S is
        room k), and (2^n,) the sizes of the subsets. Entries where j is in S are not used.
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
    """Return the cheapest order of any of these subsets (all of one size) from this place; of equals the lowest."""
    order: list[int] = []
    while subsets.any():
        for room in range(step.shape[1]):
            having = subsets[(subsets >> room) & 1 == 1]
            without = having ^ (1 << room)
            # The same sums as in the table, so comparing for equality is exact.
            going_on = without[step[place, room] + to_go[without, room] == to_go[having, place]]
            if going_on.size:
                order.append(room)
                place, subsets = room, going_on
                break
    return tuple(order)
