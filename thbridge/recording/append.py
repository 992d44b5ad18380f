"""Appending of records to a file: completely or not at all."""

import contextlib
import os
from typing import IO


def append_whole(file: IO[bytes], content: bytes, *, synced: bool) -> None:
    """Append to a file. After an error, remove the written part again if possible.

    Args:
        file: an unbuffered file, positioned at its end.
        content: one or more whole records.
        synced: True to wait until the content is on the disk (fsync).

    Raises:
        OSError: the disk is full or unavailable.
    """
    before = file.tell()
    try:
        view = memoryview(content)
        while view:
            view = view[file.write(view) :]
        if synced:
            os.fsync(file.fileno())
    except OSError:
        # If the removal also fails, readers of the file ignore the incomplete record at its end.
        with contextlib.suppress(OSError):
            file.truncate(before)
            file.seek(before)
        raise
