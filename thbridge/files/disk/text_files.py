"""Reading of text files that people write."""

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
    if b"\0" in data:
        line = data.count(b"\n", 0, data.index(b"\0")) + 1
        raise BadFile(path, "there is a NUL byte in it", "Check that it is a text file, and take it out", line=line)
    try:
        return data.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        line = data.count(b"\n", 0, error.start) + 1
        problem = f"byte 0x{data[error.start]:02x} is not UTF-8"
        raise BadFile(path, problem, "Save the file with the encoding UTF-8", line=line) from None
