"""Settings of the C library's heap, for programs that create and free arrays of many megabytes."""

import ctypes

_M_TRIM_THRESHOLD, _M_MMAP_THRESHOLD = -1, -3
_LARGE = 1 << 20
"""A block of memory is allocated separately if it has at least this size in bytes."""


def give_large_blocks_back() -> None:
    """Return large blocks of memory to the system when they are freed, if the C library is GNU's.

    By default, glibc keeps freed blocks of up to 32 MB, and the gaps between them, for later use.
    """
    mallopt = getattr(ctypes.CDLL(None), "mallopt", None)
    if mallopt is not None:
        mallopt(_M_MMAP_THRESHOLD, _LARGE)
        mallopt(_M_TRIM_THRESHOLD, _LARGE)
