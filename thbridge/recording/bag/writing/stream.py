"""Messages as a stream in the format of bags, for several readers: each gets its own chunks of the same records."""

from collections import defaultdict
from collections.abc import Sequence

from thbridge.files.ros.definitions import Definitions
from thbridge.recording.bag.options import Compression
from thbridge.recording.bag.records import (
    MAGIC,
    U32,
    BagConnection,
    bag_header,
    chunk_record,
    connection_record,
    index_record,
    message_head,
    time_bytes,
    time_in,
)
from thbridge.ros.names import CALLER
from thbridge.ros.topics import RosMessage, Topic

BEGINNING = MAGIC + bag_header(0, 0, 0)
"""The first bytes for every reader."""


class BagStream:
    """Maker of the message records, which are the same for all readers.

    Args:
        definitions: definitions of message types.

    Attributes:
        connections: the connections by number, in the order of their topics' first messages.
    """

    def __init__(self, definitions: Definitions) -> None:
        self.connections: list[BagConnection] = []
        self._definitions = definitions
        self._of_topic: dict[Topic, tuple[BagConnection, bytes]] = {}
        self._stamp_ns = -1
        self._time = b""

    def record(self, message: RosMessage) -> tuple[BagConnection, bytes]:
        """Return the connection and the record of a message."""
        topic, stamp_ns, data, _ = message
        connection, head = self._of_topic.get(topic) or self._connect(topic)
        if stamp_ns != self._stamp_ns:
            self._stamp_ns, self._time = stamp_ns, time_bytes(stamp_ns)
        return connection, b"".join((head, self._time, U32.pack(len(data)), data))

    def _connect(self, topic: Topic) -> tuple[BagConnection, bytes]:
        definition = self._definitions.of(topic.msgtype)
        number = len(self.connections)
        connection = BagConnection(
            number, topic.name, topic.msgtype, definition.md5, definition.text, CALLER, topic.latched
        )
        self.connections.append(connection)
        self._of_topic[topic] = connection, message_head(number)
        return self._of_topic[topic]


class ChunkMaker:
    """Maker of the chunks of one reader, which remembers the connections that the reader already has.

    Args:
        stream: the stream that it reads.
    """

    def __init__(self, stream: BagStream) -> None:
        self._stream = stream
        self._announced: set[int] = set()

    def chunk(self, records: Sequence[tuple[int, bytes]]) -> bytes:
        """Return a chunk of message records, given with their connection numbers.

        New connections are added before their messages. Index data follow the chunk, because rosbag's `reindex` needs a
        record after every chunk.
        """
        connections = self._stream.connections
        pieces: list[bytes] = []
        entries: defaultdict[int, list[bytes]] = defaultdict(list)
        at = 0
        for number, record in records:
            if number not in self._announced:
                self._announced.add(number)
                pieces.append(connection_record(connections[number]))
                at += len(pieces[-1])
            entries[number] += (time_in(record), U32.pack(at))
            pieces.append(record)
            at += len(record)
        indices = [index_record(connections[number], b"".join(entry)) for number, entry in entries.items()]
        return b"".join((chunk_record(b"".join(pieces), Compression.NONE), *indices))
