"""Lines of the text files of 2016."""

import codecs
from pathlib import Path

from thbridge.files.disk.regular_files import content_of
from thbridge.files.errors import BadFile

LARGEST_LINES = 1 << 24
"""Largest file in bytes; those of 2016 have some hundred."""


def numbered_lines(path: Path) -> list[tuple[int, str]]:
    """The lines that are not empty, stripped, with their numbers from 1."""
    try:
        content = content_of(path, LARGEST_LINES)
    except FileNotFoundError:
        raise BadFile(path, "there is no such file", "add it, or check the name and the folder") from None
    except OSError as error:
        raise BadFile(path, f"cannot be read ({error.strerror})", "make it a file that you may read") from None
    if b"\0" in content and not content.startswith((codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE)):
        line = content.count(b"\n", 0, content.index(b"\0")) + 1
        raise BadFile(path, "there is a NUL byte in it", "check that it is a text file, and take it out", line=line)
    try:
        text = content.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        encoding = "UTF-16" if content.startswith((codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE)) else "Latin-1"
        raise BadFile(
            path,
            f"not UTF-8 text; it was probably saved as {encoding}",
            "open it in an editor and save it with the encoding UTF-8, "
            f"or run: iconv -f {encoding} -t UTF-8 {path.name} > {path.name}.utf8",
            line=content.count(b"\n", 0, error.start) + 1,
        ) from None
    # Not splitlines(): it also splits at characters that editors show within a line, which makes line numbers wrong.
    numbered = enumerate(text.replace("\r\n", "\n").replace("\r", "\n").split("\n"), start=1)
    return [(number, line.strip()) for number, line in numbered if line.strip()]


def first_line(path: Path, lines: list[tuple[int, str]], key: str, wanted: str) -> tuple[int, str]:
    """The first line and its number."""
    if not lines:
        raise BadFile(path, "the file is empty", f"begin it with {wanted}", line=1, key=key)
    return lines[0]


def count_in(path: Path, number: int, key: str, text: str, least: int) -> int:
    """The number that stands alone on a line."""
    # isdecimal() and isascii(): int() would also take signs, underscores and digits of other scripts.
    if not (text.isascii() and text.isdecimal()) or len(text) > 6 or int(text) < least:
        raise BadFile(
            path, f"{text!r} is not a number from {least}", f"write {key} alone on this line", line=number, key=key
        )
    return int(text)
