"""Small bag that every tool accepts, as a list of messages in which tests plant faults."""

import math
from dataclasses import dataclass, field, replace
from pathlib import Path

import lz4.frame
import numpy as np
from rosbags.typesys.msg import normalize_msgtype

from sim.common.geometry import IDENTITY, Pose2
from tests.support.bags.foreign_bags import STORE, TYPES, Header, odometry, stamp, transform
from thbridge.analysis.check import Finding, Judgement, judge
from thbridge.recording.bag.reading.scan import scan
from thbridge.ros.messages.types import plain_definition

START = 100_000_000_000
STEP = 100_000_000
SCANS = 30
SCAN = "sensor_msgs/LaserScan"
TF = "tf2_msgs/TFMessage"
ODOM = "nav_msgs/Odometry"
MAP = "nav_msgs/OccupancyGrid"


@dataclass(frozen=True)
class Line:
    """Connection: one publisher of one topic."""

    topic: str
    msgtype: str
    latching: str | None = "0"
    caller: str | None = "/robot"
    md5: str | None = None
    definition: str | None = None


@dataclass(frozen=True)
class Entry:
    """Message, and the time at which it was recorded."""

    line: Line
    ns: int
    message: object = None
    data: bytes | None = None

    def bytes(self) -> bytes:
        if self.data is not None:
            return self.data
        return bytes(STORE.serialize_ros1(self.message, normalize_msgtype(self.line.msgtype)))


MAP_LINE = Line("/map", MAP, "1")
STATIC_LINE = Line("/tf_static", TF, "1")
TF_LINE = Line("/tf", TF)
ODOM_LINE = Line("/odom", ODOM)
SCAN_LINE = Line("/scan", SCAN)


@dataclass
class Planted:
    """Messages to write. Tests plant faults in them."""

    entries: list[Entry] = field(default_factory=list)

    def of(self, topic: str) -> list[Entry]:
        return [entry for entry in self.entries if entry.line.topic == topic]

    def change(self, topic: str, **changes: object) -> None:
        """Change the connection of a topic."""
        for place, entry in enumerate(self.entries):
            if entry.line.topic == topic:
                self.entries[place] = replace(entry, line=replace(entry.line, **changes))  # type: ignore[arg-type]

    def drop(self, topic: str) -> None:
        self.entries = [entry for entry in self.entries if entry.line.topic != topic]


def tf(*transforms: object) -> object:
    return TYPES["tf2_msgs/msg/TFMessage"](list(transforms))


def grid(ns: int, width: int = 4, height: int = 3, cells: int = 12) -> object:
    pose = TYPES["geometry_msgs/msg/Pose"](
        TYPES["geometry_msgs/msg/Point"](0.0, 0.0, 0.0), TYPES["geometry_msgs/msg/Quaternion"](0.0, 0.0, 0.0, 1.0)
    )
    meta = TYPES["nav_msgs/msg/MapMetaData"](stamp(ns), 0.05, width, height, pose)
    return TYPES["nav_msgs/msg/OccupancyGrid"](Header(0, stamp(ns), "map"), meta, np.zeros(cells, dtype=np.int8))


def scan_message(ns: int, frame: str = "laser", beams: int = 91, ranges: int = 91, intensities: int = 0) -> object:
    step = math.pi / (beams - 1)
    return TYPES["sensor_msgs/msg/LaserScan"](
        Header(0, stamp(ns), frame), -math.pi / 2, math.pi / 2, step, 0.0, 0.1, 0.1, 8.0,
        np.ones(ranges, dtype=np.float32), np.ones(intensities, dtype=np.float32),
    )  # fmt: skip


def odom_message(ns: int, sure: bool = False) -> object:
    message = odometry(ns, "odom", "base_link", IDENTITY)
    if not sure:
        message.pose.covariance[0] = 0.1  # type: ignore[attr-defined]
    return message


def clean() -> Planted:
    """Return three seconds of messages of a robot that stands still."""
    entries = [
        Entry(MAP_LINE, START, grid(START)),
        Entry(STATIC_LINE, START, tf(transform(START, "base_link", "laser", Pose2(0.1, 0.0, 0.0)))),
    ]
    for index in range(SCANS):
        ns = START + index * STEP
        entries += [
            Entry(
                TF_LINE, ns, tf(transform(ns, "map", "odom", IDENTITY), transform(ns, "odom", "base_link", IDENTITY))
            ),
            Entry(ODOM_LINE, ns, odom_message(ns)),
            Entry(SCAN_LINE, ns, scan_message(ns)),
        ]
    return Planted(entries)


@dataclass
class Form:
    """Options of the written file, faults included."""

    chunk_bytes: int = 4000
    padded_to: int = 4096
    indexed: bool = True
    reverse_chunks: bool = False
    extra_lines: tuple[Line, ...] = ()
    ros_order: bool = False
    empty_chunk: bool = False
    lz4_flags: dict[str, bool] | None = None


def fields(**values: bytes) -> bytes:
    parts = [name.encode() + b"=" + value for name, value in values.items()]
    return b"".join(uint32(len(part)) + part for part in parts)


def record(head: bytes, data: bytes) -> bytes:
    return uint32(len(head)) + head + uint32(len(data)) + data


def uint32(value: int) -> bytes:
    return value.to_bytes(4, "little")


def uint64(value: int) -> bytes:
    return value.to_bytes(8, "little")


def time_of(ns: int) -> bytes:
    return uint32(ns // 1_000_000_000) + uint32(ns % 1_000_000_000)


def connection_record(number: int, line: Line) -> bytes:
    md5 = plain_definition(line.msgtype).md5 if line.md5 is None else line.md5
    text = plain_definition(line.msgtype).text if line.definition is None else line.definition
    said = {"topic": line.topic.encode(), "type": line.msgtype.encode(), "md5sum": md5.encode()}
    said["message_definition"] = text.encode()
    if line.caller is not None:
        said["callerid"] = line.caller.encode()
    if line.latching is not None:
        said["latching"] = line.latching.encode()
    return record(fields(op=b"\x07", conn=uint32(number), topic=line.topic.encode()), fields(**said))


def message_record(number: int, entry: Entry, ros_order: bool) -> bytes:
    names = {"op": b"\x02", "conn": uint32(number), "time": time_of(entry.ns)}
    order = ("conn", "op", "time") if ros_order else ("op", "conn", "time")
    return record(fields(**{name: names[name] for name in order}), entry.bytes())


def file_header(index_pos: int, connections: int, chunks: int, padded_to: int) -> bytes:
    head = fields(op=b"\x03", index_pos=uint64(index_pos), conn_count=uint32(connections), chunk_count=uint32(chunks))
    return record(head, b" " * (padded_to - len(head)))


def content(planted: Planted, form: Form = Form()) -> bytes:  # noqa: B008 - it is frozen in effect
    """Return the bytes of a bag. They are built here, and not by a library, so that every fault can be planted."""
    numbers: dict[Line, int] = {}
    groups: list[list[Entry]] = [[]]
    size = 0
    for entry in planted.entries:
        if size > form.chunk_bytes:
            groups.append([])
            size = 0
        groups[-1].append(entry)
        size += len(entry.bytes())
    if form.reverse_chunks:
        groups.reverse()
    if form.empty_chunk:
        groups.append([])
    out = bytearray(b"#ROSBAG V2.0\n" + file_header(0, 0, 0, form.padded_to))
    infos = []
    for group in groups:
        inside = bytearray()
        places: dict[int, list[tuple[int, int]]] = {}
        for entry in group:
            if entry.line not in numbers:
                numbers[entry.line] = len(numbers)
                inside += connection_record(numbers[entry.line], entry.line)
            number = numbers[entry.line]
            places.setdefault(number, []).append((entry.ns, len(inside)))
            inside += message_record(number, entry, form.ros_order)
        position = len(out)
        packed, name = bytes(inside), b"none"
        if form.lz4_flags is not None:
            packed, name = lz4.frame.compress(packed, **form.lz4_flags), b"lz4"
        out += record(fields(op=b"\x05", compression=name, size=uint32(len(inside))), packed)
        for number, found_at in places.items():
            head = fields(op=b"\x04", ver=uint32(1), conn=uint32(number), count=uint32(len(found_at)))
            out += record(head, b"".join(time_of(ns) + uint32(place) for ns, place in found_at))
        stamps = [entry.ns for entry in group]
        counts = b"".join(uint32(number) + uint32(len(found_at)) for number, found_at in places.items())
        times = {"start_time": time_of(min(stamps, default=0)), "end_time": time_of(max(stamps, default=0))}
        head = fields(op=b"\x06", ver=uint32(1), chunk_pos=uint64(position), count=uint32(len(places)), **times)
        infos.append(record(head, counts))
    for line in form.extra_lines:
        numbers[line] = len(numbers)
    if form.indexed:
        index_pos = len(out)
        for line, number in numbers.items():
            out += connection_record(number, line)
        out += b"".join(infos)
        header = file_header(index_pos, len(numbers), len(infos), form.padded_to)
        out[13 : 13 + len(header)] = header
    return bytes(out)


def write(path: Path, planted: Planted, **form: object) -> Path:
    """Write the messages in their order in the list; see `Form`."""
    path.write_bytes(content(planted, Form(**form)))  # type: ignore[arg-type]
    return path


def judged(folder: Path, planted: Planted, **form: object) -> Judgement:
    """Write the messages as a bag, and return the findings about it."""
    return judge(scan(write(folder / "planted.bag", planted, **form)))


def found(judgement: Judgement, rule: str) -> Finding:
    """Return the first finding of a rule. Raise AssertionError if there is none."""
    findings = [finding for finding in judgement.findings if finding.rule == rule]
    assert findings, f"{rule} is not among {[finding.rule for finding in judgement.findings]}"
    return findings[0]


def rules(judgement: Judgement) -> set[str]:
    """Return the names of all rules that have findings."""
    return {finding.rule for finding in judgement.findings}
