"""Trajectories in the format of the TUM RGB-D benchmark. evo and other programs can read this format."""

import math

from sim.common.geometry import Pose2


def tum_line(stamp_ns: int, pose: Pose2) -> str:
    """Return the line `timestamp tx ty tz qx qy qz qw`: seconds, meters, a unit quaternion."""
    seconds, nanoseconds = divmod(stamp_ns, 1_000_000_000)
    qz, qw = math.sin(pose.theta / 2), math.cos(pose.theta / 2)
    return f"{seconds}.{nanoseconds:09d} {pose.x:.9f} {pose.y:.9f} 0 0 0 {qz:.9f} {qw:.9f}"
