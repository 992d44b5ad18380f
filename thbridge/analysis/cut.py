"""Cuts a piece out of a recording that can be played by itself."""

import math
from collections.abc import Collection
from dataclasses import dataclass
from pathlib import Path

from thbridge.files.errors import BadFile
from thbridge.files.new_file import new_file
from thbridge.recording.bag.bag_file import BagFile
from thbridge.recording.bag.reader import info, recorded
from thbridge.recording.bag.records import BagConnection, Compression


@dataclass(frozen=True, slots=True)
class CutRange:
    """What to cut out.

    Attributes:
        start: seconds from the recording's first message; what comes at that moment is in.
        end: likewise; what comes at that moment is in.
        topics: names of those wanted; None for all.
        compression: of the new bag.
    """

    start: float = 0.0
    end: float = math.inf
    topics: tuple[str, ...] | None = None
    compression: Compression = Compression.NONE


@dataclass(frozen=True, slots=True)
class CutResult:
    """What was cut out.

    Attributes:
        path: the new bag.
        messages: how many are in it.
        carried: latched messages among them that are from before the piece.
        start_ns: where the piece begins.
        end_ns: stamp of its last message.
    """

    path: Path
    messages: int
    carried: int
    start_ns: int
    end_ns: int


def cut(bag: Path, piece: CutRange, out: Path, overwrite: bool = False) -> CutResult:
    """Write a piece of a recording as one bag, in the order of time.

    Publishers keep their names, latching and definitions. What was latched when the piece begins is its beginning,
    stamped with the piece's first moment: `rosbag play` starts at the first stamp and would else wait out the time
    between, and rviz finds the map and the static transforms at once. Headers inside the messages stay as they were.

    Args:
        bag: the recording, or the name of a split one.
        piece: what to cut out.
        out: the new bag.
        overwrite: whether a file of that name may go.

    Raises:
        BadFile: the bag cannot be read, has no such time or topic, or the new one cannot be written.
    """
    found = info(bag)
    if found.start_ns is None or found.end_ns is None:
        raise BadFile(bag, None, None, "there is no message in it", "name another bag")
    _check_topics(bag, piece.topics, {topic.name for topic in found.topics})
    if not 0.0 <= piece.start < piece.end:
        raise BadFile(
            bag, None, "--from", f"{piece.start:g} s is not before {piece.end:g} s", "give --from before --to"
        )
    if piece.start > found.duration:
        problem = f"{piece.start:g} s is beyond its end"
        raise BadFile(bag, None, "--from", problem, f"it lasts {found.duration:.3f} s")
    start_ns = found.start_ns + round(piece.start * 1e9)
    end_ns = found.end_ns if math.isinf(piece.end) else found.start_ns + round(piece.end * 1e9)
    with new_file(out, bag, overwrite) as path:
        target = BagFile(path, piece.compression)
        messages, carried, last_ns = _copy(bag, piece.topics, start_ns, end_ns, target)
        target.close()
        if not messages:
            raise BadFile(bag, None, None, "nothing is in this piece", "choose other times or topics")
    return CutResult(out, messages, carried, start_ns, last_ns)


def _check_topics(bag: Path, wanted: Collection[str] | None, there: Collection[str]) -> None:
    lacking = sorted(set(wanted or ()) - set(there))
    if lacking:
        problem = f"there is no topic {', '.join(lacking)} in it"
        raise BadFile(bag, None, "--topics", problem, "see `thbridge bag info` for those it has")


def _copy(
    bag: Path, topics: Collection[str] | None, start_ns: int, end_ns: int, target: BagFile
) -> tuple[int, int, int]:
    """Number of messages, how many of them were carried over, and the last stamp."""
    latched: dict[BagConnection, bytes] = {}
    messages = carried = 0
    last_ns = start_ns
    for publisher, stamp_ns, data in recorded(bag, topics):
        if stamp_ns > end_ns:
            break
        if stamp_ns < start_ns:
            # Static transforms are meant to last, whether their recorder knew it or not.
            if publisher.latching or publisher.topic.endswith("tf_static"):
                latched[publisher] = data
            continue
        for early, early_data in latched.items():
            target.write(early, start_ns, early_data)
            carried += 1
        latched.clear()
        target.write(publisher, stamp_ns, data)
        messages += 1
        last_ns = stamp_ns
    for early, early_data in latched.items():
        target.write(early, start_ns, early_data)
        carried += 1
    return messages + carried, carried, last_ns
