"""Arrays memory-mapped from a temporary file."""

import mmap
from collections.abc import Iterable
from tempfile import TemporaryFile

import numpy as np
from numpy.typing import NDArray

MOST = 64 << 20
"""Arrays up to this size in bytes stay in memory."""


def mapped(arrays: Iterable[NDArray[np.float32]], size: int) -> list[NDArray[np.float32]]:
    """Return small arrays unchanged, and large arrays as parts of a temporary file.

    The file is deleted with the last array.

    Args:
        arrays: the arrays; they are read one at a time.
        size: approximate total size of the arrays, bytes.

    Raises:
        OSError: the disk is full.
    """
    if size <= MOST:
        return [*arrays]
    ends, shapes = [0], []
    with TemporaryFile(prefix="thbridge-") as file:
        for array in arrays:
            file.write(np.ascontiguousarray(array).data)
            ends.append(file.tell())
            shapes.append(array.shape)
        file.flush()
        # Compiled kernels expect writable arrays; writes stay in memory (copy on write).
        whole = mmap.mmap(file.fileno(), 0, access=mmap.ACCESS_COPY)
    return [
        np.frombuffer(whole, dtype=np.float32, count=(end - begin) // 4, offset=begin).reshape(shape)
        for begin, end, shape in zip(ends, ends[1:], shapes, strict=False)
    ]
