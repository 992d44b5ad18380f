"""Arrays in a temporary file, of which memory holds what is looked at."""

import mmap
from collections.abc import Iterable
from tempfile import TemporaryFile

import numpy as np
from numpy.typing import NDArray

MOST = 64 << 20
"""Bytes up to which arrays stay in memory."""


def mapped(arrays: Iterable[NDArray[np.float32]], size: int) -> list[NDArray[np.float32]]:
    """Return arrays as they are, or, where they are many and large, as parts of a file that goes with the last of them.

    Args:
        arrays: the arrays, which are taken one by one.
        size: bytes of all of them, about.

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
        # Kernels know arrays that may be written to; what is written stays in memory.
        whole = mmap.mmap(file.fileno(), 0, access=mmap.ACCESS_COPY)
    return [
        np.frombuffer(whole, dtype=np.float32, count=(end - begin) // 4, offset=begin).reshape(shape)
        for begin, end, shape in zip(ends, ends[1:], shapes, strict=False)
    ]
