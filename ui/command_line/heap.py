"""The C library's heap, for programs with arrays of many megabytes that come and go."""

import ctypes

_M_TRIM_THRESHOLD, _M_MMAP_THRESHOLD = -1, -3
_LARGE = 1 << 20
"""Bytes from which on a block is one of its own."""


def give_large_blocks_back() -> None:
    """Have large blocks of memory go back to the system when they are freed, where the C library is GNU's.

    It would keep blocks of up to 32 MB for later use, and holes between them.
    """
    mallopt = getattr(ctypes.CDLL(None), "mallopt", None)
    if mallopt is not None:
        mallopt(_M_MMAP_THRESHOLD, _LARGE)
        mallopt(_M_TRIM_THRESHOLD, _LARGE)
