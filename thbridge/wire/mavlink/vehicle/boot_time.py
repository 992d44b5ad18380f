"""How messages count simulated time since the session began, which a vehicle has for its time since boot."""

from sim.common.observations import TICKS_PER_SECOND

MICROSECONDS_PER_TICK = 1_000_000 // TICKS_PER_SECOND


def milliseconds(tick: int) -> int:
    """As 32 bits count them: from 0 again after 50 days."""
    return microseconds(tick) // 1000 & 0xFFFFFFFF


def microseconds(tick: int) -> int:
    """As 64 bits count them."""
    return tick * MICROSECONDS_PER_TICK
