"""Joint plan of a team: which robot visits which of the rooms that are left, and in which order.

An assignment of rooms to robots that visits most rooms within the robots' energies, and of those the one with the
least energy for all moves. Each robot's cheapest tour of every subset comes from the subset dynamic programme of
`thbridge.hunt.tour`; robots are then joined one by one, each taking any subset of what those before it leave. That
compares 3^n pairs of a set and a subset of it: exact, and a matter of milliseconds below twelve rooms.
"""

import math
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from thbridge.hunt.costs import CostMatrix
from thbridge.hunt.rooms import Room
from thbridge.hunt.tour import MOST_ROOMS, Tour, cost_to_go, first_order

MOST_ROOMS_OF_A_TEAM = 12
"""Greatest number of rooms of a joint plan: 3^12 pairs of subsets take 13 MB, and some 50 ms for three robots."""


@dataclass(frozen=True, slots=True)
class TourStart:
    """Start of one robot's tour, and the energy it may spend.

    Attributes:
        costs: energy from there to every place, by the number people use, as a row of `CostMatrix`.
        energy: of the robot; a tour may use all of it.
    """

    costs: tuple[float, ...]
    energy: float


def best_team_tours(
    costs: CostMatrix, starts: Sequence[TourStart], unvisited: Collection[Room], visit: float = 0.0, sent: int = -1
) -> tuple[Tour, ...]:
    """Return a tour for each robot: together they visit most rooms, with the least energy for moves.

    Among equals the earlier robots take the rooms with the lower numbers; the result depends on the arguments alone.

    Args:
        costs: energy from room to room.
        starts: one a robot.
        unvisited: rooms still to visit, at most `MOST_ROOMS_OF_A_TEAM`, or `MOST_ROOMS` for one robot; in any order.
        visit: energy that a robot spends in each room before its next move; counted against its energy, and not part
            of a tour's cost.
        sent: index of the robot that is about to be sent: its tour has at least one room, if it can pay for any.

    Returns:
        One tour a robot; an empty one stays where it is.

    Raises:
        ValueError: more rooms than can be compared.
    """
    rooms = sorted(set(unvisited))
    limit = MOST_ROOMS if len(starts) == 1 else MOST_ROOMS_OF_A_TEAM
    if len(rooms) > limit:
        raise ValueError(f"at most {limit} rooms can be shared out, and there are {len(rooms)}")
    step = _steps(costs, rooms, starts)
    to_go, sizes = cost_to_go(step)
    spent = [_payable(to_go[:, len(rooms) + at], sizes, start.energy, visit) for at, start in enumerate(starts)]
    if 0 <= sent < len(starts) and np.isfinite(spent[sent][1:]).any():
        spent[sent][0] = math.inf
    tours = []
    for at, subset in enumerate(_shared_out(spent, sizes, len(rooms))):
        order = first_order(step, to_go, len(rooms) + at, np.array([subset]))
        tours.append(Tour(tuple(rooms[room] for room in order), float(to_go[subset, len(rooms) + at])))
    return tuple(tours)


def best_score(costs: CostMatrix, starts: Sequence[TourStart], points: Mapping[Room, int], visit: float) -> int:
    """Return the most points that a team can win by naming every treasure it finds.

    Args:
        costs: energy from room to room.
        starts: one a robot.
        points: of each room's treasure, of at most `MOST_ROOMS_OF_A_TEAM` rooms.
        visit: energy of naming.

    Raises:
        ValueError: more rooms than can be compared.
    """
    rooms = sorted(points)
    if len(rooms) > MOST_ROOMS_OF_A_TEAM:
        raise ValueError(f"at most {MOST_ROOMS_OF_A_TEAM} rooms can be shared out, and there are {len(rooms)}")
    to_go, sizes = cost_to_go(_steps(costs, rooms, starts))
    worth = np.zeros(len(sizes), dtype=np.int64)
    for bit, room in enumerate(rooms):
        worth += ((np.arange(len(sizes)) >> bit) & 1) * points[room]
    spent = [to_go[:, len(rooms) + at] + visit * sizes for at in range(len(starts))]
    spent = [np.where(each <= start.energy, each, np.inf) for each, start in zip(spent, starts, strict=True)]
    return int(worth[np.bitwise_or.reduce(_shared_out(spent, worth, len(rooms)))])


def _steps(costs: CostMatrix, rooms: Sequence[Room], starts: Sequence[TourStart]) -> NDArray[np.float64]:
    """(n + s, n) energy from rooms and starts to rooms."""
    between = [[costs.cost(start, goal) for goal in rooms] for start in rooms]
    step = np.array([*between, *([start.costs[goal.people] for goal in rooms] for start in starts)], dtype=np.float64)
    return step.reshape(-1, len(rooms))


def _payable(to_go: NDArray[np.float64], sizes: NDArray[np.int64], energy: float, visit: float) -> NDArray[np.float64]:
    """Return the energy for the moves of one robot's cheapest tour, by subset; infinite where it cannot pay for it."""
    spent = to_go + visit * np.maximum(sizes - 1, 0)
    return np.where(spent <= energy, to_go, np.inf)


def _shared_out(spent: Sequence[NDArray[np.float64]], worth: NDArray[np.int64], rooms: int) -> list[int]:
    """Return the subset of so many rooms that each robot takes.

    `most[U]` and `least[U]` are the worth, and the energy, of the best plan of the robots so far within the set U. Both
    are sums over robots and compared in this order, so a part of a best plan is a best plan of its part.
    """
    every = np.arange(len(worth))
    left = len(worth) - 1
    most, least = np.zeros(len(worth), dtype=np.int64), np.zeros(len(worth))
    chosen: list[NDArray[np.int64]] = []
    # The first robot comes last and so chooses first, among equals the rooms with the lowest numbers.
    for joined, of_robot in enumerate(reversed(spent), start=1):
        # Then only the set of all rooms counts.
        alone = np.full(len(worth), left), every, np.zeros(1, dtype=np.int64)
        whole, part, begins = alone if joined == len(spent) else _subsets_of_sets(rooms)
        energy = least[whole ^ part] + of_robot[part]
        number = np.where(np.isfinite(energy), most[whole ^ part] + worth[part], -1)
        most = np.maximum.reduceat(number, begins)
        lengths = np.diff(begins, append=len(whole))
        energy[number < np.repeat(most, lengths)] = np.inf
        least = np.minimum.reduceat(energy, begins)
        # Of equals the first: its position is the least among those that are as good.
        position = np.where(energy == np.repeat(least, lengths), np.arange(len(whole)), len(whole))
        chosen.append(part[np.minimum.reduceat(position, begins)])
    taken: list[int] = []
    for subsets in reversed(chosen):
        taken.append(int(subsets[left] if len(subsets) > 1 else subsets[0]))
        left ^= taken[-1]
    return taken


@lru_cache(maxsize=2)
def _subsets_of_sets(rooms: int) -> tuple[NDArray[np.int64], NDArray[np.int64], NDArray[np.int64]]:
    """Return all pairs of a set of rooms and a subset of it, ordered by set and then by subset.

    Returns:
        (3^rooms,) the sets, (3^rooms,) the subsets, and (2^rooms,) where the pairs of each set begin.
    """
    whole = part = np.zeros(1, dtype=np.int64)
    for room in range(rooms):
        bit = 1 << room
        whole = np.concatenate([whole, whole | bit, whole | bit])
        part = np.concatenate([part, part, part | bit])
    order = np.lexsort((part, whole))
    whole, part = whole[order], part[order]
    return whole, part, np.searchsorted(whole, np.arange(1 << rooms))
