"""Good team tours for more rooms than a full search can compare, from PyVRP's iterated local search.

The joint plan is a team orienteering problem: optional clients with a prize each, vehicles that have their own starts
and largest distances, and routes that end anywhere. The search ends after a fixed number of iterations from a fixed
seed, and not after a time, so only the arguments determine the tours. PyVRP computes with integers: energy is scaled by
a power of two; spent energy is rounded up, and available energy is rounded down.
"""

import math
from collections.abc import Collection, Sequence

import numpy as np
from numpy.typing import NDArray

from thbridge.hunt.costs import CostMatrix
from thbridge.hunt.rooms import Room
from thbridge.hunt.team_tour import TourStart, paid_tour
from thbridge.hunt.tour import Tour

ITERATIONS = 500
"""Iterations of the search; about 0.4 s for fifty rooms and three robots. 3000 iterations give no better plans."""
_SEED = 1
_BITS = 20
"""Number of bits of the largest energy of a single move, as an integer."""


def search_team_tours(
    costs: CostMatrix, starts: Sequence[TourStart], unvisited: Collection[Room], visit: float = 0.0
) -> tuple[Tour, ...]:
    """Return a tour for each robot within its energy; together they visit many rooms for little energy.

    They are not proven to be the best. The arguments are those of `thbridge.hunt.team_tour.best_team_tours`.
    """
    # Imported here because only large plans need it, and the import takes 50 ms.
    import pyvrp  # noqa: PLC0415
    from pyvrp.stop import MaxIterations  # noqa: PLC0415

    rooms = sorted(set(unvisited))
    last = len(rooms) + len(starts)
    moves = np.full((last + 1, last + 1), np.inf)
    moves[: len(rooms), : len(rooms)] = [[costs.cost(start, goal) for goal in rooms] for start in rooms]
    moves[len(rooms) : last, : len(rooms)] = [[start.costs[goal.people] for goal in rooms] for start in starts]
    moves[:, last] = 0.0  # From the end of every tour, the common end depot is reached at no cost.
    scale = _scale(np.append(moves[np.isfinite(moves)], visit))
    # More than any tour of possible moves costs, and so more than any robot can spend.
    far = (2 * len(rooms) + 2) << _BITS
    paid = np.where(np.isfinite(moves), np.ceil(moves * scale), far).astype(np.int64)
    spent = paid.copy()
    spent[: len(rooms), : len(rooms)] += math.ceil(visit * scale)
    for energy in (paid, spent):
        np.fill_diagonal(energy, 0)
    clients = [pyvrp.Client(room, prize=far, required=False) for room in range(len(rooms))]
    places = [pyvrp.Location(0.0, 0.0) for _ in range(last + 1)]
    depots = [pyvrp.Depot(place) for place in range(len(rooms), last + 1)]
    robots = [
        pyvrp.VehicleType(
            start_depot=at,
            end_depot=len(starts),
            max_distance=math.floor(max(min(start.energy * scale, far - 1), 0.0)),
            unit_distance_cost=0,
            unit_duration_cost=1,
        )
        for at, start in enumerate(starts)
    ]
    data = pyvrp.ProblemData(places, clients, depots, robots, [spent], [paid])  # type: ignore[list-item]  # its stubs give arrays no shape
    found = pyvrp.solve(data, MaxIterations(ITERATIONS), seed=_SEED, collect_stats=False, display=False)
    tours = [Tour((), 0.0)] * len(starts)
    for route in found.best.routes():
        start = starts[route.vehicle_type()]
        order = [rooms[stop.idx] for stop in route.schedule() if stop.is_client()]
        tours[route.vehicle_type()] = paid_tour(costs, start, order, visit)
    return tuple(tours)


def _scale(energies: NDArray[np.float64]) -> float:
    """Return the power of two by which the largest of these becomes an integer of `_BITS` bits."""
    _, exponent = math.frexp(float(energies.max()))
    return math.ldexp(1.0, min(_BITS - exponent, 1000))
