"""Room on a disk that is set aside before it is needed."""

import ctypes
import errno
import os

_KEEP_SIZE = 1
_CANNOT = {errno.EOPNOTSUPP, errno.ENOSYS, errno.EINVAL}

_fallocate = getattr(ctypes.CDLL(None, use_errno=True), "fallocate", None)


def reserve_space(file: int, start: int, size: int) -> None:
    """Make sure that a file can be written between two places, without making it longer (fallocate(2)).

    The room is the file's until it is truncated. Where system or file system know nothing of this, nothing happens.

    Args:
        file: descriptor of an open file.
        start: the first byte.
        size: how many bytes; more than 0.

    Raises:
        OSError: there is no such room.
    """
    if _fallocate is None:
        return
    arguments = (ctypes.c_int(file), ctypes.c_int(_KEEP_SIZE), ctypes.c_int64(start), ctypes.c_int64(size))
    if _fallocate(*arguments) and ctypes.get_errno() not in _CANNOT:
        raise OSError(ctypes.get_errno(), os.strerror(ctypes.get_errno()))
