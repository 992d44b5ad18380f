"""The outline of a grid's cells, filled by the even-odd rule, covers these cells and no others."""

import re

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from numpy.typing import NDArray

from tests.support.windows.sample_screens import floor_plan
from ui.web.page.floor import floor_shapes, outline


def covered(path: str, rows: int, cols: int) -> NDArray[np.bool_]:
    """Return the cells whose middles are inside a path, by the even-odd rule."""
    inside = np.zeros((rows, cols), dtype=np.bool_)
    x = y = 0
    for letter, numbers in re.findall(r"([MHVZ])([\d ]*)", path):
        if letter == "M":
            x, y = map(int, numbers.split())
        elif letter == "H":
            x = int(numbers)
        elif letter == "V":
            low, high = sorted((y, int(numbers)))
            inside[low:high, x:] ^= True
            y = int(numbers)
    return inside


@given(arrays(np.bool_, st.tuples(st.integers(1, 9), st.integers(1, 9))))
def test_an_outline_covers_the_cells(cells: NDArray[np.bool_]) -> None:
    assert (covered(outline(cells), *cells.shape) == cells).all()


def test_a_wall_is_one_rectangle() -> None:
    assert outline(np.ones((2, 5), dtype=np.bool_)) == "M0 0H5V2H0V0Z"


def test_the_floor_of_a_map_has_its_rooms_and_is_small() -> None:
    shapes = floor_shapes(floor_plan())
    assert [room.room for room in shapes.rooms] == list(range(1, 9))
    assert len(shapes.walls) + len(shapes.unknown) < 10_000
