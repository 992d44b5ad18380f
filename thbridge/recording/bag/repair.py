"""Repair of a bag without an index: recovers the messages that a killed recording had on the disk."""

import struct
from collections.abc import Iterator
from dataclasses import dataclass
from io import SEEK_CUR, SEEK_END, BytesIO
from pathlib import Path
from typing import BinaryIO

from rosbags.rosbag1.reader import Header, ReaderError, RecordType, decompressors, read_bytes, read_uint32

from thbridge.files.errors import BadFile
from thbridge.recording.bag.bag_file import BagFile
from thbridge.recording.bag.options import Compression
from thbridge.recording.bag.reader import check_is_bag
from thbridge.recording.bag.records import MAGIC, BagConnection
from thbridge.recording.recordings import ACTIVE

_TORN = (ReaderError, struct.error, ValueError, LookupError, EOFError, OSError, RuntimeError, MemoryError)
"""Errors of reading damaged bytes, with those of decompressors."""


@dataclass(frozen=True, slots=True)
class RepairResult:
    """The result of a repair.

    Attributes:
        path: the repaired bag.
        backup: the bag as it was.
        messages: number of messages recovered.
        end_ns: stamp of the last of them; None when there are none.
        lost_bytes: number of bytes that could not be read.
    """

    path: Path
    backup: Path
    messages: int
    end_ns: int | None
    lost_bytes: int


@dataclass(frozen=True, slots=True)
class _MessageRecord:
    """A message record."""

    number: int
    stamp_ns: int
    data: bytes


def reindex(path: Path) -> RepairResult:
    """Write a bag's readable messages into a new bag of the same name, and keep the old one beside it.

    `NAME.bag` and `NAME.bag.active` give `NAME.bag`, and the old file becomes `NAME.orig.bag`. Every complete message
    is recovered, also those of a torn chunk unless it is compressed. The old file stays until the new one is complete.

    Raises:
        BadFile: it is not a ROS 1 bag, a file is in the way, or the disk is full.
    """
    check_is_bag(path)
    repaired = path.with_name(path.name.removesuffix(ACTIVE))
    backup = repaired.with_name(f"{repaired.stem}.orig{repaired.suffix}")
    fresh = repaired.with_name(repaired.name + ".reindexing")
    for taken in {backup, repaired} - {path}:
        if taken.exists():
            raise BadFile(taken, "this file is in the way of the repair", "move it elsewhere first")
    try:
        fresh.unlink(missing_ok=True)
        messages, end_ns, lost = _copy(path, fresh)
        path.replace(backup)
        fresh.replace(repaired)
    except OSError as error:
        fresh.unlink(missing_ok=True)
        reason = (error.strerror or str(error)).lower()
        raise BadFile(path, f"it cannot be repaired here: {reason}", "make room beside it") from error
    return RepairResult(repaired, backup, messages, end_ns, lost)


def _copy(path: Path, fresh: Path) -> tuple[int, int | None, int]:
    """Copy the messages. Return their number, the last stamp, and the number of lost bytes."""
    count, end_ns = 0, None
    connections: dict[int, BagConnection] = {}
    with path.open("rb") as source:
        scan = _Scan(source)
        target = BagFile(fresh, scan.compression())
        for record in scan.records():
            match record:
                case BagConnection(number):
                    connections.setdefault(number, record)
                case _MessageRecord(number, stamp_ns, data):
                    if number in connections:
                        target.write(connections[number], stamp_ns, data)
                        count += 1
                        end_ns = stamp_ns if end_ns is None else max(end_ns, stamp_ns)
    target.close()
    return count, end_ns, scan.lost


class _Scan:
    """Reads a bag from beginning to end without its index.

    Attributes:
        lost: number of bytes that could not be read so far.
    """

    def __init__(self, source: BinaryIO) -> None:
        self._source = source
        self.lost = 0

    def compression(self) -> Compression:
        """The compression of the first chunk."""
        try:
            self._source.seek(len(MAGIC))
            for _ in range(2):
                header = Header.read(self._source)
                if header.get_uint8("op") == RecordType.CHUNK:
                    return Compression(header.get_string("compression"))
                self._source.seek(read_uint32(self._source), SEEK_CUR)
        except _TORN:
            pass
        return Compression.NONE

    def records(self) -> Iterator[BagConnection | _MessageRecord]:
        """Yield connections and messages in the file's order, up to the end or the first unreadable record."""
        end = self._source.seek(0, SEEK_END)
        at = self._source.seek(len(MAGIC))
        while at < end:
            try:
                header = Header.read(self._source)
                kind = header.get_uint8("op")
                size = read_uint32(self._source)
                data = self._source.read(size)
                inner = self._inside(header, data) if kind == RecordType.CHUNK else None
            except _TORN:
                self.lost += end - at
                return
            if inner is not None:
                yield from self._chunk(inner)
            elif len(data) < size:
                self.lost += end - at
            at = self._source.tell()

    def _inside(self, header: Header, data: bytes) -> BytesIO:
        return BytesIO(decompressors[header.get_string("compression")](data))

    def _chunk(self, inner: BytesIO) -> Iterator[BagConnection | _MessageRecord]:
        end = len(inner.getbuffer())
        at = 0
        while at < end:
            try:
                record = _inner_record(inner)
            except _TORN:
                self.lost += end - at
                return
            yield record
            at = inner.tell()


def _inner_record(source: BinaryIO) -> BagConnection | _MessageRecord:
    header = Header.read(source)
    kind = header.get_uint8("op")
    if kind == RecordType.MSGDATA:
        data = read_bytes(source, read_uint32(source))
        return _MessageRecord(header.get_uint32("conn"), header.get_time("time"), data)
    if kind != RecordType.CONNECTION:
        raise ReaderError(f"no record of kind {kind} belongs into a chunk")
    number, topic = header.get_uint32("conn"), header.get_string("topic")
    fields = Header.read(source)
    return BagConnection(
        number,
        topic,
        fields.get_string("type"),
        fields.get_string("md5sum"),
        fields.get_string("message_definition"),
        fields.get_string("callerid") if "callerid" in fields else None,
        fields["latching"] == b"1" if fields.get("latching") else None,
    )
