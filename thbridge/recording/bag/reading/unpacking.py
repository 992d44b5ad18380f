"""Unpacking of chunks within bounds: some kilobytes of bz2 can stand for gigabytes of zeros."""

import bz2

import lz4.frame

from thbridge.recording.bag.damage import TooLargeChunk

ALWAYS = 1 << 28
"""Bytes that any chunk may unpack to; usual chunks have 768 KiB, or one large message."""
TIMES_PACKED = 64
"""Chunks whose packed data are larger may unpack to so many times their size."""
ALWAYS_IN_ALL = 1 << 32
TIMES_FILE = 1000
"""All chunks of a file may together unpack to `ALWAYS_IN_ALL` and so many times its size: unpacking takes time."""

COMPRESSIONS = ("none", "bz2", "lz4")


class UnpackedBytes:
    """The bytes that chunks of a file have unpacked to so far, held against what it may unpack to.

    Args:
        file_size: bytes of the file.
    """

    def __init__(self, file_size: int) -> None:
        self._left = ALWAYS_IN_ALL + TIMES_FILE * file_size

    def add(self, size: int) -> None:
        """Count a chunk. Raises TooLargeChunk: it is too much for the file."""
        self._left -= size
        if self._left < 0:
            raise TooLargeChunk("its chunks unpack to more than a recording of its size can hold")


def unpacked(compression: str, packed: bytes, size: int) -> bytes:
    """The data of a chunk; of a stream that is cut off what there is.

    Args:
        compression: a name of `COMPRESSIONS`.
        packed: its bytes in the file.
        size: bytes of its data, as its record says.

    Raises:
        TooLargeChunk: it unpacks to more than its record says, or than a chunk may.
        ValueError: there is no such compression.
        OSError, RuntimeError, EOFError: the stream is damaged.
    """
    if compression == "none":
        return packed
    most = max(ALWAYS, TIMES_PACKED * len(packed))
    if size > most:
        raise TooLargeChunk(f"a chunk of {len(packed)} bytes claims to unpack to {size}, more than the {most} it may")
    # One byte more tells a stream that has more than its record says.
    match compression:
        case "bz2":
            data = bz2.BZ2Decompressor().decompress(packed, max_length=size + 1)
        case "lz4":
            data = bytes(lz4.frame.LZ4FrameDecompressor().decompress(packed, max_length=size + 1))
        case other:
            raise ValueError(f"compression {other!r} is not known")
    if len(data) > size:
        raise TooLargeChunk(f"a chunk unpacks to more than the {size} bytes that its record says")
    return data
