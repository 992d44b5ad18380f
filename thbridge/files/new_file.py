"""Files that appear whole or not at all, and never in the place of another unasked."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from thbridge.files.errors import BadFile, reason_of

UNFINISHED = ".part"
"""Ending of a file while it is written."""


@contextmanager
def new_file(path: Path, source: Path, overwrite: bool) -> Iterator[Path]:
    """Where to write a file; when the block is left without error, it gets its name.

    Args:
        path: of the finished file.
        source: what it is made of; never overwritten.
        overwrite: whether a file of this name may go.

    Raises:
        BadFile: there is such a file, or it cannot be written.
    """
    if path.exists() and source.exists() and path.samefile(source):
        raise BadFile(path, None, None, "this is the recording itself", "choose another file by --out")
    if path.exists() and not overwrite:
        remedy = "choose another file by --out, or give --overwrite"
        raise BadFile(path, None, None, "there is such a file already", remedy)
    part = path.with_name(path.name + UNFINISHED)
    try:
        part.unlink(missing_ok=True)
        yield part
        part.replace(path)
    except OSError as error:
        problem = f"it cannot be written ({reason_of(error)})"
        raise BadFile(path, None, None, problem, "choose another place by --out, or make room") from error
    finally:
        if path.parent.is_dir():
            part.unlink(missing_ok=True)
