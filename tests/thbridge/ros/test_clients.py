import math
import struct

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from sim.common.geometry import Pose2
from sim.common.observations import Twist
from tests.support.ros.packed_messages import STORE, header, packed, pose, stamped
from thbridge.ros import clients
from thbridge.ros.clients import ActionCancel, ActionGoal, InvalidMessage, PlanRequest, PoseEstimate


def test_a_goal_of_rviz_is_a_pose() -> None:
    found = clients.goal_pose(stamped())
    assert isinstance(found, Pose2)
    assert (found.x, found.y, found.theta) == pytest.approx((1.0, 2.0, 0.5))


def test_frames_may_have_the_slash_of_old() -> None:
    assert isinstance(clients.goal_pose(stamped("/map")), Pose2)


@pytest.mark.parametrize(
    ("data", "word"),
    [
        (stamped("robot1/odom"), "robot1/odom"),
        (stamped(x=math.nan), "finite"),
        (stamped(y=math.inf), "finite"),
        (stamped(x=-1e300), "farther"),
        (stamped(scale=0.0), "quaternion"),
        (stamped()[:-1], "ends too early"),
    ],
)
def test_a_goal_that_cannot_be_used_says_why(data: bytes, word: str) -> None:
    found = clients.goal_pose(data)
    assert isinstance(found, InvalidMessage)
    assert word in found.sentence


def test_quaternions_need_not_have_length_one() -> None:
    found = clients.goal_pose(stamped(yaw=-2.0, scale=3.0))
    assert isinstance(found, Pose2)
    assert found.theta == pytest.approx(-2.0)


def test_a_tilted_goal_is_refused() -> None:
    data = bytearray(stamped())
    data[-32:] = struct.pack("<4d", math.sin(0.5), 0.0, 0.0, math.cos(0.5))
    assert isinstance(clients.goal_pose(bytes(data)), InvalidMessage)


def estimate(covariance: np.ndarray) -> bytes:
    inner = STORE.types["geometry_msgs/msg/PoseWithCovariance"](pose(1.0, 2.0, 0.5), covariance.ravel())
    return packed("geometry_msgs/msg/PoseWithCovarianceStamped", header=header(), pose=inner)


def test_an_estimate_has_the_covariance_of_the_plane() -> None:
    found = clients.pose_estimate(estimate(np.diag([0.1, 0.2, 9.0, 9.0, 9.0, 0.3])))
    assert isinstance(found, PoseEstimate)
    assert np.array_equal(found.covariance, np.diag([0.1, 0.2, 0.3]))


@pytest.mark.parametrize("bad", [np.full((6, 6), np.nan), -np.eye(6), 1e308 * np.eye(6)])
def test_an_estimate_with_an_impossible_covariance_is_refused(bad: np.ndarray) -> None:
    assert isinstance(clients.pose_estimate(estimate(bad)), InvalidMessage)


def test_goals_and_cancels_of_actions_keep_their_names_and_times() -> None:
    goal_id = STORE.types["actionlib_msgs/msg/GoalID"](STORE.types["builtin_interfaces/msg/Time"](5, 6), "me-1")
    target = STORE.types["geometry_msgs/msg/PoseStamped"](header(), pose(1.0, 2.0, 0.5))
    goal = STORE.types["move_base_msgs/msg/MoveBaseGoal"](target)
    data = packed("move_base_msgs/msg/MoveBaseActionGoal", header=header(), goal_id=goal_id, goal=goal)
    found = clients.action_goal(data)
    assert isinstance(found, ActionGoal)
    assert (found.goal_id, found.stamp_ns) == ("me-1", 5_000_000_006)
    assert isinstance(found.pose, Pose2)
    data = bytes(STORE.serialize_ros1(goal_id, "actionlib_msgs/msg/GoalID"))
    assert clients.action_cancel(data) == ActionCancel("me-1", 5_000_000_006)


def test_goals_with_endless_names_are_refused() -> None:
    for length, kind in ((512, ActionCancel), (513, InvalidMessage)):
        data = struct.pack("<III", 0, 0, length) + b"x" * length
        assert isinstance(clients.action_cancel(data), kind)
        whole = packed("std_msgs/msg/Header", seq=0, stamp=header().stamp, frame_id="") + data + stamped()
        assert isinstance(clients.action_goal(whole), ActionGoal if kind is ActionCancel else InvalidMessage)


def test_a_velocity_is_forward_and_around() -> None:
    assert clients.velocity(struct.pack("<6d", 0.5, 9.0, 9.0, 9.0, 9.0, -0.25)) == Twist(0.5, -0.25)
    assert isinstance(clients.velocity(struct.pack("<6d", math.nan, 0, 0, 0, 0, 0)), InvalidMessage)


def test_a_question_without_a_start_is_about_the_robots_own_place() -> None:
    found = clients.plan_request(stamped("") + stamped(x=4.0) + struct.pack("<f", 0.5))
    assert isinstance(found, PlanRequest)
    assert (found.start, found.goal.x, found.tolerance) == (None, 4.0, 0.5)
    both = clients.plan_request(stamped(x=3.0) + stamped(x=4.0) + struct.pack("<f", 0.5))
    assert isinstance(both, PlanRequest)
    assert both.start is not None
    assert both.start.x == 3.0


@given(st.binary(max_size=400))
def test_no_bytes_at_all_make_any_of_them_raise(data: bytes) -> None:
    for read in (clients.goal_pose, clients.pose_estimate, clients.action_goal, clients.action_cancel,
                 clients.velocity, clients.plan_request):  # fmt: skip
        read(data)


@given(st.integers(0, 140), st.binary(min_size=1, max_size=8))
def test_no_mutated_message_makes_them_raise(at: int, noise: bytes) -> None:
    data = bytearray(stamped())
    data[at : at + len(noise)] = noise
    clients.goal_pose(bytes(data))
    clients.plan_request(bytes(data) + stamped() + struct.pack("<f", 0.5))
