"""Random hunts without robots: rooms and starts in a rectangle, and moves that cost up to 20 % more than their
length."""

import math
import random

from thbridge.hunt.costs import CostMatrix
from thbridge.hunt.team_tour import TourStart


def random_hunt(rooms: int, robots: int, energy: float, seed: int) -> tuple[CostMatrix, list[TourStart]]:
    """Return asymmetric costs of moves between rooms, and the robots' starts.

    With odd seeds, costs are whole numbers.
    """
    rng = random.Random(seed)
    places = [(rng.uniform(0.0, 40.0), rng.uniform(0.0, 30.0)) for _ in range(1 + rooms + robots)]
    away = [[math.dist(one, other) * rng.uniform(1.0, 1.2) for other in places] for one in places]
    if seed % 2:
        away = [[float(round(cost)) for cost in row] for row in away]
    rows = [tuple(row[: 1 + rooms]) for row in away]
    return CostMatrix(tuple(rows[: 1 + rooms])), [TourStart(row, energy) for row in rows[1 + rooms :]]
