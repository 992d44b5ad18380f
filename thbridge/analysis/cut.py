"""Cut of a recording: a part of the recording, as a bag that can be played alone."""

import math
from collections.abc import Collection
from dataclasses import dataclass
from pathlib import Path

from thbridge.files.disk.new_file import new_file
from thbridge.files.errors import BadFile
from thbridge.recording.bag.options import Compression
from thbridge.recording.bag.reading.reader import holds, info, recorded
from thbridge.recording.bag.records import BagConnection
from thbridge.recording.bag.repair import compression_of
from thbridge.recording.bag.writing.bag_file import BagFile
from thbridge.recording.recordings import parts_of
from thbridge.ros.messages.types import SESSION


@dataclass(frozen=True, slots=True)
class CutRange:
    """Times and topics of a cut.

    Attributes:
        start: seconds from the recording's first message, inclusive.
        end: seconds from the recording's first message, inclusive.
        topics: names of the topics to copy. If None, all topics are copied.
        compression: compression of the new bag. If None, the new bag is compressed like the recording.
    """

    start: float = 0.0
    end: float = math.inf
    topics: tuple[str, ...] | None = None
    compression: Compression | None = None


@dataclass(frozen=True, slots=True)
class CutResult:
    """Result of a cut.

    Attributes:
        path: new bag.
        messages: number of messages in the new bag.
        latched: number of latched messages in the new bag that were recorded before the cut begins.
        start_ns: stamp at which the cut begins.
        end_ns: stamp of the last message in the new bag.
    """

    path: Path
    messages: int
    latched: int
    start_ns: int
    end_ns: int


def cut(bag: Path, piece: CutRange, out: Path, overwrite: bool = False) -> CutResult:
    """Write a part of a recording as one bag, in the order of time.

    Publishers keep their names, latching and definitions. The new bag begins with the last latched message that each
    topic published before the cut, with the start of the cut as its stamp. So rviz gets the map and the static
    transforms at once, and `rosbag play`, which starts at the first stamp, does not wait. Headers inside messages do
    not change.

    Args:
        bag: recording, or name of a split recording.
        piece: times and topics.
        out: new bag.
        overwrite: True to replace an existing file.

    Raises:
        BadFile: the bag cannot be read, has no such time or topic, or the new bag cannot be written.
    """
    found = info(bag)
    if found.start_ns is None or found.end_ns is None:
        raise BadFile(bag, "this bag contains no messages", "name another bag")
    _check_topics(bag, piece.topics, {topic.name for topic in found.topics})
    if not 0.0 <= piece.start < piece.end:
        raise BadFile(
            bag,
            f"{piece.start:g} s is not before {piece.end:g} s",
            "give a --from that is before --until",
            key="--from",
        )
    if piece.start > found.duration:
        problem = f"{piece.start:g} s is after the end of the bag"
        raise BadFile(bag, problem, f"write a time up to {found.duration:.3f} s", key="--from")
    start_ns = found.start_ns + round(piece.start * 1e9)
    end_ns = found.end_ns if math.isinf(piece.end) else found.start_ns + round(piece.end * 1e9)
    if piece.compression is Compression.ZSTD:
        raise BadFile(out, "bags of ROS 1 cannot have the compression zstd", "write lz4", key="--compression")
    with new_file(out, bag, overwrite) as path:
        target = BagFile(path, piece.compression or compression_of(parts_of(bag)[0]))
        # The session is always copied, because it describes the conditions of all other data.
        sessions = {topic.name for topic in found.topics if topic.msgtype == SESSION}
        chosen = None if piece.topics is None else sessions.union(piece.topics)
        messages, latched, last_ns = _copy(bag, chosen, start_ns, end_ns, target)
        target.close()
        if not messages:
            raise BadFile(bag, "this part contains no messages", "choose other times or topics")
    return CutResult(out, messages, latched, start_ns, last_ns)


def _check_topics(bag: Path, wanted: Collection[str] | None, there: Collection[str]) -> None:
    lacking = sorted(set(wanted or ()) - set(there))
    if lacking:
        problem = f"the bag has no topic {', '.join(lacking)}"
        raise BadFile(bag, problem, "`thbridge bag info` lists the topics", key="--topics")


def _copy(
    bag: Path, topics: Collection[str] | None, start_ns: int, end_ns: int, target: BagFile
) -> tuple[int, int, int]:
    """Copy the messages. Return the number of messages, the number of latched messages, and the last stamp."""
    latched: dict[BagConnection, bytes] = {}
    messages = early_messages = 0
    last_ns = start_ns
    for publisher, stamp_ns, data in recorded(bag, topics, start_ns):
        if stamp_ns > end_ns:
            break
        if stamp_ns < start_ns:
            if holds(publisher):
                latched[publisher] = data
            continue
        for early, early_data in latched.items():
            target.write(early, start_ns, early_data)
            early_messages += 1
        latched.clear()
        target.write(publisher, stamp_ns, data)
        messages += 1
        last_ns = stamp_ns
    for early, early_data in latched.items():
        target.write(early, start_ns, early_data)
        early_messages += 1
    return messages + early_messages, early_messages, last_ns
