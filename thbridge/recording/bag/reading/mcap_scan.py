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
from thbridge.recording.bag.mcap_records import (
    CHANNEL,
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


def scan_mcap(path: Path) -> Iterator[McapRecord]:
    """Yield the connections, chunks and messages in the file's order; damaged bytes become an `UnreadableSpan`.

    The readable part of a chunk that is cut off is yielded. Of a compressed chunk with a wrong checksum, nothing is.

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
    schemas: dict[int, Schema] = {}
    known: set[int] = set()
    so_far = UnpackedBytes(end)
    at = file.tell()
    while at < end:
        head = file.read(HEAD.size)
        if len(head) < HEAD.size:
            yield UnreadableSpan(at, end - at, "the file ends in the middle of a record")
            return
        opcode, size = HEAD.unpack(head)
        if opcode == DATA_END:
            return
        if opcode not in {SCHEMA, CHANNEL, CHUNK, MESSAGE_INDEX}:
            yield UnreadableSpan(at, end - at, f"{opcode} is not a kind of record")
            return
        content, at_end = file.read(min(size, end)), at + HEAD.size + size
        try:
            if opcode == CHUNK:
                yield from _chunk(at, content, size, known, so_far)
            elif at_end > end:
                raise _Torn(f"the file ends {at_end - end} bytes too early")
            elif opcode == SCHEMA:
                schema = Schema.read(_stream(content))
                schemas[schema.id] = schema
            elif opcode == CHANNEL:
                channel = Channel.read(_stream(content))
                yield _connection(channel, schemas)
                known.add(channel.id)
        except (_Torn, McapError, struct.error, ValueError, LookupError, OSError, RuntimeError, EOFError) as torn:
            yield UnreadableSpan(at, min(at_end, end) - at, str(torn) or "a record cannot be read")
        at = file.seek(at_end)


def _chunk(at: int, content: bytes, size: int, known: set[int], so_far: UnpackedBytes) -> Iterator[McapRecord]:
    _, _, length, crc = CHUNK_TIMES.unpack_from(content)
    name, packed, begin = _text(content, CHUNK_TIMES.size)
    (packed_size,) = U64.unpack_from(packed, begin)
    packed = packed[begin + U64.size :]
    compression = Compression(name) if name else Compression.NONE
    yield ChunkRecord(at, compression, packed_size, length, None)
    data = unpacked_zstd(packed, length) if compression is Compression.ZSTD else unpacked(compression, packed, length)
    so_far.add(len(data))
    is_wrong = len(content) == size and len(data) == length and zlib.crc32(data) != crc
    if is_wrong and compression is not Compression.NONE:
        raise _Torn("the checksum of a chunk is wrong")
    place, last, waiting = 0, 0, None
    while place + MESSAGE_HEAD.size <= len(data):
        opcode, message_size, channel, _, stamp_ns, _ = MESSAGE_HEAD.unpack_from(data, place)
        after = place + HEAD.size + message_size
        if opcode != MESSAGE or channel not in known or after > len(data) or after < place + MESSAGE_HEAD.size:
            break
        if waiting is not None:
            yield waiting
        waiting = MessageRecord(channel, stamp_ns, data[place + MESSAGE_HEAD.size : after])
        last, place = place, after
    if is_wrong:
        place = last  # After a power failure, the last message before lost bytes may be partly lost, too.
    elif waiting is not None:
        yield waiting
    if place < length:
        lost = (len(data) if compression is Compression.NONE else length) - place
        missing = size - len(content)
        problem = "a chunk ends in the middle of a record, or its checksum is wrong"
        if missing > 0:
            problem = f"the file ends {missing} bytes too early"
        yield UnreadableSpan(at, lost, problem)


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
