"""Planners for the next rooms of a team: the joint plan, and simpler planners for comparison.

All planners implement the interface `PlanTours`: they return a tour for each robot within the robot's energy. No room
is in two tours. A robot's next room is the first room of its tour. `PLANNERS` is the table of all planners.
"""

import math
from collections.abc import Callable, Collection, Mapping, Sequence
from types import MappingProxyType
from typing import Protocol

from thbridge.hunt.costs import CostMatrix
from thbridge.hunt.rooms import Room
from thbridge.hunt.team_planner import TeamPlanner
from thbridge.hunt.team_tour import TourStart, best_team_tours, most_rooms_shared_out, paid_tour
from thbridge.hunt.team_tour_search import search_team_tours
from thbridge.hunt.tour import Tour

PLANNING_ALONE = frozenset({TeamPlanner.NEAREST, TeamPlanner.TOUR})
"""Planners in which a robot chooses its next room without regard to other robots."""


class PlanTours(Protocol):
    """Planner of a team's tours."""

    def __call__(
        self,
        costs: CostMatrix,
        starts: Sequence[TourStart],
        unvisited: Collection[Room],
        visit: float = 0.0,
        sent: int = -1,
    ) -> tuple[Tour, ...]:
        """Return one tour per robot.

        Args:
            costs: energy of moves between rooms.
            starts: one start per robot.
            unvisited: rooms to visit, in any order.
            visit: energy that a robot spends in each room before its next move. It is not part of a tour's cost.
            sent: index of the robot that will be sent next. If it has energy for any room, its tour has a room.
        """
        ...


def joint_tours(
    costs: CostMatrix, starts: Sequence[TourStart], unvisited: Collection[Room], visit: float = 0.0, sent: int = -1
) -> tuple[Tour, ...]:
    """Return the best tours of the team. If there are too many rooms for a full search, return good tours.

    See `PlanTours`.
    """
    if len(set(unvisited)) <= most_rooms_shared_out(len(starts)):
        return best_team_tours(costs, starts, unvisited, visit, sent)
    return searched_tours(costs, starts, unvisited, visit, sent)


def searched_tours(
    costs: CostMatrix, starts: Sequence[TourStart], unvisited: Collection[Room], visit: float = 0.0, sent: int = -1
) -> tuple[Tour, ...]:
    """Return good tours for any number of rooms. They are nearly always the best tours, but there is no
    proof of this. See `PlanTours`.
    """
    return _sending(search_team_tours, costs, starts, unvisited, visit, sent)


def tours_begun_with(
    costs: CostMatrix, starts: Sequence[TourStart], tours: Sequence[Tour], robot: int, room: Room, visit: float
) -> tuple[Tour, ...]:
    """Return the tours of a plan after moving a room to the start of one robot's tour.

    Each tour is shortened to the robot's energy.
    """
    orders = [[other for other in tour.rooms if other != room] for tour in tours]
    orders[robot].insert(0, room)
    return tuple(paid_tour(costs, start, order, visit) for start, order in zip(starts, orders, strict=True))


def nearest_tours(
    costs: CostMatrix, starts: Sequence[TourStart], unvisited: Collection[Room], visit: float = 0.0, sent: int = -1
) -> tuple[Tour, ...]:
    """Return tours in which each robot always drives to its nearest room; see `PlanTours` and `_in_turns`."""

    def nearest(start: TourStart, left: Collection[Room]) -> Room | None:
        payable = filter(start.can_pay, left)
        return min(payable, key=lambda room: (start.costs[room.people], room), default=None)

    return _in_turns(nearest, costs, starts, unvisited, visit, sent)


def own_tours(
    costs: CostMatrix, starts: Sequence[TourStart], unvisited: Collection[Room], visit: float = 0.0, sent: int = -1
) -> tuple[Tour, ...]:
    """Return tours in which each robot plans its own tour before each move; see `PlanTours` and `_in_turns`.

    If there are too many rooms for a full search, this tour is good, but not proven to be the best.
    """

    def first_of_tour(start: TourStart, left: Collection[Room]) -> Room | None:
        plan = best_team_tours if len(left) <= most_rooms_shared_out(1) else search_team_tours
        (tour,) = plan(costs, (start,), left, visit)
        return tour.rooms[0] if tour.rooms else None

    return _in_turns(first_of_tour, costs, starts, unvisited, visit, sent)


def greedy_tours(
    costs: CostMatrix, starts: Sequence[TourStart], unvisited: Collection[Room], visit: float = 0.0, sent: int = -1
) -> tuple[Tour, ...]:
    """Return tours that grow move by move, always by the cheapest next move of all robots; see `PlanTours`."""
    return _sending(_grown_by_moves, costs, starts, unvisited, visit, sent)


def auction_tours(
    costs: CostMatrix, starts: Sequence[TourStart], unvisited: Collection[Room], visit: float = 0.0, sent: int = -1
) -> tuple[Tour, ...]:
    """Return the tours of a sequential single-item auction (Lagoudakis et al. 2005); see `PlanTours`.

    In each round, every robot bids for every remaining room. A bid is the additional energy of the robot's tour with
    the room at its cheapest position. The lowest bid wins the room. With these bids, the auction is the method of
    cheapest insertion for the team.
    """
    return _sending(_grown_by_bids, costs, starts, unvisited, visit, sent)


PLANNERS: Mapping[TeamPlanner, PlanTours] = MappingProxyType(
    {
        TeamPlanner.JOINT: joint_tours,
        TeamPlanner.NEAREST: nearest_tours,
        TeamPlanner.GREEDY: greedy_tours,
        TeamPlanner.TOUR: own_tours,
        TeamPlanner.AUCTION: auction_tours,
    }
)
"""Planners by name."""


def _in_turns(
    choose: Callable[[TourStart, Collection[Room]], Room | None],
    costs: CostMatrix,
    starts: Sequence[TourStart],
    unvisited: Collection[Room],
    visit: float,
    sent: int,
) -> tuple[Tour, ...]:
    """Return the tours of robots that choose their next rooms in turn.

    Costs are travel times. So the next robot is the robot with the least energy spent on moves, as in the game. If
    several robots have spent this energy, the robot to send is next if it is one of them. Otherwise, the robot with
    the lowest number is next.
    """
    here, orders = list(starts), [list[Room]() for _ in starts]
    spent, left, going = [0.0] * len(starts), set(unvisited), set(range(len(starts)))
    while going:
        robot = min(going, key=lambda each: (spent[each], each != sent, each))
        room = choose(here[robot], left)
        if room is None:
            going.remove(robot)
            continue
        orders[robot].append(room)
        left.remove(room)
        spent[robot] += here[robot].costs[room.people]
        here[robot] = here[robot].after(costs, room, visit)
    return tuple(Tour(tuple(order), cost) for order, cost in zip(orders, spent, strict=True))


def _sending(
    plan: Callable[[CostMatrix, Sequence[TourStart], Collection[Room], float], tuple[Tour, ...]],
    costs: CostMatrix,
    starts: Sequence[TourStart],
    unvisited: Collection[Room],
    visit: float,
    sent: int,
) -> tuple[Tour, ...]:
    """Return the tours of a plan. If the robot to send would stay, it drives to its nearest room, and all further moves
    are planned from there.
    """
    tours = plan(costs, starts, unvisited, visit)
    if sent < 0 or tours[sent].rooms:
        return tours
    (begun,) = nearest_tours(costs, (starts[sent],), unvisited, visit)
    if not begun.rooms:
        return tours
    first = begun.rooms[0]
    gone = [start.after(costs, first, visit) if at == sent else start for at, start in enumerate(starts)]
    rest = list(plan(costs, gone, set(unvisited) - {first}, visit))
    rest[sent] = paid_tour(costs, starts[sent], (first, *rest[sent].rooms), visit)
    return tuple(rest)


def _grown_by_moves(
    costs: CostMatrix, starts: Sequence[TourStart], unvisited: Collection[Room], visit: float
) -> tuple[Tour, ...]:
    here, orders, left = list(starts), [list[Room]() for _ in starts], set(unvisited)
    while moves := [
        (start.costs[room.people], at, room) for at, start in enumerate(here) for room in left if start.can_pay(room)
    ]:
        _, robot, room = min(moves)
        orders[robot].append(room)
        left.remove(room)
        here[robot] = here[robot].after(costs, room, visit)
    return tuple(paid_tour(costs, start, order, visit) for start, order in zip(starts, orders, strict=True))


def _grown_by_bids(
    costs: CostMatrix, starts: Sequence[TourStart], unvisited: Collection[Room], visit: float
) -> tuple[Tour, ...]:
    orders, left = [list[Room]() for _ in starts], sorted(set(unvisited))
    while True:
        bids = [_lowest_bid(costs, start, order, left, visit) for start, order in zip(starts, orders, strict=True)]
        winner = min(range(len(starts)), key=lambda robot: bids[robot][0])
        energy, order = bids[winner]
        if math.isinf(energy):
            return tuple(paid_tour(costs, start, order, visit) for start, order in zip(starts, orders, strict=True))
        left = [room for room in left if room not in order]
        orders[winner] = order


def _lowest_bid(
    costs: CostMatrix, start: TourStart, order: list[Room], left: Sequence[Room], visit: float
) -> tuple[float, list[Room]]:
    """Return a robot's lowest bid, and its tour with the room of this bid. The bid is infinite without a room."""
    lowest, best = math.inf, order
    rows = [start.costs, *(costs.rows[room.people] for room in order)]
    for room in left:
        onward = costs.rows[room.people]
        for place, row in enumerate(rows):
            added = row[room.people]
            if place < len(order):
                following = order[place].people
                added += onward[following] - row[following]
            if added < lowest:
                longer = [*order[:place], room, *order[place:]]
                if len(paid_tour(costs, start, longer, visit).rooms) == len(longer):
                    lowest, best = added, longer
    return lowest, best
