"""Bags as other robots record them, written by rosbags: a drive through a room whose walls are known."""

import itertools
import math
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from rosbags.rosbag1 import Writer
from rosbags.typesys import get_types_from_msg

from sim.common.geometry import IDENTITY, Pose2
from sim.common.grid import OccupancyGrid
from sim.common.raycast import Raycaster
from sim.numerics.float_array import FloatArray
from thbridge.files.grid_files import write_grid
from thbridge.ros.messages.types import typestore

STORE = typestore()
STORE.register(get_types_from_msg("geometry_msgs/TransformStamped[] transforms", "tf/msg/tfMessage"))
TYPES = STORE.types
Header = TYPES["std_msgs/msg/Header"]
Time = TYPES["builtin_interfaces/msg/Time"]
RATE = 10
START_NS = 1_500_000_000_000_000_000
PERIOD_NS = 1_000_000_000 // RATE
FIRST = Pose2(1.5, 1.5, 0.3)
LASER = Pose2(0.2, 0.05, 0.0)


def room(origin: Pose2 = IDENTITY) -> OccupancyGrid:
    """Return a room of 8 m x 5 m with a pillar and one corner cut off, so that no two places in it look the same to a
    laser."""
    cells = np.zeros((100, 160), dtype=np.int8)
    cells[[0, -1], :] = cells[:, [0, -1]] = 100
    cells[60:70, 90:100] = 100
    cells[70:, :30] = 100
    return OccupancyGrid(cells, 0.05, origin)


def drive(seconds: float, weave: float = 0.0) -> list[Pose2]:
    """Return the poses of a drive in the room's frame, RATE poses per second: a wide arc around the pillar, weaving
    left and right."""
    pose = FIRST
    poses = [pose]
    for number in range(int(seconds * RATE)):
        pose = pose.compose(Pose2(0.05, 0.0, 0.005 + weave * math.sin(0.4 * number)))
        poses.append(pose)
    return poses


def quaternion(roll: float, yaw: float) -> tuple[float, float, float, float]:
    """Return x, y, z and w of the quaternion of Rz(yaw) Rx(roll)."""
    sr, cr, sy, cy = math.sin(roll / 2), math.cos(roll / 2), math.sin(yaw / 2), math.cos(yaw / 2)
    return sr * cy, sr * sy, cr * sy, cr * cy


@dataclass
class Robot:
    """Robot in a bag, and options of its recording.

    Attributes:
        spikes: error along x of single odometry messages, meters, by the number of the message.
        reset_at: number of the odometry message at which odometry restarts from 0.
        weave: greatest turn to the left or right while the robot weaves, radians per scan.
        odom_early_ns: nanoseconds by which the stamps of odometry are too early, compared with those of scans.
    """

    laser: Pose2 = LASER
    roll: float = 0.0
    laser_height: float = 0.3
    odom_frame: str = "odom"
    base_frame: str = "base_footprint"
    body_frame: str = "base_link"
    laser_frame: str = "hokuyo"
    tf: bool = True
    odom_topic: str | None = "/odom"
    scan_topic: str = "/scan"
    more_scans: tuple[str, ...] = ()
    tf_type: str = "tf2_msgs/msg/TFMessage"
    tf_namespace: str = ""
    stray_tf: str | None = None
    odom_per_scan: int = 2
    slip: float = 1.02
    beams: int = 181
    angle_min: float = -math.pi / 2
    range_max: float = 6.0
    compression: Writer.CompressionFormat | None = None
    stamp_offsets: dict[int, int] = field(default_factory=dict)
    spikes: dict[int, float] = field(default_factory=dict)
    reset_at: int | None = None
    weave: float = 0.0
    odom_early_ns: int = 0


def ranges_at(grid: OccupancyGrid, robot: Robot, base: Pose2, angles: FloatArray) -> FloatArray:
    """Return the ranges of the laser; for a laser mounted upside down, the angles are mirrored."""
    seen = -angles if math.cos(robot.roll) < 0 else angles
    laser = base.compose(robot.laser).array()[np.newaxis]
    return Raycaster.of(grid).ranges(laser, seen, robot.range_max)[0]


def stamp(ns: int) -> object:
    return Time(ns // 1_000_000_000, ns % 1_000_000_000)


def transform(ns: int, parent: str, child: str, pose: Pose2, roll: float = 0.0, z: float = 0.0) -> object:
    vector, rotation = TYPES["geometry_msgs/msg/Vector3"], TYPES["geometry_msgs/msg/Quaternion"]
    return TYPES["geometry_msgs/msg/TransformStamped"](
        header=Header(0, stamp(ns), parent),
        child_frame_id=child,
        transform=TYPES["geometry_msgs/msg/Transform"](
            vector(pose.x, pose.y, z), rotation(*quaternion(roll, pose.theta))
        ),
    )


def odometry(ns: int, frame: str, child: str, pose: Pose2) -> object:
    point, rotation, vector = (TYPES[f"geometry_msgs/msg/{name}"] for name in ("Point", "Quaternion", "Vector3"))
    zero = vector(0.0, 0.0, 0.0)
    return TYPES["nav_msgs/msg/Odometry"](
        Header(0, stamp(ns), frame),
        child,
        TYPES["geometry_msgs/msg/PoseWithCovariance"](
            TYPES["geometry_msgs/msg/Pose"](point(pose.x, pose.y, 0.0), rotation(*quaternion(0.0, pose.theta))),
            np.zeros(36),
        ),
        TYPES["geometry_msgs/msg/TwistWithCovariance"](TYPES["geometry_msgs/msg/Twist"](zero, zero), np.zeros(36)),
    )


def laser_scan(ns: int, robot: Robot, angles: FloatArray, ranges: FloatArray) -> object:
    return TYPES["sensor_msgs/msg/LaserScan"](
        Header(0, stamp(ns), robot.laser_frame),
        float(angles[0]),
        float(angles[-1]),
        float(angles[1] - angles[0]),
        0.0,
        0.0,
        0.05,
        robot.range_max,
        ranges.astype(np.float32),
        np.zeros(0, dtype=np.float32),
    )


def write(path: Path, robot: Robot, seconds: float = 6.0) -> list[Pose2]:
    """Record a drive; return the true poses of the base at the scans, in the room's frame.

    The odometry starts at another pose, overestimates distances, and its messages lie between the scans.
    """
    grid = room()
    poses = drive(seconds, robot.weave)
    angles = robot.angle_min + np.arange(robot.beams) * (math.pi / 180)
    in_odom = Pose2(3.0, -2.0, 1.0)
    writer = Writer(path)
    if robot.compression is not None:
        writer.set_compression(robot.compression)
    with writer as bag:
        scans = (robot.scan_topic, *robot.more_scans)
        topics = dict.fromkeys(scans, "sensor_msgs/msg/LaserScan")
        # Old tf had no topic for static transforms; they are sent repeatedly.
        moving = f"{robot.tf_namespace}/tf"
        static = f"{robot.tf_namespace}/tf_static" if robot.tf_type == "tf2_msgs/msg/TFMessage" else moving
        if robot.tf:
            topics |= dict.fromkeys((moving, static), robot.tf_type)
        if robot.stray_tf:
            topics[robot.stray_tf] = robot.tf_type
        if robot.odom_topic:
            topics[robot.odom_topic] = "nav_msgs/msg/Odometry"
        at = {name: bag.add_connection(name, msgtype, typestore=STORE) for name, msgtype in topics.items()}

        def say(topic: str, ns: int, message: object) -> None:
            bag.write(at[topic], ns, STORE.serialize_ros1(message, at[topic].msgtype))

        if robot.tf:
            tf_message = TYPES[robot.tf_type]
            lift = transform(START_NS, robot.base_frame, robot.body_frame, Pose2(0.0, 0.0, 0.0), z=0.1)
            seat = transform(START_NS, robot.body_frame, robot.laser_frame, robot.laser, robot.roll, robot.laser_height)
            say(static, START_NS, tf_message([lift, seat]))

        said = itertools.count()
        origin = IDENTITY

        def say_odometry(ns: int, pose: Pose2) -> None:
            nonlocal origin
            number = next(said)
            origin = pose.inverse() if number == robot.reset_at else origin
            pose = origin.compose(pose)
            pose = Pose2(pose.x + robot.spikes.get(number, 0.0), pose.y, pose.theta)
            if robot.odom_topic:
                stamped = ns - robot.odom_early_ns
                say(robot.odom_topic, ns, odometry(stamped, robot.odom_frame, robot.base_frame, pose))
            if robot.tf:
                say(moving, ns, tf_message([transform(ns, robot.odom_frame, robot.base_frame, pose)]))
            if robot.stray_tf:  # from another robot, which uses the same frame names and stands still
                say(robot.stray_tf, ns, tf_message([transform(ns, robot.odom_frame, robot.base_frame, IDENTITY)]))

        half = PERIOD_NS // (2 * robot.odom_per_scan)
        say_odometry(START_NS - half, in_odom)
        for index, pose in enumerate(poses):
            ns = START_NS + index * PERIOD_NS
            stamped = ns + robot.stamp_offsets.get(index, 0)
            for topic in scans:
                say(topic, ns, laser_scan(stamped, robot, angles, ranges_at(grid, robot, pose, angles)))
            if index + 1 < len(poses):
                moved = pose.between(poses[index + 1])
                part = 1.0 / robot.odom_per_scan
                step = Pose2(robot.slip * moved.x * part, robot.slip * moved.y * part, moved.theta * part)
                for part_index in range(robot.odom_per_scan):
                    in_odom = in_odom.compose(step)
                    say_odometry(ns + half + 2 * half * part_index, in_odom)
    return poses


def write_map(folder: Path, origin: Pose2 = IDENTITY) -> Path:
    """Write the room as files for map_server, with its corner at `origin` in the map frame; return the path of
    map.yaml."""
    write_grid(folder, room(origin))
    return folder / "map.yaml"
