"""Stamps of a recording whose clock was set while it ran."""

from tests.support.bags.foreign_bags import TYPES, Header, stamp

BEGIN = 1_700_000_000_000_000_000
TENTH = 100_000_000
LATE = 5 * TENTH
HOUR = 36_000 * TENTH


def pose(stamp_ns: int, x: float) -> object:
    """geometry_msgs/PoseStamped on the map."""
    placed = TYPES["geometry_msgs/msg/Pose"](
        TYPES["geometry_msgs/msg/Point"](x, 0.0, 0.0), TYPES["geometry_msgs/msg/Quaternion"](0.0, 0.0, 0.0, 1.0)
    )
    return TYPES["geometry_msgs/msg/PoseStamped"](Header(0, stamp(stamp_ns), "map"), placed)
