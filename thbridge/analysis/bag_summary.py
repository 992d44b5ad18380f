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
"""A gap is a time without messages that is longer than `GAP_PERIODS` median periods and longer than `GAP_NS`. Latched
topics have no gaps, because their last message stays valid until the next message."""
REGULAR = 10
REGULAR_SHARE = 0.5
"""A topic can have gaps only if it has at least `REGULAR` messages. Also, the number of messages times the median
period must be at least `REGULAR_SHARE` times the topic's time span. This excludes topics that publish in bursts."""


@dataclass(frozen=True, slots=True)
class Gap:
    """Gap in the messages of a regular topic.

    Attributes:
        start_ns: stamp of the last message before the gap.
        seconds: length of the gap.
    """

    start_ns: int
    seconds: float


@dataclass(frozen=True, slots=True)
class TopicSummary:
    """Summary of one topic.

    Attributes:
        name: name, with its leading slash.
        msgtype: type of its messages; if publishers have different types, all types, separated by commas.
        md5: md5 sum of the type; if publishers have different types, all sums, separated by commas.
        messages: number of messages.
        latched: True if a publisher latches the topic.
        callers: names of the publishers.
        hertz: inverse of the median period; None if the topic has no period.
        start_ns: stamp of the first message, or None.
        end_ns: stamp of the last message, or None.
        gaps: the ten longest gaps, longest first.
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
    """File of a recording."""

    path: Path
    size: int
    messages: int


@dataclass(frozen=True, slots=True)
class SessionSummary:
    """Data needed to replay a session recorded by thbridge.

    Attributes:
        seed: seed of all random numbers.
        versions: versions of programs and libraries, and the machine; see `SessionRecord`.
        study: the resolved study file, YAML.
    """

    seed: int
    versions: dict[str, str]
    study: str


@dataclass(frozen=True, slots=True)
class RecordingSummary:
    """Summary of a recording.

    Attributes:
        path: path as given.
        parts: files of the recording.
        size: size of all files, bytes.
        compression: compression of the chunks; if there are several kinds, all kinds, separated by commas.
        start_ns: stamp of the first message, nanoseconds; None if there is none.
        end_ns: stamp of the last message, nanoseconds.
        duration: time between the first and the last message, seconds.
        messages: number of messages, including latched messages that are repeated at the beginning of parts.
        topics: topics, sorted by name.
        session: data of the session; None if thbridge did not record the bag.
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
    """Summarize a recording, using its index.

    Args:
        bag: bag, or name of a split recording.

    Raises:
        BadFile: the file does not exist, is not a ROS 1 bag, or is incomplete or damaged.
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
        return None  # recorded by a version with other fields
    return SessionSummary(session.seed, session.versions, session.study)
