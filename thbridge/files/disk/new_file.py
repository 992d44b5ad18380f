"""New files that are written completely or not at all, and never replace another one unasked."""

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
    """Yield the path to write to; when the block is left without an error, the file gets its final name.

    Args:
        path: path of the finished file.
        source: the file that it is made of, which is never overwritten.
        overwrite: True to replace an existing file.

    Raises:
        BadFile: the file exists already, it cannot be written, or a link of another account leads to its folder.
    """
    if path.exists() and source.exists() and path.samefile(source):
        raise BadFile(path, "this is the recording itself", "choose another file by --to")
    if path.exists() and not overwrite:
        remedy = "choose another file by --to, or give --overwrite"
        raise BadFile(path, "there is such a file already", remedy)
    if path.exists() and not path.is_file():
        raise BadFile(path, "this is no file", "choose another name by --to")
    own_target(path.parent)
    part = path.with_name(path.name + UNFINISHED)
    try:
        part.unlink(missing_ok=True)
        yield part
        put_in_place(part, path)
    except OSError as error:
        problem = f"it cannot be written ({reason_of(error)})"
        raise BadFile(path, problem, "choose another place by --to, or make room") from error
    finally:
        with suppress(OSError):  # a folder that nobody may write to has no such file
            part.unlink(missing_ok=True)
