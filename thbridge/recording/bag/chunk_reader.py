"""Random access to single messages in the chunks of bags."""

import os
from collections import OrderedDict
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import BinaryIO

from rosbags.rosbag1.reader import Header, RecordType, decompressors, read_bytes, read_uint32

from thbridge.recording.bag.options import Compression
from thbridge.recording.bag.reader import damage_as_bad_file, damaged

BYTES_KEPT = 32 * 1024 * 1024
"""Bytes of unpacked chunks that are cached."""
WHOLE = 1024 * 1024
"""Largest uncompressed chunk that is read as a whole; of larger ones single messages are read."""

_CONNECTION = b"\x09\x00\x00\x00conn="
"""The field `conn` of an index data record's header, up to its value of 4 bytes."""


@dataclass(frozen=True, slots=True, eq=False)
class ChunkInfo:
    """The chunk info record of a chunk, from the end of its file.

    Attributes:
        file: index of the file among the recording's parts.
        position: offset of the chunk in the file.
        start_ns: stamp of its first message.
        end_ns: stamp of its last message.
        counts: number of messages by connection number.
    """

    file: int
    position: int
    start_ns: int
    end_ns: int
    counts: Mapping[int, int]


@dataclass(frozen=True, slots=True, eq=False)
class _Packed:
    """Position and size of a chunk's data in its file, and their decompressor; None when not compressed."""

    position: int
    size: int
    unpack: Callable[[bytes], bytes] | None


class ChunkReader:
    """Reads the chunks of a recording, in one thread. All methods raise BadFile: a file is damaged, or gone.

    Args:
        parts: paths of the files.
        files: the same, opened; `close` closes them.
    """

    def __init__(self, parts: Sequence[Path], files: Sequence[BinaryIO]) -> None:
        self._parts, self._files = parts, files
        self._packed: dict[ChunkInfo, _Packed] = {}
        self._unpacked: OrderedDict[ChunkInfo, bytes] = OrderedDict()
        self._bytes = 0

    def close(self) -> None:
        """Close the files."""
        for file in self._files:
            file.close()

    def index_of(self, chunk: ChunkInfo) -> dict[int, bytes]:
        """The data of a chunk's index data records, by connection number."""
        file = self._files[chunk.file]
        with damage_as_bad_file(self._parts[chunk.file]):
            packed = self._packed_at(chunk)
            file.seek(packed.position + packed.size)
            found: dict[int, bytes] = {}
            for _ in chunk.counts:
                # Parsing the header by rosbags would take longer than all the rest of this function.
                head = read_bytes(file, read_uint32(file))
                at = head.index(_CONNECTION) + len(_CONNECTION)
                number = int.from_bytes(head[at : at + 4], "little")
                found[number] = read_bytes(file, read_uint32(file))
            if found.keys() != chunk.counts.keys():
                raise ValueError("a chunk's index is not what the file's end says")
            return found

    def message(self, chunk: ChunkInfo, offset: int) -> bytes:
        """The message whose record begins at an offset of the unpacked chunk."""
        packed = self._packed.get(chunk)
        if packed is None:
            with damage_as_bad_file(self._parts[chunk.file]):
                packed = self._packed_at(chunk)
        if packed.unpack is None and packed.size > WHOLE:
            return self._message_alone(chunk, packed, offset)
        data = self._data(chunk, packed)
        try:
            start = _after_length(data, offset)  # behind the record's header
            return data[start + 4 : _after_length(data, start)]
        except ValueError as error:
            raise damaged(self._parts[chunk.file]) from error

    def _packed_at(self, chunk: ChunkInfo) -> _Packed:
        known = self._packed.get(chunk)
        if known is None:
            file = self._files[chunk.file]
            file.seek(chunk.position)
            compression = Header.read(file, RecordType.CHUNK).get_string("compression")
            unpack = None if compression == Compression.NONE else decompressors[compression]
            size = read_uint32(file)
            known = self._packed[chunk] = _Packed(file.tell(), size, unpack)
        return known

    def _message_alone(self, chunk: ChunkInfo, packed: _Packed, offset: int) -> bytes:
        """Read one message of a large chunk without the rest, for example images."""
        file = self._files[chunk.file]
        with damage_as_bad_file(self._parts[chunk.file]):
            file.seek(packed.position + offset)
            file.seek(read_uint32(file), os.SEEK_CUR)
            return read_bytes(file, read_uint32(file))

    def _data(self, chunk: ChunkInfo, packed: _Packed) -> bytes:
        """The unpacked data of a chunk."""
        known = self._unpacked.get(chunk)
        if known is not None:
            self._unpacked.move_to_end(chunk)
            return known
        file = self._files[chunk.file]
        with damage_as_bad_file(self._parts[chunk.file]):
            file.seek(packed.position)
            known = read_bytes(file, packed.size)
            known = known if packed.unpack is None else packed.unpack(known)
        self._unpacked[chunk] = known
        self._bytes += len(known)
        while self._bytes > BYTES_KEPT and len(self._unpacked) > 1:
            self._bytes -= len(self._unpacked.popitem(last=False)[1])
        return known


def _after_length(data: bytes, at: int) -> int:
    """End of a field that begins with its length of 4 bytes. Raises ValueError: it is beyond the data."""
    end = at + 4 + int.from_bytes(data[at : at + 4], "little")
    if end > len(data):
        raise ValueError("a record ends beyond its chunk")
    return end
