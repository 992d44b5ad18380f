import math

import numpy as np
import pytest
from scipy.ndimage import distance_transform_edt

from sim.common.distance_fields import BAND, distance_field, near_walls
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


def test_cells_near_walls_are_those_as_near_in_the_field_of_distances():
    cells = np.where(np.random.default_rng(1).random((600, 40)) < 0.01, 100, 0).astype(np.int8)
    grid = OccupancyGrid(cells, 0.05, IDENTITY)
    for distance in (0.05, 0.15, 0.3):
        assert np.array_equal(near_walls(grid, distance), distance_field(grid, 2.0) <= np.float64(distance))


def test_a_tall_map_is_worked_out_in_bands_as_at_once():
    cells = np.where(np.random.default_rng(2).random((2 * BAND + 50, 30)) < 0.002, 100, 0).astype(np.int8)
    field = distance_field(OccupancyGrid(cells, 0.05, IDENTITY), 3.0)
    assert np.array_equal(field, np.minimum(distance_transform_edt(cells == 0) * 0.05, 3.0).astype(np.float32))
