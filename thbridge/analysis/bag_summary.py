"""Summary of a recording: number of messages, rate, publishers and gaps of each topic."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from itertools import groupby
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from thbridge.recording.bag.reading.contents import BagContents, ConnectionStamps, contents
from thbridge.recording.bag.reading.reader import messages
from thbridge.recording.recordings import parts_of
from thbridge.ros.messages import unpack_session
from thbridge.ros.messages.types import SESSION

GAP_PERIODS = 5.0
GAP_NS = 1_000_000_000
"""A topic has a gap where it has no message for more than this many median periods, and for at least a second. A
latched topic has none: its last message holds until the next."""
REGULAR = 10
REGULAR_SHARE = 0.5
"""Only topics with at least this many messages can have gaps, and only if number of messages times median period is at
least this share of their time: topics that publish in bursts are left out."""


@dataclass(frozen=True, slots=True)
class Gap:
    """A gap in the messages of a regular topic.

    Attributes:
        start_ns: stamp of the last message before it.
        seconds: its length.
    """

    start_ns: int
    seconds: float


@dataclass(frozen=True, slots=True)
class TopicSummary:
    """Summary of one topic.

    Attributes:
        name: with its leading slash.
        msgtype: type of its messages; several, separated by commas, where publishers disagree.
        md5: md5 sum of the type; several, separated by commas, where publishers disagree.
        messages: number of messages.
        latched: True when a publisher latches it.
        callers: names of its publishers.
        hertz: inverse of the median period; None without one.
        start_ns: stamp of its first message, or None.
        end_ns: stamp of its last one.
        gaps: longest first, ten at most.
    """

    name: str
    msgtype: str
    md5: str
    messages: int
    latched: bool
    callers: tuple[str, ...]
    hertz: float | None
    start_ns: int | None
    end_ns: int | None
    gaps: tuple[Gap, ...]


@dataclass(frozen=True, slots=True)
class RecordingFile:
    """One file of a recording."""

    path: Path
    size: int
    messages: int


@dataclass(frozen=True, slots=True)
class SessionSummary:
    """The data needed to run one of our sessions again.

    Attributes:
        seed: seed of all random numbers.
        versions: versions of programs and libraries, and the machine; as in `SessionRecord`.
        study: the resolved study file, YAML.
    """

    seed: int
    versions: dict[str, str]
    study: str


@dataclass(frozen=True, slots=True)
class RecordingSummary:
    """Summary of a recording.

    Attributes:
        path: the path as it was given.
        parts: its files.
        size: bytes of all files.
        compression: compression of its chunks; several are separated by commas.
        start_ns: stamp of the first message, nanoseconds; None when there is none.
        end_ns: stamp of the last one.
        duration: seconds between them.
        messages: number of messages, with the latched ones that are repeated at the beginning of parts.
        topics: the topics by name.
        session: data of the session; None for recordings of others.
    """

    path: Path
    parts: tuple[RecordingFile, ...]
    size: int
    compression: str
    start_ns: int | None
    end_ns: int | None
    duration: float
    messages: int
    topics: tuple[TopicSummary, ...]
    session: SessionSummary | None


def summarise(bag: Path) -> RecordingSummary:
    """Summarise a recording by its index.

    Args:
        bag: a bag, or the name of a split recording.

    Raises:
        BadFile: there is no such file, it is not a ROS 1 bag, or it is cut off or damaged.
    """
    files = [contents(part) for part in parts_of(bag)]
    publishers = sorted((who for file in files for who in file.publishers), key=lambda who: who.topic)
    topics = tuple(_topic(name, list(group)) for name, group in groupby(publishers, key=lambda who: who.topic))
    starts = [topic.start_ns for topic in topics if topic.start_ns is not None]
    ends = [topic.end_ns for topic in topics if topic.end_ns is not None]
    return RecordingSummary(
        path=bag,
        parts=tuple(RecordingFile(file.path, file.size, _count(file)) for file in files),
        size=sum(file.size for file in files),
        compression=_joined(name for file in files for name in file.compressions),
        start_ns=min(starts, default=None),
        end_ns=max(ends, default=None),
        duration=(max(ends) - min(starts)) / 1e9 if starts else 0.0,
        messages=sum(topic.messages for topic in topics),
        topics=topics,
        session=_session(bag, topics),
    )


def _count(file: BagContents) -> int:
    return sum(who.stamps_ns.size for who in file.publishers)


def _joined(words: Iterable[str]) -> str:
    return ", ".join(sorted(set(words)))


def _topic(name: str, publishers: Sequence[ConnectionStamps]) -> TopicSummary:
    latched = any(who.latched for who in publishers)
    stamps = np.sort(np.concatenate([who.stamps_ns for who in publishers]), kind="stable")
    periods = np.diff(stamps)
    median = float(np.median(periods)) if periods.size else 0.0
    return TopicSummary(
        name=name,
        msgtype=_joined(who.msgtype for who in publishers),
        md5=_joined(who.md5 for who in publishers),
        messages=stamps.size,
        latched=latched,
        callers=tuple(sorted({who.caller for who in publishers if who.caller is not None})),
        hertz=1e9 / median if median > 0.0 else None,
        start_ns=int(stamps[0]) if stamps.size else None,
        end_ns=int(stamps[-1]) if stamps.size else None,
        gaps=() if latched else _gaps(stamps, periods, median),
    )


def _gaps(stamps: NDArray[np.int64], periods: NDArray[np.int64], median: float) -> tuple[Gap, ...]:
    if stamps.size < REGULAR or median * stamps.size < REGULAR_SHARE * float(stamps[-1] - stamps[0]):
        return ()
    (places,) = np.nonzero(periods > max(GAP_PERIODS * median, GAP_NS))
    longest = sorted(places.tolist(), key=lambda place: -int(periods[place]))[:10]
    return tuple(Gap(int(stamps[place]), int(periods[place]) / 1e9) for place in longest)


def _session(bag: Path, topics: Sequence[TopicSummary]) -> SessionSummary | None:
    names = {topic.name for topic in topics if topic.msgtype == SESSION}
    first = next(iter(messages(bag, names)), None) if names else None
    if first is None:
        return None
    try:
        session = unpack_session.session(first.data)
    except ValueError:
        return None  # of a release with other fields
    return SessionSummary(session.seed, session.versions, session.study)
