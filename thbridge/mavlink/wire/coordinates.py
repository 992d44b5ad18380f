"""Conversions between MAVLink's coordinate frames and the map: points, headings and velocities.

The map has x east and y north, and angles counterclockwise from east. MAVLink has x north and y east, and angles
clockwise from north. Heights are ignored, because all robots are on one floor.
"""

import math

from sim.common.geometry import Pose2
from sim.common.observations import Twist
from sim.numerics import elementary
from sim.numerics.elementary import wrap_angle
from thbridge.mavlink.wire.dialect import mav

GLOBAL = frozenset(
    {
        mav.MAV_FRAME_GLOBAL,
        mav.MAV_FRAME_GLOBAL_RELATIVE_ALT,
        mav.MAV_FRAME_GLOBAL_TERRAIN_ALT,
        mav.MAV_FRAME_GLOBAL_INT,
        mav.MAV_FRAME_GLOBAL_RELATIVE_ALT_INT,
        mav.MAV_FRAME_GLOBAL_TERRAIN_ALT_INT,
    }
)
"""Frames with latitude and longitude. They differ only in their heights."""

_BODY = frozenset({mav.MAV_FRAME_BODY_NED, mav.MAV_FRAME_BODY_OFFSET_NED, mav.MAV_FRAME_BODY_FRD})

LOCAL = _BODY | {mav.MAV_FRAME_LOCAL_NED, mav.MAV_FRAME_LOCAL_OFFSET_NED}
"""Frames in meters. Their origin is the map's origin or the robot, and their axes are those of the map or the robot."""

PER_METRE = 10_000
"""Units per meter in COMMAND_INT and MISSION_ITEM_INT for frames of `LOCAL`."""

_TURN_RATE = 2.0
"""Angular velocity in rad/s for each radian between the robot's heading and the wanted direction."""


def yaw_of(theta: float) -> float:
    """Convert a direction of the map to MAVLink's yaw: radians clockwise from north, in [-pi, pi)."""
    return wrap_angle(math.pi / 2.0 - theta)


def theta_of(yaw: float) -> float:
    """Convert a finite yaw to a direction of the map."""
    return wrap_angle(math.pi / 2.0 - yaw)


def compass(theta: float) -> float:
    """Convert a direction of the map to degrees clockwise from north, in [0, 360)."""
    return math.degrees(yaw_of(theta)) % 360.0


def quaternion(theta: float) -> tuple[float, float, float, float]:
    """Convert a direction of the map to a quaternion (w, x, y, z) of a rotation about MAVLink's down axis."""
    half = yaw_of(theta) / 2.0
    w, z = elementary.cos_sin(half)
    return w, 0.0, 0.0, z


def north_east(twist: Twist, theta: float) -> tuple[float, float]:
    """Return the velocity north and east, m/s, of a robot with heading `theta`."""
    east, north = elementary.cos_sin(theta)
    return twist.linear * north, twist.linear * east


def point_in_map(frame: int, first: float, second: float, base_in_map: Pose2) -> tuple[float, float]:
    """Return the map point for coordinates in a frame of `LOCAL`. They are north and east, or forward and right."""
    if frame in _BODY:
        away = base_in_map.compose(Pose2(first, -second, 0.0))
        return away.x, away.y
    if frame == mav.MAV_FRAME_LOCAL_OFFSET_NED:
        return base_in_map.x + second, base_in_map.y + first
    return second, first


def twist_towards(
    frame: int, first: float, second: float, yaw_rate: float, base_in_map: Pose2, fastest: Twist
) -> Twist:
    """Return the twist for a velocity that is given in a frame of `LOCAL`. Robots cannot move sideways.

    In body frames, the twist consists of the forward velocity and the yaw rate. In map frames, the robot turns toward
    the direction of the velocity. Meanwhile it drives at the speed times the cosine of the remaining angle. If the
    velocity is 0, it turns at the yaw rate.
    """
    if frame in _BODY:
        return bounded(Twist(first, -yaw_rate), fastest)
    speed = elementary.hypot(first, second)
    if speed == 0.0:
        return bounded(Twist(0.0, -yaw_rate), fastest)
    error = wrap_angle(elementary.atan2(first, second) - base_in_map.theta)
    # If more than a right angle remains, the robot only turns.
    return bounded(Twist(speed * max(0.0, elementary.cos(error)), _TURN_RATE * error), fastest)


def bounded(twist: Twist, fastest: Twist) -> Twist:
    """Clamp both speeds of a twist to the maximum speeds."""
    return Twist(
        max(-fastest.linear, min(twist.linear, fastest.linear)),
        max(-fastest.angular, min(twist.angular, fastest.angular)),
    )
