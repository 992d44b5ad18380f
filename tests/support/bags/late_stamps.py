"""Stamps of a recording during which the clock was changed."""

from tests.support.bags.foreign_bags import TYPES, Header, stamp

BEGIN = 1_700_000_000_000_000_000
TENTH = 100_000_000
LATE = 5 * TENTH
HOUR = 36_000 * TENTH


def pose(stamp_ns: int, x: float) -> object:
    """Return a geometry_msgs/PoseStamped in the map frame."""
    placed = TYPES["geometry_msgs/msg/Pose"](
        TYPES["geometry_msgs/msg/Point"](x, 0.0, 0.0), TYPES["geometry_msgs/msg/Quaternion"](0.0, 0.0, 0.0, 1.0)
    )
    return TYPES["geometry_msgs/msg/PoseStamped"](Header(0, stamp(stamp_ns), "map"), placed)
