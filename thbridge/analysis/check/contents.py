"""Rules about the contents of messages: rotations, positions, covariances, lengths of arrays."""

import math
from collections.abc import Callable, Iterator, Mapping

from thbridge.analysis.check.finding import (
    ALL,
    TF_TYPES,
    BagStructure,
    BagTool,
    CheckedMessage,
    Finding,
    FindingSeverity,
    MessageHandler,
    OccurrenceCounter,
)
from thbridge.analysis.check.reading import LEAST, Quaternion
from thbridge.recording.bag.reading.scan import ConnectionRecord
from thbridge.ros.messages.types import LASER_SCAN, OCCUPANCY_GRID, ODOMETRY, POSE_WITH_COVARIANCE

UNIT_TOLERANCE = 1e-2
"""Tolerance of a quaternion's squared length (tf2, buffer_core.cpp, and rviz, validate_quaternions.h: 10e-3)."""
ALL_ZERO = "all zero"
POSES: tuple[BagTool, ...] = (BagTool.RVIZ, BagTool.FOXGLOVE, BagTool.EVO)
PLOTTED_ARRAY = 500
"""Length of the longest array that PlotJuggler plots element by element by default; 100 in older versions."""
_GROUND_TRUTH = "ground_truth"


class MessageSizes:
    """Rule for messages whose bytes do not match their definition: readers of the topic fail at these messages."""

    def __init__(self) -> None:
        self._off: OccurrenceCounter[tuple[str, str]] = OccurrenceCounter()

    def listen(self, source: ConnectionRecord) -> MessageHandler:
        """Check every topic."""
        topic = source.topic

        def check(message: CheckedMessage) -> None:
            if message.fault is not None:
                self._off.add((topic, message.fault), message.stamp_ns)

        return check

    def findings(self, bag: BagStructure) -> Iterator[Finding]:
        """Yield one finding for each topic and fault."""
        for (topic, fault), first, count in self._off.items():
            what = f"messages do not match their definition: {fault}"
            remedy = "record the topic again, or remove the topic with `thbridge bag cut --topics`"
            tools = bag.tools_of(topic, ALL)
            yield Finding("data-wrong", FindingSeverity.ERROR, tools, topic, what, remedy, first, count)


class UnitQuaternions:
    """Rule for quaternions whose length is not one: tf2 ignores such transforms, rviz refuses such messages.

    A quaternion of zeros was not filled in: rviz treats it as no rotation, except in tf.
    """

    def __init__(self) -> None:
        self._off: OccurrenceCounter[tuple[str, str]] = OccurrenceCounter()
        self._tf: set[str] = set()

    def listen(self, source: ConnectionRecord) -> MessageHandler:
        """Check every topic. An IMU's orientation may be zero if its covariance marks it as not measured."""
        topic, imu = source.topic, source.msgtype == "sensor_msgs/Imu"
        if source.msgtype in TF_TYPES:
            self._tf.add(topic)

        def check(message: CheckedMessage) -> None:
            for quaternion in message.reading.quaternions:
                x, y, z, w = quaternion
                # NaN also fails this comparison.
                if not abs(x * x + y * y + z * z + w * w - 1.0) <= UNIT_TOLERANCE:
                    fault = _fault(quaternion)
                    if not (imu and fault == ALL_ZERO):
                        self._off.add((topic, fault), message.stamp_ns)
                    return

        return check

    def findings(self, bag: BagStructure) -> Iterator[Finding]:
        """Yield one finding for each topic and kind of fault."""
        for (topic, fault), first, count in self._off.items():
            severity, tools = FindingSeverity.ERROR, POSES
            what = f"quaternions are {fault}"
            if topic in self._tf:
                what += ": tf2 ignores such transforms"
            elif fault == ALL_ZERO:
                severity, tools = FindingSeverity.WARNING, POSES[1:]
                what += ": tools treat them as no rotation or refuse them"
            remedy = "normalize them to length one; no rotation is 0 0 0 1"
            yield Finding("quaternion", severity, bag.tools_of(topic, tools), topic, what, remedy, first, count)


def _fault(quaternion: Quaternion) -> str:
    if not all(math.isfinite(part) for part in quaternion):
        return "not finite"
    return "not of length one" if any(quaternion) else ALL_ZERO


class FinitePositions:
    """Rule for points and vectors that are NaN or infinite: rviz refuses the whole message."""

    def __init__(self) -> None:
        self._off: OccurrenceCounter[str] = OccurrenceCounter()

    def listen(self, source: ConnectionRecord) -> MessageHandler:
        """Check every topic."""
        topic = source.topic

        def check(message: CheckedMessage) -> None:
            if not message.reading.finite:
                self._off.add(topic, message.stamp_ns)

        return check

    def findings(self, bag: BagStructure) -> Iterator[Finding]:
        """Yield one finding for each topic."""
        for topic, first, count in self._off.items():
            what = "positions or vectors are NaN or infinite"
            remedy = "omit unknown values"
            tools = bag.tools_of(topic, POSES)
            yield Finding("not-finite", FindingSeverity.ERROR, tools, topic, what, remedy, first, count)


class FilledCovariances:
    """Rule for covariances that are zero in all messages of a topic, except in a simulator's ground truth."""

    def __init__(self) -> None:
        self._filled: dict[str, bool] = {}
        self._first_ns: dict[str, int] = {}
        self._count: dict[str, int] = {}

    def listen(self, source: ConnectionRecord) -> MessageHandler | None:
        """Check odometry and poses with covariance."""
        topic = source.topic
        if source.msgtype not in (ODOMETRY, POSE_WITH_COVARIANCE) or topic.endswith(_GROUND_TRUTH):
            return None

        def check(message: CheckedMessage) -> None:
            if not self._filled.get(topic, False):
                self._first_ns.setdefault(topic, message.stamp_ns)
                self._count[topic] = self._count.get(topic, 0) + 1
                # In both types, the first covariance is the covariance of the pose.
                self._filled[topic] = message.reading.covariances[:1] == [True]

        return check

    def findings(self, bag: BagStructure) -> Iterator[Finding]:
        """Yield one finding for each topic."""
        for topic, filled in self._filled.items():
            if not filled:
                what = "the covariance of the pose is zero in every message: filters reject this pose, or diverge"
                remedy = "fill in the covariance in the driver"
                first, count = self._first_ns[topic], self._count[topic]
                tools = (BagTool.RVIZ,)
                yield Finding("covariance-zero", FindingSeverity.WARNING, tools, topic, what, remedy, first, count)


Numbers = Mapping[str, float]


def _scan_fault(numbers: Numbers) -> str | None:
    step, span = numbers["angle_increment"], numbers["angle_max"] - numbers["angle_min"]
    if not (math.isfinite(step) and math.isfinite(span)) or step == 0.0:
        return "the angles of the beams are zero or not finite"
    wanted, found = round(span / step) + 1, numbers["ranges"]
    # Drivers of full circles may or may not count the last beam.
    if abs(wanted - found) > 1:
        return f"angle_min, angle_max and angle_increment give {wanted} beams, but ranges has {found:.0f} values"
    if numbers["intensities"] not in (0, found):
        return f"ranges has {found:.0f} values, but intensities has {numbers['intensities']:.0f}"
    return None


def _grid_fault(numbers: Numbers) -> str | None:
    wanted, found = numbers["info.width"] * numbers["info.height"], numbers["data"]
    if wanted != found:
        return f"width x height give {wanted:.0f} cells, but data has {found:.0f} cells"
    return None


def _rows_fault(row: str) -> Callable[[Numbers], str | None]:
    def fault(numbers: Numbers) -> str | None:
        wanted, found = numbers[row] * numbers["height"], numbers["data"]
        return f"height x {row} give {wanted:.0f} bytes, but data has {found:.0f} bytes" if found < wanted else None

    return fault


_AGREEMENTS: Mapping[str, tuple[tuple[str, ...], Callable[[Numbers], str | None]]] = {
    LASER_SCAN: (("angle_min", "angle_max", "angle_increment", "ranges", "intensities"), _scan_fault),
    OCCUPANCY_GRID: (("info.width", "info.height", "data"), _grid_fault),
    "sensor_msgs/PointCloud2": (("height", "row_step", "data"), _rows_fault("row_step")),
    "sensor_msgs/Image": (("height", "step", "data"), _rows_fault("step")),
}


def numbers_of(msgtype: str) -> tuple[str, ...]:
    """Return the fields of a message type that `ArrayLengths` and `ScanHeaders` need."""
    lengths = _AGREEMENTS[msgtype][0] if msgtype in _AGREEMENTS else ()
    return (*lengths, *(_SCAN_NUMBERS if msgtype == LASER_SCAN else ()))


class ArrayLengths:
    """Rule for arrays whose length does not agree with other fields of their message."""

    def __init__(self) -> None:
        self._off: OccurrenceCounter[tuple[str, str]] = OccurrenceCounter()

    def listen(self, source: ConnectionRecord) -> MessageHandler | None:
        """Check scans, grids, clouds and images."""
        if source.msgtype not in _AGREEMENTS:
            return None
        names, fault_of = _AGREEMENTS[source.msgtype]
        topic = source.topic

        def check(message: CheckedMessage) -> None:
            # A type of this name with other fields, from another version, is not checked.
            if all(name in message.reading.numbers for name in names):
                fault = fault_of(message.reading.numbers)
                if fault is not None:
                    self._off.add((topic, fault), message.stamp_ns)

        return check

    def findings(self, bag: BagStructure) -> Iterator[Finding]:
        """Yield one finding for each topic and fault."""
        for (topic, fault), first, count in self._off.items():
            remedy = "correct the driver that publishes these messages"
            tools = (BagTool.RVIZ, BagTool.FOXGLOVE)
            yield Finding("length-wrong", FindingSeverity.ERROR, tools, topic, fault, remedy, first, count)


_SCAN_NUMBERS = ("range_min", "range_max", "time_increment", "scan_time", f"ranges{LEAST}")


def _scan_header_faults(numbers: Numbers) -> Iterator[tuple[FindingSeverity, str]]:
    """Yield impossible values in a scan's header, and values that its ranges contradict.

    Sources: REP 117 (Informational Distance Measurements); laser_geometry, which drops ranges outside range_min to
    range_max, and adds time_increment to stamps; amcl, which treats range_max as no hit.
    """
    error, warning = FindingSeverity.ERROR, FindingSeverity.WARNING
    least, most = numbers["range_min"], numbers["range_max"]
    for name in ("range_min", "range_max"):
        if math.isnan(numbers[name]):
            yield error, f"{name} is not a number, so no range is valid"
    if least >= most:
        yield error, "range_min is not below range_max, so no range is valid"
    if least < 0.0 <= most:
        yield warning, "range_min is negative"
    for name in ("time_increment", "scan_time"):
        if not math.isfinite(numbers[name]):
            yield error, f"{name} is not finite"
        elif numbers[name] < 0.0:
            yield warning, f"{name} is negative"
    if numbers[f"ranges{LEAST}"] < 0.0:
        yield (
            warning,
            "some ranges are negative: in ROS, inf means no obstacle, and NaN no measurement",
        )


class ScanHeaders:
    """Rule for scans whose header contradicts itself or its ranges."""

    def __init__(self) -> None:
        self._off: OccurrenceCounter[tuple[str, FindingSeverity, str]] = OccurrenceCounter()

    def listen(self, source: ConnectionRecord) -> MessageHandler | None:
        """Check scans."""
        if source.msgtype != LASER_SCAN:
            return None
        topic = source.topic

        def check(message: CheckedMessage) -> None:
            if all(name in message.reading.numbers for name in _SCAN_NUMBERS):
                for severity, fault in _scan_header_faults(message.reading.numbers):
                    self._off.add((topic, severity, fault), message.stamp_ns)

        return check

    def findings(self, bag: BagStructure) -> Iterator[Finding]:
        """Yield one finding for each topic and fault."""
        for (topic, severity, fault), first, count in self._off.items():
            remedy = "correct the driver that publishes these scans"
            tools = (BagTool.RVIZ, BagTool.FOXGLOVE)
            yield Finding("scan-header", severity, tools, topic, fault, remedy, first, count)


class LongArrays:
    """Rule for arrays that are too long for PlotJuggler's default setting."""

    def __init__(self) -> None:
        self._longest: dict[str, int] = {}

    def listen(self, source: ConnectionRecord) -> MessageHandler:
        """Check every topic."""
        topic = source.topic

        def check(message: CheckedMessage) -> None:
            if message.reading.longest > PLOTTED_ARRAY:
                self._longest[topic] = max(self._longest.get(topic, 0), message.reading.longest)

        return check

    def findings(self, bag: BagStructure) -> Iterator[Finding]:
        """Yield one finding for all topics."""
        if self._longest:
            lengths = ", ".join(f"{topic} ({length})" for topic, length in sorted(self._longest.items()))
            what = f"by default, PlotJuggler plots {PLOTTED_ARRAY} elements of an array, fewer than in {lengths}"
            remedy = "raise PlotJuggler's maximum array size, or omit these topics"
            yield Finding("long-array", FindingSeverity.NOTE, (BagTool.PLOTJUGGLER,), None, what, remedy)


RULES = (MessageSizes, UnitQuaternions, FinitePositions, FilledCovariances, ArrayLengths, ScanHeaders, LongArrays)
