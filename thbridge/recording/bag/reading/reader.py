"""Reader of ROS 1 bags, of thbridge or other programs. Damaged bags raise BadFile with a remedy."""

from bisect import bisect_left
from collections.abc import Callable, Collection, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Literal, NamedTuple

import numpy as np

from thbridge.recording.bag.damage import check_is_bag, damage_as_bad_file
from thbridge.recording.bag.reading.chunk_reader import ChunkInfo, ChunkReader
from thbridge.recording.bag.reading.file_end import FileEnd, read_end
from thbridge.recording.bag.records import BagConnection
from thbridge.recording.bag.ros2 import as_ros1
from thbridge.recording.bag.ros2_storage import size_of
from thbridge.recording.recordings import parts_of
from thbridge.ros.messages.identification import DefinitionSource, IdentifiedType, by_name, identified, missing_types

BYTES_KEPT = 4 * 1024 * 1024
"""Size of the cache of unpacked chunks, in bytes; it is used for chunks that overlap in time."""


@dataclass(frozen=True, slots=True)
class TopicInfo:
    """One topic of a bag.

    Attributes:
        name: name of the topic, with the leading slash.
        msgtype: type of its messages, such as "nav_msgs/Odometry"; if publishers have different types, all types,
            separated by commas.
        messages: number of messages.
        latched: True if a publisher latches the topic.
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
        start_ns: stamp of the first message, nanoseconds; None if there are no messages.
        end_ns: stamp of the last message.
        duration: seconds between these two stamps; 0 if there are no messages.
        messages: number of messages.
        topics: the topics, ordered by name.
    """

    path: Path
    size: int
    start_ns: int | None
    end_ns: int | None
    duration: float
    messages: int
    topics: tuple[TopicInfo, ...]


class RawMessage(NamedTuple):
    """One message of a bag, not decoded.

    Attributes:
        topic: name of the topic.
        msgtype: for example "nav_msgs/Odometry".
        md5: md5 sum of the type. The sum differs between releases if the fields of the type differ.
        stamp_ns: stamp of recording.
        data: bytes of the message.
    """

    topic: str
    msgtype: str
    md5: str
    stamp_ns: int
    data: bytes


def info(path: Path) -> BagInfo:
    """Return the summary of a recording from its index. A split recording has one summary for all parts.

    Latched messages that are repeated at the beginning of a part count in each part.

    Raises:
        BadFile: the file does not exist, is not a ROS 1 bag, or is cut off or damaged.
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
    with opened(path) as (end, _):
        counts: dict[int, int] = {}
        for chunk in end.chunks:
            for number, count in chunk.counts.items():
                counts[number] = counts.get(number, 0) + count
        topics: dict[str, TopicInfo] = {}
        for each in end.connections:
            topic = TopicInfo(each.topic, each.msgtype, counts.get(each.number, 0), each.latching is True)
            before = topics.get(each.topic)
            topics[each.topic] = topic if before is None else _together(before, topic)
        start, last = end.start_ns, end.end_ns
        duration = (last - start) / 1e9 if start is not None and last is not None else 0.0
        in_order = tuple(topic for _, topic in sorted(topics.items()))
        return BagInfo(path, size_of(path), start, last, duration, sum(counts.values()), in_order)


def _together(one: TopicInfo, other: TopicInfo) -> TopicInfo:
    types = {*one.msgtype.split(", "), *other.msgtype.split(", ")}
    return TopicInfo(one.name, ", ".join(sorted(types)), one.messages + other.messages, one.latched or other.latched)


def messages(path: Path, topics: Collection[str] | None = None, unchanged: bool = False) -> Iterator[RawMessage]:
    """Yield every message, oldest first; see `recorded` for arguments, split recordings and errors."""
    for connection, stamp_ns, data in recorded(path, topics, unchanged=unchanged):
        yield RawMessage(connection.topic, connection.msgtype, connection.md5, stamp_ns, data)


def recorded(
    path: Path, topics: Collection[str] | None = None, since_ns: int | None = None, unchanged: bool = False
) -> Iterator[tuple[BagConnection, int, bytes]]:
    """Yield every message, oldest first: its publisher, stamp of recording (nanoseconds), and bytes.

    Messages with equal stamps come in the order of recording. Only a few chunks are in memory, for recordings of any
    size.

    The parts of a split recording are read as one recording. A part repeats latched messages at its beginning, so that
    each part can be played alone. These repetitions are left out. A publisher that is in several parts is represented
    by one object. A publisher without a complete definition gets the known definition with its md5 sum. Otherwise the
    publisher gets the known definition for the name of its type, if the first message fits.

    Args:
        path: the bag, or the name of a split recording.
        topics: names of the topics to read. If None, all topics are read. Chunks without these topics are not unpacked.
        unchanged: True to yield messages of ROS 2 recordings as CDR, as they are in the file. By default, they become
            messages of ROS 1.
        since_ns: a stamp. From chunks that end before this stamp, only messages that stay valid (see `holds`) are read.

    Raises:
        BadFile: the file does not exist, is not a ROS 1 bag, or is cut off or damaged.
    """
    latched: dict[str, bytes] = {}
    known: dict[tuple[str | bool | None, ...], BagConnection] = {}
    for part in parts_of(path):
        with opened(part, unchanged) as (end, reader):
            repeatable, start_ns = dict(latched), end.start_ns
            publishers = {
                each.number: _publisher(each, known)
                for each in end.connections
                if topics is None or each.topic in topics
            }
            held = {number for number, publisher in publishers.items() if holds(publisher)}

            def wanted(
                chunk: ChunkInfo,
                held: Collection[int] = held,
                publishers: Mapping[int, BagConnection] = publishers,
            ) -> Collection[int]:
                return chunk.counts.keys() & (held if chunk.is_before(since_ns) else publishers.keys())

            undefined = {number for number, publisher in publishers.items() if _lacks(publisher)}
            for number, stamp, data in _in_order(reader, [chunk for chunk in end.chunks if wanted(chunk)], wanted):
                publisher = publishers[number]
                if number in undefined:
                    undefined.remove(number)
                    publisher = publishers[number] = _named(publisher, data, known)
                if repeatable and stamp == start_ns and repeatable.pop(publisher.topic, None) == data:
                    continue
                if publisher.latching:
                    latched[publisher.topic] = data
                yield publisher, stamp, data


def holds(publisher: BagConnection) -> bool:
    """Return True when the last message of a publisher stays valid: it latches, or publishes static transforms.

    Static transforms count even if their recorder did not mark them as latched.
    """
    return publisher.latching is True or publisher.topic.endswith("tf_static")


def _publisher(found: BagConnection, known: dict[tuple[str | bool | None, ...], BagConnection]) -> BagConnection:
    better = identified(found.msgtype, found.md5, found.definition)
    if better is None or better.source is DefinitionSource.BAG:
        better = IdentifiedType(found.definition, found.source)
    key = (found.topic, found.msgtype, found.md5, better.definition, found.caller, found.latching)
    return known.setdefault(key, BagConnection(len(known), *key, better.source))


def _lacks(publisher: BagConnection) -> bool:
    """Return True when a publisher has no complete definition."""
    return bool(missing_types(publisher.msgtype, publisher.md5, publisher.definition))


def _named(
    publisher: BagConnection, data: bytes, known: dict[tuple[str | bool | None, ...], BagConnection]
) -> BagConnection:
    """Return the publisher. If a message fits the known definition of its type's name, use this definition."""
    better = by_name(publisher.msgtype, data)
    return publisher if better is None else _publisher(replace(publisher, **better._asdict()), known)


def _in_order(
    reader: ChunkReader, chosen: Collection[ChunkInfo], wanted: Callable[[ChunkInfo], Collection[int]]
) -> Iterator[tuple[int, int, bytes]]:
    """Yield connection number, stamp and bytes of each message on a wanted connection, from chunks of one file."""
    chunks = sorted(chosen, key=lambda chunk: (chunk.start_ns, chunk.position))
    # Chunks may overlap in time, so messages that are not before the next chunk wait here: stamp, chunk, offset,
    # number, turn.
    late: list[tuple[int, int, int, int, int]] = []
    for turn, chunk in enumerate(chunks):
        numbers, stamps, offsets = reader.places(chunk, wanted(chunk))
        horizon, ready = (2**64, 0), stamps.size
        if turn + 1 < len(chunks):
            after = chunks[turn + 1]
            horizon = (after.start_ns, after.position)
            side: Literal["left", "right"] = "right" if chunk.position < after.position else "left"
            ready = int(np.searchsorted(stamps, after.start_ns, side))
        waited, begin = bool(late), 0
        if not waited:
            yield from zip(
                numbers[:ready].tolist(), stamps[:ready].tolist(), reader.messages(chunk, offsets[:ready]), strict=True
            )
            begin = ready
        rest = zip(stamps[begin:].tolist(), offsets[begin:].tolist(), numbers[begin:].tolist(), strict=True)
        late += [(stamp, chunk.position, offset, number, turn) for stamp, offset, number in rest]
        if waited:
            late.sort()
            ready = bisect_left(late, horizon)
            for stamp, _, offset, number, of in late[:ready]:
                yield number, stamp, reader.message(chunks[of], offset)
            del late[:ready]


@contextmanager
def opened(path: Path, unchanged: bool = False) -> Iterator[tuple[FileEnd, ChunkReader]]:
    """Open one file: the index at its end, and a reader of its chunks. A ROS 2 recording is converted first.

    If `unchanged` is True, its messages stay CDR.

    Raises:
        BadFile: the file does not exist, is not a recording, or is cut off or damaged.
    """
    path = as_ros1(path, unchanged)
    check_is_bag(path)
    with path.open("rb") as file:
        end = FileEnd()
        with damage_as_bad_file(path):
            for _ in read_end(file, 0, path, end):
                pass
        yield end, ChunkReader((path,), (file,), BYTES_KEPT)
