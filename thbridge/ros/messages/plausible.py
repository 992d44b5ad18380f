"""Bounds of numbers that can be drawn and calculated with, because drivers also write NaN, inf and 1e308."""

LARGEST = 1e9
"""Largest plausible number of meters, radians or m/s."""


def is_plausible(*values: float) -> bool:
    """Return True if all values are finite and at most `LARGEST`."""
    return all(abs(value) <= LARGEST for value in values)  # False for NaN
