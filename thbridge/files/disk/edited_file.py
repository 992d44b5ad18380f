"""A text file that both a program and people edit.

The file is read with all bytes, and written completely or not at all.
"""

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
        text: the text with its own line ends; empty if there is no file.
        exists: True if there is a file.
        marked: True if the file begins with a byte order mark.
    """

    text: str
    exists: bool
    marked: bool = False


def read_edited(path: Path) -> TextOnDisk:
    """Read the file.

    Raises:
        BadFile: the file cannot be read, or is not UTF-8.
    """
    if not path.exists():
        if not path.parent.is_dir():
            raise BadFile(path, f"folder {path.parent} does not exist", "Create the folder, or choose another name")
        return TextOnDisk("", exists=False)
    text = text_of(path, read_bytes(path))
    try:
        with open_regular(path) as file:
            marked = file.read(3) == _MARK.encode()
    except OSError:
        marked = False
    return TextOnDisk(text, exists=True, marked=marked)


def write_edited(path: Path, text: str, marked: bool) -> TextOnDisk:
    """Replace the content of the file in one step; links and permissions do not change.

    Raises:
        BadFile: the file cannot be written; its content is unchanged.
    """
    try:
        data = ((_MARK if marked else "") + text).encode()
    except UnicodeEncodeError:
        problem = "the text has characters that cannot be written"
        raise BadFile(path, problem, "Delete these characters") from None
    write_whole(path, data)
    return TextOnDisk(text, exists=True, marked=marked)
