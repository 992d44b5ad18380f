"""Messages that ROS clients send, serialized by rosbags."""

import math

from thbridge.ros.messages.types import typestore

STORE = typestore()


def packed(msgtype: str, **fields: object) -> bytes:
    """Return a message serialized by rosbags, not by the code under test."""
    kind = STORE.types[msgtype]
    return bytes(STORE.serialize_ros1(kind(**fields), msgtype))


def pose(x: float, y: float, yaw: float, scale: float = 1.0) -> object:
    point = STORE.types["geometry_msgs/msg/Point"](x, y, 0.0)
    turned = STORE.types["geometry_msgs/msg/Quaternion"](0.0, 0.0, scale * math.sin(yaw / 2), scale * math.cos(yaw / 2))
    return STORE.types["geometry_msgs/msg/Pose"](point, turned)


def header(frame: str = "map") -> object:
    time = STORE.types["builtin_interfaces/msg/Time"](3, 4)
    return STORE.types["std_msgs/msg/Header"](7, time, frame)


def stamped(frame: str = "map", x: float = 1.0, y: float = 2.0, yaw: float = 0.5, scale: float = 1.0) -> bytes:
    return packed("geometry_msgs/msg/PoseStamped", header=header(frame), pose=pose(x, y, yaw, scale))
