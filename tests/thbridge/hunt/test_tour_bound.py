import numpy as np
import pytest

from thbridge.hunt.costs import CostMatrix
from thbridge.hunt.rooms import CORRIDOR
from thbridge.hunt.tour import Tour, best_tour
from thbridge.hunt.tour_bound import least_tour_cost


@pytest.mark.parametrize("seed", range(12))
@pytest.mark.parametrize("skew", [0.0, 0.5])
def test_no_tour_undercuts_the_bound_and_it_is_near_the_best(seed: int, skew: float) -> None:
    """Places on a plane; at times dearer one way than the other, and without some moves."""
    random = np.random.default_rng(seed)
    places = random.uniform(0.0, 50.0, (12, 2))
    far = np.hypot(*(places[:, np.newaxis] - places).T) * (1.0 + skew * random.uniform(size=(12, 12)))
    far[random.uniform(size=far.shape) < 0.2 * skew] = np.inf
    costs = CostMatrix(tuple(tuple(row) for row in far.tolist()))
    best = best_tour(costs, CORRIDOR, costs.rooms)
    assert isinstance(best, Tour)
    least = least_tour_cost(costs, CORRIDOR, costs.rooms, 1.05 * best.cost)
    assert (0.97 if skew == 0.0 else 0.8) * best.cost < least <= best.cost + 1e-9
