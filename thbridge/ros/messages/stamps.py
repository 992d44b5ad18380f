"""Conversion of ticks to ROS time and back."""

from sim.common.observations import TICKS_PER_SECOND

START_NS = 1_000_000_000
"""The stamp of tick 0: `rosbag play` takes a stamp of zero for "no time yet" and drops the message."""

TICK_NS = 1_000_000_000 // TICKS_PER_SECOND


def stamp_ns(tick: int) -> int:
    """Nanoseconds of ROS time at a tick."""
    return START_NS + tick * TICK_NS


def tick_of(stamp_ns: int) -> int:
    """The tick at a time."""
    return (stamp_ns - START_NS) // TICK_NS
