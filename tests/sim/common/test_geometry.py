import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from sim.common.geometry import IDENTITY, Pose2
from sim.numerics.elementary import wrap_angle
from sim.numerics.kernels import njit

coordinates = st.floats(-100, 100)
angles = st.floats(-math.pi, math.pi, exclude_max=True)
poses = st.builds(Pose2, coordinates, coordinates, angles)


def same(a: Pose2, b: Pose2) -> bool:
    turn = abs(wrap_angle(a.theta - b.theta))
    return a.distance(b) < 1e-9 and min(turn, 2 * math.pi - turn) < 1e-9


@given(st.floats(-1e6, 1e6))
def test_a_wrapped_angle_is_the_same_direction_in_range(angle: float) -> None:
    wrapped = wrap_angle(angle)
    assert -math.pi <= wrapped < math.pi
    assert math.cos(wrapped) == pytest.approx(math.cos(angle), abs=1e-9)
    assert math.sin(wrapped) == pytest.approx(math.sin(angle), abs=1e-9)


@pytest.mark.parametrize(
    ("angle", "wrapped"),
    [
        (0.0, 0.0),
        (math.pi, -math.pi),
        (-math.pi, -math.pi),
        (np.nextafter(-math.pi, -4.0), -math.pi),
        (-1e-20, 0.0),
        (3 * math.pi, -math.pi),
    ],
)
def test_the_seam_of_the_angles_is_minus_pi(angle: float, wrapped: float) -> None:
    assert wrap_angle(angle) == pytest.approx(wrapped, abs=1e-15)
    assert -math.pi <= wrap_angle(angle) < math.pi


@given(poses)
def test_a_pose_and_its_inverse_cancel(pose: Pose2) -> None:
    assert same(pose.compose(pose.inverse()), IDENTITY)
    assert same(pose.inverse().compose(pose), IDENTITY)


@given(poses, poses, poses)
def test_composition_is_associative(a: Pose2, b: Pose2, c: Pose2) -> None:
    assert same(a.compose(b).compose(c), a.compose(b.compose(c)))


@given(poses, poses)
def test_between_undoes_compose(a: Pose2, b: Pose2) -> None:
    assert same(a.between(a.compose(b)), b)


@given(poses, poses)
def test_points_move_as_poses_do(a: Pose2, b: Pose2) -> None:
    moved = a.transform(np.array([[b.x, b.y]]))
    expected = a.compose(b)
    assert moved == pytest.approx(np.array([[expected.x, expected.y]]), abs=1e-9)


def test_a_pose_ahead_of_one_that_looks_up_lies_above() -> None:
    assert same(Pose2(1.0, 2.0, math.pi / 2).compose(Pose2(3.0, 1.0, 0.5)), Pose2(0.0, 5.0, math.pi / 2 + 0.5))


def test_distance_ignores_headings() -> None:
    assert Pose2(0, 0, 1).distance(Pose2(3, 4, -1)) == 5.0


@njit(cache=False)
def wrapped_in_a_kernel(angle: float) -> float:
    return wrap_angle(angle)


@given(st.floats(-1e6, 1e6))
def test_kernels_wrap_angles_to_the_same_bits(angle: float) -> None:
    assert wrapped_in_a_kernel(angle).hex() == wrap_angle(angle).hex()


def test_numbers_of_arrays_become_plain_ones() -> None:
    x, y, theta = np.array([1.0, 2.0, 3.0])
    composed = Pose2(x, y, theta).compose(Pose2(x, y, theta))
    assert {type(value) for value in (composed.x, composed.y, composed.theta, wrap_angle(theta))} == {float}


def test_an_array_holds_x_y_theta() -> None:
    assert Pose2(1.0, 2.0, 3.0).array().tolist() == [1.0, 2.0, 3.0]
