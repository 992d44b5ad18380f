"""A text file that both a program and people edit: read with all its bytes, written completely or not at all."""

import os
import tempfile
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

from thbridge.files.errors import BadFile, reason_of
from thbridge.files.regular_files import open_regular
from thbridge.files.synced import put_in_place
from thbridge.files.yaml.tree import read_text

_MARK = "\ufeff"


@dataclass(frozen=True, slots=True)
class TextOnDisk:
    """The text of a file on disk.

    Attributes:
        text: the text with its own line ends; empty when there is no file.
        exists: True when there is a file.
        marked: True when it begins with a byte order mark.
    """

    text: str
    exists: bool
    marked: bool = False


def read_edited(path: Path) -> TextOnDisk:
    """Read the file.

    Raises:
        BadFile: it cannot be read, or is not UTF-8.
    """
    if not path.exists():
        if not path.parent.is_dir():
            raise BadFile(path, f"there is no folder {path.parent}", "Make it, or choose another name")
        return TextOnDisk("", exists=False)
    text = read_text(path)
    try:
        with open_regular(path) as file:
            marked = file.read(3) == _MARK.encode()
    except OSError:
        marked = False
    return TextOnDisk(text, exists=True, marked=marked)


def write_edited(path: Path, text: str, marked: bool) -> TextOnDisk:
    """Replace the file by a text in one step; links and permissions are kept.

    Raises:
        BadFile: it cannot be written; then the file is unchanged.
    """
    try:
        data = ((_MARK if marked else "") + text).encode()
    except UnicodeEncodeError:
        problem = "it cannot be written (it has signs that are no text)"
        raise BadFile(path, problem, "Check the folder and the disk") from None
    write_whole(path, data)
    return TextOnDisk(text, exists=True, marked=marked)


def write_whole(path: Path, data: bytes, remedy: str = "check the folder and the disk") -> None:
    """Replace the file, or make it, in one step, and outlive a power cut; links and permissions are kept.

    Devices and pipes are written to.

    Raises:
        BadFile: it cannot be written; then the file is unchanged.
    """
    target = path.resolve()
    part = ""
    try:
        if target.exists() and not target.is_file():
            target.write_bytes(data)
            return
        handle, part = tempfile.mkstemp(prefix=f".{target.name}.", dir=target.parent)
        with os.fdopen(handle, "wb") as file:
            file.write(data)
        # Files of mkstemp are readable only by their owner.
        Path(part).chmod(target.stat().st_mode & 0o7777 if target.exists() else 0o666 & ~_umask())
        put_in_place(Path(part), target)
    except OSError as error:
        if part:
            with suppress(OSError):
                Path(part).unlink()
        problem = f"it cannot be written ({reason_of(error)})"
        raise BadFile(path, problem, remedy) from None


def _umask() -> int:
    mask = os.umask(0)
    os.umask(mask)
    return mask
