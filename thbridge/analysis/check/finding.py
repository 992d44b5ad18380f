"""The words of a judgement: tools, severities, findings; and what a rule is."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from enum import StrEnum
from typing import Generic, Protocol, TypeVar

from thbridge.analysis.check.reading import Reading
from thbridge.recording.bag.scan import BagHeaderRecord, ChunkInfoRecord, ChunkRecord, ConnectionRecord, UnreadableSpan
from thbridge.ros.messages.types import ODOMETRY, POSE_WITH_COVARIANCE, TFMESSAGE

K = TypeVar("K")


class BagTool(StrEnum):
    """Whose acceptance is judged. `rosbag` stands for info, play, check, reindex and the topics that play makes."""

    ROSBAG = "rosbag"
    RVIZ = "rviz"
    FOXGLOVE = "Foxglove"
    PLOTJUGGLER = "PlotJuggler"
    EVO = "evo"


class FindingSeverity(StrEnum):
    """How bad: a tool refuses or shows wrong things; it works with a loss; good to know."""

    ERROR = "error"
    WARNING = "warning"
    NOTE = "note"


ALL = tuple(BagTool)
TF_TYPES = (TFMESSAGE, "tf/tfMessage")
POINT = "geometry_msgs/PointStamped"
STAMPED_POSES = (ODOMETRY, POSE_WITH_COVARIANCE, "geometry_msgs/PoseStamped", "geometry_msgs/TransformStamped", POINT)
EVO_TYPES = (*STAMPED_POSES, *TF_TYPES)
"""What evo makes trajectories of (evo, file_interface.py)."""


@dataclass(frozen=True, slots=True)
class Finding:
    """Something that a tool will stumble over.

    Attributes:
        rule: short name of the rule that found it.
        severity: how bad it is.
        tools: who stumbles.
        topic: where, or None when it is about the whole bag.
        what: one sentence, without its full stop.
        remedy: what to do about it, as a clause without its full stop.
        first_ns: record stamp of the first message concerned, or None when it is about no message.
        count: how many messages are concerned; 0 when it is about no message.
    """

    rule: str
    severity: FindingSeverity
    tools: tuple[BagTool, ...]
    topic: str | None
    what: str
    remedy: str
    first_ns: int | None = None
    count: int = 0


@dataclass(slots=True)
class ScannedChunk:
    """A chunk as it is in the file.

    Attributes:
        chunk: its record.
        counts: messages in it by connection.
        indexed: messages by connection that the index behind the chunk has.
        start_ns: least stamp in it, or None when it has no message.
        end_ns: greatest stamp.
    """

    chunk: ChunkRecord
    counts: dict[int, int]
    indexed: dict[int, int]
    start_ns: int | None = None
    end_ns: int | None = None


@dataclass(frozen=True, slots=True)
class BagStructure:
    """All of a bag but its messages' contents.

    Attributes:
        header: the first record; None when it cannot be read.
        sources: every connection by its number.
        counts: messages read, by connection.
        chunks: in the file's order.
        index: what the index says of each chunk.
        indexed_sources: number of connection records in the index.
        tears: what cannot be read.
        start_ns: least stamp of all messages; None when there are none.
        end_ns: greatest.
    """

    header: BagHeaderRecord | None
    connections: dict[int, ConnectionRecord]
    counts: dict[int, int]
    chunks: tuple[ScannedChunk, ...]
    index: tuple[ChunkInfoRecord, ...]
    indexed_connections: int
    unreadable: tuple[UnreadableSpan, ...]
    start_ns: int | None
    end_ns: int | None

    @property
    def seconds(self) -> float:
        """From the first message to the last."""
        return 0.0 if self.start_ns is None or self.end_ns is None else (self.end_ns - self.start_ns) / 1e9

    def tools_of(self, topic: str, tools: tuple[BagTool, ...]) -> tuple[BagTool, ...]:
        """Those tools that read a topic: evo makes trajectories of some types only."""
        types = {source.msgtype for source in self.connections.values() if source.topic == topic}
        return tools if types.intersection(EVO_TYPES) else tuple(tool for tool in tools if tool is not BagTool.EVO)

    def connections_by_topic(self) -> dict[str, list[ConnectionRecord]]:
        """The connections of each topic that have messages."""
        topics: dict[str, list[ConnectionRecord]] = {}
        for source in self.connections.values():
            if self.counts.get(source.number):
                topics.setdefault(source.topic, []).append(source)
        return topics


@dataclass(frozen=True, slots=True)
class CheckedMessage:
    """One message.

    Attributes:
        stamp_ns: when it was recorded.
        reading: what is in it; empty when it or its definition cannot be read.
        fault: why its bytes are no message of its type, as a clause; None when they are, or nobody knows.
    """

    stamp_ns: int
    reading: Reading
    fault: str | None = None


MessageHandler = Callable[[CheckedMessage], None]

StructureRule = Callable[[BagStructure], Iterator[Finding]]
"""A rule that needs no message."""


class MessageRule(Protocol):
    """A rule that listens to messages; made anew for each bag."""

    def listen(self, source: ConnectionRecord) -> MessageHandler | None:
        """What shall hear each message of a connection; None to leave it out."""
        ...

    def findings(self, bag: BagStructure) -> Iterator[Finding]:
        """What was found, once everything was heard."""
        ...


class OccurrenceCounter(Generic[K]):
    """Counts what happens and remembers when it first did."""

    def __init__(self) -> None:
        self._seen: dict[K, tuple[int, int]] = {}

    def add(self, key: K, stamp_ns: int) -> None:
        """It happened in a message of that stamp."""
        first, count = self._seen.get(key, (stamp_ns, 0))
        self._seen[key] = (first, count + 1)

    def items(self) -> Iterator[tuple[K, int, int]]:
        """Each thing, the stamp of its first message, and how often."""
        for key, (first, count) in self._seen.items():
            yield key, first, count
