"""Poses of frames on the map at one moment, from the tf messages that are valid at that moment."""

from collections.abc import Iterable
from struct import Struct

import numpy as np

from sim.common.geometry import Pose2
from sim.numerics.float_array import FloatArray
from thbridge.ros.frames import PlanarMount, matrix
from thbridge.ros.messages import unpack
from thbridge.ros.messages.unpack import SpatialTransform
from thbridge.ros.names import frame_name
from thbridge.ros.robots import is_map_frame, is_odom_frame
from ui.model.watching.messages import WatchedMessage

HORIZON_NS = 10_000_000_000
"""Nanoseconds after which the pose of a moving frame is no longer valid, as in tf2."""

_UINT32 = Struct("<I")
_STAMP_AND_NUMBER = 12
_POSE = 56
"""Number of bytes of a transform's header before the frame, and of the transform's pose."""


def namespace_of_tf(topic: str) -> str:
    """Return the namespace of a tf topic: "" for /tf, "robot1" for /robot1/tf."""
    return topic.strip("/").rpartition("/")[0]


def children_of(data: bytes) -> bytes:
    """Return the child frames of a tf message as a key; a message replaces the previous message with the same key.

    Raises:
        ValueError: the bytes are not a tf message.
    """
    names = []
    try:
        (count,) = _UINT32.unpack_from(data)
        at = 4
        for _ in range(count):
            at += _STAMP_AND_NUMBER
            at += 4 + _UINT32.unpack_from(data, at)[0]
            end = at + 4 + _UINT32.unpack_from(data, at)[0]
            names.append(data[at:end])
            at = end + _POSE
    except Exception as error:
        raise ValueError("the tf message is incomplete") from error
    return b"".join(names)


class Frames:
    """Frames at one moment.

    Frames of different namespaces are different even if their names are equal. Only the map frame is common to all.

    Args:
        messages: tf messages, oldest first; unreadable messages are ignored.
        mapped: True if there is a map. Without a map, poses are relative to the root of each tree of frames, usually
            the odometry frame.
    """

    def __init__(self, messages: Iterable[WatchedMessage], mapped: bool = True) -> None:
        self._above: dict[str, tuple[str, SpatialTransform]] = {}
        for message in messages:
            namespace = namespace_of_tf(message.topic)
            try:
                for transform in unpack.spatial_transforms(message.data):
                    child, parent = (self._own(namespace, name) for name in (transform.child, transform.parent))
                    self._above[child] = (parent, transform)
            except ValueError:
                continue
        self._mapped = mapped
        self._parents = {parent for parent, _ in self._above.values()}
        self._poses: dict[str, FloatArray | None] = {}

    def pose(self, frame: str, owner: str = "") -> FloatArray | None:
        """Return the (4, 4) pose of a frame on the map; None if no transforms connect the frame with the map.

        Args:
            frame: name of the frame.
            owner: namespace of the topic in whose messages the frame occurs.
        """
        name = self._own(owner, frame)
        return self._pose(name if name in self._above else frame_name(frame))

    def planar(self, frame: str, owner: str = "") -> Pose2 | None:
        """Return the result of `pose` as a pose in the plane."""
        found = self.pose(frame, owner)
        return None if found is None else PlanarMount.of(found).laser_in_base

    def _own(self, namespace: str, frame: str) -> str:
        name = frame_name(frame)
        if not namespace or is_map_frame(name) or name.startswith(f"{namespace}/"):
            return name
        return f"{namespace}/{name}"

    def _pose(self, frame: str) -> FloatArray | None:
        if is_map_frame(frame):
            return np.eye(4)
        if frame not in self._poses:
            self._poses[frame] = None  # This ends the recursion if frames form a circle.
            above = self._above.get(frame)
            if above is not None:
                parent = self._pose(above[0])
                self._poses[frame] = None if parent is None else parent @ matrix(above[1])
            elif not self._mapped and (frame in self._parents or is_odom_frame(frame)):
                self._poses[frame] = np.eye(4)
        return self._poses[frame]
