"""Files that are there completely or not at all, whatever happens to the program or the machine."""

import os
import socket
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import IO

from thbridge.files.errors import BadFile, reason_of
from thbridge.files.synced import make_folder, put_in_free_place, put_in_place

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
        make_folder(path.parent)
        with part.open("wb") as file:
            yield file
        if not exclusive:
            put_in_place(part, path)
        else:
            with suppress(FileExistsError):
                put_in_free_place(part, path)
    except OSError as error:
        raise BadFile(path, f"it cannot be written ({reason_of(error)})", "make room, then go on") from error
    finally:
        if path.parent.is_dir():
            part.unlink(missing_ok=True)
