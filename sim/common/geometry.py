"""SE(2): poses in the plane, their composition, and angles in [-pi, pi)."""

from functools import lru_cache

import numpy as np

from sim.common.frozen import frozen
from sim.numerics import elementary
from sim.numerics.elementary import wrap_angle
from sim.numerics.float_array import FloatArray

_cos_sin = lru_cache(maxsize=1024)(elementary.cos_sin)
"""Cosine and sine with a cache, because every tick needs them for the same few directions, e.g. of odom and laser."""


@frozen()
class Pose2:
    """A pose in the plane. It is also the transform from its own frame to its parent's.

    The name `base_in_odom` means the pose of frame base in frame odom. Meters, radians in [-pi, pi).
    """

    x: float
    y: float
    theta: float

    def compose(self, other: "Pose2") -> "Pose2":
        """Return the composition: `a_in_b.compose(c_in_a)` is `c_in_b`."""
        c, s = _cos_sin(self.theta)
        x = self.x + c * other.x - s * other.y
        y = self.y + s * other.x + c * other.y
        return Pose2(float(x), float(y), wrap_angle(self.theta + other.theta))

    def inverse(self) -> "Pose2":
        """Return the inverse: `a_in_b.inverse()` is `b_in_a`."""
        c, s = _cos_sin(self.theta)
        return Pose2(-c * self.x - s * self.y, s * self.x - c * self.y, wrap_angle(-self.theta))

    def between(self, other: "Pose2") -> "Pose2":
        """Return the pose of `other` relative to this pose. Both are in the same frame."""
        return self.inverse().compose(other)

    def distance(self, other: "Pose2") -> float:
        """Return the distance between the two origins, meters."""
        return elementary.hypot(other.x - self.x, other.y - self.y)

    def transform(self, points: FloatArray) -> FloatArray:
        """Return (..., 2) points of this frame in the parent frame."""
        c, s = _cos_sin(self.theta)
        points = np.asarray(points, dtype=np.float64)
        x, y = points[..., 0], points[..., 1]
        moved = np.empty(points.shape)
        moved[..., 0] = self.x + c * x - s * y
        moved[..., 1] = self.y + s * x + c * y
        return moved

    def array(self) -> FloatArray:
        """Return (3,) x, y, theta."""
        return np.array([self.x, self.y, self.theta])


IDENTITY = Pose2(0.0, 0.0, 0.0)
