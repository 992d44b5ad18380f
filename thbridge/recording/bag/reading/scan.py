"""Reader of all records of a ROS 1 bag from beginning to end, without its index. The reader reports unreadable bytes.

Source: the bag format 2.0 of ROS 1 (rosbag, bag.py and bag.cpp).
"""

import struct
from collections.abc import Iterator
from dataclasses import dataclass
from io import SEEK_END
from pathlib import Path
from struct import Struct
from typing import BinaryIO

from rosbags.rosbag1.reader import RecordType

from thbridge.recording.bag.checksums import intact_bytes
from thbridge.recording.bag.damage import MAGIC, VERSION, check_is_bag
from thbridge.recording.bag.ros2 import as_ros1
from thbridge.recording.bag.unpacking import UnpackedBytes, unpacked

_UINT32 = Struct("<I")
_UINT64 = Struct("<Q")
_TIME = Struct("<II")
_PAIR = Struct("<II")
_LZ4_FLAGS = 4
"""Offset of the byte FLG in an LZ4 frame, after the magic number."""
_MESSAGE_HEADER = 38
"""Length of the usual header of a message record: the fields op, conn and time, each preceded by its length."""
_INDEX_HEADER = 51
"""Length of the header of an index data record, with the length before it."""
_OP_CONN_TIME = Struct("<II3sBI5sII5sII")
_CONN_OP_TIME = Struct("<II5sII3sBI5sII")
"""The first form has the field order of rosbags, the second form that of ROS 1. Other headers are read field by
field."""


@dataclass(frozen=True, slots=True)
class BagHeaderRecord:
    """The first record of a bag.

    Attributes:
        index_pos: offset of the index; 0 if there is none yet.
        connections: number of connections in the index.
        chunks: number of chunks in the index.
        length: bytes of header and padding, without the two length words; in ROS 1 always 4096.
        encryptor: name of the encryption; empty if the bag is not encrypted.
    """

    index_pos: int
    connections: int
    chunks: int
    length: int
    encryptor: str


@dataclass(frozen=True, slots=True)
class ConnectionRecord:
    """A connection record: one publisher of one topic.

    Attributes:
        number: number of the connection in message records.
        topic: name of the topic.
        msgtype: for example "nav_msgs/Odometry".
        md5: md5 sum of the type.
        definition: definition of the type and of all types in it.
        caller: name of the node, or None if the name was not recorded.
        latching: the text in the file, normally "0" or "1"; None if this field was not recorded.
        lacks: required fields that are missing; these fields are empty here.
    """

    number: int
    topic: str
    msgtype: str
    md5: str
    definition: str
    caller: str | None
    latching: str | None
    lacks: tuple[str, ...] = ()

    @property
    def latched(self) -> bool:
        """True if `rosbag play` latches the connection."""
        return self.latching == "1"


@dataclass(frozen=True, slots=True)
class ChunkRecord:
    """A chunk record; the connections and messages in the chunk follow as separate records.

    Attributes:
        position: offset of the record in the file.
        compression: name of the compression.
        size: size of the packed data in the file, bytes.
        unpacked: size of the unpacked data, bytes.
        lz4_flags: the byte FLG of an LZ4 frame; None for other compressions.
    """

    position: int
    compression: str
    size: int
    unpacked: int
    lz4_flags: int | None


@dataclass(frozen=True, slots=True)
class MessageRecord:
    """A message record.

    Attributes:
        number: number of its connection.
        stamp_ns: stamp of recording.
        data: bytes of the message.
    """

    number: int
    stamp_ns: int
    data: bytes


@dataclass(frozen=True, slots=True)
class ChunkInfoRecord:
    """A chunk info record of the index: position, first and last stamp, number of messages by connection."""

    position: int
    start_ns: int
    end_ns: int
    counts: dict[int, int]


@dataclass(frozen=True, slots=True)
class IndexDataRecord:
    """An index data record, which follows its chunk: the messages of one connection in the chunk.

    Attributes:
        number: number of the connection.
        count: number of messages.
    """

    number: int
    count: int


@dataclass(frozen=True, slots=True)
class UnreadableSpan:
    """Bytes that cannot be read.

    Attributes:
        position: offset in the file; for bytes inside a chunk, the offset of the chunk.
        lost: number of bytes, compressed or uncompressed.
        problem: the problem as a clause.
    """

    position: int
    lost: int
    problem: str


BagRecord = (
    BagHeaderRecord
    | ConnectionRecord
    | ChunkRecord
    | MessageRecord
    | IndexDataRecord
    | ChunkInfoRecord
    | UnreadableSpan
)


class _Torn(Exception):  # noqa: N818 - not an error of the program
    """The file cannot be read at this point."""


def scan(path: Path) -> Iterator[BagRecord]:
    """Yield every record in the file's order; damaged bytes become an `UnreadableSpan`.

    The readable part of a chunk that is cut off or damaged is yielded. After an invalid record the scan continues with
    the next record, also inside chunks, unless the lengths of the record are invalid. Messages are yielded only from
    the blocks of a chunk before the first block with a wrong checksum. Bags of other programs have no checksums: from
    these, a message is not yielded if unreadable bytes follow it, because its end may be lost, too.

    Raises:
        BadFile: the file does not exist, or does not begin like a bag.
    """
    path = as_ros1(path)
    check_is_bag(path)
    with path.open("rb") as file:
        end = file.seek(0, SEEK_END)
        so_far = UnpackedBytes(end)
        at = file.seek(len(MAGIC + VERSION))
        while at < end:
            try:
                fields = _fields(_read(file, end))
                kind = _kind(fields)
                size = _uint32(_exactly(file, 4, end))
            except (_Torn, OSError) as torn:
                yield UnreadableSpan(at, end - at, str(torn))
                return
            left = end - file.tell()
            after = file.tell() + size
            if size > left:
                yield from _cut_off(at, kind, fields, file.read(left), size, so_far)
                return
            try:
                data = file.read(size)
                yield from _outer(at, kind, fields, data, size, so_far, is_followed=_is_followed(file, end))
            except (_Torn, OSError) as torn:
                yield UnreadableSpan(at, after - at, str(torn))
            at = file.seek(after)


def _is_followed(file: BinaryIO, end: int) -> bool:
    """Return True if a record begins here, or the file ends here or in the first bytes of a record."""
    left = end - file.tell()
    try:
        if left < _INDEX_HEADER:
            return left < _UINT32.size or _uint32(file.read(_UINT32.size)) > 0
        return _kind(_fields(_read(file, end))) in set(RecordType)
    except (_Torn, OSError):
        return False


def _cut_off(
    at: int, kind: int, fields: dict[bytes, bytes], data: bytes, size: int, so_far: UnpackedBytes
) -> Iterator[BagRecord]:
    """Yield the last, incomplete record of a file: the readable part of a chunk, or nothing."""
    lost = len(data)
    if kind == RecordType.CHUNK:
        lost = 0
        try:
            for record in _outer(at, kind, fields, data, size, so_far, is_cut=True):
                if isinstance(record, UnreadableSpan):
                    lost += record.lost
                else:
                    yield record
        except _Torn:
            lost = len(data)
    yield UnreadableSpan(at, lost, f"the file ends {size - len(data)} bytes too early")


def _outer(
    at: int,
    kind: int,
    fields: dict[bytes, bytes],
    data: bytes,
    length: int,
    so_far: UnpackedBytes,
    *,
    is_cut: bool = False,
    is_followed: bool = True,
) -> Iterator[BagRecord]:
    match kind:
        case RecordType.BAGHEADER:
            encryptor = fields.get(b"encryptor", b"").decode(errors="replace")
            # Before each field is its length (4 bytes). Each field contains a "=".
            length = sum(len(name) + len(value) + 5 for name, value in fields.items()) + len(data)
            yield BagHeaderRecord(
                _unpack(_UINT64, fields, b"index_pos"),
                _unpack(_UINT32, fields, b"conn_count"),
                _unpack(_UINT32, fields, b"chunk_count"),
                length,
                encryptor,
            )
        case RecordType.CHUNK:
            compression = _word(fields, b"compression")
            size = _unpack(_UINT32, fields, b"size")
            flags = data[_LZ4_FLAGS] if compression == "lz4" and len(data) > _LZ4_FLAGS else None
            yield ChunkRecord(at, compression, len(data), size, flags)
            checksums = fields.get(b"crc32")
            intact = len(data) if checksums is None else intact_bytes(data, length, checksums)
            is_followed = is_followed or checksums is not None or compression != "none"
            yield from _chunk(at, compression, data, intact, size, so_far, is_cut, is_followed)
        case RecordType.CHUNK_INFO:
            start, end = _time(fields, b"start_time"), _time(fields, b"end_time")
            counts = dict(_PAIR.iter_unpack(data[: len(data) // 8 * 8]))
            yield ChunkInfoRecord(_unpack(_UINT64, fields, b"chunk_pos"), start, end, counts)
        case RecordType.CONNECTION:
            yield _connection(fields, data)
        case RecordType.IDXDATA:
            yield IndexDataRecord(_unpack(_UINT32, fields, b"conn"), _unpack(_UINT32, fields, b"count"))
        case _:
            raise _Torn(f"a record of kind {kind} cannot be outside a chunk")


def _chunk(
    at: int,
    compression: str,
    packed: bytes,
    intact: int,
    size: int,
    so_far: UnpackedBytes,
    is_cut: bool,
    is_followed: bool,
) -> Iterator[BagRecord]:
    damage = "the checksum of a chunk is wrong" if intact < len(packed) else ""
    is_cut = is_cut or bool(damage)
    try:
        data = unpacked(compression, packed[:intact], size)
        so_far.add(len(data))
        if len(data) < size and not is_cut and compression != "none":
            # For a stream that ends early, a decompressor returns data without an error and without a check.
            raise EOFError("its end is missing")
    except (OSError, RuntimeError, EOFError, ValueError, MemoryError) as error:
        yield UnreadableSpan(at, len(packed), f"a chunk cannot be unpacked ({error})")
        return
    place, problem = 0, damage or "a packed chunk ends too early"
    odd, odd_bytes = "", 0
    waiting: MessageRecord | None = None
    begin = 0
    try:
        while place < len(data):
            usual = _usual_message(data, place)
            if usual is not None:
                if waiting is not None:
                    yield waiting
                begin = place
                waiting, place = usual
                continue
            head, after = _sized(data, place)
            body, place_after = _sized(data, after)
            try:
                record = _inner(head, body)
                if waiting is not None:
                    yield waiting
                begin, waiting = place, record if isinstance(record, MessageRecord) else None
                if waiting is None:
                    yield record
            except _Torn as torn:
                odd, odd_bytes = odd or str(torn), odd_bytes + place_after - (place if waiting is None else begin)
                waiting = None
            place = place_after
    except _Torn as torn:
        problem = damage or str(torn)
        if waiting is not None and not (is_cut and _begins_record(data, place)):
            place, waiting = begin, None
    if waiting is not None and not is_followed:
        place, problem = begin, "unreadable bytes follow the last message of a chunk"
    elif waiting is not None:
        yield waiting
    if odd:
        yield UnreadableSpan(at, odd_bytes, odd)
    # For a stream that is cut off, a decompressor returns the available data without an error.
    whole = len(packed) if compression == "none" else size
    if place < whole:
        yield UnreadableSpan(at, whole - place, problem)


def _begins_record(data: bytes, at: int) -> bool:
    """Return True if the last bytes of a chunk that is cut off can be the beginning of a record."""
    if len(data) - at < 4 + _MESSAGE_HEADER:
        return True
    try:
        return _kind(_fields(_sized(data, at)[0])) in {RecordType.MSGDATA, RecordType.CONNECTION}
    except _Torn:
        return False


def _inner(head: bytes, body: bytes) -> ConnectionRecord | MessageRecord:
    """Return the record in a chunk with this head and body."""
    fields = _fields(head)
    match _kind(fields):
        case RecordType.MSGDATA:
            return MessageRecord(_unpack(_UINT32, fields, b"conn"), _time(fields, b"time"), body)
        case RecordType.CONNECTION:
            return _connection(fields, body)
        case kind:
            raise _Torn(f"a record of kind {kind} cannot be in a chunk")


def _usual_message(data: bytes, at: int) -> tuple[MessageRecord, int] | None:
    """Return a message with a usual header, and the end of the message; None for other headers.

    This fast path makes scans much faster.
    """
    start = at + 4 + _MESSAGE_HEADER + 4
    if start > len(data) or data[at] != _MESSAGE_HEADER:
        return None
    head, _, name, kind, _, conn, number, _, time, seconds, nanoseconds = _OP_CONN_TIME.unpack_from(data, at)
    if name != b"op=":
        head, _, conn, number, _, name, kind, _, time, seconds, nanoseconds = _CONN_OP_TIME.unpack_from(data, at)
    if (head, name, kind, conn, time) != (_MESSAGE_HEADER, b"op=", RecordType.MSGDATA, b"conn=", b"time="):
        return None
    end = start + _UINT32.unpack_from(data, start - 4)[0]
    if end > len(data):
        return None
    return MessageRecord(number, seconds * 1_000_000_000 + nanoseconds, data[start:end]), end


def _connection(fields: dict[bytes, bytes], data: bytes) -> ConnectionRecord:
    inner = _fields(data)
    topic = _word(fields if b"topic" in fields else inner, b"topic")
    if b"type" not in inner:
        raise _Torn(f"the connection of {topic} lacks its field type")
    return ConnectionRecord(
        _unpack(_UINT32, fields, b"conn"),
        topic,
        _word(inner, b"type"),
        _text(inner, b"md5sum") or "",
        _text(inner, b"message_definition") or "",
        _text(inner, b"callerid"),
        _text(inner, b"latching"),
        tuple(name for name in ("md5sum", "message_definition") if name.encode() not in inner),
    )


def _exactly(file: BinaryIO, count: int, end: int) -> bytes:
    if file.tell() + count > end:
        raise _Torn("the file ends in the middle of a record")
    return file.read(count)


def _read(file: BinaryIO, end: int) -> bytes:
    return _exactly(file, _uint32(_exactly(file, 4, end)), end)


def _uint32(data: bytes) -> int:
    return int(_UINT32.unpack(data)[0])


def _sized(data: bytes, at: int) -> tuple[bytes, int]:
    """Return bytes that are stored after their length (4 bytes), and the offset of their end."""
    if at + 4 > len(data):
        raise _Torn("a chunk ends in the middle of a record")
    start = at + 4
    end = start + _UINT32.unpack_from(data, at)[0]
    if end > len(data):
        raise _Torn("a record is longer than its chunk")
    return data[start:end], end


def _fields(header: bytes) -> dict[bytes, bytes]:
    fields = {}
    at = 0
    while at < len(header):
        field, at = _sized(header, at)
        name, equals, value = field.partition(b"=")
        if not equals:
            raise _Torn("a field of a record's head has no value")
        fields[name] = value
    return fields


def _kind(fields: dict[bytes, bytes]) -> int:
    kind = fields.get(b"op", b"")
    if len(kind) != 1:
        raise _Torn("the kind of a record is missing")
    return kind[0]


def _unpack(form: Struct, fields: dict[bytes, bytes], name: bytes) -> int:
    try:
        return int(form.unpack(fields[name])[0])
    except (KeyError, struct.error):
        raise _Torn(f"a record lacks its field {name.decode()}") from None


def _time(fields: dict[bytes, bytes], name: bytes) -> int:
    try:
        seconds, nanoseconds = _TIME.unpack(fields[name])
    except (KeyError, struct.error):
        raise _Torn(f"a record lacks its field {name.decode()}") from None
    return int(seconds) * 1_000_000_000 + int(nanoseconds)


def _text(fields: dict[bytes, bytes], name: bytes) -> str | None:
    return _word(fields, name) if name in fields else None


def _word(fields: dict[bytes, bytes], name: bytes) -> str:
    if name not in fields:
        raise _Torn(f"a record lacks its field {name.decode()}")
    return fields[name].decode(errors="replace")
