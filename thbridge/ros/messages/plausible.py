"""Bounds of numbers in messages that can be drawn and calculated with: drivers write NaN, inf and 1e308, too."""

LARGEST = 1e9
"""Largest number of meters, radians or m/s that is taken for one."""


def is_plausible(*values: float) -> bool:
    """True when all are finite, and none is beyond `LARGEST`."""
    return all(abs(value) <= LARGEST for value in values)  # NaN fails it
