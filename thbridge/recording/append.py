"""Records that are appended to a file whole or not at all."""

import contextlib
import os
from typing import IO


def append_whole(file: IO[bytes], content: bytes, *, synced: bool) -> None:
    """Write at the end of a file; what could be written of a part is cut off again as far as possible.

    Args:
        file: unbuffered, and at its end.
        content: one or more whole records.
        synced: whether it is on the disk, and not only with the system, when this returns.

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
        # Whoever reads the file drops a torn record at its end.
        with contextlib.suppress(OSError):
            file.truncate(before)
            file.seek(before)
        raise
