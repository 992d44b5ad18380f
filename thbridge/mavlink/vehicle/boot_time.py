"""Time since boot in messages, which is the simulated time since the start of the session."""

from sim.common.observations import TICKS_PER_SECOND

MICROSECONDS_PER_TICK = 1_000_000 // TICKS_PER_SECOND


def milliseconds(tick: int) -> int:
    """Convert a tick to milliseconds in 32 bits. They start again at 0 after 50 days."""
    return microseconds(tick) // 1000 & 0xFFFFFFFF


def microseconds(tick: int) -> int:
    """Convert a tick to microseconds."""
    return tick * MICROSECONDS_PER_TICK
