"""Owner and purpose of topics and frames. They are guessed from names that robots commonly use.

Names differ: Stage has `/robot_0/base_scan`, TurtleBot `/odom`, robot_localization `/odometry/filtered`, a camera
`/camera/odom/sample`. The type of a message determines its purpose. The prefix of its frame names
its robot. Without a prefix, the namespace of its topic names its robot, unless this is the name of a node.
"""

import re
from collections.abc import Collection, Iterable, Mapping

from thbridge.ros.names import frame_name

MAP_FRAMES = frozenset({"map", "world", "static_map"})
"""Last words of the frames of maps."""
ODOM_FRAME = "odom"
"""Beginning of the last word in names of odometry frames, such as odom and odom_combined."""

_OWN_TOPICS = frozenset(
    {
        *("odom", "base_pose_ground_truth", "scan", "base_scan", "amcl_pose", "cmd_vel", "battery", "battery_state"),
        *("particlecloud", "initialpose", "robot_pose"),
    }
)
"""Topics that are directly in a robot's namespace."""
_NODES = re.compile(
    r"odom|pose|[eu]kf|filter|camera|slam|locali[sz]|base$|driver|controller|move_base|amcl|imu|gps|zed|t265|gazebo|ground"
)
"""Words in namespaces that are names of nodes, not of robots."""
_TRUTH = re.compile(r"ground_?truth|(^|[/_])(gt|truth|mocap|vicon|vrpn\w*|optitrack)([/_]|$)")


def last_word(name: str) -> str:
    """Return a topic or frame without its namespace or prefix."""
    return name.rpartition("/")[2]


def is_map_frame(frame: str) -> bool:
    """Return True if a frame is the frame of a map."""
    return last_word(frame_name(frame)) in MAP_FRAMES


def is_odom_frame(frame: str) -> bool:
    """Return True if a frame is a frame of odometry."""
    return last_word(frame_name(frame)).startswith(ODOM_FRAME)


def is_truth(topic: str) -> bool:
    """Return True if a topic of poses has the name of a ground truth, from a simulator or from motion capture."""
    return _TRUTH.search(topic.lower()) is not None


def prefix_of(frame: str) -> str:
    """Return the robot's part of a frame, such as "robot1" for "/robot1/base_link", or an empty text."""
    return frame_name(frame).rpartition("/")[0]


def namespace_of(topic: str) -> str:
    """Return the robot's part of a topic, such as "robot1" for "/robot1/odom", or an empty text."""
    words = topic.strip("/").split("/")
    for length in range(len(words) - 1, 0, -1):
        if words[length] in _OWN_TOPICS or words[length] == "move_base":
            namespace = "/".join(words[:length])
            return "" if _NODES.search(words[length - 1].lower()) else namespace
    return ""


def owner_of(topic: str, robots: Collection[str]) -> str:
    """Return the known robot to which a topic belongs.

    It is the robot in the topic's namespace. If there is none, it is the only robot. If there are several robots, it is
    the namespace itself.
    """
    path = topic.strip("/")
    within = [robot for robot in robots if robot and path.startswith(f"{robot}/")]
    if within:
        return max(within, key=len)
    return next(iter(robots)) if len(robots) == 1 else namespace_of(topic)


def usual_first(topics: Iterable[str], usual: Collection[str]) -> list[str]:
    """Return topics in the order of preference: usual names in the order of `usual`, then names with few slashes."""
    ranks = {name: rank for rank, name in enumerate(usual)}
    return sorted(topics, key=lambda topic: (ranks.get(last_word(topic), len(ranks)), topic.count("/"), topic))


def owner_of_edge(key: tuple[str, str, str]) -> str:
    """Return the robot of a transform: the prefix of one of its frames, or else the namespace of the tf topic.

    Args:
        key: namespace of the topic, parent frame, and child frame.
    """
    namespace, parent, child = key
    return prefix_of(child) or prefix_of(parent) or namespace


def robots_among(
    odometry: Mapping[str, str], edges: Iterable[tuple[str, str, str]], others: Iterable[str]
) -> frozenset[str]:
    """Return the names of the robots: prefixes of frames, and namespaces. A robot without them has the name "".

    Args:
        odometry: topics of odometry, each with its child frame.
        edges: transforms with an odometry frame as parent, as in `owner_of_edge`.
        others: topics that belong to a robot.
    """
    found = {prefix_of(child) or namespace_of(topic) for topic, child in odometry.items()}
    if not found:
        found |= {owner_of_edge(edge) for edge in edges}
    for topic in others:
        found.add(owner_of(topic, found) if found else namespace_of(topic))
    named = found - {""}
    return frozenset(named if len(named) == 1 else found)


def by_number(robot: str) -> tuple[int, str]:
    """Return the sorting key of a robot. With it, robot2 is before robot10."""
    digits = "".join(sign for sign in robot if sign.isdigit())
    return int(digits or 0), robot
