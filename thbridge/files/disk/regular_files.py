"""Opening of files that users name. Pipes and devices are refused, because reading them could wait or never end."""

import stat
import unicodedata
from pathlib import Path
from typing import BinaryIO

from thbridge.files.errors import BadFile

_KINDS = {
    stat.S_IFIFO: "a pipe",
    stat.S_IFSOCK: "a socket",
    stat.S_IFCHR: "a device",
    stat.S_IFBLK: "a device",
}


def is_regular(path: Path) -> bool:
    """Return True for a file that exists and can be accessed. For an invalid name, return False."""
    try:
        return path.is_file()
    except (OSError, ValueError):
        return False


def as_on_disk(path: Path) -> Path:
    """Return the path of an existing file or folder, spelled as on the disk; other paths are unchanged.

    Letters with marks, such as "ä", are one character (NFC) when people type them, and may be two (NFD) in names that
    were made on macOS. Linux treats these as different names.
    """
    if str(path).isascii() or _is_there(path):
        return path
    found = Path(path.anchor)
    for name in path.parts[bool(path.anchor) :]:
        spelled = found / name
        if not (name.isascii() or _is_there(spelled)):
            composed = unicodedata.normalize("NFC", name)
            try:
                spelled = min(each for each in found.iterdir() if unicodedata.normalize("NFC", each.name) == composed)
            except (OSError, ValueError):
                return path
        found = spelled
    return found


def _is_there(path: Path) -> bool:
    try:
        return path.exists()
    except (OSError, ValueError):
        return False


def size_of(path: Path) -> int:
    """Return the size of a file in bytes, without opening it.

    Raises:
        BadFile: the path is a pipe, a socket or a device, or contains a NUL character.
        OSError: the file does not exist, or cannot be accessed.
    """
    try:
        found = path.stat()
    except ValueError:
        raise BadFile(path, "the name of a file cannot contain a NUL character", "Check the name") from None
    kind = stat.S_IFMT(found.st_mode)
    if kind in _KINDS:
        raise BadFile(path, f"this is {_KINDS[kind]}, not a file", "Save its output to a file, and name that file")
    return found.st_size


def open_regular(path: Path) -> BinaryIO:
    """Open a file for reading.

    Raises:
        BadFile: as for `size_of`.
        OSError: the file cannot be opened.
    """
    size_of(path)
    return path.open("rb")


def content_of(path: Path, largest: int | None = None) -> bytes:
    """Return the content of a file.

    Raises:
        BadFile: as for `open_regular`, or the file is larger than `largest` bytes.
        OSError: the file cannot be read.
    """
    with open_regular(path) as file:
        data = file.read() if largest is None else file.read(largest + 1)
    if largest is not None and len(data) > largest:
        raise BadFile(path, f"the file is larger than {largest} bytes", "Check that this is the right file")
    return data
