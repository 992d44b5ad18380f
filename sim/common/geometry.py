"""SE(2): poses of the plane, their composition, and angles in [-pi, pi)."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]


def wrap_angle(angle: float) -> float:
    """The same direction in [-pi, pi); an angle that is there already comes back as it is. Kernels may call this."""
    angle = float(angle)  # a plain number, though it was one of an array
    if -math.pi <= angle < math.pi:
        return angle
    wrapped = (angle + math.pi) % (2.0 * math.pi) - math.pi
    # The remainder of a tiny negative number rounds to the modulus itself.
    return wrapped if wrapped < math.pi else -math.pi


@dataclass(frozen=True, slots=True)
class Pose2:
    """A pose of the plane, equally the transform from its own frame to its parent's.

    `base_in_odom` reads: the pose of frame base in frame odom. Metres, radians in [-pi, pi).
    """

    x: float
    y: float
    theta: float

    def compose(self, other: "Pose2") -> "Pose2":
        """`a_in_b.compose(c_in_a)` is `c_in_b`."""
        c, s = math.cos(self.theta), math.sin(self.theta)
        x = self.x + c * other.x - s * other.y
        y = self.y + s * other.x + c * other.y
        return Pose2(float(x), float(y), wrap_angle(self.theta + other.theta))

    def inverse(self) -> "Pose2":
        """`a_in_b.inverse()` is `b_in_a`."""
        c, s = math.cos(self.theta), math.sin(self.theta)
        return Pose2(-c * self.x - s * self.y, s * self.x - c * self.y, wrap_angle(-self.theta))

    def between(self, other: "Pose2") -> "Pose2":
        """Return the pose of `other` as seen from this one; both are given in one frame."""
        return self.inverse().compose(other)

    def distance(self, other: "Pose2") -> float:
        """Metres between the two origins."""
        return math.hypot(other.x - self.x, other.y - self.y)

    def transform(self, points: FloatArray) -> FloatArray:
        """(n, 2) points of this frame, seen from its parent."""
        c, s = math.cos(self.theta), math.sin(self.theta)
        rotation = np.array([[c, s], [-s, c]])
        moved: FloatArray = points @ rotation + np.array([self.x, self.y])
        return moved

    def array(self) -> FloatArray:
        """(3,) x, y, theta."""
        return np.array([self.x, self.y, self.theta])


IDENTITY = Pose2(0.0, 0.0, 0.0)
