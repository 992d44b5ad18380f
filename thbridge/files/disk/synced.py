"""Files and names that outlive a power cut.

Bytes that were written, and names that were given, are in memory at first; a kill does not lose them, a power cut does,
in any order. So a file gets its name after its bytes are on the disk, and its folder is synced before anybody is told.
"""

import contextlib
import errno
import os
from collections.abc import Iterator
from pathlib import Path

from thbridge.files.disk.own_links import own_target

# Errors of file systems that have nothing to sync in a folder.
_CANNOT = {errno.EINVAL, errno.ENOTSUP, errno.EBADF}


def sync_file(path: Path) -> None:
    """Force the bytes of a file onto the disk. Raises OSError."""
    with _opened(path, os.O_RDONLY) as descriptor:
        os.fsync(descriptor)


def sync_folder(folder: Path) -> None:
    """Force the names in a folder onto the disk. Raises OSError."""
    with _opened(folder, os.O_RDONLY | os.O_DIRECTORY) as descriptor:
        try:
            os.fsync(descriptor)
        except OSError as error:
            if error.errno not in _CANNOT:
                raise


def make_folder(folder: Path) -> None:
    """Make a folder, with those above it, where it is not there; it outlives a power cut when this returns.

    Raises:
        BadFile: a link of another account leads to it.
        OSError: it cannot be made.
    """
    own_target(folder)
    new = [each for each in (folder, *folder.parents) if not each.exists()]
    folder.mkdir(parents=True, exist_ok=True)
    for each in new:
        sync_folder(each.parent)


def put_in_place(part: Path, path: Path) -> None:
    """Give a written file its name in the same folder, in one step; a file of that name is replaced.

    Raises:
        OSError: it cannot be synced or renamed.
    """
    sync_file(part)
    part.replace(path)
    sync_folder(path.parent)


def put_in_free_place(part: Path, path: Path) -> None:
    """Give a written file its name in the same folder, in one step, unless there is such a file.

    Raises:
        FileExistsError: there is.
        OSError: it cannot be synced or renamed.
    """
    sync_file(part)
    try:
        # Of several programs that do this at once, one wins.
        path.hardlink_to(part)
    except FileExistsError:
        raise
    except OSError:
        # Some file systems have no second names.
        if path.exists():
            raise FileExistsError(errno.EEXIST, os.strerror(errno.EEXIST), str(path)) from None
        part.replace(path)
    part.unlink(missing_ok=True)
    sync_folder(path.parent)


@contextlib.contextmanager
def _opened(path: Path, flags: int) -> Iterator[int]:
    descriptor = os.open(path, flags)
    try:
        yield descriptor
    finally:
        os.close(descriptor)
