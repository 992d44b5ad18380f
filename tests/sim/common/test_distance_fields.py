import math

import numpy as np
import pytest

from sim.common.distance_fields import distance_field
from sim.common.geometry import IDENTITY
from sim.common.grid import OCCUPIED, OccupancyGrid


def grid_of(cells: list[list[int]]) -> OccupancyGrid:
    return OccupancyGrid(np.array(cells, dtype=np.int8), 0.5, IDENTITY)


def test_distances_are_exact_and_capped() -> None:
    cells = np.zeros((5, 9), dtype=np.int8)
    cells[0, 0] = OCCUPIED
    field = distance_field(OccupancyGrid(cells, 0.5, IDENTITY), max_distance=2.0)
    assert field.dtype == np.float32
    assert field[0, 0] == 0.0
    assert field[3, 2] == pytest.approx(0.5 * math.hypot(3, 2))
    assert field[4, 8] == 2.0


def test_unknown_is_no_wall() -> None:
    assert distance_field(grid_of([[-1, -1, 100]]), 9.0).tolist() == [[1.0, 0.5, 0.0]]


def test_no_wall_at_all_is_far() -> None:
    assert distance_field(grid_of([[0, -1]]), 2.0).tolist() == [[2.0, 2.0]]
