"""Joint plan of a team: it assigns the remaining rooms to robots and determines the order of visits.

With this plan, the team visits the largest possible number of rooms within the robots' energies, and spends the least
energy on moves. The subset dynamic program of `thbridge.hunt.tour` gives each robot's cheapest tour of every subset of
rooms. Then robots are added one by one. Each robot visits any subset of a set of rooms, and the earlier robots visit
the other rooms. This compares 3^n pairs of a set and a subset. The result is exact. For three robots, the computation
takes 15 ms for twelve rooms, and 0.5 s for sixteen rooms.
"""

import math
from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from thbridge.hunt.costs import CostMatrix
from thbridge.hunt.rooms import Room
from thbridge.hunt.tour import MOST_ROOMS, Tour, cost_to_go, first_order

MOST_ROOMS_OF_A_TEAM = 16
"""Maximum number of rooms for an exact plan of a team. For four robots, this takes seconds."""
_LOW_ROOMS = 9
"""Number of rooms in a block. All 3^9 pairs of a set and a subset in a block are compared in one operation."""


@dataclass(frozen=True, slots=True)
class TourStart:
    """Start of one robot's tour, and the available energy.

    Attributes:
        costs: energy from the start to every place, by the number for people, as in a row of `CostMatrix`.
        energy: energy of the robot. A tour may use all of this energy.
    """

    costs: tuple[float, ...]
    energy: float

    def can_pay(self, room: Room) -> bool:
        """Return True if the robot has energy for a move to this room."""
        return self.costs[room.people] <= self.energy and self.costs[room.people] < math.inf

    def after(self, costs: CostMatrix, room: Room, visit: float) -> "TourStart":
        """Return the start of the rest of the tour, after this first room. Its energy may be below 0."""
        return TourStart(costs.rows[room.people], self.energy - self.costs[room.people] - visit)


def paid_tour(costs: CostMatrix, start: TourStart, order: Iterable[Room], visit: float) -> Tour:
    """Return the tour of rooms in this order. It ends before the first room that the robot has no energy for."""
    rooms, cost = [], 0.0
    for room in order:
        if not start.can_pay(room):
            break
        rooms.append(room)
        cost += start.costs[room.people]
        start = start.after(costs, room, visit)
    return Tour(tuple(rooms), cost)


def most_rooms_shared_out(robots: int) -> int:
    """Return the largest number of rooms for the exact computation of a team's best tours."""
    return MOST_ROOMS if robots == 1 else MOST_ROOMS_OF_A_TEAM


def best_team_tours(
    costs: CostMatrix, starts: Sequence[TourStart], unvisited: Collection[Room], visit: float = 0.0, sent: int = -1
) -> tuple[Tour, ...]:
    """Return a tour for each robot. Together, they visit the largest number of rooms, with the least energy for moves.

    If several plans are equally good, earlier robots get the rooms with lower numbers. So only the arguments determine
    the result.

    Args:
        costs: energy from room to room.
        starts: one start per robot.
        unvisited: rooms to visit, in any order. At most `MOST_ROOMS_OF_A_TEAM`, or `MOST_ROOMS` for one robot.
        visit: energy that a robot spends in each room before its next move. It reduces the robot's energy, but is not
            part of a tour's cost.
        sent: index of the robot that will be sent next. If it has energy for any room, its tour has at least one room.

    Returns:
        One tour per robot. A robot with an empty tour does not move.

    Raises:
        ValueError: there are too many rooms for the exact computation.
    """
    rooms = _comparable(unvisited, starts)
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


@dataclass(frozen=True, slots=True)
class PlanValue:
    """Value of a team's plan: the number of visited rooms, and the energy of all moves."""

    rooms: int
    cost: float

    @classmethod
    def of(cls, tours: Sequence[Tour]) -> "PlanValue":
        """Return the value of the plan with these tours."""
        return cls(sum(len(tour.rooms) for tour in tours), math.fsum(tour.cost for tour in tours))


def alternatives(
    costs: CostMatrix, starts: Sequence[TourStart], unvisited: Collection[Room], visit: float = 0.0
) -> tuple[dict[Room, PlanValue], ...]:
    """Return, for each robot and each possible next room, the value of the best plan with this next room.

    Rooms that a robot has no energy for are not in the result. For the arguments, see `best_team_tours`.

    Raises:
        ValueError: there are too many rooms to compare.
    """
    rooms = _comparable(unvisited, starts)
    step = _steps(costs, rooms, starts)
    to_go, sizes = cost_to_go(step)
    spent = [_payable(to_go[:, len(rooms) + at], sizes, start.energy, visit) for at, start in enumerate(starts)]
    every, values = np.arange(len(sizes)), []
    for at, start in enumerate(starts):
        others = _plans(spent[:at] + spent[at + 1 :], sizes, len(rooms))[-1]
        of_robot: dict[Room, PlanValue] = {}
        for bit, room in enumerate(rooms):
            having = every[(every >> bit) & 1 == 1]
            first = np.full(len(sizes), np.inf)
            first[having] = step[len(rooms) + at, bit] + to_go[having ^ (1 << bit), bit]
            own = _payable(first, sizes, start.energy, visit)
            best = _first_of_best(others, own, sizes, len(sizes) - 1)
            if np.isfinite(own[best]):
                rest = len(sizes) - 1 - best
                value = float(own[best] + others.least[rest])
                of_robot[room] = PlanValue(int(sizes[best] + others.most[rest]), value)
        values.append(of_robot)
    return tuple(values)


def best_score(costs: CostMatrix, starts: Sequence[TourStart], points: Mapping[Room, int], visit: float) -> int:
    """Return the highest possible score of a team that names all treasures in visited rooms.

    Args:
        costs: energy from room to room.
        starts: one start per robot.
        points: points of each room's treasure. For the largest number of rooms, see `most_rooms_shared_out`.
        visit: energy of naming a treasure.

    Raises:
        ValueError: there are too many rooms to compare.
    """
    rooms = _comparable(points, starts)
    to_go, sizes = cost_to_go(_steps(costs, rooms, starts))
    worth = np.zeros(len(sizes), dtype=np.int64)
    for bit, room in enumerate(rooms):
        worth += ((np.arange(len(sizes)) >> bit) & 1) * points[room]
    spent = [to_go[:, len(rooms) + at] + visit * sizes for at in range(len(starts))]
    spent = [np.where(each <= start.energy, each, np.inf) for each, start in zip(spent, starts, strict=True)]
    return int(worth[np.bitwise_or.reduce(_shared_out(spent, worth, len(rooms)))])


def _comparable(unvisited: Collection[Room], starts: Sequence[TourStart]) -> list[Room]:
    """Return the rooms in order. Raises ValueError if there are too many rooms."""
    rooms = sorted(set(unvisited))
    limit = most_rooms_shared_out(len(starts))
    if len(rooms) > limit:
        raise ValueError(f"an exact plan is possible for at most {limit} rooms, but there are {len(rooms)}")
    return rooms


def _steps(costs: CostMatrix, rooms: Sequence[Room], starts: Sequence[TourStart]) -> NDArray[np.float64]:
    """Return (n + s, n) energy from rooms and starts to rooms."""
    between = [[costs.cost(start, goal) for goal in rooms] for start in rooms]
    step = np.array([*between, *([start.costs[goal.people] for goal in rooms] for start in starts)], dtype=np.float64)
    return step.reshape(len(rooms) + len(starts), len(rooms))


def _payable(to_go: NDArray[np.float64], sizes: NDArray[np.int64], energy: float, visit: float) -> NDArray[np.float64]:
    """Return the energy for the moves of one robot's cheapest tour, by subset. Infinite if the robot has less energy.

    Staying costs no energy, so that the other robots can drive if one robot has an energy below 0.
    """
    spent = to_go + visit * np.maximum(sizes - 1, 0)
    return np.where((spent <= energy) | (sizes == 0), to_go, np.inf)


def _shared_out(spent: Sequence[NDArray[np.float64]], worth: NDArray[np.int64], rooms: int) -> list[int]:
    """Return the subset of rooms for each robot.

    Robots are added in reverse order, so the first robot chooses first. If several subsets are equally good, it gets
    the rooms with the lowest numbers.
    """
    plans = _plans(spent[1:], worth, rooms)
    taken = [_first_of_best(plans[-1], spent[0], worth, len(worth) - 1)]
    left = len(worth) - 1 - taken[0]
    for plan in reversed(plans[1:]):
        taken.append(int(plan.taken[left]))
        left ^= taken[-1]
    return taken


@dataclass(frozen=True, slots=True)
class _Plan:
    """Best plan of some robots for every set of rooms. It has the highest worth and, among these plans, the least
    energy.

    Worth and energy are sums over robots. So each part of a best plan is a best plan for its robots and rooms.

    Attributes:
        most: (2^rooms,) worth; -1 if the robots have no energy for any plan.
        least: (2^rooms,) energy.
        taken: (2^rooms,) the subset of the last added robot.
    """

    most: NDArray[np.int64]
    least: NDArray[np.float64]
    taken: NDArray[np.int64]


def _plans(spent: Sequence[NDArray[np.float64]], worth: NDArray[np.int64], rooms: int) -> list[_Plan]:
    """Return the plans for no robot, for the last robot, for the last two robots, and so on."""
    nothing = np.zeros(len(worth), dtype=np.int64)
    plans = [_Plan(nothing, np.zeros(len(worth)), nothing)]
    for of_robot in reversed(spent):
        first = len(plans) == 1
        plans.append(_best_within(of_robot, worth, rooms) if first else _joined(plans[-1], of_robot, worth, rooms))
    return plans


def _best_within(spent: NDArray[np.float64], worth: NDArray[np.int64], rooms: int) -> _Plan:
    """Return the plan of one robot: the best subset of each set. The computation adds one room after the other."""
    can_pay = np.isfinite(spent)
    most, least, taken = np.where(can_pay, worth, -1), spent.copy(), np.arange(len(worth))
    for room in range(rooms):
        blocks = (2 ** (rooms - 1 - room), 2, 2**room)
        number, energy, subset = most.reshape(blocks), least.reshape(blocks), taken.reshape(blocks)
        cheaper = (energy[:, 0] < energy[:, 1]) | ((energy[:, 0] == energy[:, 1]) & (subset[:, 0] < subset[:, 1]))
        better = (number[:, 0] > number[:, 1]) | ((number[:, 0] == number[:, 1]) & cheaper)
        for each in (number, energy, subset):
            each[:, 1] = np.where(better, each[:, 0], each[:, 1])
    return _Plan(most, least, taken)


def _first_of_best(plan: _Plan, spent: NDArray[np.float64], worth: NDArray[np.int64], left: int) -> int:
    """Return a robot's best subset of the rooms `left`, given the plan of the other robots.

    If several subsets are equally good, return the lowest subset.
    """
    rest = left ^ np.arange(len(worth))
    energy = plan.least[rest] + spent
    number = np.where(np.isfinite(energy), plan.most[rest] + worth, -1)
    return int(np.where(number == number.max(), energy, np.inf).argmin())


def _joined(plan: _Plan, spent: NDArray[np.float64], worth: NDArray[np.int64], rooms: int) -> _Plan:
    """Return the plan with a further robot. It visits any subset of a set, and the other robots visit the other rooms.

    Rooms are split into low and high bits. For each pair of a set of high rooms and its subset, one array operation
    compares all pairs of low rooms. These are 3^n comparisons in blocks that fit into the processor's cache.
    """
    low = min(rooms, _LOW_ROOMS)
    whole, part, begins = _subsets_of_sets(low)
    rest, lengths, size = whole ^ part, np.diff(begins, append=len(whole)), 1 << low
    sets = 1 << (rooms - low)
    worth, spent = worth.reshape(sets, size), spent.reshape(sets, size)
    most_left, least_left = plan.most.reshape(sets, size), plan.least.reshape(sets, size)
    most = np.full((sets, size), -1, dtype=np.int64)
    least, taken = np.full((sets, size), np.inf), np.zeros((sets, size), dtype=np.int64)
    payable = set(np.flatnonzero(np.isfinite(spent).any(axis=1)).tolist())
    positions = np.arange(len(whole))
    for high, high_part in zip(*_subsets_of_sets(rooms - low)[:2], strict=True):
        if int(high_part) not in payable:
            continue
        energy = least_left[high ^ high_part][rest] + spent[high_part][part]
        number = np.where(np.isfinite(energy), most_left[high ^ high_part][rest] + worth[high_part][part], -1)
        best = np.maximum.reduceat(number, begins)
        energy[number < np.repeat(best, lengths)] = np.inf
        cheapest = np.minimum.reduceat(energy, begins)
        # Subsets are in ascending order, within a block and between blocks. So the lowest of several equally good
        # subsets is kept.
        position = np.where(energy == np.repeat(cheapest, lengths), positions, len(whole))
        subset = part[np.minimum.reduceat(position, begins)] | (int(high_part) << low)
        better = (best > most[high]) | ((best == most[high]) & (cheapest < least[high]))
        most[high][better], least[high][better], taken[high][better] = best[better], cheapest[better], subset[better]
    return _Plan(most.reshape(-1), least.reshape(-1), taken.reshape(-1))


@lru_cache(maxsize=2)
def _subsets_of_sets(rooms: int) -> tuple[NDArray[np.int64], NDArray[np.int64], NDArray[np.int64]]:
    """Return all pairs of a set of rooms and a subset of this set, ordered by set and then by subset.

    Returns:
        (3^rooms,) the sets, (3^rooms,) the subsets, and (2^rooms,) the index of the first pair of each set.
    """
    whole = part = np.zeros(1, dtype=np.int64)
    for room in range(rooms):
        bit = 1 << room
        whole = np.concatenate([whole, whole | bit, whole | bit])
        part = np.concatenate([part, part, part | bit])
    order = np.lexsort((part, whole))
    whole, part = whole[order], part[order]
    return whole, part, np.searchsorted(whole, np.arange(1 << rooms))
