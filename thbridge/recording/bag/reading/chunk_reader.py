"""Random access to single messages in the chunks of bags."""

import os
import struct
from collections import OrderedDict
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import BinaryIO

import numpy as np
from numpy.typing import NDArray
from rosbags.rosbag1.reader import Header, RecordType, read_bytes, read_uint32

from thbridge.recording.bag.checksums import intact_bytes
from thbridge.recording.bag.damage import damage_as_bad_file, damaged
from thbridge.recording.bag.options import Compression
from thbridge.recording.bag.records import INDEX_ENTRY_BYTES, U32
from thbridge.recording.bag.unpacking import COMPRESSIONS, UnpackedBytes, unpacked

BYTES_KEPT = 32 * 1024 * 1024
"""Default size of the cache of unpacked chunks, in bytes."""
WHOLE = 1024 * 1024
"""Size of the largest uncompressed chunk that is read completely. From larger chunks, single messages are read."""

FEW = 16
"""Maximum number of messages of an uncompressed chunk that are read one by one."""

_CONNECTION = b"\x09\x00\x00\x00conn="
"""Beginning of the field `conn` in an index data record's header, before its value of 4 bytes."""
_USUAL_HEAD = 55
"""Size in bytes of an index data record's header, including both lengths, as ROS and thbridge write it."""
_BYTES_OF_U32 = np.arange(4)


@dataclass(frozen=True, slots=True, eq=False)
class ChunkInfo:
    """The chunk info record of a chunk, from the end of its file.

    Attributes:
        file: index of the file among the recording's parts.
        position: offset of the chunk in the file.
        start_ns: stamp of the first message in the chunk.
        end_ns: stamp of the last message in the chunk.
        counts: number of messages by connection number.
    """

    file: int
    position: int
    start_ns: int
    end_ns: int
    counts: Mapping[int, int]

    def is_before(self, stamp_ns: int | None) -> bool:
        """Return True if all messages of the chunk are before a stamp. For None, return False."""
        return stamp_ns is not None and self.end_ns < stamp_ns


@dataclass(frozen=True, slots=True, eq=False)
class _Packed:
    """Position, size and compression of a chunk's data in the file, the unpacked size, and the checksums if any."""

    position: int
    size: int
    compression: str
    unpacked: int
    checksums: bytes | None

    @property
    def plain(self) -> bool:
        """True if the data are not compressed."""
        return self.compression == Compression.NONE


class ChunkReader:
    """Reader of the chunks of a recording, for use by one thread. All methods raise BadFile for damaged or lost files.

    Args:
        parts: paths of the files.
        files: the opened files; `close` closes them.
        bytes_kept: size of the cache of unpacked chunks, in bytes.
    """

    def __init__(self, parts: Sequence[Path], files: Sequence[BinaryIO], bytes_kept: int = BYTES_KEPT) -> None:
        self._parts, self._files, self._bytes_kept = parts, files, bytes_kept
        self._packed: dict[ChunkInfo, _Packed] = {}
        self._unpacked: OrderedDict[ChunkInfo, bytes] = OrderedDict()
        self._bytes = 0
        self._so_far = [UnpackedBytes(_size_of(file)) for file in files]
        self._counted: set[ChunkInfo] = set()

    def close(self) -> None:
        """Close the files."""
        for file in self._files:
            file.close()

    def compression_of(self, chunk: ChunkInfo) -> str:
        """Return the name of a chunk's compression."""
        with damage_as_bad_file(self._parts[chunk.file]):
            return self._packed_at(chunk).compression

    def index_of(self, chunk: ChunkInfo) -> dict[int, bytes]:
        """Return the data of a chunk's index data records, by connection number."""
        file = self._files[chunk.file]
        with damage_as_bad_file(self._parts[chunk.file]):
            packed = self._packed_at(chunk)
            file.seek(packed.position + packed.size)
            size = sum(chunk.counts.values()) * INDEX_ENTRY_BYTES + len(chunk.counts) * _USUAL_HEAD
            if size > _size_of(file):
                raise ValueError("a chunk's index is longer than the file")
            block = file.read(size)
            while (found := _index_in(block, len(chunk.counts))) is None:
                more = file.read(size)
                if not more:
                    raise ValueError("the file ends within a chunk's index")
                block += more
            if found.keys() != chunk.counts.keys():
                raise ValueError("a chunk's index differs from the index at the file's end")
            return found

    def message(self, chunk: ChunkInfo, offset: int) -> bytes:
        """Return the message whose record is at an offset of the unpacked chunk."""
        packed = self._packed.get(chunk)
        if packed is None:
            with damage_as_bad_file(self._parts[chunk.file]):
                packed = self._packed_at(chunk)
        if packed.plain and packed.size > WHOLE:
            return self._message_alone(chunk, packed, offset)
        data = self._data(chunk, packed)
        try:
            start = _after_length(data, offset)  # The end of the record's header.
            return data[start + 4 : _after_length(data, start)]
        except ValueError as error:
            raise damaged(self._parts[chunk.file]) from error

    def places(
        self, chunk: ChunkInfo, numbers: Collection[int]
    ) -> tuple[NDArray[np.int64], NDArray[np.int64], NDArray[np.int64]]:
        """Return (n,) connection numbers, stamps and offsets of messages in a chunk, in order of time.

        Only messages of the connections `numbers` are returned. Messages with one stamp are in the order of offsets.
        """
        found = self.index_of(chunk)
        wanted = [(number, found[number]) for number in numbers]
        with damage_as_bad_file(self._parts[chunk.file]):
            stamps, offsets = entries_in(b"".join(data for _, data in wanted))
        counts = [len(data) // INDEX_ENTRY_BYTES for _, data in wanted]
        who = np.repeat(np.array([number for number, _ in wanted], dtype=np.int64), counts)
        order = np.lexsort((offsets, stamps))
        return who[order], stamps[order], offsets[order]

    def messages(self, chunk: ChunkInfo, offsets: NDArray[np.int64]) -> Iterator[bytes]:
        """Yield the messages whose records are at these offsets of the unpacked chunk."""
        with damage_as_bad_file(self._parts[chunk.file]):
            packed = self._packed_at(chunk)
        if packed.plain and (packed.size > WHOLE or len(offsets) <= FEW):
            yield from (self._message_alone(chunk, packed, offset) for offset in offsets.tolist())
            return
        data = self._data(chunk, packed)
        with damage_as_bad_file(self._parts[chunk.file]):
            octets = np.frombuffer(data, dtype=np.uint8)
            bodies = offsets + 4 + _lengths_at(octets, offsets)  # The ends of the records' headers.
            ends = bodies + 4 + _lengths_at(octets, bodies)
            if (ends > len(data)).any():
                raise ValueError("a record ends beyond its chunk")
        yield from (data[start:end] for start, end in zip((bodies + 4).tolist(), ends.tolist(), strict=True))

    def _packed_at(self, chunk: ChunkInfo) -> _Packed:
        known = self._packed.get(chunk)
        if known is None:
            file = self._files[chunk.file]
            file.seek(chunk.position)
            head = Header.read(file, RecordType.CHUNK)
            compression, size = head.get_string("compression"), read_uint32(file)
            if compression not in COMPRESSIONS:
                raise ValueError(f"compression {compression!r} is unknown")
            known = self._packed[chunk] = _Packed(
                file.tell(), size, compression, head.get_uint32("size"), head.get("crc32")
            )
        return known

    def _message_alone(self, chunk: ChunkInfo, packed: _Packed, offset: int) -> bytes:
        """Read one message of a large chunk, for example an image, without the rest of the chunk."""
        file = self._files[chunk.file]
        with damage_as_bad_file(self._parts[chunk.file]):
            file.seek(packed.position + offset)
            file.seek(read_uint32(file), os.SEEK_CUR)
            return read_bytes(file, read_uint32(file))

    def _data(self, chunk: ChunkInfo, packed: _Packed) -> bytes:
        """Return the unpacked data of a chunk."""
        known = self._unpacked.get(chunk)
        if known is not None:
            self._unpacked.move_to_end(chunk)
            return known
        file = self._files[chunk.file]
        with damage_as_bad_file(self._parts[chunk.file]):
            file.seek(packed.position)
            data = read_bytes(file, packed.size)
            if packed.checksums is not None and intact_bytes(data, packed.size, packed.checksums) < packed.size:
                raise ValueError("the checksum of a chunk is wrong")
            known = unpacked(packed.compression, data, packed.unpacked)
            if not packed.plain and len(known) < packed.unpacked:
                raise ValueError("a packed chunk ends too early")
            if chunk not in self._counted:
                self._counted.add(chunk)
                self._so_far[chunk.file].add(len(known))
        self._unpacked[chunk] = known
        self._bytes += len(known)
        while self._bytes > self._bytes_kept and len(self._unpacked) > 1:
            self._bytes -= len(self._unpacked.popitem(last=False)[1])
        return known


def _size_of(file: BinaryIO) -> int:
    return os.fstat(file.fileno()).st_size


def _after_length(data: bytes, at: int) -> int:
    """Return the end of a field that begins with its length, 4 bytes. Raises ValueError if it ends beyond the data."""
    end = at + 4 + int.from_bytes(data[at : at + 4], "little")
    if end > len(data):
        raise ValueError("a record ends beyond its chunk")
    return end


def entries_in(data: bytes | bytearray) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Return (n,) stamps and offsets in the data of index data records. Raises ValueError if the data are cut off."""
    seconds, nanoseconds, offsets = np.frombuffer(data, dtype="<u4").reshape(-1, 3).T
    return seconds.astype(np.int64) * 1_000_000_000 + nanoseconds, offsets.astype(np.int64)


def _index_in(block: bytes, records: int) -> dict[int, bytes] | None:
    """Return the data of some index data records, by connection number; None if the block ends too early."""
    found: dict[int, bytes] = {}
    at = 0
    try:
        for _ in range(records):
            head_end = at + 4 + U32.unpack_from(block, at)[0]
            end = head_end + 4 + U32.unpack_from(block, head_end)[0]
            if end > len(block):
                return None
            number_at = block.index(_CONNECTION, at, head_end) + len(_CONNECTION)
            found[U32.unpack_from(block, number_at)[0]] = block[head_end + 4 : end]
            at = end
    except struct.error:
        return None
    return found


def _lengths_at(octets: NDArray[np.uint8], places: NDArray[np.int64]) -> NDArray[np.int64]:
    """Return (n,) lengths of 4 bytes at these places. Raises IndexError if a place is beyond the end."""
    lengths: NDArray[np.int64] = octets[places[:, np.newaxis] + _BYTES_OF_U32].view("<u4")[:, 0].astype(np.int64)
    return lengths
