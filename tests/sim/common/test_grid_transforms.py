import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import array_shapes, arrays
from numpy.typing import NDArray
from scipy import ndimage

from sim.common.grid_transforms import connected_areas, king_moves, nearest_cells

masks = arrays(np.bool_, array_shapes(min_dims=2, max_dims=2, max_side=24), fill=st.just(value=False))


@given(masks)
def test_nearest_cells_are_those_of_scipy_also_where_several_are_equally_near(mask: NDArray[np.bool_]) -> None:
    mask.flat[-1] |= not mask.any()
    expected = ndimage.distance_transform_edt(~mask, return_distances=False, return_indices=True)
    np.testing.assert_array_equal(nearest_cells(mask), expected)


@given(masks, st.sampled_from([3, 255]))
def test_kings_moves_are_those_of_scipy_up_to_a_limit(mask: NDArray[np.bool_], limit: int) -> None:
    mask.flat[-1] |= not mask.any()
    expected = np.minimum(ndimage.distance_transform_cdt(~mask, metric="chessboard"), limit)
    np.testing.assert_array_equal(king_moves(mask, limit), expected)


@pytest.mark.parametrize("limit", [3, 255])
def test_without_a_cell_the_kings_moves_are_the_limit(limit: int) -> None:
    assert (king_moves(np.zeros((4, 300), dtype=np.bool_), limit) == limit).all()


@given(masks)
def test_areas_have_the_numbers_of_scipy(mask: NDArray[np.bool_]) -> None:
    np.testing.assert_array_equal(connected_areas(mask), ndimage.label(mask)[0])
