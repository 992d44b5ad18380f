"""Lower bound for the energy of all tours of some rooms. The computation does not need the best tour.

Two relaxed problems each give a bound; the greater bound is used. In the *assignment*, every room is entered from a
different place, but the moves may form several tours. In the *1-tree* (Held and Karp, The traveling-salesman problem
and minimum spanning trees, 1970 and 1971), a tree instead of a path connects the places. The price of a place increases
if it has too many neighbors, and decreases if it has too few neighbors, until the tree is nearly a path. In the 1-tree,
the cost of a move is the lower cost of its two directions.
"""

from collections.abc import Collection

import numpy as np
from scipy.optimize import linear_sum_assignment

from sim.numerics.float_array import FloatArray
from thbridge.hunt.costs import CostMatrix
from thbridge.hunt.rooms import Room

ROUNDS = 300
"""Number of rounds with changes of prices. They take about 0.1 s for fifty rooms."""
_ROUNDS_WITHOUT_PROGRESS = 20
"""Price changes are halved after this number of rounds without a better bound."""


def least_tour_cost(costs: CostMatrix, at: Room, unvisited: Collection[Room], known: float) -> float:
    """Return a lower bound for the energy of all tours of these rooms. A tour may end in any room.

    Args:
        costs: energy of moves between places.
        at: place of the robot.
        unvisited: rooms to visit, at least one.
        known: energy of a known tour.
    """
    rooms = sorted(set(unvisited) - {at})
    moves = np.array([[costs.cost(start, goal) for goal in rooms] for start in (*rooms, at)])
    np.fill_diagonal(moves, np.inf)
    # A finite cost for impossible moves can only decrease the bound.
    moves[np.isinf(moves)] = known + 1.0
    entered, left = linear_sum_assignment(moves.T)
    least = max(float(moves.T[entered, left].sum()), _tree_bound(moves, known))
    # If all costs are whole numbers, the cost of a tour is a whole number.
    return float(np.ceil(least - 1e-6)) if (moves == np.floor(moves)).all() else min(least, known)


def _tree_bound(moves: FloatArray, known: float) -> float:
    """Return the lower bound from 1-trees.

    The (n + 1, n) array `moves` has the energy to each room: from each room and, in the last row, from the start.
    """
    count = moves.shape[1]
    between = np.full((count + 1, count + 1), np.inf)
    between[:, :count] = moves
    between = np.minimum(between, between.T)
    prices, best, step, waited = np.zeros(count + 1), 0.0, 2.0, 0
    for _ in range(ROUNDS):
        neighbours, cost = _tree(between + prices[:, np.newaxis] + prices)
        # An additional place without costs closes the path to a round trip. Its neighbors are the start and the
        # cheapest end.
        end = int(prices[:count].argmin())
        neighbours[[end, count]] += 1
        bound = cost + prices[end] + prices[count] - 2.0 * float(prices.sum())
        waited += 1
        if bound > best:
            best, waited = bound, 0
        elif waited >= _ROUNDS_WITHOUT_PROGRESS:
            step, waited = 0.5 * step, 0
        excess = neighbours - 2
        if not excess.any() or best >= known:
            break
        prices += step * max(known - bound, 1e-3 * known) / float((excess * excess).sum()) * excess
    return best


def _tree(weights: FloatArray) -> tuple["np.ndarray[tuple[int], np.dtype[np.int64]]", float]:
    """Return the minimum spanning tree of all places: the number of neighbors of each place, and the weight (Prim)."""
    size = len(weights)
    neighbours, total = np.zeros(size, dtype=np.int64), 0.0
    nearest, distance = np.zeros(size, dtype=np.int64), weights[0].copy()
    outside = np.ones(size, dtype=bool)
    outside[0] = False
    for _ in range(size - 1):
        place = int(np.where(outside, distance, np.inf).argmin())
        outside[place] = False
        total += float(distance[place])
        neighbours[[place, nearest[place]]] += 1
        closer = weights[place] < distance
        nearest[closer], distance[closer] = place, weights[place][closer]
    return neighbours, total
