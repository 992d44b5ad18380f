"""Lower bound for the energy of any tour of some rooms, found without the best tour.

The bound is the greater of the bounds from two relaxations. In the *assignment*, every room is entered from a different
place, but the moves need not form one tour. In the *1-tree* (Held and Karp, The traveling-salesman problem and minimum
spanning trees, 1970 and 1971), a tree instead of a path joins the places. Places with too many neighbors become dearer,
and places with too few become cheaper, until the tree is nearly a path. A move costs the lesser of its two directions
there.
"""

from collections.abc import Collection

import numpy as np
from scipy.optimize import linear_sum_assignment

from sim.numerics.float_array import FloatArray
from thbridge.hunt.costs import CostMatrix
from thbridge.hunt.rooms import Room

ROUNDS = 300
"""Rounds in which prices of places change; about 0.1 s for fifty rooms."""
_ROUNDS_WITHOUT_PROGRESS = 20
"""Rounds without a better bound after which the price changes are halved."""


def least_tour_cost(costs: CostMatrix, at: Room, unvisited: Collection[Room], known: float) -> float:
    """Return a lower bound for the energy of all tours of all these rooms; a tour may end in any of them.

    Args:
        costs: energy from place to place.
        at: place of the robot.
        unvisited: rooms to visit, at least one.
        known: energy of a known tour.
    """
    rooms = sorted(set(unvisited) - {at})
    moves = np.array([[costs.cost(start, goal) for goal in rooms] for start in (*rooms, at)])
    np.fill_diagonal(moves, np.inf)
    # A missing move gets a high cost, which can only lower the result.
    moves[np.isinf(moves)] = known + 1.0
    entered, left = linear_sum_assignment(moves.T)
    least = max(float(moves.T[entered, left].sum()), _tree_bound(moves, known))
    # Sums of whole numbers are whole.
    return float(np.ceil(least - 1e-6)) if (moves == np.floor(moves)).all() else min(least, known)


def _tree_bound(moves: FloatArray, known: float) -> float:
    """Return the lower bound from 1-trees.

    The (n + 1, n) moves go to each room: from each room and, in the last row, from the start.
    """
    count = moves.shape[1]
    between = np.full((count + 1, count + 1), np.inf)
    between[:, :count] = moves
    between = np.minimum(between, between.T)
    prices, best, step, waited = np.zeros(count + 1), 0.0, 2.0, 0
    for _ in range(ROUNDS):
        neighbours, cost = _tree(between + prices[:, np.newaxis] + prices)
        # An extra place at no cost closes the path to a round trip. Its neighbors are the start and the cheapest end.
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
    """Return the number of neighbors of each place in the lightest tree of all places, and its weight (Prim)."""
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
