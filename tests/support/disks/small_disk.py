"""Small disk in memory that can be full or read-only. `chmod` cannot test this, because it does not restrict root."""

import contextlib
import ctypes
import os
import shutil
import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import Self

_libc = ctypes.CDLL(None, use_errno=True)
_READ_ONLY, _REMOUNT, _DETACH = 1, 32, 2
_MIB = 1 << 20


def _mount(folder: Path, flags: int, size: int) -> None:
    if _libc.mount(b"none", str(folder).encode(), b"tmpfs", flags, f"size={size}".encode()):
        raise OSError(ctypes.get_errno(), os.strerror(ctypes.get_errno()), str(folder))


def why_not() -> str | None:
    """Return the reason why no such disk can be mounted here; None if it can be."""
    with tempfile.TemporaryDirectory() as folder:
        try:
            SmallDisk(Path(folder), _MIB).close()
        except OSError as error:
            return f"no disk can be mounted here ({error.strerror})"
    return None


class SmallDisk:
    """Mounted disk. Use it in `with`.

    Args:
        folder: mount point; it is created.
        size: capacity in bytes.

    Raises:
        OSError: nothing can be mounted here.
    """

    def __init__(self, folder: Path, size: int) -> None:
        self.folder = folder
        self._size = size
        folder.mkdir(parents=True, exist_ok=True)
        _mount(folder, 0, size)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def close(self) -> None:
        """Unmount the disk."""
        _libc.umount2(str(self.folder).encode(), _DETACH)

    def empty(self) -> None:
        """Remove all files and folders on the disk."""
        for path in self.folder.iterdir():
            if path.is_dir() and not path.is_symlink():
                shutil.rmtree(path)
            else:
                path.unlink()

    @property
    def used(self) -> int:
        """Used space, bytes."""
        found = os.statvfs(self.folder)
        return (found.f_blocks - found.f_bfree) * found.f_frsize

    @contextlib.contextmanager
    def full(self, room: int = 0) -> Iterator[None]:
        """Leave only `room` bytes free, rounded to whole pages, until the end of the block."""
        _mount(self.folder, _REMOUNT, max(self.used + room, 4096))
        try:
            yield
        finally:
            _mount(self.folder, _REMOUNT, self._size)

    @contextlib.contextmanager
    def read_only(self) -> Iterator[None]:
        """Make the disk read-only until the end of the block."""
        _mount(self.folder, _REMOUNT | _READ_ONLY, self._size)
        try:
            yield
        finally:
            _mount(self.folder, _REMOUNT, self._size)
