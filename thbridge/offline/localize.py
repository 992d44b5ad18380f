"""Localization of a robot in a recording."""

from collections import Counter
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from enum import StrEnum
from typing import NamedTuple

from sim.common.geometry import Pose2
from sim.common.observations import STANDSTILL, Imu, Odometry
from sim.numerics.float_array import FloatArray
from sim.robot.localization.estimate import Estimate, Localizer
from thbridge.hunt.refusals import RequestRefused
from thbridge.offline.laser import Laser, usable
from thbridge.offline.odometry import OdometryTrack
from thbridge.offline.recording import StampedScan
from thbridge.offline.scan_headings import ScanHeadings
from thbridge.offline.time_offset import TimeOffset
from thbridge.ros.clock_changes import CLOCK_STEP_NS, split_by_clock
from thbridge.ros.names import frame_name
from thbridge.ros.odometry_faults import FaultKind, RecordedFault, clock_faults


class SkipReason(StrEnum):
    """Reason for skipping a scan."""

    NO_ODOMETRY = "no odometry near its time"
    NOT_NEWER = "not newer than the one before"
    OTHER_LASER = "of another laser"
    UNUSABLE = "without beams"


@dataclass(frozen=True, slots=True, eq=False)
class FilterUpdate:
    """One update of the filter.

    Attributes:
        stamp_ns: stamp of the scan.
        base_in_map: the estimated pose.
        covariance: (3, 3) covariance of x, y, theta.
        agreement: share of the scan that the map explains from this pose, 0 to 1. None if the filter does not compute
            it.
        lost: True if the filter reported that the robot was lost.
        p_wrong: probability of a wrong pose, see `Estimate`. None if the filter does not compute it.
    """

    stamp_ns: int
    base_in_map: Pose2
    covariance: FloatArray
    agreement: float | None
    lost: bool
    p_wrong: float | None


@dataclass(frozen=True, slots=True)
class LostStretch:
    """Consecutive updates at which the robot was lost.

    Attributes:
        updates: number of these updates.
        start_ns: stamp of the first update.
        end_ns: stamp of the next update, at which the robot was found. If it was never found, stamp of the last update.
    """

    updates: int
    start_ns: int
    end_ns: int


@dataclass(frozen=True, slots=True, eq=False)
class LocalizationResult:
    """The result of a localization.

    Attributes:
        updates: all updates, in order.
        last: the estimate at the last scan.
        scans: number of scans given to the filter. The filter ignores scans after too little motion.
        skipped: number of skipped scans, by reason.
        cpu_seconds: processor time of the filter's updates, without reading the bag.
        scan_faults: changes of the scans' clock, and scans with stamps that do not match the stamps of other scans.
        unstamped: number of scans with a stamp of 0. For these scans, the time of recording is used.
        time_offset: offset between odometry and scans, from the original stamps of `odometry`. None if it cannot be
            estimated.
    """

    updates: tuple[FilterUpdate, ...]
    last: Estimate
    scans: int
    skipped: Mapping[SkipReason, int]
    cpu_seconds: float
    scan_faults: tuple[RecordedFault, ...]
    unstamped: int
    time_offset: TimeOffset | None

    @property
    def lost_stretches(self) -> tuple[LostStretch, ...]:
        """Return every stretch of updates at which the robot was lost, in order."""
        stretches: list[LostStretch] = []
        first: int | None = None
        for number, update in enumerate(self.updates):
            if update.lost and first is None:
                first = number
            if first is not None and (not update.lost or number == len(self.updates) - 1):
                updates = number - first + update.lost
                stretches.append(LostStretch(updates, self.updates[first].stamp_ns, update.stamp_ns))
                first = None
        return tuple(stretches)


class _ScanStamp(NamedTuple):
    received_ns: int
    stamp_ns: int


def localize(
    localizer: Localizer,
    laser: Laser,
    odometry: OdometryTrack,
    scans: Iterable[StampedScan],
    clock: Callable[[], float],
    progress: Callable[[], None],
    headings: ScanHeadings | None = None,
) -> LocalizationResult | RequestRefused:
    """Localize a robot in a recording. If no scan is usable, return the reason.

    Each scan is used with the odometry at its stamp. amcl gets this odometry from tf.

    Args:
        localizer: the filter, initialized at the start pose.
        laser: converter of the scans.
        odometry: odometry of the whole recording.
        scans: scans in the order of recording.
        clock: clock of processor time, seconds.
        progress: function without arguments that is called for each scan.
        headings: object that receives the scans of a robot that is not lost, for the time offset. If None, the offset
            is not estimated.
    """
    updates: list[FilterUpdate] = []
    skipped: Counter[SkipReason] = Counter()
    last: Estimate | None = None
    given, unstamped, latest_ns, received_ns, cpu_seconds = 0, 0, 0, 0, 0.0
    stamps: list[_ScanStamp] = []
    frame = frame_name(laser.first.frame)
    for tick, read in enumerate(scans):
        progress()
        if not usable(read.scan):
            skipped[SkipReason.UNUSABLE] += 1
            continue
        if frame_name(read.scan.frame) != frame:
            skipped[SkipReason.OTHER_LASER] += 1
            continue
        unstamped += read.scan.stamp_ns == 0
        stamps.append(_ScanStamp(read.received_ns, read.stamp_ns))
        if latest_ns - CLOCK_STEP_NS <= read.stamp_ns <= latest_ns:
            skipped[SkipReason.NOT_NEWER] += 1
            continue
        base_in_odom = odometry.at(read.stamp_ns, read.received_ns)
        if base_in_odom is None:
            skipped[SkipReason.NO_ODOMETRY] += 1
            continue
        for missed in odometry.missed(received_ns, read.received_ns):
            localizer.widen(missed.distance, missed.turn)
        latest_ns, received_ns = read.stamp_ns, read.received_ns
        given += 1
        scan = laser.scan(tick, read.scan)
        started = clock()
        # The tick is the number of the scan instead of its time, because the tick is the key of the filter's random
        # numbers.
        last = localizer.update(Odometry(tick, base_in_odom, STANDSTILL), Imu(tick, 0.0), scan)
        cpu_seconds += clock() - started
        if headings is not None and not last.lost:
            headings.add(read.stamp_ns, scan, last.base_in_map)
        if last.updated:
            told = (last.base_in_map, last.covariance, last.agreement, last.lost, last.p_wrong)
            updates.append(FilterUpdate(read.stamp_ns, *told))
    if last is None:
        reasons = ", ".join(f"{count} {reason}" for reason, count in skipped.items())
        return RequestRefused("no-usable-scan", f"No scan could be used: {reasons or 'the recording has no scans'}.")
    offset = headings.time_offset(odometry) if headings is not None else None
    faults = _faults_of(stamps)
    return LocalizationResult(tuple(updates), last, given, dict(skipped), cpu_seconds, faults, unstamped, offset)


def _faults_of(stamps: Iterable[_ScanStamp]) -> tuple[RecordedFault, ...]:
    """Return the faults of the scans' stamps, in the order of recording."""
    runs, odd = split_by_clock(stamps)
    faults = [*clock_faults(runs), *(RecordedFault(FaultKind.WRONG_STAMP, *each) for each in odd)]
    return tuple(sorted(faults, key=lambda fault: fault.received_ns))
