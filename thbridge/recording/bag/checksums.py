"""Checksums of the blocks of a chunk. Even if the chunk is cut off or damaged, each recovered message is checked."""

import zlib
from struct import Struct

BLOCKS = 64
"""Largest number of blocks of a chunk. Their checksums always need the same space. So the bytes after them do not move
when a longer chunk is written over a shorter one, and the blocks of the shorter chunk stay valid."""
_SMALLEST_BLOCK = 4096
_SUMS = Struct(f"<{BLOCKS}I")


def block_checksums(data: bytes) -> bytes:
    """Return the CRC-32 of each block of a chunk's packed data, and zeros for unused blocks; always 256 bytes."""
    size, view = _block_bytes(len(data)), memoryview(data)
    sums = [zlib.crc32(view[at : at + size]) for at in range(0, len(data), size)]
    return _SUMS.pack(*sums, *(0 for _ in range(BLOCKS - len(sums))))


def intact_bytes(data: bytes, size: int, checksums: bytes) -> int:
    """Return the number of bytes before the first block that is damaged or incomplete.

    Args:
        data: the packed data of a chunk, or their beginning.
        size: size of all packed data of the chunk.
        checksums: see `block_checksums`.
    """
    if len(checksums) != _SUMS.size:
        return 0
    block, view = _block_bytes(size), memoryview(data)
    for at, expected in zip(range(0, size, block), _SUMS.unpack(checksums), strict=False):
        end = min(at + block, size)
        if end > len(data) or zlib.crc32(view[at:end]) != expected:
            return at
    return size


def _block_bytes(size: int) -> int:
    """Return the size of a block: the smallest of 4096, 8192, ... bytes with at most `BLOCKS` blocks."""
    block = _SMALLEST_BLOCK
    while block * BLOCKS < size:
        block *= 2
    return block
