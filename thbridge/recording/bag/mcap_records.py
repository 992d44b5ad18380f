"""The records of MCAP files, as bytes (mcap.dev/spec), with the profile `ros2` as rosbag2 writes it.

Channels have rosbag2's metadata `offered_qos_profiles` and `topic_type_hash`. As in rosbag2's files, schemas and
channels are in the chunk of their first message. So the checksums of the chunk protect them, too.
"""

import zlib
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from struct import Struct

import zstandard

from thbridge.recording.bag.checksums import block_checksums
from thbridge.recording.bag.options import Compression
from thbridge.recording.bag.records import BagConnection, lz4_frame

MAGIC = b"\x89MCAP0\r\n"
LIBRARY = "thbridge"

HEADER, FOOTER, SCHEMA, CHANNEL, MESSAGE, CHUNK, MESSAGE_INDEX, CHUNK_INDEX = 1, 2, 3, 4, 5, 6, 7, 8
ATTACHMENT, STATISTICS, METADATA, METADATA_INDEX, SUMMARY_OFFSET, DATA_END = 9, 11, 12, 13, 14, 15
"""Opcodes of the records that we write or read."""
CHECKSUMS = 0x81
"""Opcode of our own record before each chunk, with the `block_checksums` of its packed data.

MCAP reserves the opcodes from 0x80 for applications, and other readers skip them. The chunk's own checksum is for all
its messages, so it cannot check a part of the chunk."""

U16, U32, U64 = Struct("<H"), Struct("<I"), Struct("<Q")
HEAD = Struct("<BQ")
"""Beginning of every record: opcode, and number of bytes that follow."""
MESSAGE_HEAD = Struct("<BQHIQQ")
"""Beginning of a message record: the head, channel, sequence number, time of recording, time of publication."""
CHUNK_TIMES = Struct("<QQQI")
"""Beginning of a chunk's content: first and last time, size of the unpacked messages, and their CRC-32."""
INDEX_ENTRY_BYTES = 16
"""Size of a message in a message index: time of recording and offset."""
MOST_CHANNELS = 65535
"""Largest number of channels, which are counted from 1."""
_STATISTICS = Struct("<QHIIIIQQ")
_ZSTD_LEVEL = 3
"""zstd's default level. It packs about three times as fast as level 6, which saves 3 %."""

LATCHED_QOS = """\
- history: keep_last
  depth: 1
  reliability: reliable
  durability: transient_local
  deadline:
    sec: 9223372036
    nsec: 854775807
  lifespan:
    sec: 9223372036
    nsec: 854775807
  liveliness: automatic
  liveliness_lease_duration:
    sec: 9223372036
    nsec: 854775807
  avoid_ros_namespace_conventions: false"""
"""Quality of service of a latched topic, as rosbag2 writes it since version 9 of its metadata."""
QOS = LATCHED_QOS.replace("depth: 1", "depth: 10").replace("transient_local", "volatile")
"""Quality of service of all other topics: the default of ROS 2."""


@dataclass(frozen=True, slots=True)
class PackedChunk:
    """Chunk in a file, with the facts for its index record.

    Attributes:
        data: the checksums, the chunk record, and its message indexes.
        index: its record in the index at the end of the file.
    """

    data: bytes
    index: bytes


def record(opcode: int, content: bytes) -> bytes:
    """Return a record."""
    return HEAD.pack(opcode, len(content)) + content


def header() -> bytes:
    """Return the first bytes of a file."""
    return MAGIC + record(HEADER, _text("ros2") + _text(LIBRARY))


def connection_records(new: Sequence[BagConnection], known: Iterable[BagConnection]) -> bytes:
    """Return the schemas and channels of connections that are new to a file.

    Args:
        new: the connections.
        known: the connections of the file so far. Schemas are numbered in the order of all connections, from 1.
    """
    schemas = {key: number for number, key in enumerate(dict.fromkeys(map(_schema_key, known)), 1)}
    records = []
    for connection in new:
        key = _schema_key(connection)
        if key not in schemas:
            schemas[key] = len(schemas) + 1
            name, definition = key
            content = U16.pack(schemas[key]) + _text(name) + _text("ros2msg") + _text(definition)
            records.append(record(SCHEMA, content))
        records.append(record(CHANNEL, _channel(connection, schemas[key])))
    return b"".join(records)


def qos_of(connection: BagConnection) -> str:
    """Return the quality of service that a publisher offers, in YAML."""
    return LATCHED_QOS if connection.latching else QOS


def packed_chunk(
    position: int,
    data: bytes,
    times: tuple[int, int],
    entries: Mapping[int, bytes],
    compression: Compression,
) -> PackedChunk:
    """Return a chunk of messages.

    Args:
        position: offset in the file of the result.
        data: the schema, channel and message records.
        times: first and last time of the messages, nanoseconds.
        entries: content of the message index of each channel.
        compression: compression of the messages.
    """
    name = "" if compression is Compression.NONE else str(compression)
    packed = packed_bytes(data, compression)
    content = CHUNK_TIMES.pack(*times, len(data), zlib.crc32(data)) + _text(name) + U64.pack(len(packed))
    head = HEAD.pack(CHUNK, len(content) + len(packed)) + content
    checksums = record(CHECKSUMS, block_checksums(packed))
    position += len(checksums)
    indexes, offsets = [], []
    length = len(head) + len(packed)
    at = position + length
    for channel, entry in entries.items():
        offsets.append(U16.pack(channel) + U64.pack(at))
        indexes.append(record(MESSAGE_INDEX, U16.pack(channel) + _sized(entry)))
        at += len(indexes[-1])
    index = (
        Struct("<QQQQ").pack(*times, position, length)
        + _sized(b"".join(offsets))
        + U64.pack(at - position - length)
        + _text(name)
        + Struct("<QQ").pack(len(packed), len(data))
    )
    return PackedChunk(b"".join((checksums, head, packed, *indexes)), record(CHUNK_INDEX, index))


def packed_bytes(data: bytes, compression: Compression) -> bytes:
    """Return the packed messages of a chunk. Raises KeyError: MCAP has no such compression."""
    match compression:
        case Compression.NONE:
            return data
        case Compression.LZ4:
            return lz4_frame(data)
        case Compression.ZSTD:
            return zstandard.ZstdCompressor(level=_ZSTD_LEVEL).compress(data)
    raise KeyError(compression)


def end(
    position: int,
    connections: Sequence[BagConnection],
    chunks: Sequence[bytes],
    counts: Mapping[BagConnection, int],
    times: tuple[int, int],
) -> bytes:
    """Return everything after the last chunk: the end of the data, the index, and the footer.

    Args:
        position: offset of the result in the file.
        connections: all connections, in the order in which their records were written.
        chunks: chunk index records.
        counts: number of messages of each connection.
        times: first and last time of all messages, nanoseconds.
    """
    data_end = record(DATA_END, U32.pack(0))
    start = position + len(data_end)
    described = connection_records(connections, ())
    schemas = len(dict.fromkeys(map(_schema_key, connections)))
    per_channel = b"".join(U16.pack(each.number) + U64.pack(counts[each]) for each in connections)
    total = _STATISTICS.pack(sum(counts.values()), schemas, len(connections), 0, 0, len(chunks), *times)
    # Without groups of schemas and channels, readers of groups read the whole summary.
    summary = b"".join((described, *chunks, record(STATISTICS, total + _sized(per_channel))))
    content = U64.pack(start) + U64.pack(0)
    crc = zlib.crc32(summary + HEAD.pack(FOOTER, len(content) + U32.size) + content)
    return data_end + summary + record(FOOTER, content + U32.pack(crc)) + MAGIC


END_BYTES = 256
"""Largest size of `end` without connections and chunks."""

TAIL = record(DATA_END, U32.pack(0)) + record(FOOTER, bytes(20)) + MAGIC
"""End of a file without an index. With it, readers can read a file that is still being written."""


def _channel(connection: BagConnection, schema: int) -> bytes:
    metadata = {
        "offered_qos_profiles": qos_of(connection),
        "topic_type_hash": connection.md5,
    }
    if connection.caller is not None:
        metadata["callerid"] = connection.caller
    pairs = b"".join(_text(name) + _text(value) for name, value in metadata.items())
    numbers = U16.pack(connection.number) + U16.pack(schema)
    return numbers + _text(connection.topic) + _text("cdr") + _sized(pairs)


def _schema_key(connection: BagConnection) -> tuple[str, str]:
    return connection.msgtype, connection.definition


def _text(text: str) -> bytes:
    return _sized(text.encode())


def _sized(data: bytes) -> bytes:
    return U32.pack(len(data)) + data
