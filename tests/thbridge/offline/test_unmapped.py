"""Obstacles that the robot's map does not have."""

from pathlib import Path

import numpy as np
import pytest

from sim.common.geometry import Pose2
from sim.common.grid import OCCUPIED, OccupancyGrid
from thbridge.files.errors import BadFile
from thbridge.offline.unmapped import with_unmapped

FILE = Path("boxes.yaml")


def drawn(shape: tuple[int, int], cells: list[tuple[int, int]], resolution: float, origin: Pose2) -> OccupancyGrid:
    values = np.full(shape, -1, np.int8)
    values[::2] = 0
    for row, col in cells:
        values[row, col] = OCCUPIED
    return OccupancyGrid(values, resolution, origin)


ROOM = drawn((40, 60), [(0, 0)], 0.1, Pose2(-2.0, -1.0, 0.0))


def added(unmapped: OccupancyGrid, grid: OccupancyGrid = ROOM) -> tuple[set[tuple[int, int]], int]:
    true_grid, outside = with_unmapped(grid, unmapped, FILE)
    new = np.argwhere((true_grid.cells == OCCUPIED) & (grid.cells != OCCUPIED))
    # Whatever is no obstacle stays as it was.
    assert np.array_equal(true_grid.cells[true_grid.cells != OCCUPIED], grid.cells[true_grid.cells != OCCUPIED])
    return {(int(row), int(col)) for row, col in new}, outside


def test_a_map_of_the_same_cells_adds_its_occupied_ones_alone() -> None:
    assert added(drawn((40, 60), [(5, 7), (39, 59)], 0.1, ROOM.origin)) == ({(5, 7), (39, 59)}, 0)


def test_a_smaller_map_stands_at_its_own_origin() -> None:
    """Rounded origins and sums of tenths do not thicken obstacles."""
    assert added(drawn((4, 5), [(1, 2)], 0.1, Pose2(-0.7, 0.5, 0.0))) == ({(16, 15)}, 0)
    assert added(drawn((4, 5), [(1, 2)], 0.1, Pose2(-0.70001, 0.49999, 0.0))) == ({(16, 15)}, 0)


def test_cells_of_another_size_fill_all_that_they_overlap() -> None:
    coarse = drawn((3, 3), [(1, 1)], 0.25, Pose2(-2.0, -1.0, 0.0))
    assert added(coarse) == ({(row, col) for row in (2, 3, 4) for col in (2, 3, 4)}, 0)
    fine = drawn((9, 9), [(4, 4), (4, 5)], 0.02, Pose2(-2.0, -1.0, 0.0))
    assert added(fine) == ({(0, 1)}, 0)


def test_what_lies_outside_is_counted_and_stands_nowhere() -> None:
    assert added(drawn((100, 100), [(5, 7), (5, 99), (99, 2)], 0.1, ROOM.origin)) == ({(5, 7)}, 2)


def test_maps_that_are_turned_alike_are_one_frame() -> None:
    turned = OccupancyGrid(ROOM.cells, 0.1, Pose2(3.0, 1.0, 0.7))
    corner = turned.origin.transform(np.array([[1.0, 2.0]]))[0]
    boxes = drawn((4, 5), [(1, 2)], 0.1, Pose2(float(corner[0]), float(corner[1]), 0.7))
    assert added(boxes, turned) == ({(21, 12)}, 0)


@pytest.mark.parametrize(
    ("unmapped", "told"),
    [
        (
            drawn((4, 4), [(1, 1)], 0.1, Pose2(0.0, 0.0, 0.5)),
            "boxes.yaml, origin: it is rotated by 0.5 rad, but the map is rotated by 0 rad",
        ),
        (drawn((4, 4), [], 0.1, Pose2(0.0, 0.0, 0.0)), "it has no occupied cell"),
        (drawn((4, 4), [(1, 1)], 0.1, Pose2(50.0, 0.0, 0.0)), "all of its 1 occupied cells are outside the map"),
    ],
)
def test_what_does_not_fit_is_refused(unmapped: OccupancyGrid, told: str) -> None:
    with pytest.raises(BadFile) as found:
        with_unmapped(ROOM, unmapped, FILE)
    assert told in str(found.value)
