import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from thbridge.ros.messages.unpack import LaserScan
from ui.model.watching.robot_scene_builder import CHI_SQUARE_95, ellipse_of, end_points, thinned

SIZES = st.floats(0.01, 10.0)


@given(major=SIZES, minor=SIZES, angle=st.floats(-1.5, 1.5))
def test_an_ellipse_is_that_of_its_covariance(major: float, minor: float, angle: float) -> None:
    axes = np.array([[math.cos(angle), -math.sin(angle)], [math.sin(angle), math.cos(angle)]])
    covariance = np.zeros((3, 3))
    covariance[:2, :2] = axes @ np.diag([major**2, minor**2]) @ axes.T / CHI_SQUARE_95
    found = ellipse_of(covariance)
    assert found is not None
    assert (found.major, found.minor) == pytest.approx((max(major, minor), min(major, minor)), rel=1e-6)
    along = np.array([math.cos(found.angle), math.sin(found.angle)])
    assert along @ covariance[:2, :2] @ along == pytest.approx(found.major**2 / CHI_SQUARE_95, rel=1e-6)


@pytest.mark.parametrize("covariance", [np.full((3, 3), np.nan), np.diag([-1.0, 1.0, 1.0])])
def test_a_covariance_that_says_nothing_has_none(covariance: np.ndarray[tuple[int, int], np.dtype[np.float64]]) -> None:
    assert ellipse_of(covariance) is None


def scan(*ranges: float) -> LaserScan:
    return LaserScan(0, "laser", 0.0, math.pi / 2, math.pi / 2, 0.1, 5.0, np.array(ranges, dtype=np.float32))


def test_beams_that_met_nothing_end_nowhere() -> None:
    for nothing in (math.inf, math.nan, 6.0, 0.05):
        assert end_points(scan(2.0, nothing), np.eye(4)) == pytest.approx(np.array([[2.0, 0.0]]))


def test_a_laser_upside_down_turns_the_other_way() -> None:
    hanging = np.diag([1.0, -1.0, -1.0, 1.0])
    hanging[:2, 3] = 10.0, 20.0
    assert end_points(scan(1.0, 2.0), hanging) == pytest.approx(np.array([[11.0, 20.0], [10.0, 18.0]]))


@given(size=st.integers(0, 500), most=st.integers(1, 100))
def test_thinning_keeps_some_of_it_from_the_first_to_the_last(size: int, most: int) -> None:
    cloud = np.arange(3.0 * size).reshape(size, 3)
    kept = thinned(cloud, most)
    assert len(kept) == min(size, most)
    assert {tuple(row) for row in kept.tolist()} <= {tuple(row) for row in cloud.tolist()}
    if 1 < most < size:
        assert kept[[0, -1]].tolist() == cloud[[0, -1]].tolist()
