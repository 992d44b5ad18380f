"""Reads ROS 1 bags, ours and others; damaged ones raise BadFile with a remedy."""

import struct
from collections.abc import Collection, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

from rosbags.interfaces import Connection as ConnectionInIndex
from rosbags.rosbag1 import Reader, ReaderError
from rosbags.rosbag1.reader import IndexData
from rosbags.typesys.msg import denormalize_msgtype

from thbridge.files.errors import BadFile
from thbridge.recording.bag.records import BagConnection
from thbridge.recording.recordings import parts_of

MAGIC = b"#ROSBAG V"
VERSION = b"2.0\n"

_STUMBLES = (
    ReaderError,
    AssertionError,
    struct.error,
    ValueError,
    LookupError,
    EOFError,
    OSError,
    MemoryError,
    RuntimeError,
)
"""Errors of rosbags and of its decompressors on damaged files; they include failed assertions."""


@dataclass(frozen=True, slots=True)
class TopicInfo:
    """One topic of a bag.

    Attributes:
        name: its name, with the leading slash.
        msgtype: type of its messages, "nav_msgs/Odometry"; several, separated by commas, where publishers disagree.
        messages: number of messages.
        latched: True when a publisher latches it.
    """

    name: str
    msgtype: str
    messages: int
    latched: bool


@dataclass(frozen=True, slots=True)
class BagInfo:
    """Summary of a bag.

    Attributes:
        path: the file.
        size: bytes.
        start_ns: stamp of the first message, nanoseconds; None when there is none.
        end_ns: stamp of the last message.
        duration: seconds between them; 0 when there is none.
        messages: number of messages.
        topics: the topics by name.
    """

    path: Path
    size: int
    start_ns: int | None
    end_ns: int | None
    duration: float
    messages: int
    topics: tuple[TopicInfo, ...]


@dataclass(frozen=True, slots=True)
class RawMessage:
    """One message of a bag, not decoded.

    Attributes:
        topic: its topic.
        msgtype: for example "nav_msgs/Odometry".
        md5: md5 sum of its type; differs between releases with different fields.
        stamp_ns: stamp of recording.
        data: its bytes.
    """

    topic: str
    msgtype: str
    md5: str
    stamp_ns: int
    data: bytes


def info(path: Path) -> BagInfo:
    """Summary of a recording from its index; of a split one over all parts.

    The latched messages that are repeated at the beginning of each part are counted in each.

    Raises:
        BadFile: there is no such file, it is not a ROS 1 bag, or it is cut off or damaged.
    """
    parts = [_info_of(part) for part in parts_of(path)]
    topics: dict[str, TopicInfo] = {}
    for topic in (topic for part in parts for topic in part.topics):
        before = topics.get(topic.name)
        topics[topic.name] = topic if before is None else _together(before, topic)
    starts = [part.start_ns for part in parts if part.start_ns is not None]
    ends = [part.end_ns for part in parts if part.end_ns is not None]
    return BagInfo(
        path=path,
        size=sum(part.size for part in parts),
        start_ns=min(starts, default=None),
        end_ns=max(ends, default=None),
        duration=(max(ends) - min(starts)) / 1e9 if starts else 0.0,
        messages=sum(part.messages for part in parts),
        topics=tuple(topic for _, topic in sorted(topics.items())),
    )


def _info_of(path: Path) -> BagInfo:
    with opened(path) as reader:
        topics = tuple(
            TopicInfo(
                name,
                ", ".join(sorted({denormalize_msgtype(connection.msgtype) for connection in topic.connections})),
                topic.msgcount,
                any(_latched(connection.ext) for connection in topic.connections),
            )
            for name, topic in sorted(reader.topics.items())
        )
        messages = sum(topic.messages for topic in topics)
        start, end = (reader.start_time, reader.end_time - 1) if messages else (None, None)
        duration = (end - start) / 1e9 if start is not None and end is not None else 0.0
        return BagInfo(path, path.stat().st_size, start, end, duration, messages, topics)


def _together(one: TopicInfo, other: TopicInfo) -> TopicInfo:
    types = {*one.msgtype.split(", "), *other.msgtype.split(", ")}
    return TopicInfo(one.name, ", ".join(sorted(types)), one.messages + other.messages, one.latched or other.latched)


def messages(path: Path, topics: Collection[str] | None = None) -> Iterator[RawMessage]:
    """Yield every message, oldest first; see `recorded` for arguments, split recordings and errors."""
    for connection, stamp_ns, data in recorded(path, topics):
        yield RawMessage(connection.topic, connection.msgtype, connection.md5, stamp_ns, data)


def recorded(path: Path, topics: Collection[str] | None = None) -> Iterator[tuple[BagConnection, int, bytes]]:
    """Yield every message, oldest first: its publisher, stamp of recording (nanoseconds), and bytes.

    Messages with equal stamps come in the order of recording.

    The parts of a split recording are read as one: the latched messages that a part repeats at its beginning, so that
    it can be played by itself, are left out. A publisher that is in several parts is one object.

    Args:
        path: the bag, or the name of a split recording.
        topics: names of the topics to read; None for all. Chunks without them are not unpacked.

    Raises:
        BadFile: there is no such file, it is not a ROS 1 bag, or it is cut off or damaged.
    """
    latched: dict[str, bytes] = {}
    known: dict[tuple[str | bool | None, ...], BagConnection] = {}
    for part in parts_of(path):
        with opened(part) as reader:
            repeatable, start_ns = dict(latched), reader.start_time
            wanted = [connection for connection in reader.connections if topics is None or connection.topic in topics]
            publishers = {connection.id: _publisher(connection, known) for connection in wanted}
            _order(reader)
            # For the reader an empty list means every topic.
            for connection, stamp, data in reader.messages(wanted) if wanted else ():
                data = bytes(data)  # noqa: PLW2901
                if stamp == start_ns and repeatable.pop(connection.topic, None) == data:
                    continue
                publisher = publishers[connection.id]
                if publisher.latching:
                    latched[connection.topic] = data
                yield publisher, stamp, data


def _publisher(found: ConnectionInIndex, known: dict[tuple[str | bool | None, ...], BagConnection]) -> BagConnection:
    caller = getattr(found.ext, "callerid", None)
    latching = None if getattr(found.ext, "latching", None) is None else _latched(found.ext)
    topic, msgtype, md5, definition = found.topic, denormalize_msgtype(found.msgtype), found.digest, found.msgdef.data
    key = (topic, msgtype, md5, definition, caller, latching)
    return known.setdefault(key, BagConnection(len(known), topic, msgtype, md5, definition, caller, latching))


class _Place(IndexData):
    """Location of a message; ordered by time, then by position in the file."""

    __lt__, __eq__, __hash__ = tuple.__lt__, tuple.__eq__, tuple.__hash__


def _order(reader: Reader) -> None:
    """Make a reader order messages of equal stamps by position in the file; rosbags compares stamps only."""
    for number, entries in reader.indexes.items():
        reader.indexes[number] = sorted(_Place(*entry) for entry in entries)


def check_is_bag(path: Path) -> None:
    """Raise BadFile unless a file begins like a ROS 1 bag.

    Raises:
        BadFile: it does not, or cannot be read.
    """
    try:
        with path.open("rb") as file:
            head = file.read(len(MAGIC) + len(VERSION))
    except OSError as error:
        raise BadFile(path, (error.strerror or str(error)).lower(), "name a bag that can be read") from error
    if not head.startswith(MAGIC):
        raise BadFile(path, "this is not a ROS 1 bag", "name a file that rosbag or thbridge recorded")
    if head != MAGIC + VERSION:
        raise BadFile(path, "this bag has another version than 2.0", "convert it with `rosbag fix` of its own ROS")


def _latched(ext: object) -> bool:
    return getattr(ext, "latching", None) == 1


@contextmanager
def opened(path: Path) -> Iterator[Reader]:
    """Open one file with rosbags; errors of damaged files within the block become BadFile."""
    check_is_bag(path)
    reader = Reader(path)
    try:
        with damage_as_bad_file(path):
            reader.open()
            yield reader
    finally:
        if reader.bio is not None:
            reader.close()


@contextmanager
def damage_as_bad_file(path: Path) -> Iterator[None]:
    """Convert errors of parser and decompressors within the block to BadFile."""
    try:
        yield
    except _STUMBLES as error:
        raise damaged(path) from error


def damaged(path: Path) -> BadFile:
    """The BadFile for a file that is cut off or damaged."""
    return BadFile(path, "the bag was cut off or is damaged", f"run `thbridge bag reindex {path}`")
