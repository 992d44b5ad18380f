"""Bounds of numbers for drawings and calculations. They are needed because drivers also write NaN, inf and 1e308."""

LARGEST = 1e9
"""Maximum plausible number of meters, radians or m/s."""


def is_plausible(*values: float) -> bool:
    """Return True if all values are finite and not larger than `LARGEST`."""
    return all(abs(value) <= LARGEST for value in values)  # NaN gives False.
