"""Goals for the actions of Nav2, and ids for them."""

from collections.abc import Sequence

from thbridge.ros2.distribution import Distribution


def goal_id(number: int) -> bytes:
    """Return the UUID of a goal."""
    return bytes([number]) * 16


def pose(distribution: Distribution, x: float, frame: str = "map") -> object:
    """Return a geometry_msgs/PoseStamped."""
    make = distribution.make
    return make(
        "geometry_msgs/msg/PoseStamped",
        header=make("std_msgs/msg/Header", frame_id=frame),
        pose=make("geometry_msgs/msg/Pose", position=make("geometry_msgs/msg/Point", x=x)),
    )


def navigation_goal(distribution: Distribution, x: float, frame: str = "map", behavior_tree: str = "") -> object:
    """Return a goal of navigate_to_pose."""
    return distribution.make(
        "nav2_msgs/action/NavigateToPose_Goal", pose=pose(distribution, x, frame), behavior_tree=behavior_tree
    )


def waypoints_goal(distribution: Distribution, xs: Sequence[float], index: int = 0, loops: int = 0) -> object:
    """Return a goal of follow_waypoints."""
    return distribution.make(
        "nav2_msgs/action/FollowWaypoints_Goal",
        poses=[pose(distribution, x) for x in xs],
        goal_index=index,
        number_of_loops=loops,
    )
