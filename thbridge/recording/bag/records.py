"""The records of ROS 1's bag format 2.0, as bytes (wiki.ros.org/Bags/Format/2.0).

This module differs from rosbags' writer in two points on which ROS 1's own tools depend. The first record is padded as
in ROS, and LZ4 frames have the only format that roslz4 can read.
"""

import bz2
from collections.abc import Mapping
from dataclasses import dataclass
from functools import lru_cache
from struct import Struct

import lz4.frame
from rosbags.rosbag1.reader import RecordType

from thbridge.recording.bag.checksums import block_checksums
from thbridge.recording.bag.options import Compression
from thbridge.ros.messages.identification import DefinitionSource

MAGIC = b"#ROSBAG V2.0\n"
HEADER_BYTES = 4096
"""Size of the first record: its header and padding, without its two length words. rosbags includes these words; ROS 1
does not. ROS 1's `reindex` overwrites exactly the number of bytes that ROS 1 writes."""

U32 = Struct("<I")
_U64 = Struct("<Q")
_TIME = Struct("<II")
_BZ2_LEVEL = 9
_LZ4_LEVEL = 0
"""Level of ROS's own recorder. From level 3 on, LZ4 searches longer: recordings are at least a tenth smaller, but need
four times the processor time."""


@dataclass(frozen=True, slots=True, eq=False)
class BagConnection:
    """One connection of a bag: a publisher of a topic. Two connections are equal only if they are the same object.

    Attributes:
        number: number of the connection in the bag.
        topic: name of the topic.
        msgtype: for example "nav_msgs/Odometry".
        md5: md5 sum of the type.
        definition: definition of the type, with the definitions of the types in it.
        caller: name of the publishing node; None if unknown.
        latching: True if late subscribers get the last message; None if unknown.
        source: origin of the definition.
    """

    number: int
    topic: str
    msgtype: str
    md5: str
    definition: str
    caller: str | None
    latching: bool | None
    source: DefinitionSource = DefinitionSource.BAG


def time_bytes(stamp_ns: int) -> bytes:
    """Return a stamp in the format of records: seconds and nanoseconds."""
    return _TIME.pack(*divmod(stamp_ns, 1_000_000_000))


def bag_header(index_pos: int, connections: int, chunks: int) -> bytes:
    """Return the first record, which always has the same length. Its numbers are 0 while the bag is being written."""
    header = _header(
        RecordType.BAGHEADER,
        index_pos=_U64.pack(index_pos),
        conn_count=U32.pack(connections),
        chunk_count=U32.pack(chunks),
    )
    return header + _sized(b" " * (HEADER_BYTES - len(header) + 4))


def connection_record(connection: BagConnection) -> bytes:
    """Return a connection record."""
    values = {
        "topic": connection.topic,
        "type": connection.msgtype,
        "md5sum": connection.md5,
        "message_definition": connection.definition,
    }
    if connection.caller is not None:
        values["callerid"] = connection.caller
    if connection.latching is not None:
        values["latching"] = str(int(connection.latching))
    fields = {name: value.encode() for name, value in values.items()}
    head = _header(RecordType.CONNECTION, conn=U32.pack(connection.number), topic=fields["topic"])
    return head + _fields(fields)


def message_head(connection: int) -> bytes:
    """Return the beginning of a message record; `time_bytes`, the message's length (`U32`) and the message follow."""
    fields = (b"op=" + bytes((RecordType.MSGDATA,)), b"conn=" + U32.pack(connection))
    head = b"".join(map(_sized, fields)) + U32.pack(len(b"time=") + _TIME.size) + b"time="
    return U32.pack(len(head) + _TIME.size) + head


def time_in(record: bytes) -> bytes:
    """Return the `time_bytes` of a message record."""
    (head,) = U32.unpack_from(record)
    return record[U32.size + head - _TIME.size : U32.size + head]


def chunk_record(data: bytes, compression: Compression) -> bytes:
    """Return a chunk record that contains message and connection records."""
    return b"".join(chunk_pieces(data, compression))


def chunk_pieces(data: bytes, compression: Compression) -> tuple[bytes, bytes]:
    """Return a `chunk_record` in two pieces. A caller that joins it to other records then copies the data only once.

    The field `crc32` of its header has the `block_checksums`. Readers of ROS ignore fields that they do not know.
    """
    packed = _packed(data, compression)
    header = _header(
        RecordType.CHUNK,
        compression=compression.encode(),
        size=U32.pack(len(data)),
        crc32=block_checksums(packed),
    )
    return header + U32.pack(len(packed)), packed


def index_record(connection: BagConnection, entries: bytes) -> bytes:
    """Return an index data record for the chunk before it: stamp and offset (4 bytes) of a connection's messages."""
    return _index_head(connection.number, len(entries)) + entries


INDEX_ENTRY_BYTES = _TIME.size + U32.size


@lru_cache(maxsize=4096)
def _index_head(number: int, size: int) -> bytes:
    """Return an index data record up to its entries; `size` is their length in bytes."""
    count = size // INDEX_ENTRY_BYTES
    header = _header(RecordType.IDXDATA, ver=U32.pack(1), conn=U32.pack(number), count=U32.pack(count))
    return header + U32.pack(size)


def chunk_info_record(position: int, start_ns: int, end_ns: int, counts: Mapping[BagConnection, int]) -> bytes:
    """Return a chunk info record: position, first and last stamp, and number of messages by connection."""
    head = _header(
        RecordType.CHUNK_INFO,
        ver=U32.pack(1),
        chunk_pos=_U64.pack(position),
        start_time=time_bytes(start_ns),
        end_time=time_bytes(end_ns),
        count=U32.pack(len(counts)),
    )
    return head + _sized(b"".join(U32.pack(who.number) + U32.pack(count) for who, count in counts.items()))


def _packed(data: bytes, compression: Compression) -> bytes:
    match compression:
        case Compression.NONE:
            return data
        case Compression.LZ4:
            return lz4_frame(data)
        case Compression.BZ2:
            return bz2.compress(data, _BZ2_LEVEL)
    raise KeyError(compression)


def lz4_frame(data: bytes) -> bytes:
    """Return the data as an LZ4 frame that roslz4 can read."""
    # The only frames that roslz4 accepts: independent blocks, no content size, with a checksum of the content.
    packed: bytes = lz4.frame.compress(
        data,
        compression_level=_LZ4_LEVEL,
        block_size=lz4.frame.BLOCKSIZE_MAX256KB,  # A chunk that was cut off is recovered up to a block.
        block_linked=False,
        store_size=False,
        content_checksum=True,
    )
    return packed


def _header(kind: RecordType, **fields: bytes) -> bytes:
    return _fields({"op": bytes((kind,)), **fields})


def _fields(fields: Mapping[str, bytes]) -> bytes:
    return _sized(b"".join(_sized(name.encode() + b"=" + value) for name, value in fields.items()))


def _sized(data: bytes) -> bytes:
    return U32.pack(len(data)) + data
