"""A text file that both a program and people edit: read with all its bytes, written completely or not at all."""

from dataclasses import dataclass
from pathlib import Path

from thbridge.files.disk.regular_files import open_regular
from thbridge.files.disk.text_files import read_bytes, text_of
from thbridge.files.disk.whole import write_whole
from thbridge.files.errors import BadFile

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
    text = text_of(path, read_bytes(path))
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
