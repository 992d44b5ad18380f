"""Reader of all records of an MCAP file by thbridge from beginning to end, without its index.

The reader reports unreadable bytes.
"""

import struct
import zlib
from collections.abc import Iterator
from io import SEEK_END, BytesIO
from pathlib import Path
from typing import BinaryIO

from mcap.data_stream import ReadDataStream
from mcap.exceptions import McapError
from mcap.records import Channel, Schema

from thbridge.files.disk.regular_files import open_regular
from thbridge.files.errors import BadFile
from thbridge.recording.bag.checksums import intact_bytes
from thbridge.recording.bag.mcap_records import (
    CHANNEL,
    CHECKSUMS,
    CHUNK,
    CHUNK_TIMES,
    DATA_END,
    HEAD,
    HEADER,
    LATCHED_QOS,
    LIBRARY,
    MAGIC,
    MESSAGE,
    MESSAGE_HEAD,
    MESSAGE_INDEX,
    SCHEMA,
    U32,
    U64,
)
from thbridge.recording.bag.options import Compression
from thbridge.recording.bag.reading.scan import ChunkRecord, ConnectionRecord, MessageRecord, UnreadableSpan
from thbridge.recording.bag.unpacking import UnpackedBytes, unpacked, unpacked_zstd

McapRecord = ConnectionRecord | ChunkRecord | MessageRecord | UnreadableSpan


class _Torn(Exception):  # noqa: N818 - not an error of the program
    """The file cannot be read at this point."""


_TORN = (_Torn, McapError, struct.error, ValueError, LookupError, OSError, RuntimeError, EOFError)
"""Errors of damaged records."""


def scan_mcap(path: Path) -> Iterator[McapRecord]:
    """Yield the connections, chunks and messages in the file's order; damaged bytes become an `UnreadableSpan`.

    Messages are yielded only from the blocks of a chunk before the first block with a wrong checksum. Older recordings
    have no checksums of blocks: if the checksum of such a chunk is wrong, none of its messages is yielded.

    Raises:
        BadFile: the file does not exist, or thbridge did not record it.
    """
    try:
        file = open_regular(path)
    except OSError as error:
        problem = (error.strerror or str(error)).lower()
        raise BadFile(path, problem, "name a recording that can be read") from error
    with file:
        end = file.seek(0, SEEK_END)
        file.seek(0)
        _check_header(path, file, end)
        yield from _records(file, end)


def _check_header(path: Path, file: BinaryIO, end: int) -> None:
    """Read the first record. Raise BadFile if thbridge did not write it."""
    try:
        if file.read(len(MAGIC)) != MAGIC:
            raise _Torn
        opcode, size = HEAD.unpack(file.read(HEAD.size))
        content = file.read(min(size, end))
        if opcode != HEADER or _text(*_text(content, 0)[1:])[0] != LIBRARY:
            raise _Torn
    except (_Torn, struct.error):
        problem = "thbridge did not record this MCAP file"
        raise BadFile(path, problem, "repair it with `mcap recover` or `ros2 bag reindex`") from None


def _records(file: BinaryIO, end: int) -> Iterator[McapRecord]:
    connections = _Connections()
    so_far = UnpackedBytes(end)
    checksums: bytes | None = None
    at = file.tell()
    while at < end:
        head = file.read(HEAD.size)
        if len(head) < HEAD.size:
            yield UnreadableSpan(at, end - at, "the file ends in the middle of a record")
            return
        opcode, size = HEAD.unpack(head)
        if opcode == DATA_END:
            return
        if opcode not in {SCHEMA, CHANNEL, CHECKSUMS, CHUNK, MESSAGE_INDEX}:
            yield UnreadableSpan(at, end - at, f"{opcode} is not a kind of record")
            return
        content, at_end = file.read(min(size, end)), at + HEAD.size + size
        try:
            if opcode == CHUNK:
                yield from _chunk(at, content, size, checksums, connections, so_far)
            elif at_end > end:
                raise _Torn(f"the file ends {at_end - end} bytes too early")
            elif (connection := connections.read(opcode, content)) is not None:
                yield connection
            checksums = content if opcode == CHECKSUMS else None
        except _TORN as torn:
            yield UnreadableSpan(at, min(at_end, end) - at, str(torn) or "a record cannot be read")
        if at_end > end:
            return
        at = file.seek(at_end)


class _Connections:
    """Connections of a file, from the records of its schemas and channels."""

    def __init__(self) -> None:
        self._schemas: dict[int, Schema] = {}
        self._known: set[int] = set()

    def __contains__(self, number: int) -> bool:
        return number in self._known

    def read(self, opcode: int, content: bytes) -> ConnectionRecord | None:
        """Return the connection of a channel; return None for other records."""
        if opcode == SCHEMA:
            schema = Schema.read(_stream(content))
            self._schemas[schema.id] = schema
        if opcode != CHANNEL:
            return None
        channel = Channel.read(_stream(content))
        connection = _connection(channel, self._schemas)
        self._known.add(channel.id)
        return connection


def _chunk(
    at: int, content: bytes, size: int, checksums: bytes | None, connections: _Connections, so_far: UnpackedBytes
) -> Iterator[McapRecord]:
    _, _, length, crc = CHUNK_TIMES.unpack_from(content)
    name, _, begin = _text(content, CHUNK_TIMES.size)
    (packed_size,) = U64.unpack_from(content, begin)
    packed = content[begin + U64.size :]
    compression = Compression(name) if name else Compression.NONE
    whole = len(packed) if compression is Compression.NONE else length
    yield ChunkRecord(at, compression, packed_size, length, None)
    if checksums is not None:
        packed = packed[: intact_bytes(packed, packed_size, checksums)]
    data = unpacked_zstd(packed, length) if compression is Compression.ZSTD else unpacked(compression, packed, length)
    so_far.add(len(data))
    if checksums is None and len(data) == length and zlib.crc32(data) != crc:
        raise _Torn("the checksum of a chunk is wrong")
    place = 0
    while place + HEAD.size <= len(data):
        opcode, record_size = HEAD.unpack_from(data, place)
        after = place + HEAD.size + record_size
        if after > len(data):
            break
        if opcode != MESSAGE:
            connection = connections.read(opcode, data[place + HEAD.size : after])
            if connection is not None:
                yield connection
        else:
            _, _, channel, _, stamp_ns, _ = MESSAGE_HEAD.unpack_from(data, place)
            if channel not in connections or after < place + MESSAGE_HEAD.size:
                break
            yield MessageRecord(channel, stamp_ns, data[place + MESSAGE_HEAD.size : after])
        place = after
    if place < whole:
        missing = size - len(content)
        problem = "the checksum of a chunk is wrong, or a record in it cannot be read"
        if missing > 0:
            problem = f"the file ends {missing} bytes too early"
        yield UnreadableSpan(at, whole - place, problem)


def _connection(channel: Channel, schemas: dict[int, Schema]) -> ConnectionRecord:
    schema, metadata = schemas[channel.schema_id], channel.metadata
    return ConnectionRecord(
        channel.id,
        channel.topic,
        schema.name,
        metadata.get("topic_type_hash", ""),
        schema.data.decode(),
        metadata.get("callerid"),
        str(int(metadata.get("offered_qos_profiles") == LATCHED_QOS)),
    )


def _stream(content: bytes) -> ReadDataStream:
    return ReadDataStream(BytesIO(content))


def _text(content: bytes, at: int) -> tuple[str, bytes, int]:
    """Return a text, the content, and the position after the text."""
    (size,) = U32.unpack_from(content, at)
    end = at + U32.size + size
    if end > len(content):
        raise _Torn("a record ends too early")
    return content[at + U32.size : end].decode(errors="replace"), content, end
