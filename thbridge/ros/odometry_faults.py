"""Faults of odometry: outliers, resets of its origin, changes of its clock.

A robot cannot jump. The speeds around a message in the recording show how far the robot can have driven since the
previous message. A larger distance is not motion. If the next messages return to the earlier poses, the message was an
outlier. If they continue from the new pose, the odometry was reset. Then only its increments are used from that time.

Source of the limits by median and median absolute deviation: Hampel, The influence curve and its role in robust
estimation (1974). They are valid while less than half of the surrounding values are wrong.
"""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from enum import StrEnum
from itertools import pairwise
from typing import NamedTuple

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view
from numpy.typing import NDArray

from sim.common.geometry import IDENTITY, Pose2
from sim.numerics import elementary_arrays
from sim.numerics.elementary import wrap_angle
from sim.numerics.float_array import FloatArray
from thbridge.ros.clock_changes import ClockRun, Message, stamps_by_clock
from thbridge.ros.messages.plausible import LARGEST

WINDOW = 51
"""Number of steps between messages that determine the usual speed: a step, 25 steps before and 25 steps after it."""
TOGETHER = 8192
"""Number of steps whose medians are computed together. The limit saves memory."""
DEVIATIONS = 10.0
"""Maximum possible speed of a robot, as a number of median absolute deviations above the median speed."""
LEAST_ABOVE_USUAL = (2.0, 3.0)
"""Increase over the median speed that always counts as possible, m/s and rad/s, because a standing robot may start."""
FASTEST = (50.0, 50.0)
"""Speeds in m/s and rad/s that no robot exceeds. This limit also works if most surrounding values are wrong."""
RETURN_NS = 1_000_000_000
"""Maximum duration of outliers. If odometry returns later, it does not count as a return from outliers."""
LEAST_MESSAGES = 3
"""Minimum number of consecutive messages after a jump. If there are fewer, the jump is an outlier."""
AT_ORIGIN = 0.5
"""If odometry after a jump is at most this far from 0, it counts as reset; meters and radians."""
MISSED = ((0.05, 0.03), (1.0, 0.5))
"""Minimum and maximum standard deviations of the motion that a reset hides from odometry, in meters and radians."""


class FaultKind(StrEnum):
    """Kind of a fault in a recorded topic."""

    NOT_FINITE = "not-finite"
    OUTLIER = "outlier"
    RESET = "reset"
    JUMP = "jump"
    WRONG_STAMP = "wrong-stamp"
    CLOCK_BACK = "clock-back"
    CLOCK_AHEAD = "clock-ahead"


class OdometrySample(NamedTuple):
    """Odometry message: time of recording, time stamp in the message, pose of the base in odom."""

    received_ns: int
    stamp_ns: int
    base_in_odom: Pose2


@dataclass(frozen=True, slots=True)
class RecordedFault:
    """Fault of a recorded message.

    Attributes:
        kind: kind of the fault.
        received_ns: time of recording of the message.
        stamp_ns: time stamp of the message.
        distance: meters from the last valid message. 0 for faults of time stamps.
        turn: radians from the last valid message, not negative.
        seconds: change of the clock, positive if it was set ahead. 0 for other faults.
    """

    kind: FaultKind
    received_ns: int
    stamp_ns: int
    distance: float = 0.0
    turn: float = 0.0
    seconds: float = 0.0


class MissedMotion(NamedTuple):
    """Motion that odometry does not report because of a reset: time of recording, standard deviations in m and rad."""

    received_ns: int
    distance: float
    turn: float


@dataclass(frozen=True, slots=True, eq=False)
class OdometryRun:
    """Valid odometry between two changes of the clock.

    Attributes:
        received_ns: time of recording of its first message.
        stamps: (n,) int64 nanoseconds, strictly increasing. n is at least 1.
        poses: (n, 3) poses of the base in the odom frame of the start. Jumps of the origin are removed.
    """

    received_ns: int
    stamps: NDArray[np.int64]
    poses: FloatArray


@dataclass(frozen=True, slots=True, eq=False)
class SoundOdometry:
    """Odometry without its faults.

    Attributes:
        runs: runs in the order of recording.
        faults: all faults, in the order of recording.
        missed: motions that the odometry does not report.
        kept: (n,) indices of the valid samples among all samples, for each run in the order of time stamps.
        outliers: (o,) indices of the outliers.
        cuts: (k,) positions in `kept`. At each position, the origin of the poses or the clock was changed.
    """

    runs: tuple[OdometryRun, ...]
    faults: tuple[RecordedFault, ...]
    missed: tuple[MissedMotion, ...]
    kept: NDArray[np.int64]
    outliers: NDArray[np.int64]
    cuts: NDArray[np.int64]


MOST_EXAMPLES = 5
"""Maximum number of faults of a kind that a sentence lists."""
_WORDS = {
    FaultKind.NOT_FINITE: "messages left out because their values are not finite or too large",
    FaultKind.OUTLIER: "messages left out as outliers, because the robot cannot have driven there",
    FaultKind.WRONG_STAMP: "messages with a time stamp that does not fit the others",
    FaultKind.RESET: "resets to 0; from then on, only increments are used",
    FaultKind.JUMP: "jumps of the origin; from then on, only increments are used",
    FaultKind.CLOCK_BACK: "clock set back",
    FaultKind.CLOCK_AHEAD: "clock set ahead",
}


def fault_sentences(topic: str, faults: Iterable[RecordedFault], begin_ns: int) -> Iterator[str]:
    """Yield a sentence for each kind of fault, with number, times in seconds after the beginning, and sizes.

    Args:
        topic: name of the topic, or its frames in tf.
        faults: faults in the order of recording.
        begin_ns: time of recording at the beginning.
    """
    of_kind: dict[FaultKind, list[RecordedFault]] = {}
    for fault in faults:
        of_kind.setdefault(fault.kind, []).append(fault)
    for kind, alike in of_kind.items():
        examples = [_example(fault, begin_ns) for fault in alike[:MOST_EXAMPLES]]
        if len(alike) > MOST_EXAMPLES:
            examples.append(f"and {len(alike) - MOST_EXAMPLES} more")
        yield f"{topic}: {_WORDS[kind]}: {len(alike)} ({'; '.join(examples)})."


def _example(fault: RecordedFault, begin_ns: int) -> str:
    when = f"after {(fault.received_ns - begin_ns) / 1e9:.2f} s"
    match fault.kind:
        case FaultKind.OUTLIER | FaultKind.RESET | FaultKind.JUMP:
            return f"{when}, by {fault.distance:.1f} m and {fault.turn:.2f} rad"
        case FaultKind.CLOCK_BACK | FaultKind.CLOCK_AHEAD:
            return f"{when}, by {abs(fault.seconds):.1f} s"
        case _:
            return when


def sound_odometry(samples: Iterable[OdometrySample], max_speed: float | None) -> SoundOdometry:
    """Remove odometry that cannot be true, and join the odometry before and after each reset.

    Args:
        samples: samples in the order of recording.
        max_speed: maximum speed of the robot in m/s. If None, the speeds around each message determine it.
    """
    samples = list(samples)
    received = np.array([sample.received_ns for sample in samples], dtype=np.int64)
    stamps = np.array([sample.stamp_ns for sample in samples], dtype=np.int64)
    poses = np.array([sample.base_in_odom.array() for sample in samples]).reshape(-1, 3)
    return sound_poses(received, stamps, poses, max_speed)


def sound_poses(
    received: NDArray[np.int64], stamps: NDArray[np.int64], poses: FloatArray, max_speed: float | None = None
) -> SoundOdometry:
    """Remove poses that cannot be true, and join the poses before and after each reset.

    Args:
        received: (n,) times of recording, nanoseconds, in increasing order.
        stamps: (n,) time stamps.
        poses: (n, 3) poses of the base.
        max_speed: see `sound_odometry`.
    """
    plausible = (np.abs(poses) <= LARGEST).all(axis=1)  # NaN gives False.
    finite = np.flatnonzero(plausible)

    def faults_of(kind: FaultKind, indices: NDArray[np.int64]) -> Iterator[RecordedFault]:
        return (RecordedFault(kind, int(received[i]), int(stamps[i])) for i in indices.tolist())

    faults = [*faults_of(FaultKind.NOT_FINITE, np.flatnonzero(~plausible))]
    by_clock, odd = stamps_by_clock(stamps[finite], received[finite])
    faults += faults_of(FaultKind.WRONG_STAMP, finite[odd])
    for indices, changed_ns in by_clock[1:]:
        first = finite[indices[0]]
        faults.append(_clock_fault(int(received[first]), int(stamps[first]), changed_ns))
    runs: tuple[OdometryRun, ...] = ()
    missed: list[MissedMotion] = []
    kept = outliers = cuts = np.empty(0, dtype=np.int64)
    if by_clock:
        judge = _Judge([finite[indices] for indices, _ in by_clock], received, stamps, poses, max_speed)
        judge.judge()
        runs, missed = tuple(judge.sound()), judge.missed
        kept, outliers, cuts = judge.kept()
        faults += judge.faults
    in_order = tuple(sorted(faults, key=lambda fault: fault.received_ns))
    return SoundOdometry(runs, in_order, tuple(missed), kept, outliers, cuts)


def clock_faults(runs: Sequence[ClockRun[Message]]) -> Iterator[RecordedFault]:
    """Yield the changes of a clock between its runs."""
    for run in runs[1:]:
        yield _clock_fault(run.messages[0].received_ns, run.messages[0].stamp_ns, run.changed_ns)


def _clock_fault(received_ns: int, stamp_ns: int, changed_ns: int) -> RecordedFault:
    kind = FaultKind.CLOCK_AHEAD if changed_ns > 0 else FaultKind.CLOCK_BACK
    return RecordedFault(kind, received_ns, stamp_ns, seconds=changed_ns / 1e9)


class _Piece(NamedTuple):
    """Samples from `begin` to `end` (excluded). The robot can have driven from each of these samples to the next."""

    begin: int
    end: int


class _Judge:
    """Search for outliers and resets among the samples of all runs of a clock, in the order of the runs.

    Attributes:
        faults: outliers, resets and jumps, after `judge`.
        missed: see `SoundOdometry`.
    """

    def __init__(
        self,
        runs: Sequence[NDArray[np.int64]],
        received: NDArray[np.int64],
        stamps: NDArray[np.int64],
        poses: FloatArray,
        max_speed: float | None,
    ) -> None:
        # If time stamps are equal, the last sample is kept, as in tf.
        newest = [run[len(run) - 1 - np.unique(stamps[run][::-1], return_index=True)[1]] for run in runs]
        self._begins = [int(received[run[0]]) for run in runs]
        self._index = np.concatenate(newest)
        self._run_of = np.repeat(np.arange(len(runs)), [len(run) for run in newest])
        self._stamps, self._received, self._poses = stamps[self._index], received[self._index], poses[self._index]
        self._corrections: list[tuple[_Piece, Pose2]] = []
        self._outliers: list[int] = []
        self._measure(max_speed)
        self.faults: list[RecordedFault] = []
        self.missed: list[MissedMotion] = []

    def _measure(self, max_speed: float | None) -> None:
        """Compute the usual period, and the speed and the limit of each step to the next sample.

        Cut the samples into pieces at steps that are too long.
        """
        same = np.diff(self._run_of) == 0
        seconds = np.maximum(np.where(same, np.diff(self._stamps), np.diff(self._received)) / 1e9, 0.0)
        # The mean is used, because messages may arrive in bursts. Gaps of the recording are excluded.
        usual = seconds[seconds <= RETURN_NS / 1e9]
        self._period = float(usual.mean()) if len(usual) else 0.0
        steps = np.diff(self._poses, axis=0)
        turns = np.abs((steps[:, 2] + np.pi) % (2.0 * np.pi) - np.pi)
        moved = np.column_stack((elementary_arrays.hypot(steps[:, 0], steps[:, 1]), turns))
        speeds = moved / np.maximum(seconds, max(self._period, 1e-3))[:, np.newaxis]
        self._usual = _moving_median(speeds)
        scatter = _moving_median(np.abs(speeds - self._usual))
        self._limits = np.minimum(self._usual + np.maximum(DEVIATIONS * scatter, LEAST_ABOVE_USUAL), FASTEST)
        if max_speed is not None:
            self._limits[:, 0] = max_speed
        drivable = (moved <= self._limits * (seconds + self._period)[:, np.newaxis]).all(axis=1)
        cuts = np.flatnonzero(~(same & drivable)) + 1
        self._pieces = [_Piece(*ends) for ends in pairwise([0, *cuts.tolist(), len(self._index)])]

    def _seconds(self, before: int, after: int) -> float:
        """Return the time between two samples. If the clock was changed between them, use the times of recording."""
        times = self._stamps if self._run_of[before] == self._run_of[after] else self._received
        return max(0.0, float(times[after] - times[before]) / 1e9)

    def _pose(self, i: int) -> Pose2:
        return Pose2(*self._poses[i].tolist())

    def _moved(self, before: int, after: int) -> tuple[float, float]:
        """Return the distances between two samples in meters and radians, not negative."""
        one, other = self._pose(before), self._pose(after)
        return one.distance(other), abs(wrap_angle(other.theta - one.theta))

    def _effort(self, before: int, after: int) -> float:
        """Return the motion between two samples as a fraction of the possible motion in this time plus one period."""
        seconds = max(self._seconds(before, after) + self._period, 1e-9)
        distance, turn = self._moved(before, after)
        most, most_turn = (self._limits[after - 1] * seconds).tolist()
        return float(max(distance / most, turn / most_turn))

    def _drivable(self, before: int, after: int) -> bool:
        return self._effort(before, after) <= 1.0

    def judge(self) -> None:
        """Process the pieces. Each piece is kept, removed, or joined to the earlier ones."""
        last, correction = None, IDENTITY
        pieces = self._pieces
        number = 0
        while number < len(pieces):
            piece = pieces[number]
            if last is not None and not self._drivable(last, piece.begin):
                begin = self._return_within(piece, last)
                if begin > piece.begin:
                    self._leave_out([_Piece(piece.begin, begin)], last)
                    pieces[number] = _Piece(begin, piece.end)
                    continue
                back = self._return(number, last)
                if back > number or piece.end - piece.begin < LEAST_MESSAGES:
                    after = max(back, number + 1)
                    self._leave_out(pieces[number:after], last)
                    number = after
                    continue
                if sum(kept.end - kept.begin for kept, _ in self._corrections) < LEAST_MESSAGES:  # of integers
                    self._leave_out([kept for kept, _ in self._corrections], piece.begin)
                    self._corrections = []
                else:
                    correction = self._reset(last, piece.begin, correction)
            self._corrections.append((piece, correction))
            last = piece.end - 1
            number += 1

    def _return_within(self, piece: _Piece, last: int) -> int:
        """Return the first sample of a piece that is nearer to the last valid sample than to the start of the piece.

        The step to an outlier may be slightly too long for a robot, although the step back is possible. See `_return`.
        """
        for later in range(piece.begin + 1, min(piece.begin + LEAST_MESSAGES, piece.end)):
            if self._effort(last, later) < min(1.0, self._effort(piece.begin, later)):
                return later
        return piece.begin

    def _return(self, number: int, last: int) -> int:
        """Return the first piece that soon returns to the last valid sample, as a number; otherwise return `number`."""
        for later in range(number + 1, len(self._pieces)):
            begin = self._pieces[later].begin
            if self._seconds(last, begin) * 1e9 > RETURN_NS:
                break
            if self._drivable(last, begin):
                return later
        return number

    def _leave_out(self, pieces: Iterable[_Piece], sound: int) -> None:
        for piece in pieces:
            for i in range(*piece):
                self.faults.append(self._fault(FaultKind.OUTLIER, i, sound))
                self._outliers.append(i)

    def _reset(self, last: int, begin: int, correction: Pose2) -> Pose2:
        """Record a jump of the odometry's origin. Return the pose of the new origin in the first origin."""
        x, y, theta = np.abs(self._poses[begin]).tolist()
        kind = FaultKind.RESET if max(x, y, theta) <= AT_ORIGIN else FaultKind.JUMP
        self.faults.append(self._fault(kind, begin, last))
        seconds = self._seconds(last, begin) + self._period
        distance, turn = (
            max(least, min(usual * seconds, most))
            for usual, least, most in zip(self._usual[begin - 1].tolist(), *MISSED, strict=True)
        )
        self.missed.append(MissedMotion(int(self._received[begin]), distance, turn))
        return correction.compose(self._pose(last)).compose(self._pose(begin).inverse())

    def _fault(self, kind: FaultKind, i: int, sound: int) -> RecordedFault:
        return RecordedFault(kind, int(self._received[i]), int(self._stamps[i]), *self._moved(sound, i))

    def sound(self) -> Iterator[OdometryRun]:
        """Yield the valid odometry of each run of the clock. Runs without valid odometry are skipped."""
        for number, begins in enumerate(self._begins):
            parts = [(piece, to) for piece, to in self._corrections if self._run_of[piece.begin] == number]
            if parts:
                stamps = np.concatenate([self._stamps[slice(*piece)] for piece, _ in parts])
                poses = np.concatenate([_moved_by(to, self._poses[slice(*piece)]) for piece, to in parts])
                yield OdometryRun(begins, stamps, poses)

    def kept(self) -> tuple[NDArray[np.int64], NDArray[np.int64], NDArray[np.int64]]:
        """Return the valid samples, the outliers, and the cuts among the valid samples. See `SoundOdometry`."""
        places = np.concatenate([np.arange(*piece) for piece, _ in self._corrections])
        changed = self._run_of[places[1:]] != self._run_of[places[:-1]]
        origins = np.repeat(
            np.cumsum([0, *(one != other for (_, one), (_, other) in pairwise(self._corrections))]),
            [piece.end - piece.begin for piece, _ in self._corrections],
        )
        cuts = np.flatnonzero(changed | (np.diff(origins) != 0)) + 1
        return self._index[places], self._index[np.array(sorted(self._outliers), dtype=np.int64)], cuts


def _moving_median(values: FloatArray) -> FloatArray:
    """Return (n, 2) medians of the values around each value. At the ends, the first or last value is repeated."""
    medians = np.empty_like(values)
    if len(values):
        padded = np.pad(values, ((WINDOW // 2, WINDOW // 2), (0, 0)), mode="edge")
        for begin in range(0, len(values), TOGETHER):
            end = min(begin + TOGETHER, len(values))
            around = sliding_window_view(padded[begin : end + WINDOW - 1], WINDOW, axis=0)
            medians[begin:end] = np.partition(around, WINDOW // 2, axis=2)[..., WINDOW // 2]
    return medians


def _moved_by(correction: Pose2, poses: FloatArray) -> FloatArray:
    """Return (n, 3) poses relative to the first origin. Poses that have this origin are returned as the same object."""
    if correction == IDENTITY:
        return poses
    headings = [wrap_angle(correction.theta + theta) for theta in poses[:, 2].tolist()]
    return np.column_stack((correction.transform(poses[:, :2]), headings))
