"""Unpacking of chunks with limits: a few kilobytes of bz2 can expand to gigabytes of zeros."""

import bz2
from collections.abc import Iterator
from contextlib import suppress
from io import SEEK_END, BytesIO
from pathlib import Path
from struct import Struct
from typing import BinaryIO

import lz4.frame
import zstandard
from mcap.opcode import Opcode

from thbridge.files.disk.regular_files import is_regular
from thbridge.recording.bag.damage import TooLargeChunk

ALWAYS = 1 << 28
"""Unpacked size that is allowed for any chunk, in bytes. Chunks usually have 768 KiB, or one large message."""
TIMES_PACKED = 64
"""Largest ratio of unpacked size to packed size, for chunks with an unpacked size above `ALWAYS`."""
ALWAYS_IN_ALL = 1 << 32
TIMES_FILE = 1000
"""All chunks of a file may together unpack to `ALWAYS_IN_ALL` plus `TIMES_FILE` times the file's size, because
unpacking takes time."""

COMPRESSIONS = ("none", "bz2", "lz4")

MCAP_MAGIC = b"\x89MCAP0\r\n"
_MCAP_RECORD = Struct("<BQ")
"""Kind and length of a record."""
_MCAP_CHUNK = Struct("<QQQII")
"""First and last time of a chunk, unpacked size, checksum, and the length of the name of its compression."""
_PIECE = 1 << 20


TIMES_WHOLE = 1000
"""Largest ratio of unpacked size to packed size, for packed files of rosbag2 with an unpacked size above `ALWAYS`."""


class UnpackedBytes:
    """Counter of the unpacked bytes of a file's chunks, with the file's limit.

    Args:
        file_size: bytes of the file.
        always: bytes that are allowed for any size.
    """

    def __init__(self, file_size: int, always: int = ALWAYS_IN_ALL) -> None:
        self._left = always + TIMES_FILE * file_size

    def add(self, size: int) -> None:
        """Count a chunk. Raises TooLargeChunk above the file's limit."""
        self._left -= size
        if self._left < 0:
            raise TooLargeChunk("the chunks expand to more data than a recording of this size can contain")


def unpacked(compression: str, packed: bytes, size: int) -> bytes:
    """Return the data of a chunk. If its stream is cut off, return the available data.

    Args:
        compression: a name of `COMPRESSIONS`.
        packed: bytes of the chunk in the file.
        size: size of the unpacked data according to the chunk's record, bytes.

    Raises:
        TooLargeChunk: the unpacked size is above the size in the record, or above the limit for a chunk.
        ValueError: the compression is unknown.
        OSError, RuntimeError, EOFError: the stream is damaged.
    """
    if compression == "none":
        return packed
    _check_claim(len(packed), size)
    # One more byte is requested, to detect a stream that is longer than in its record.
    match compression:
        case "bz2":
            data = bz2.BZ2Decompressor().decompress(packed, max_length=size + 1)
        case "lz4":
            data = bytes(lz4.frame.LZ4FrameDecompressor().decompress(packed, max_length=size + 1))
        case other:
            raise ValueError(f"compression {other!r} is unknown")
    _check_size(len(data), size)
    return data


def unpacked_message(packed: bytes, so_far: UnpackedBytes) -> bytes:
    """Return the data of a rosbag2 message that is packed with zstd, and count the bytes.

    Raises:
        TooLargeChunk: the unpacked size is above the limit for a packed chunk of this size, or for the file.
        ZstdError: the data are damaged.
    """
    data = b"".join(_zstd_pieces(BytesIO(packed), max(ALWAYS, TIMES_PACKED * len(packed)), so_far))
    if not data and packed:
        raise zstandard.ZstdError("cut off")
    return data


def unpacked_zstd(packed: bytes, size: int) -> bytes:
    """Return the data of an MCAP chunk that is packed with zstd. If its stream is cut off, return the available data.

    Raises:
        TooLargeChunk: the unpacked size is above the size in the record, or above the limit for a chunk.
        OSError: the stream is damaged.
    """
    _check_claim(len(packed), size)
    pieces, found = [], 0
    try:
        with zstandard.ZstdDecompressor().stream_reader(packed) as stream:
            while found <= size and (piece := stream.read(min(_PIECE, size + 1 - found))):
                pieces.append(piece)
                found += len(piece)
    except zstandard.ZstdError as error:
        raise OSError(str(error)) from error
    _check_size(found, size)
    return b"".join(pieces)


def unpack_file(packed: Path, to: Path, so_far: UnpackedBytes) -> None:
    """Unpack a file of rosbag2 that is packed with zstd as a whole.

    Raises:
        TooLargeChunk: the unpacked size is above the limit for a packed file of this size.
        ZstdError: the data are damaged.
        OSError: a file cannot be read or written.
    """
    most = max(ALWAYS, TIMES_WHOLE * packed.stat().st_size)
    with packed.open("rb") as source, to.open("wb") as out:
        for piece in _zstd_pieces(source, most, so_far):
            out.write(piece)


def check_mcap(path: Path) -> None:
    """Check the unpacked sizes of the chunks of an MCAP file, because its readers unpack without limits.

    Files of other kinds are ignored.

    Raises:
        TooLargeChunk: an unpacked size is above the size in the record, or above the limit.
        OSError: the file cannot be read.
    """
    if not is_regular(path):
        return
    with path.open("rb") as file:
        end = file.seek(0, SEEK_END)
        so_far = UnpackedBytes(end)
        file.seek(0)
        if file.read(len(MCAP_MAGIC)) != MCAP_MAGIC:
            return
        at = file.tell()
        while at + _MCAP_RECORD.size <= end:
            kind, length = _MCAP_RECORD.unpack(file.read(_MCAP_RECORD.size))
            at += _MCAP_RECORD.size + length
            if at > end:
                return  # The file is cut off; its readers report that.
            if kind == Opcode.CHUNK:
                record = file.read(length)
                if len(record) >= _MCAP_CHUNK.size:
                    _check_mcap_chunk(record, so_far)
            file.seek(at)


def _check_mcap_chunk(record: bytes, so_far: UnpackedBytes) -> None:
    _, _, size, _, name = _MCAP_CHUNK.unpack_from(record)
    start = _MCAP_CHUNK.size + name
    compression, packed = record[start - name : start], record[start + 8 :]
    if not compression:
        return
    _check_claim(len(packed), size)
    so_far.add(size)
    found = 0
    for count in _counts(compression, packed):
        found += count
        _check_size(found, size)


def _zstd_pieces(packed: BinaryIO, most: int, so_far: UnpackedBytes) -> Iterator[bytes]:
    """Yield the unpacked pieces of a stream. Raises TooLargeChunk above `most` bytes, or above the file's limit."""
    found = 0
    with zstandard.ZstdDecompressor().stream_reader(packed, read_across_frames=True) as stream:
        while piece := stream.read(_PIECE):
            found += len(piece)
            if found > most:
                raise TooLargeChunk(f"the unpacked size is above the limit of {most} bytes")
            so_far.add(len(piece))
            yield piece


def _counts(compression: bytes, packed: bytes) -> Iterator[int]:
    """Yield the sizes of a chunk's unpacked pieces; errors are left to the readers."""
    with suppress(zstandard.ZstdError, RuntimeError, EOFError):
        if compression == b"zstd":
            with zstandard.ZstdDecompressor().stream_reader(packed, read_across_frames=True) as stream:
                while piece := stream.read(_PIECE):
                    yield len(piece)
        elif compression == b"lz4":
            unpacker = lz4.frame.LZ4FrameDecompressor()
            data = packed
            while not unpacker.eof:
                piece = unpacker.decompress(data, max_length=_PIECE)
                if not piece:
                    return
                data = b""
                yield len(piece)


def _check_claim(packed: int, size: int) -> None:
    """Raise TooLargeChunk if a chunk claims an unpacked size above the limit."""
    most = max(ALWAYS, TIMES_PACKED * packed)
    if size > most:
        raise TooLargeChunk(f"a chunk of {packed} bytes claims an unpacked size of {size} bytes; the limit is {most}")


def _check_size(found: int, size: int) -> None:
    """Raise TooLargeChunk if a chunk unpacks to more than it claims."""
    if found > size:
        raise TooLargeChunk(f"a chunk unpacks to more than the {size} bytes in its record")
