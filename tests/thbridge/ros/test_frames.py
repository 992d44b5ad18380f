import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from sim.common.geometry import Pose2
from thbridge.ros.frames import FrameTree, PlanarMount
from thbridge.ros.messages.unpack import SpatialTransform

ANGLES = st.floats(-math.pi, math.pi, exclude_max=True)
POSES = st.builds(Pose2, st.floats(-5, 5), st.floats(-5, 5), ANGLES)


def hung(parent: str, child: str, pose: Pose2, roll: float = 0.0, z: float = 0.0) -> SpatialTransform:
    sr, cr = math.sin(roll / 2), math.cos(roll / 2)
    sy, cy = math.sin(pose.theta / 2), math.cos(pose.theta / 2)
    return SpatialTransform(0, parent, child, (pose.x, pose.y, z), (sr * cy, sr * sy, cr * sy, cr * cy))


def tree(*transforms: SpatialTransform) -> FrameTree:
    grown = FrameTree()
    for transform in transforms:
        grown.add(transform)
    return grown


def mount(grown: FrameTree, frame: str, reference: str) -> PlanarMount:
    pose = grown.pose(frame, reference)
    assert pose is not None
    return PlanarMount.of(pose)


def same(a: Pose2, b: Pose2) -> bool:
    turn = math.remainder(a.theta - b.theta, 2 * math.pi)
    return bool(np.allclose((a.x, a.y, turn), (b.x, b.y, 0.0), atol=1e-9))


@given(POSES, POSES, POSES)
def test_hops_compose_as_in_the_plane(first: Pose2, second: Pose2, other: Pose2) -> None:
    grown = tree(hung("base", "plate", first, z=0.2), hung("plate", "laser", second), hung("base", "imu", other))
    assert same(mount(grown, "laser", "base").laser_in_base, first.compose(second))
    assert same(mount(grown, "base", "laser").laser_in_base, first.compose(second).inverse())
    assert same(mount(grown, "laser", "imu").laser_in_base, other.between(first.compose(second)))


@given(ANGLES)
def test_a_laser_upside_down(yaw: float) -> None:
    found = mount(tree(hung("base", "laser", Pose2(1.0, 2.0, yaw), roll=math.pi)), "laser", "base")
    assert same(found.laser_in_base, Pose2(1.0, 2.0, yaw))
    assert found.upside_down
    assert found.tilt == pytest.approx(0.0, abs=1e-7)


def test_two_halves_of_a_turn_are_none() -> None:
    grown = tree(hung("base", "a", Pose2(0, 0, 0), math.pi), hung("a", "laser", Pose2(0, 0, 0), math.pi))
    assert not mount(grown, "laser", "base").upside_down


def test_a_tilted_laser() -> None:
    assert mount(tree(hung("base", "laser", Pose2(0, 0, 0), 0.5)), "laser", "base").tilt == pytest.approx(0.5)


def test_slashes_before_names_are_nothing() -> None:
    assert mount(tree(hung("/base", "/laser", Pose2(1, 0, 0))), "laser", "base").laser_in_base == Pose2(1, 0, 0)


def test_the_first_word_holds() -> None:
    grown = tree(hung("base", "laser", Pose2(1, 0, 0)))
    assert not grown.add(hung("base", "laser", Pose2(2, 0, 0)))
    assert mount(grown, "laser", "base").laser_in_base.x == 1


def test_nothing_joins_strangers() -> None:
    assert tree(hung("base", "laser", Pose2(0, 0, 0))).pose("laser", "other") is None


def test_frames_that_hang_on_each_other() -> None:
    grown = tree(hung("a", "b", Pose2(0, 0, 0)), hung("b", "a", Pose2(0, 0, 0)))
    assert grown.chain("a") == ["a", "b"]
    assert grown.pose("a", "c") is None


def test_an_empty_quaternion_is_no_rotation() -> None:
    grown = tree(SpatialTransform(0, "base", "laser", (1.0, 0.0, 0.0), (0.0, 0.0, 0.0, 0.0)))
    assert mount(grown, "laser", "base").laser_in_base == Pose2(1, 0, 0)


def test_what_is_not_finite_is_not_taken() -> None:
    assert not FrameTree().add(hung("base", "laser", Pose2(math.nan, 0, 0)))
