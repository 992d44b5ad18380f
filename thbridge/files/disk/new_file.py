"""New files that are written completely or not at all, and replace another file only if requested."""

from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from thbridge.files.disk.own_links import own_target
from thbridge.files.disk.synced import put_in_place
from thbridge.files.errors import BadFile, reason_of

UNFINISHED = ".part"
"""Suffix of a file while it is being written."""


@contextmanager
def new_file(path: Path, source: Path, overwrite: bool) -> Iterator[Path]:
    """Yield the path to write to; if the block ends without an error, the file gets its final name.

    Args:
        path: path of the finished file.
        source: file from which the new file is made; it is never overwritten.
        overwrite: True to replace an existing file.

    Raises:
        BadFile: the file already exists or cannot be written, or a link of another account leads to its folder.
    """
    if path.exists() and source.exists() and path.samefile(source):
        raise BadFile(path, "this is the recording itself", "choose another file with --to")
    if path.exists() and not overwrite:
        remedy = "choose another file with --to, or give --overwrite"
        raise BadFile(path, "the file already exists", remedy)
    if path.exists() and not path.is_file():
        raise BadFile(path, "not a regular file", "choose another name with --to")
    own_target(path.parent)
    part = path.with_name(path.name + UNFINISHED)
    try:
        part.unlink(missing_ok=True)
        yield part
        put_in_place(part, path)
    except OSError as error:
        problem = f"it cannot be written ({reason_of(error)})"
        raise BadFile(path, problem, "choose another path with --to, or free some space") from error
    finally:
        with suppress(OSError):  # a folder without write permission has no such file
            part.unlink(missing_ok=True)
