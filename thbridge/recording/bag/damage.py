"""Refusal of files that are not bags, and of bags that are damaged, cut off or still being written."""

import struct
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from rosbags.rosbag1 import ReaderError
from rosbags.serde.errors import SerdeError

from thbridge.files.disk.regular_files import open_regular
from thbridge.files.errors import BadFile
from thbridge.recording.recordings import ACTIVE, unfinished_of

MAGIC = b"#ROSBAG V"
VERSION = b"2.0\n"
MCAP_MAGIC = b"\x89MCAP0\r\n"

_STUMBLES = (
    ReaderError,
    SerdeError,
    AssertionError,
    struct.error,
    ValueError,
    LookupError,
    EOFError,
    OSError,
    MemoryError,
    RuntimeError,
)
"""Errors of rosbags and of its decompressors for damaged files, including failed assertions."""


class TooLargeChunk(ValueError):  # noqa: N818 - it names the fault of a chunk
    """A chunk whose unpacked size is above a limit; the text is the problem as a clause."""


def check_is_bag(path: Path) -> None:
    """Raise BadFile if a file does not begin like a ROS 1 bag.

    Raises:
        BadFile: the file begins differently, cannot be read, or is still being written (as `NAME.active`).
    """
    try:
        with open_regular(path) as file:
            head = file.read(len(MAGIC) + len(VERSION))
    except FileNotFoundError as error:
        if (active := unfinished_of(path)) is not None:
            raise unfinished(active) from error
        raise BadFile(path, "no such file or directory", "name a bag that can be read") from error
    except OSError as error:
        if isinstance(error, IsADirectoryError) and unfinished_of(path) is not None:
            raise unfinished(path) from error
        raise BadFile(path, (error.strerror or str(error)).lower(), "name a bag that can be read") from error
    if head.startswith(MCAP_MAGIC) and path.name.endswith(ACTIVE):
        raise unfinished(path)
    if not head.startswith(MAGIC):
        raise BadFile(path, "this is not a ROS 1 bag", "name a file that rosbag or thbridge recorded")
    if head != MAGIC + VERSION:
        remedy = "convert it with `rosbag fix`, in the ROS release that recorded it"
        raise BadFile(path, "the format of this bag is not version 2.0", remedy)


@contextmanager
def damage_as_bad_file(path: Path) -> Iterator[None]:
    """Convert errors of the parser and the decompressors in the block to BadFile."""
    try:
        yield
    except TooLargeChunk as error:
        remedy = "the bag is forged or damaged; `thbridge bag reindex` saves all other messages"
        raise BadFile(path, str(error), remedy) from error
    except _STUMBLES as error:
        raise damaged(path) from error


def damaged(path: Path) -> BadFile:
    """Return the BadFile for a file that is cut off or damaged."""
    return BadFile(path, "the bag was cut off or is damaged", f"run `thbridge bag reindex {path}`")


def unfinished(path: Path) -> BadFile:
    """Return the BadFile for a file without an index."""
    if path.name.endswith(ACTIVE) or path.is_dir():
        problem = "the bag is still being written, or its writer was killed"
        remedy = f"wait until its session has ended; otherwise run `thbridge bag reindex {path}`"
        return BadFile(path, problem, remedy)
    return BadFile(path, "the bag was cut off, so the index is missing", f"run `thbridge bag reindex {path}`")
