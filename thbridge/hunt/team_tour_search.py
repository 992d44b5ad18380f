"""Search for good team tours by PyVRP's iterated local search, for too many rooms for a full search.

The joint plan is a team orienteering problem: optional clients with prizes, vehicles with different starts and maximum
distances, and routes that may end at any place. The search uses a fixed seed and ends after a fixed number of
iterations, so only the arguments determine the tours. PyVRP computes with integers. So energy is scaled by a power of
two; spent energy is rounded up, and available energy is rounded down.
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
"""Number of iterations of the search. They take about 0.4 s for fifty rooms and three robots. With 3000 iterations,
plans are not better."""
_SEED = 1
_BITS = 20
"""Number of bits of the integer for the largest energy of a single move."""


def search_team_tours(
    costs: CostMatrix, starts: Sequence[TourStart], unvisited: Collection[Room], visit: float = 0.0
) -> tuple[Tour, ...]:
    """Return a tour for each robot within the robot's energy. Together, the tours visit many rooms for little energy.

    There is no proof that these tours are the best. For the arguments, see `thbridge.hunt.team_tour.best_team_tours`.
    """
    # Import PyVRP here, because only large plans need it, and the import takes 50 ms.
    import pyvrp  # noqa: PLC0415
    from pyvrp.stop import MaxIterations  # noqa: PLC0415

    rooms = sorted(set(unvisited))
    last = len(rooms) + len(starts)
    moves = np.full((last + 1, last + 1), np.inf)
    moves[: len(rooms), : len(rooms)] = [[costs.cost(start, goal) for goal in rooms] for start in rooms]
    moves[len(rooms) : last, : len(rooms)] = [[start.costs[goal.people] for goal in rooms] for start in starts]
    moves[:, last] = 0.0  # All tours end at a common depot, which costs no energy.
    scale = _scale(np.append(moves[np.isfinite(moves)], visit))
    # This energy is more than the cost of any tour of possible moves, and so more than a robot can spend.
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
    """Return the power of two that scales the largest of these energies to an integer of `_BITS` bits."""
    _, exponent = math.frexp(float(energies.max()))
    return math.ldexp(1.0, min(_BITS - exponent, 1000))
