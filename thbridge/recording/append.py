"""Records appended to a file completely or not at all, and folders that are on the disk."""

import contextlib
import os
from pathlib import Path
from typing import IO


def append_whole(file: IO[bytes], content: bytes, *, synced: bool) -> None:
    """Write at the end of a file. After an error, what was written is cut off again as far as possible.

    Args:
        file: an unbuffered file, positioned at its end.
        content: one or more whole records.
        synced: True to wait until the content is on the disk (fsync).

    Raises:
        OSError: the disk is full or gone.
    """
    before = file.tell()
    try:
        view = memoryview(content)
        while view:
            view = view[file.write(view) :]
        if synced:
            os.fsync(file.fileno())
    except OSError:
        # If this fails, too: readers of the file ignore a torn record at its end.
        with contextlib.suppress(OSError):
            file.truncate(before)
            file.seek(before)
        raise


def sync_folder(folder: Path) -> None:
    """Force the names in a folder onto the disk."""
    descriptor = os.open(folder, os.O_RDONLY)
    try:
        os.fsync(descriptor)
    finally:
        os.close(descriptor)


def make_folder(folder: Path) -> None:
    """Make a folder, with those above it, where it is not there; it outlives a power cut when this returns.

    Raises:
        OSError: it cannot be made.
    """
    new = [each for each in (folder, *folder.parents) if not each.exists()]
    folder.mkdir(parents=True, exist_ok=True)
    for each in new:
        sync_folder(each.parent)
