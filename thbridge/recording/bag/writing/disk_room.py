"""Reservation of disk space before it is needed."""

import ctypes
import errno
import os

_KEEP_SIZE = 1
"""FALLOC_FL_KEEP_SIZE: the space is reserved after the end of the file, and the file's size does not change."""
# Errors of file systems that cannot reserve space.
_CANNOT = {errno.EOPNOTSUPP, errno.ENOSYS, errno.EINVAL}

_fallocate = getattr(ctypes.CDLL(None, use_errno=True), "fallocate", None)


def reserve_space(file: int, start: int, size: int) -> None:
    """Reserve disk space for a range of a file without making the file longer (fallocate(2)).

    The space belongs to the file until it is truncated. Without support by the system or file system, nothing is done.

    Args:
        file: descriptor of an open file.
        start: the first byte.
        size: number of bytes; more than 0.

    Raises:
        OSError: the disk does not have enough space.
    """
    if _fallocate is None:
        return
    arguments = (ctypes.c_int(file), ctypes.c_int(_KEEP_SIZE), ctypes.c_int64(start), ctypes.c_int64(size))
    if _fallocate(*arguments) and ctypes.get_errno() not in _CANNOT:
        raise OSError(ctypes.get_errno(), os.strerror(ctypes.get_errno()))
