"""Files that are there completely or not at all, whatever happens to the program or the machine."""

import os
import socket
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import IO

from thbridge.files.errors import BadFile, reason_of
from thbridge.recording.append import sync_folder

PART = ".part"
"""Suffix of a file while it is being written; its name begins with a dot, so that readers of folders pass it over."""


def worker_name() -> str:
    """Return the name of this process among all that write into a folder."""
    return f"{socket.gethostname()}:{os.getpid()}"


@contextmanager
def whole_file(path: Path, *, exclusive: bool = False) -> Iterator[IO[bytes]]:
    """Yield a file to write; when the block is left without an error, it is on the disk under its name.

    Args:
        path: its name; folders are made.
        exclusive: True to leave a file of that name as it is.

    Raises:
        BadFile: it cannot be written.
    """
    part = path.with_name(f".{path.name}.{worker_name().replace(':', '.')}{PART}")
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        with part.open("wb") as file:
            yield file
            file.flush()
            os.fsync(file.fileno())
        if not exclusive:
            part.replace(path)
        elif not path.exists():
            # Of several programs that begin at once, one wins.
            with suppress(FileExistsError):
                path.hardlink_to(part)
        sync_folder(path.parent)
    except OSError as error:
        raise BadFile(path, f"it cannot be written ({reason_of(error)})", "make room, then go on") from error
    finally:
        if path.parent.is_dir():
            part.unlink(missing_ok=True)
