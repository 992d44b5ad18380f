"""Rules about time stamps, of records and of headers."""

from collections import Counter
from collections.abc import Iterator

from thbridge.analysis.check.finding import (
    EVO_TYPES,
    TF_TYPES,
    BagStructure,
    BagTool,
    CheckedMessage,
    Finding,
    FindingSeverity,
    MessageHandler,
    OccurrenceCounter,
)
from thbridge.analysis.check.structure import CUT
from thbridge.recording.bag.reading.scan import ConnectionRecord

TF_CACHE = 10.0
"""Seconds that tf2 keeps transforms (tf2, buffer_core.h, DEFAULT_CACHE_TIME)."""
LATE, LEAST_LATE = 0.25, 5
"""Minimum difference between stamp and time of recording that counts as large, seconds; minimum number of messages with
such a difference. Drivers and filters need less time. A robot at 0.5 m/s drives 12 cm in 0.25 s."""


class StampZero:
    """Rule for messages recorded at time zero, which `rosbag play` drops."""

    def __init__(self) -> None:
        self._zero: OccurrenceCounter[str] = OccurrenceCounter()

    def listen(self, source: ConnectionRecord) -> MessageHandler:
        """Check every topic."""
        topic = source.topic

        def check(message: CheckedMessage) -> None:
            if message.stamp_ns == 0:
                self._zero.add(topic, 0)

        return check

    def findings(self, bag: BagStructure) -> Iterator[Finding]:
        """Yield one finding for each topic."""
        for topic, first, count in self._zero.items():
            what = "messages have record stamp 0, so `rosbag play` drops them"
            remedy = "start the clock above zero"
            yield Finding(
                "stamp-zero", FindingSeverity.ERROR, (BagTool.ROSBAG, BagTool.RVIZ), topic, what, remedy, first, count
            )


class BackInTime:
    """Rule for messages that are not in the order of time in the file."""

    def __init__(self) -> None:
        self._latest_ns = 0
        self._first_ns: int | None = None
        self._count = 0
        self._worst_ns = 0

    def listen(self, source: ConnectionRecord) -> MessageHandler:
        """Check the order of messages over all topics."""
        return self._check

    def _check(self, message: CheckedMessage) -> None:
        back = self._latest_ns - message.stamp_ns
        if back <= 0:
            self._latest_ns = message.stamp_ns
            return
        self._count += 1
        self._worst_ns = max(self._worst_ns, back)
        if self._first_ns is None:
            self._first_ns = message.stamp_ns

    def findings(self, bag: BagStructure) -> Iterator[Finding]:
        """Yield one finding for the bag."""
        if self._count:
            what = f"messages are not in the order of time, by up to {self._worst_ns / 1e9:.3f} s"
            tools = (BagTool.ROSBAG, BagTool.PLOTJUGGLER)
            yield Finding("back-in-time", FindingSeverity.WARNING, tools, None, what, CUT, self._first_ns, self._count)


class HeaderStampOffset:
    """Rule for headers whose stamps differ much from the time of recording: tools mix the two times.

    Latched topics are not checked, because their messages may be older than the recording. Static transforms are not
    checked either, because they are valid at all times, for any stamp (tf2, buffer_core.cpp).
    """

    def __init__(self) -> None:
        self._far: OccurrenceCounter[str] = OccurrenceCounter()
        self._worst_ns: dict[str, int] = {}

    def listen(self, source: ConnectionRecord) -> MessageHandler | None:
        """Check every topic, except latched topics and topics with static transforms."""
        if _is_sent_once(source):
            return None
        topic = source.topic

        def check(message: CheckedMessage) -> None:
            headers = message.reading.headers
            if not headers or headers[0][0] == 0:
                return
            off = headers[0][0] - message.stamp_ns
            if abs(off) > TF_CACHE * 1e9:
                self._far.add(topic, message.stamp_ns)
                self._worst_ns[topic] = max(self._worst_ns.get(topic, 0), off, key=abs)

        return check

    def findings(self, bag: BagStructure) -> Iterator[Finding]:
        """Yield one finding for each topic."""
        for topic, first, count in self._far.items():
            off = self._worst_ns[topic] / 1e9
            what = (
                f"header stamps are up to {abs(off):.1f} s {'after' if off > 0 else 'before'} the time of recording, "
                f"but tf2 keeps transforms only for {TF_CACHE:.0f} s"
            )
            remedy = "record with one clock: set `use_sim_time` for the recorder if the robots use it"
            tools = (BagTool.RVIZ, BagTool.FOXGLOVE, BagTool.PLOTJUGGLER)
            yield Finding("header-far", FindingSeverity.WARNING, tools, topic, what, remedy, first, count)


class RecordedLate:
    """Rule for topics whose stamps differ from the time of recording.

    Tools that use the time of recording then match messages wrongly. The messages are recorded late, or stamped later
    than their recording, which is impossible with one clock. Latched topics and static transforms are not checked, as
    in `HeaderStampOffset`, which finds greater differences. amcl's transforms, which have stamps in the future, are not
    checked either.
    """

    def __init__(self) -> None:
        self._off: OccurrenceCounter[tuple[str, bool]] = OccurrenceCounter()
        self._count: Counter[str] = Counter()
        self._sum_ns: Counter[tuple[str, bool]] = Counter()

    def listen(self, source: ConnectionRecord) -> MessageHandler | None:
        """Check every topic, except latched topics and topics with static transforms."""
        if _is_sent_once(source):
            return None
        topic, may_be_ahead = source.topic, source.msgtype in TF_TYPES

        def check(message: CheckedMessage) -> None:
            headers = message.reading.headers
            if not headers or headers[0][0] == 0:
                return
            self._count[topic] += 1
            late_ns = message.stamp_ns - headers[0][0]
            if LATE * 1e9 <= abs(late_ns) <= TF_CACHE * 1e9 and not (may_be_ahead and late_ns < 0):
                self._off.add((topic, late_ns > 0), message.stamp_ns)
                self._sum_ns[topic, late_ns > 0] += abs(late_ns)

        return check

    def findings(self, bag: BagStructure) -> Iterator[Finding]:
        """Yield one finding for each topic whose messages are mostly late, or mostly ahead."""
        for (topic, late), first, count in self._off.items():
            if count < LEAST_LATE or 2 * count <= self._count[topic]:
                continue
            seconds = self._sum_ns[topic, late] / count / 1e9
            if late:
                rule, what = "recorded-late", f"messages are recorded {seconds:.2f} s after their stamps on average"
                remedy = "compare topics by the stamps of headers, as `thbridge report` and evo do"
                tools: tuple[BagTool, ...] = (BagTool.FOXGLOVE, BagTool.PLOTJUGGLER)
            else:
                rule, what = "stamped-ahead", f"stamps are {seconds:.2f} s after the time of recording on average"
                remedy = "synchronize the clocks of all computers (NTP, chrony), and record again"
                tools = (BagTool.RVIZ, BagTool.FOXGLOVE, BagTool.PLOTJUGGLER, BagTool.EVO)
            yield Finding(rule, FindingSeverity.WARNING, tools, topic, what, remedy, first, count)


class TrajectoryStamps:
    """Rule for header stamps that are zero, decrease or repeat: evo needs increasing stamps.

    For transforms, only stamps of zero count, because one topic contains many frames.
    """

    def __init__(self) -> None:
        self._zero: OccurrenceCounter[tuple[str, bool]] = OccurrenceCounter()
        self._back: OccurrenceCounter[str] = OccurrenceCounter()
        self._again: OccurrenceCounter[str] = OccurrenceCounter()
        self._latest_ns: dict[str, int] = {}

    def listen(self, source: ConnectionRecord) -> MessageHandler | None:
        """Check the types that evo reads."""
        if source.msgtype not in EVO_TYPES or source.topic.endswith("tf_static"):
            return None
        topic, has_frames = source.topic, source.msgtype in TF_TYPES

        def check(message: CheckedMessage) -> None:
            stamps = [stamp_ns for stamp_ns, _ in message.reading.headers]
            if not stamps:
                return
            if has_frames:
                if not all(stamps):
                    self._zero.add((topic, True), message.stamp_ns)
                return
            stamp_ns = stamps[0]
            if stamp_ns == 0:
                self._zero.add((topic, False), message.stamp_ns)
            elif stamp_ns < self._latest_ns.get(topic, 0):
                self._back.add(topic, message.stamp_ns)
            elif stamp_ns == self._latest_ns.get(topic):
                self._again.add(topic, message.stamp_ns)
            else:
                self._latest_ns[topic] = stamp_ns

        return check

    def findings(self, bag: BagStructure) -> Iterator[Finding]:
        """Yield one finding for each topic and fault."""
        tools: tuple[BagTool, ...] = (BagTool.EVO,)
        for (topic, has_frames), first, count in self._zero.items():
            what = (
                "transforms are stamped 0: tf2 cannot use them for later messages"
                if has_frames
                else "headers are stamped 0: evo cannot use them"
            )
            remedy = "set the stamps in the driver"
            concerned = (BagTool.RVIZ, BagTool.FOXGLOVE, BagTool.EVO) if has_frames else tools
            yield Finding("header-zero", FindingSeverity.ERROR, concerned, topic, what, remedy, first, count)
        for topic, first, count in self._back.items():
            what = "header stamps decrease: evo's check fails, and evo matches poses wrongly"
            remedy = "let one publisher use the topic, with one clock"
            yield Finding("header-back", FindingSeverity.ERROR, tools, topic, what, remedy, first, count)
        for topic, first, count in self._again.items():
            what = "header stamps repeat: evo cannot compute speeds"
            remedy = "omit repeated messages"
            yield Finding("header-repeated", FindingSeverity.WARNING, tools, topic, what, remedy, first, count)


RULES = (StampZero, BackInTime, HeaderStampOffset, RecordedLate, TrajectoryStamps)


def _is_sent_once(source: ConnectionRecord) -> bool:
    """Return True for latched topics and static transforms, whose stamps may be of any earlier time."""
    return source.latched or source.topic.endswith("tf_static")
