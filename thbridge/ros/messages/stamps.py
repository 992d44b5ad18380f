"""Conversion of ticks to ROS time and back."""

from sim.common.observations import TICKS_PER_SECOND

START_NS = 1_000_000_000
"""Time stamp of tick 0. It is not 0: for `rosbag play`, a time stamp of 0 means "no time yet", and it drops the
message."""

TICK_NS = 1_000_000_000 // TICKS_PER_SECOND


def stamp_ns(tick: int) -> int:
    """Return the ROS time at a tick, nanoseconds."""
    return START_NS + tick * TICK_NS


def tick_of(stamp_ns: int) -> int:
    """Return the tick at a ROS time."""
    return (stamp_ns - START_NS) // TICK_NS
