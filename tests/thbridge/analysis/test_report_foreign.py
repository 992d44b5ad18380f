"""Reports of other robots' recordings, with the topics and frames that the field's well-known bags have."""

from collections.abc import Iterable

import numpy as np
import pytest

from sim.common.geometry import IDENTITY, Pose2
from sim.common.grid import OccupancyGrid
from sim.common.observations import STANDSTILL, Twist
from sim.numerics.float_array import FloatArray
from thbridge.analysis.report.builder import read_report
from thbridge.analysis.report.report import Report, Track
from thbridge.analysis.report.tracks import TrajectoryTopics
from thbridge.ros.messages import pack, types
from thbridge.ros.messages.pack import Transform
from thbridge.ros.messages.types import plain_definition
from thbridge.ros.robots import namespace_of

TIMES = np.arange(20) / 10.0
GRID = OccupancyGrid(np.zeros((4, 4), dtype=np.int8), 0.5, IDENTITY)


class Message:
    def __init__(self, second: float, topic: str, msgtype: str, data: bytes, said: str = "") -> None:
        self.topic, self.msgtype, self.data = topic, said or msgtype, data
        self.stamp_ns = round(second * 1e9) + 1_500_000_000_000_000_000
        self.md5 = plain_definition(msgtype).md5


def odometry(topic: str, frame: str, child: str, ahead: float = 0.0) -> list[Message]:
    """A robot that drives along x, a meter a second."""
    return [
        Message(t, topic, types.ODOMETRY, pack.odometry(0, frame, child, Pose2(ahead + t, 0.0, 0.0), Twist(1.0, 0.0)))
        for t in TIMES
    ]


def tf(topic: str, parent: str, child: str, pose: Pose2, moving: bool = False, said: str = "") -> list[Message]:
    return [
        Message(
            t,
            topic,
            types.TFMESSAGE,
            pack.transforms(0, [Transform(parent, child, Pose2(pose.x + t * moving, pose.y, pose.theta))]),
            said,
        )
        for t in TIMES
    ]


def amcl(topic: str) -> list[Message]:
    covariance = np.diag([0.03, 0.01, 0.09])
    return [
        Message(
            t, topic, types.POSE_WITH_COVARIANCE, pack.pose_with_covariance(0, "map", Pose2(t, 1.0, 0.0), covariance)
        )
        for t in TIMES[::5]
    ]


def a_map(topic: str) -> list[Message]:
    return [Message(0.0, topic, types.OCCUPANCY_GRID, pack.occupancy_grid(0, "map", GRID))]


def report(*streams: Iterable[Message]) -> Report:
    return read_report(sorted((m for stream in streams for m in stream), key=lambda m: m.stamp_ns))


def only(found: Report) -> Track:
    (track,) = found.tracks
    return track


def ends(path: FloatArray) -> list[float]:
    return path[-1, 1:3].tolist()


def test_turtlebot3() -> None:
    """/odom, /tf with amcl's correction, /amcl_pose, /map, no truth."""
    found = report(
        odometry("/odom", "odom", "base_footprint"),
        tf("/tf", "map", "odom", Pose2(1.0, 2.0, 0.0)),
        tf("/tf", "odom", "base_footprint", IDENTITY, moving=True),
        amcl("/amcl_pose"),
        a_map("/map"),
    )
    track = only(found)
    assert found.grid == GRID
    assert (track.name, len(track.truth), ends(track.estimate)) == ("robot", 0, pytest.approx([2.9, 2.0]))
    assert track.deviations[0].tolist() == pytest.approx([0.0, 0.2, 0.3])
    assert track.speeds[:, 1].tolist() == [1.0] * 20
    assert track.sources == ("odometry from /odom", "estimate from tf map -> odom")


def test_stage_with_several_robots() -> None:
    """stageros: /robot_0/odom, /robot_0/base_scan, its truth in a frame that is called odom."""
    found = report(
        *(
            stream
            for robot in ("robot_1", "robot_0")
            for stream in (
                odometry(f"/{robot}/odom", f"/{robot}/odom", f"/{robot}/base_link"),
                odometry(f"/{robot}/base_pose_ground_truth", f"/{robot}/odom", f"/{robot}/base_link", 0.5),
                tf("/tf", "/map", f"/{robot}/odom", Pose2(0.25, 0.0, 0.0), said="tf/tfMessage"),
            )
        )
    )
    assert [track.name for track in found.tracks] == ["robot_0", "robot_1"]
    for track in found.tracks:
        assert track.errors[:, 1].tolist() == pytest.approx([0.25] * 20)
        assert any("used as positions on the map" in sentence for sentence in track.sources)


def test_a_pr2_that_has_its_odometry_under_a_node() -> None:
    """MIT's Stata bags: /base_odometry/odom, /base_scan, /robot_pose_ekf/odom_combined, tf's of old."""
    combined = [
        Message(
            t,
            "/robot_pose_ekf/odom_combined",
            types.POSE_WITH_COVARIANCE,
            pack.pose_with_covariance(0, "odom_combined", Pose2(t, 0.0, 0.0), np.eye(3)),
        )
        for t in TIMES
    ]
    track = only(report(odometry("/base_odometry/odom", "odom", "base_footprint"), combined))
    assert (track.name, len(track.odometry), len(track.estimate)) == ("robot", 20, 0)


def test_tf_alone() -> None:
    """gmapping's tutorials: scans and tf, no odometry topic."""
    found = report(
        tf("/tf", "/map", "/odom", Pose2(0.0, 3.0, 0.0), said="tf/tfMessage"),
        tf("/tf", "/odom", "/base_link", IDENTITY, moving=True, said="tf/tfMessage"),
    )
    track = only(found)
    assert ends(track.estimate) == pytest.approx([1.9, 3.0])
    assert track.sources == ("odometry from tf odom -> base_link", "estimate from tf map -> odom")


def test_two_sources_of_odometry_are_one_robot() -> None:
    track = only(
        report(
            odometry("/odometry/filtered", "odom", "base_link"),
            odometry("/husky_velocity_controller/odom", "odom", "base_link"),
            odometry("/camera/odom/sample", "camera_odom_frame", "camera_pose_frame"),
        )
    )
    assert track.sources[0].startswith("odometry from /husky_velocity_controller/odom; other topics: ")
    assert "/odometry/filtered" in track.sources[0]


def test_motion_capture_is_the_truth_and_slam_the_estimate() -> None:
    captured = [
        Message(t, "/vrpn_client_node/jackal/pose", types.POSE_STAMPED, _pose("world", Pose2(t, 0.0, 0.0)))
        for t in TIMES
    ]
    slam = [Message(t, "/slam_out_pose", types.POSE_STAMPED, _pose("map", Pose2(t, 0.3, 0.0))) for t in TIMES]
    wanted = [Message(0.0, "/move_base_simple/goal", types.POSE_STAMPED, _pose("map", Pose2(9.0, 9.0, 0.0)))]
    track = only(report(wanted, captured, slam, odometry("/odom", "odom", "base_link")))
    assert track.errors[:, 1].tolist() == pytest.approx([0.3] * 20)


def test_named_trajectories_are_compared_whatever_they_are_called() -> None:
    streams = [
        [Message(t, topic, types.POSE_STAMPED, _pose(frame, Pose2(t, y, 0.0))) for t in TIMES]
        for topic, frame, y in (("/lidar/a", "lab", 0.0), ("/fused", "odom", 0.25), ("/other", "odom", 9.0))
    ]
    messages = sorted((m for stream in streams for m in stream), key=lambda m: m.stamp_ns)
    assert read_report(messages).tracks == ()
    track = only(read_report(messages, named=TrajectoryTopics(truth="/lidar/a", estimate="/fused")))
    assert track.errors[:, 1].tolist() == pytest.approx([0.25] * 20)
    assert track.sources[0] == "truth from /lidar/a, as requested"


def test_of_several_robots_that_one_whose_trajectories_are_named() -> None:
    streams = [odometry(f"/r{n}/odom", f"r{n}/odom", f"r{n}/base_link") for n in (1, 2)]
    streams += [
        [Message(t, f"/r{n}/fused", types.POSE_STAMPED, _pose("map", Pose2(t, n, 0.0))) for t in TIMES] for n in (1, 2)
    ]
    messages = sorted((m for stream in streams for m in stream), key=lambda m: m.stamp_ns)
    track = only(read_report(messages, named=TrajectoryTopics(estimate="/r2/fused")))
    assert (track.name, ends(track.estimate)) == ("r2", pytest.approx([1.9, 2.0]))


def test_a_robot_of_which_only_commands_are_recorded() -> None:
    commands = [Message(t, "/turtle1/cmd_vel", types.TWIST, pack.command(Twist(0.5, 0.1))) for t in TIMES]
    track = only(report(commands))
    assert track.name == "turtle1"
    assert track.commands[:, 1].tolist() == [0.5] * 20


def _pose(frame: str, pose: Pose2) -> bytes:
    return pack.pose_with_covariance(0, frame, pose, np.eye(3))[: -36 * 8]


def test_robots_that_have_tf_topics_of_their_own() -> None:
    found = report(
        *(
            stream
            for number, robot in enumerate(("/tb3_0", "/tb3_1"))
            for stream in (
                odometry(f"{robot}/odom", "odom", "base_footprint"),
                tf(f"{robot}/tf", "map", "odom", Pose2(0.0, number, 0.0)),
            )
        )
    )
    assert [(track.name, ends(track.estimate)[1]) for track in found.tracks] == [("tb3_0", 0.0), ("tb3_1", 1.0)]


def test_costmaps_are_no_map_and_a_given_map_wins() -> None:
    bag = [*a_map("/move_base/global_costmap/costmap"), *odometry("/odom", "odom", "base_link")]
    assert read_report(bag).grid is None
    assert read_report(bag, GRID).grid == GRID
    assert read_report([*bag, *a_map("/robot/slam/map")]).grid == GRID


def test_a_robot_that_stands_still_has_no_errors_without_truth() -> None:
    still = [Message(0.0, "/odom", types.ODOMETRY, pack.odometry(0, "odom", "", IDENTITY, STANDSTILL))]
    assert len(only(report(still)).errors) == 0


@pytest.mark.parametrize(
    ("topic", "robot"),
    [
        ("/odom", ""),
        ("/robot1/move_base/goal", "robot1"),
        ("/fleet/tb3_0/scan", "fleet/tb3_0"),
        ("/odometry/filtered", ""),
        ("/mobile_base/odom", ""),
        ("/move_base/goal", ""),
        ("/camera/scan", ""),
    ],
)
def test_whose_a_topic_is(topic: str, robot: str) -> None:
    assert namespace_of(topic) == robot
