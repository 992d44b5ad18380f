"""Pose of a real robot, from its own localization and odometry.

amcl corrects odometry from time to time. It sends map -> odom on tf, and the pose of the base at the time of the scan
on amcl_pose. Between corrections, the pose changes with odometry, as for every tf listener.
"""

import math
from collections import deque
from collections.abc import Iterable

import numpy as np

from sim.common.geometry import Pose2
from sim.common.observations import STANDSTILL, Twist
from sim.numerics.float_array import FloatArray
from sim.robot.localization.estimate import Estimate
from thbridge.ros.clients import InvalidMessage
from thbridge.ros.messages.pack import Transform
from thbridge.ros.messages.unpack import OdometryMessage, PoseInFrame
from thbridge.ros.names import frame_name
from thbridge.ros.remote.names import RemoteNames

STALE_NS = 5_000_000_000
"""By default, a part of a robot counts as dead after this time without messages."""
SET_BACK_NS = 5_000_000_000
"""If a message is older than the last message by more than this time, it is not late. Then the robot's clock was set
back, or its program was restarted."""
UNLOCALIZED_DISTANCE = 3.0
"""A robot that only sends amcl_pose counts as lost after this number of meters of odometry without a correction.

amcl publishes amcl_pose every 0.2 m (update_min_d).
"""

_REMEMBERED = 500
_APART_NS = 1_000_000_000
"""Maximum time difference between odometry and a pose that are combined."""
_JUMP, _FASTEST = 1.0, 5.0
"""Maximum possible distance between two odometry messages: meters, plus m/s times the time between them. A message that
is farther away is an outlier, or the driver was restarted and counts from zero again. The next message shows the cause.
"""
_NO_PARTICLES: FloatArray = np.empty((0, 3))
_UNKNOWN: FloatArray = np.full((3, 3), np.nan)


class RemotePose:
    """Pose of one real robot.

    Args:
        names: its frames.
        stale_ns: time without messages after which a part of the robot counts as dead.

    Attributes:
        received_ns: time of the last odometry message. None before the first message.
        base_in_odom: pose of the last odometry message.
        twist: velocity of the last odometry message.
        notices: sentences about impossible odometry. The reader empties the list.
    """

    def __init__(self, names: RemoteNames, stale_ns: int = STALE_NS) -> None:
        self._names = names
        self._stale_ns = stale_ns
        self._odom_later_ns = 0
        self.received_ns: int | None = None
        self.base_in_odom = Pose2(0.0, 0.0, 0.0)
        self.twist = STANDSTILL
        self._stamp_ns = 0
        self._from_topic_ns: int | None = None
        self._odometry: deque[tuple[int, Pose2]] = deque(maxlen=_REMEMBERED)
        self._odom_in_map: Pose2 | None = None
        self._tf_ns: int | None = None
        self._amcl_stamp_ns = -1
        self._early: Pose2 | None = None
        """Pose of the localization from before the first odometry."""
        self._covariance = _UNKNOWN
        self._blind = 0.0
        self._restarted = False
        self._updated = False
        self.notices: list[str] = []
        self._suspect: tuple[int, Pose2] | None = None
        self._outliers = 0

    @property
    def localized(self) -> bool:
        """True if the robot's pose on the map is known, or was known before."""
        return self._odom_in_map is not None

    def stamp_odometry_later(self, later_ns: int) -> None:
        """Add a time to the stamps of odometry, also of stored messages, if they are too early for the scans."""
        more_ns = later_ns - self._odom_later_ns
        self._odom_later_ns = later_ns
        self._stamp_ns += more_ns
        self._odometry = deque(((stamp_ns + more_ns, pose) for stamp_ns, pose in self._odometry), _REMEMBERED)
        if self._suspect is not None:
            self._suspect = self._suspect[0] + more_ns, self._suspect[1]

    def is_silent(self, now_ns: int) -> bool:
        """Return True if odometry arrived earlier, but none has arrived for a long time."""
        return self.received_ns is not None and now_ns - self.received_ns > self._stale_ns

    def receive_odometry(self, message: OdometryMessage, now_ns: int) -> InvalidMessage | None:
        """Process odometry. Return the reason if it cannot be used."""
        if frame_name(message.frame) != self._names.odom_frame:
            return InvalidMessage(
                f"its frame is {message.frame!r}, not {self._names.odom_frame!r}: see odom_frame in the study"
            )
        self._from_topic_ns = now_ns
        return self._moved(message.stamp_ns, message.pose, message.twist, now_ns)

    def receive_pose(self, message: PoseInFrame) -> InvalidMessage | None:
        """Process a pose of the localization (amcl_pose). Return the reason if it cannot be used."""
        if frame_name(message.frame) != self._names.map_frame:
            return InvalidMessage(
                f"its frame is {message.frame!r}, not {self._names.map_frame!r}: see map_frame in the study"
            )
        if not _is_finite(message.pose):
            return InvalidMessage("its pose is not finite")
        if message.stamp_ns < self._amcl_stamp_ns and self._amcl_stamp_ns - message.stamp_ns < SET_BACK_NS:
            return None  # The message is late. If it were much older, the robot's clock would have been set back.
        self._amcl_stamp_ns = message.stamp_ns
        self._covariance = message.covariance
        self._updated = True
        if not self._odometry:
            self._early = message.pose
        elif self._tf_ns is None:
            stamp_ns, base_in_odom = min(self._odometry, key=lambda entry: abs(entry[0] - message.stamp_ns))
            # A latched pose from before our start is valid, because amcl publishes the next one when the robot moves.
            if self._odom_in_map is None or abs(stamp_ns - message.stamp_ns) <= _APART_NS:
                self._correct(message.pose.compose(base_in_odom.inverse()))
        return None

    def receive_transforms(self, message: Iterable[tuple[int, Transform]], now_ns: int) -> None:
        """Process a message of /tf. Transforms of other robots are ignored."""
        names = self._names
        for stamp_ns, transform in message:
            parent, child = frame_name(transform.parent), frame_name(transform.child)
            if not _is_finite(transform.pose):
                continue
            if (parent, child) == (names.map_frame, names.odom_frame):
                self._tf_ns = now_ns
                self._correct(transform.pose)
            elif (parent, child) == (names.odom_frame, names.base_frame) and self._odometry_is_on_tf_only(now_ns):
                self._moved(stamp_ns, transform.pose, self._twist_to(stamp_ns, transform.pose), now_ns)

    def estimate(self, tick: int, now_ns: int) -> Estimate | None:
        """Return the estimated pose, or None before it is known."""
        if self._odom_in_map is None or self.received_ns is None:
            return None
        updated, self._updated = self._updated, False
        base_in_map = self._odom_in_map.compose(self.base_in_odom)
        return Estimate(
            tick, base_in_map, self._odom_in_map, self._covariance, _NO_PARTICLES, updated, self.is_lost(now_ns)
        )

    def is_lost(self, now_ns: int) -> bool:
        """Return True if the robot's pose on the map was known before, but is not known now."""
        if self._odom_in_map is None:
            return False
        if self._restarted:
            return True
        return self._blind > UNLOCALIZED_DISTANCE if self._tf_ns is None else now_ns - self._tf_ns > self._stale_ns

    def _correct(self, odom_in_map: Pose2) -> None:
        self._odom_in_map = odom_in_map
        self._restarted = False
        self._blind = 0.0

    def _odometry_is_on_tf_only(self, now_ns: int) -> bool:
        return self._from_topic_ns is None or now_ns - self._from_topic_ns > self._stale_ns

    def _twist_to(self, stamp_ns: int, base_in_odom: Pose2) -> Twist:
        seconds = (stamp_ns + self._odom_later_ns - self._stamp_ns) / 1e9
        if self.received_ns is None or not 0.0 < seconds < 1.0:
            return STANDSTILL
        moved = self.base_in_odom.between(base_in_odom)
        return Twist(moved.x / seconds, moved.theta / seconds)

    def _moved(self, stamp_ns: int, base_in_odom: Pose2, twist: Twist, now_ns: int) -> InvalidMessage | None:
        if not (_is_finite(base_in_odom) and math.isfinite(twist.linear + twist.angular)):
            return InvalidMessage("its pose or its speed is not finite")
        stamp_ns += self._odom_later_ns
        late_ns = self._stamp_ns - stamp_ns
        if self.received_ns is not None:
            if 0 < late_ns < SET_BACK_NS:
                return None
            is_new = now_ns - self.received_ns < SET_BACK_NS
            if late_ns > 0 or (is_new and not _drivable(self._stamp_ns, self.base_in_odom, stamp_ns, base_in_odom)):
                if not self._continues_suspect(stamp_ns, base_in_odom):
                    self._leave_out_suspect()
                    self._suspect = stamp_ns, base_in_odom
                    return None
                self._restart(late_ns, base_in_odom)
            else:
                self._leave_out_suspect()
            self._suspect = None
            self._blind += self.base_in_odom.distance(base_in_odom)
        self.received_ns, self._stamp_ns = now_ns, stamp_ns
        self.base_in_odom, self.twist = base_in_odom, twist
        self._odometry.append((stamp_ns, base_in_odom))
        if self._early is not None and self._tf_ns is None:
            self._correct(self._early.compose(base_in_odom.inverse()))
        self._early = None
        return None

    def _continues_suspect(self, stamp_ns: int, base_in_odom: Pose2) -> bool:
        """Return True if a message continues from the previous message, which seemed to be an outlier."""
        if self._suspect is None:
            return False
        return 0 <= stamp_ns - self._suspect[0] < SET_BACK_NS and _drivable(*self._suspect, stamp_ns, base_in_odom)

    def _leave_out_suspect(self) -> None:
        if self._suspect is None:
            return
        self._outliers += 1
        # A broken driver may send only outliers. So report only the first, the second, the fourth, and so on.
        if self._outliers & (self._outliers - 1) == 0:
            distance = self.base_in_odom.distance(self._suspect[1])
            notice = f"an odometry message is left out: its pose is {distance:.1f} m away"
            self.notices.append(f"{notice} ({self._outliers} so far)")

    def _restart(self, late_ns: int, base_in_odom: Pose2) -> None:
        self._odometry.clear()
        self._restarted = True
        distance = self.base_in_odom.distance(base_in_odom)
        cause = f"its clock was set back by {late_ns / 1e9:.1f} s" if late_ns > 0 else "its odometry was reset"
        self.notices.append(f"{cause}: the pose in odometry jumps by {distance:.1f} m")


def _drivable(stamp_ns: int, left: Pose2, later_ns: int, reached: Pose2) -> bool:
    """Return True if a robot can have driven from one pose to another between two time stamps."""
    return left.distance(reached) <= _JUMP + _FASTEST * (later_ns - stamp_ns) / 1e9


def _is_finite(pose: Pose2) -> bool:
    return math.isfinite(pose.x + pose.y + pose.theta)
