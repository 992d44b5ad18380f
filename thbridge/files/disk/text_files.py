"""Reading of text files that people write."""

import codecs
from pathlib import Path

from thbridge.files.disk.regular_files import content_of
from thbridge.files.errors import BadFile

LARGEST_FILE = 1 << 20
"""Largest file in bytes; files of people have some thousand."""


def read_text(path: Path, largest: int = LARGEST_FILE) -> str:
    """Read the text of a file that people write.

    Raises:
        BadFile: it is missing, not a file, larger than `largest` bytes, or not UTF-8.
    """
    try:
        data = content_of(path, largest)
    except FileNotFoundError:
        raise BadFile(path, "there is no such file", "Check the name and the folder") from None
    except OSError as error:
        raise BadFile(path, f"it cannot be read ({error.strerror})", "Check that it is a file") from None
    is_utf16 = data.startswith((codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE))
    if b"\0" in data and not is_utf16:
        line = data.count(b"\n", 0, data.index(b"\0")) + 1
        raise BadFile(path, "there is a NUL byte in it", "Check that it is a text file, and take it out", line=line)
    try:
        return data.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        line = data.count(b"\n", 0, error.start) + 1
        encoding = "UTF-16" if is_utf16 else "Latin-1"
        problem = f"byte 0x{data[error.start]:02x} is not UTF-8; it was probably saved as {encoding}"
        remedy = (
            "Save the file with the encoding UTF-8 in an editor, "
            f"or run: iconv -f {encoding} -t UTF-8 {path.name} > {path.name}.utf8"
        )
        raise BadFile(path, problem, remedy, line=line) from None
