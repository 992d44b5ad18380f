"""Poses of robots between two messages of pose telemetry: smooth, slightly delayed, and without backward jumps.

A simulation sends the poses of its robots many times a second. Over a network, a message can be late, early or lost.
The simulation can also run at another rate, pause or restart. `MotionPlayback` stores the last messages as samples.
Its clock of simulated time is slightly behind the newest sample. The poses at the time of this clock are shown.
"""

import math
from collections import deque
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sim.common.geometry import Pose2
from sim.numerics.elementary import wrap_angle
from sim.numerics.float_array import FloatArray
from thbridge.roles.shared.notices import Ellipse, PlannedPaths, PoseTelemetry
from ui.model.playing.playback_clock import PlaybackClock
from ui.model.playing.trails import PathAhead, Trail

TICK = 0.02
"""Simulated seconds per tick."""

KEPT_SAMPLES = 64
"""Number of stored samples: 2.5 s at 25 Hz."""

JUMP = 0.5
"""Distance in meters. A robot that is farther than this from its expected place counts as moved by hand.

The screen then shows the new place at once.
"""

MAX_SPEED = 1.5
"""Maximum speed of robots, m/s, which limits the plausible distance between samples."""

MAX_ACCELERATION = 10.0
"""Maximum acceleration of robots, m/s².

If the acceleration between samples seems to be more than twice this value, the robot has corrected its estimate.
"""

MAX_TURN_ACCELERATION = 25.0
"""Maximum angular acceleration of robots, rad/s²."""

GAP = 2.0
"""Simulated seconds between two samples. After a longer gap, playback restarts, as after a lost connection."""

MAX_EXTRAPOLATION = 0.1
"""Without a new sample, a robot is drawn ahead for this time at decreasing speed, simulated seconds."""

BLEND = 0.07
"""Time constant with which corrections fade, seconds: 95 % in 0.2 s."""

MAX_HELD_CORRECTION = 0.2
"""Maximum size of a correction for which a driving robot is never moved backward, meters."""

MOVING_SPEED = 0.03
"""A robot counts as driving if its speed is above this, m/s."""


@dataclass(frozen=True, slots=True, eq=False)
class DisplayedRobot:
    """One robot at the displayed moment, in the map frame, meters and radians.

    Attributes:
        pose: estimated pose.
        trail: (k, 2) earlier displayed places, oldest first.
        path: (m, 2) rest of the planned path, beginning at the robot; (0, 2) if there is no path.
        ellipse: uncertainty of the robot's place, if the telemetry contains it.
        truth: true pose, if the telemetry contains it.
    """

    pose: Pose2
    trail: FloatArray
    path: FloatArray
    ellipse: Ellipse | None
    truth: Pose2 | None


@dataclass(slots=True, eq=False)
class _Sample:
    """One message of pose telemetry: simulated time, (n, 3) poses, and other contents."""

    time: float
    poses: FloatArray
    truth: FloatArray | None
    ellipses: tuple[Ellipse, ...] | None


class MotionPlayback:
    """Interpolator of all robots' poses from pose telemetry.

    Arguments called `now` are monotonic seconds of this program. They must not decrease, with one exception: `receive`
    may be called after `at` for a message that arrived before that call.

    When a robot corrects its estimate, the correction is added to the robot's earlier samples, so that all samples are
    in the frame of the newest estimate. An offset of the same size prevents a jump on the screen. It fades within
    0.2 s. The same offset absorbs errors of extrapolation.
    """

    def __init__(self) -> None:
        self._clock = PlaybackClock()
        self._samples: deque[_Sample] = deque(maxlen=KEPT_SAMPLES)
        self._offsets: FloatArray = np.zeros((0, 3))
        self._speeds: FloatArray = np.zeros((0, 3))
        self._last_speeds: FloatArray = np.zeros((0, 3))
        self._trails: list[Trail] = []
        self._paths: list[PathAhead] = []
        self._faded = 0.0

    def receive(self, notice: PoseTelemetry | PlannedPaths, now: float) -> None:
        """Process pose telemetry or planned paths that arrived at the time `now`."""
        if isinstance(notice, PlannedPaths):
            before = self._paths
            self._paths = [
                before[robot] if robot < len(before) and before[robot].planned == planned else PathAhead(planned)
                for robot, planned in enumerate(notice.ways)
            ]
        elif all(math.isfinite(number) for pose in notice.poses for number in pose):
            self._receive_poses(notice, now)

    def at(self, now: float) -> tuple[DisplayedRobot, ...]:
        """Return all robots at the time `now`, in the team's order; empty before the first telemetry."""
        if not self._samples:
            return ()
        self._fade(now)
        time = self._clock.at(now)
        believed = self._read(time)
        shown = believed + self._offsets
        truth, ellipses = self._read_truth(time), self._bracket(time)[1].ellipses
        return tuple(self._moving(robot, pose, truth, ellipses) for robot, pose in enumerate(shown.tolist()))

    # Messages ---------------------------------------------------------------------------------------------------------

    def _receive_poses(self, notice: PoseTelemetry, now: float) -> None:
        poses = np.array(notice.poses, dtype=np.float64).reshape(-1, 3)
        truth = None if notice.truth is None else np.array(notice.truth, dtype=np.float64).reshape(-1, 3)
        sample = _Sample(notice.tick * TICK, poses, truth, notice.ellipses)
        newest = self._samples[-1] if self._samples else None
        if newest is None or len(newest.poses) != len(poses) or not 0.0 <= sample.time - newest.time <= GAP:
            self._begin(sample, now)
            return
        self._fade(now)
        time = self._clock.at(now)
        before = self._read(time) + self._offsets
        if sample.time > newest.time:
            self._clock.receive(sample.time, now)
        carried = self._correct(sample, newest)
        if sample.time == newest.time:
            self._samples.pop()
        self._samples.append(sample)
        self._offsets = before - self._read(time)
        self._offsets[:, 2] = _wrapped(self._offsets[:, 2])
        self._offsets[carried] = 0.0

    def _begin(self, sample: _Sample, now: float) -> None:
        self._samples.clear()
        self._samples.append(sample)
        self._clock = PlaybackClock()
        self._clock.receive(sample.time, now)
        self._offsets = np.zeros_like(sample.poses)
        self._speeds = self._last_speeds = np.zeros_like(sample.poses)
        self._trails = [Trail() for _ in sample.poses]
        self._faded = now

    def _correct(self, sample: _Sample, newest: _Sample) -> NDArray[np.bool_]:
        """Transform the stored samples into the frame of a new sample.

        If a robot's motion changes, the robot has changed its speed or corrected its estimate. If the change exceeds
        the motors' greatest acceleration, a share of the change counts as a correction; this share grows with the
        change. If the previous step had the same speed, the change is not a correction, because a correction occurs
        only in a single step.

        Returns:
            (n,) flags, True for robots that were moved by hand.
        """
        passed = sample.time - newest.time
        moved = sample.poses - newest.poses
        moved[:, 2] = _wrapped(moved[:, 2])
        carried: NDArray[np.bool_] = np.hypot(moved[:, 0], moved[:, 1]) > JUMP + MAX_SPEED * passed
        odd = np.where(carried, 0.0, 1.0)
        if passed > 0.0:
            speed = moved / passed
            odd *= np.minimum(_oddity(speed, self._speeds, passed), _oddity(speed, self._last_speeds, passed))
            before, self._last_speeds = self._speeds, speed
            self._speeds = np.where(odd[:, None] > 0.0, before, speed)
            moved = moved - before * passed
        self._speeds[carried] = 0.0
        if odd.any():
            shift = odd[:, None] * moved
            for kept in self._samples:
                kept.poses += shift
        if not carried.any():
            return carried
        for kept in self._samples:
            kept.poses[carried] = sample.poses[carried]
        for robot in np.flatnonzero(carried).tolist():
            self._trails[robot].cut()
        return carried

    # Poses ------------------------------------------------------------------------------------------------------------

    def _moving(
        self, robot: int, pose: list[float], truth: FloatArray | None, ellipses: tuple[Ellipse, ...] | None
    ) -> DisplayedRobot:
        x, y, theta = pose
        trail = self._trails[robot]
        trail.add(x, y)
        return DisplayedRobot(
            pose=Pose2(x, y, wrap_angle(theta)),
            trail=trail.array(),
            path=self._paths[robot].remaining_from(x, y) if robot < len(self._paths) else np.empty((0, 2)),
            ellipse=ellipses[robot] if ellipses is not None and robot < len(ellipses) else None,
            truth=_pose(truth[robot]) if truth is not None and robot < len(truth) else None,
        )

    def _bracket(self, time: float) -> tuple[_Sample, _Sample]:
        """Return the samples before and after a simulated time.

        Before the first sample or after the last sample, return this sample twice.
        """
        later = self._samples[-1]
        if time >= later.time:
            return later, later
        for sample in reversed(self._samples):
            if sample.time <= time:
                return sample, later
            later = sample
        return later, later

    def _read(self, time: float) -> FloatArray:
        """Return (n, 3) poses at a simulated time: interpolated, or extrapolated after the last sample."""
        one, other = self._bracket(time)
        if one is not other:
            return _between(one.poses, other.poses, (time - one.time) / (other.time - one.time))
        driven: FloatArray = one.poses + self._speeds * _driven_on(time - one.time)
        return driven

    def _read_truth(self, time: float) -> FloatArray | None:
        one, other = self._bracket(time)
        if one is other and len(self._samples) > 1:
            # After the last sample, the motion between the last two samples continues.
            one = self._samples[-2]
            time = other.time + _driven_on(time - other.time)
        if one.truth is None or other.truth is None or one.time == other.time or len(one.truth) != len(other.truth):
            return other.truth
        carried = np.hypot(*(other.truth - one.truth)[:, :2].T) > JUMP
        read = _between(one.truth, other.truth, (time - one.time) / (other.time - one.time))
        read[carried] = other.truth[carried]
        return read

    def _fade(self, now: float) -> None:
        """Reduce the offsets by the part that fades between the last call and now.

        If a driving robot corrects its place slightly backward, its displayed place does not change until the
        correction has faded. So the robot never seems to drive backward.
        """
        passed = max(now - self._faded, 0.0)
        self._faded = max(self._faded, now)
        fades = self._offsets * -math.expm1(-passed / BLEND)
        speed = np.hypot(self._speeds[:, 0], self._speeds[:, 1])
        ahead = self._speeds[:, :2] / np.maximum(speed, 1e-9)[:, None]
        driven = speed * passed * self._clock.rate
        back = np.sum(fades[:, :2] * ahead, axis=1) - driven
        held = (
            (back > 0.0)
            & (speed > MOVING_SPEED)
            & (np.hypot(self._offsets[:, 0], self._offsets[:, 1]) < MAX_HELD_CORRECTION)
        )
        fades[:, :2] -= np.where(held, back, 0.0)[:, None] * ahead
        self._offsets = self._offsets - fades


def _driven_on(late: float) -> float:
    """Return the extrapolation of robots, in seconds at full speed, if the last sample is `late` seconds old."""
    late = min(max(late, 0.0), MAX_EXTRAPOLATION)
    return late - late * late / (2.0 * MAX_EXTRAPOLATION)


def _between(one: FloatArray, other: FloatArray, share: float) -> FloatArray:
    """Return poses at a share of the distance between two poses; angles change in the shorter direction."""
    change = other - one
    change[:, 2] = _wrapped(change[:, 2])
    between: FloatArray = one + share * change
    return between


def _oddity(speeds: FloatArray, others: FloatArray, passed: float) -> FloatArray:
    """Return (n,) the implausibility of a change between (n, 3) speeds in `passed` seconds, 0 to 1 (impossible)."""
    change = np.abs(speeds - others)
    moves, turns = np.hypot(change[:, 0], change[:, 1]) / MAX_ACCELERATION, change[:, 2] / MAX_TURN_ACCELERATION
    odd: FloatArray = np.clip(np.maximum(moves, turns) / passed - 1.0, 0.0, 1.0)
    return odd


def _wrapped(angles: FloatArray) -> FloatArray:
    wrapped: FloatArray = (angles + np.pi) % (2.0 * np.pi) - np.pi
    return wrapped


def _pose(row: FloatArray) -> Pose2:
    return Pose2(float(row[0]), float(row[1]), wrap_angle(float(row[2])))
