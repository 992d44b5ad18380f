"""The robot's footprint: padding, outline, radii.

Source: ros-planning/navigation, costmap_2d/src/footprint.cpp.
"""

import math

import numpy as np

from sim.numerics import elementary
from sim.numerics.float_array import FloatArray


def of_radius(radius: float) -> FloatArray:
    """Return (16, 2) corners of the polygon that costmap_2d uses for round robots."""
    return radius * np.array([elementary.cos_sin(i * 2 * math.pi / 16) for i in range(16)])


def pad(footprint: FloatArray, padding: float) -> FloatArray:
    """Move every corner outward by `padding` meters along each axis. Coordinates that are 0 do not change.

    Args:
        footprint: (n, 2) corners in the base frame, meters.

    Returns:
        (n, 2).
    """
    padded: FloatArray = footprint + padding * np.sign(footprint)
    return padded


def radii(footprint: FloatArray) -> tuple[float, float]:
    """Return the inscribed and circumscribed radius about the base frame's origin, meters.

    Args:
        footprint: (n, 2) corners in order. The last corner is connected to the first.
    """
    following = np.roll(footprint, -1, axis=0)
    edges = following - footprint
    lengths = np.maximum((edges * edges).sum(axis=1), 1e-12)
    along = np.clip(-(footprint * edges).sum(axis=1) / lengths, 0.0, 1.0)
    nearest = footprint + along[:, np.newaxis] * edges
    return min(map(elementary.hypot, *nearest.T)), max(map(elementary.hypot, *footprint.T))


def outline(footprint: FloatArray, spacing: float) -> FloatArray:
    """Return (m, 2) points along the outline, including the corners, at most `spacing` meters apart."""
    points: list[FloatArray] = []
    for start, end in zip(footprint, np.roll(footprint, -1, axis=0), strict=True):
        steps = max(1, math.ceil(elementary.hypot(*(end - start)) / spacing))
        points.extend(start + (end - start) * (step / steps) for step in range(steps))
    return np.array(points)
