"""Tree of the frames in tf messages, with the three-dimensional pose of each child frame in its parent frame."""

import math
from dataclasses import dataclass

import numpy as np

from sim.common.geometry import Pose2
from sim.numerics import elementary
from sim.numerics.elementary import wrap_angle
from sim.numerics.float_array import FloatArray
from thbridge.ros.messages.unpack import SpatialTransform
from thbridge.ros.names import frame_name


def matrix(transform: SpatialTransform) -> FloatArray:
    """Return the (4, 4) homogeneous transform from the child's coordinates to the parent's."""
    x, y, z, w = transform.orientation
    norm = math.sqrt(x * x + y * y + z * z + w * w)
    # Some drivers send a quaternion of zeros, and mean no rotation.
    x, y, z, w = (x / norm, y / norm, z / norm, w / norm) if norm > 0.0 else (0.0, 0.0, 0.0, 1.0)
    whole = np.eye(4)
    whole[:3, :3] = (
        (1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)),
        (2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)),
        (2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)),
    )
    whole[:3, 3] = transform.position
    return whole


class FrameTree:
    """Tree of frames, each with its first received transform. Names have no leading slash.

    Later transforms of the same frame are ignored, because amcl also looks up the pose of a laser only once.
    """

    def __init__(self) -> None:
        self._above: dict[str, tuple[str, FloatArray]] = {}

    def add(self, transform: SpatialTransform) -> bool:
        """Add one transform. Return True if it was new and valid."""
        child = frame_name(transform.child)
        if child in self._above or not np.isfinite((*transform.position, *transform.orientation)).all():
            return False
        self._above[child] = (frame_name(transform.parent), matrix(transform))
        return True

    def edges(self) -> list[tuple[str, str]]:
        """Return all pairs (parent, child)."""
        return [(parent, child) for child, (parent, _) in self._above.items()]

    def chain(self, frame: str) -> list[str]:
        """Return the frame and its ancestors, the nearest first."""
        chain = [frame_name(frame)]
        while chain[-1] in self._above:
            parent = self._above[chain[-1]][0]
            # A faulty recording may contain a loop of frames.
            if parent in chain:
                break
            chain.append(parent)
        return chain

    def pose(self, frame: str, reference: str) -> FloatArray | None:
        """Return the (4, 4) pose of a frame in a reference frame, or None if they have no common ancestor."""
        up, down = self.chain(frame), self.chain(reference)
        common = next((name for name in up if name in down), None)
        if common is None:
            return None
        frame_in_common = self._up_to(up[: up.index(common)])
        reference_in_common = self._up_to(down[: down.index(common)])
        return _product(_inverse(reference_in_common), frame_in_common)

    def _up_to(self, chain: list[str]) -> FloatArray:
        whole = np.eye(4)
        for name in chain:
            whole = _product(self._above[name][1], whole)
        return whole


def _product(a: FloatArray, b: FloatArray) -> FloatArray:
    """Return the (4, 4) product. Terms are added in a fixed order, because the order in NumPy's product may vary."""
    product: FloatArray = (a[:, :, np.newaxis] * b[np.newaxis]).sum(axis=1)
    return product


def _inverse(rigid: FloatArray) -> FloatArray:
    """Return the (4, 4) inverse of a rotation with a translation."""
    inverse = np.eye(4)
    inverse[:3, :3] = rigid[:3, :3].T
    inverse[:3, 3] = -(inverse[:3, :3] * rigid[:3, 3]).sum(axis=1)
    return inverse


@dataclass(frozen=True, slots=True)
class PlanarMount:
    """Mounting of a planar laser on a base.

    Attributes:
        laser_in_base: pose of the laser in the base frame, seen from above.
        upside_down: True if its z axis points to the ground, so that its beams turn clockwise.
        tilt: angle between its plane and the plane of the base, radians in [0, pi/2].
    """

    laser_in_base: Pose2
    upside_down: bool
    tilt: float

    @classmethod
    def of(cls, pose: FloatArray) -> "PlanarMount":
        """Return the mounting of a laser from its (4, 4) pose in the base frame."""
        yaw = elementary.atan2(pose[1, 0], pose[0, 0])
        # Rounding may make this cosine slightly larger than 1.
        upward = float(pose[2, 2])
        return cls(
            Pose2(float(pose[0, 3]), float(pose[1, 3]), wrap_angle(yaw)),
            upward < 0.0,
            elementary.atan2(math.sqrt(max(0.0, 1.0 - upward * upward)), abs(upward)),
        )
