"""Files and names that survive a power cut.

Written bytes and new names are at first only in memory. Both survive if the program is killed, but a power cut can lose
any of them. So a file gets its name after its bytes are on the disk. The folder is synced before success is reported.
"""

import contextlib
import errno
import os
from collections.abc import Iterator
from pathlib import Path

from thbridge.files.disk.own_links import own_target

# Errors of file systems that cannot sync a folder.
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
    """Create a folder and missing folders above it. From then on, these folders survive a power cut.

    Raises:
        BadFile: a link of another account leads to it.
        OSError: the folder cannot be created.
    """
    own_target(folder)
    new = [each for each in (folder, *folder.parents) if not each.exists()]
    folder.mkdir(parents=True, exist_ok=True)
    for each in new:
        sync_folder(each.parent)


def put_in_place(part: Path, path: Path) -> None:
    """Rename a written file within its folder, in one step; an existing file of the new name is replaced.

    Raises:
        OSError: the file cannot be synced or renamed.
    """
    sync_file(part)
    part.replace(path)
    sync_folder(path.parent)


def put_in_free_place(part: Path, path: Path) -> None:
    """Rename a written file within its folder, in one step, unless a file of the new name exists.

    Raises:
        FileExistsError: a file of that name exists.
        OSError: the file cannot be synced or renamed.
    """
    sync_file(part)
    try:
        # If several programs do this at the same time, only one succeeds.
        path.hardlink_to(part)
    except FileExistsError:
        raise
    except OSError:
        # Some file systems have no hard links.
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
