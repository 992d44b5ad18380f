"""Lines of the text files of 2016."""

from pathlib import Path

from thbridge.files.disk.text_files import read_text
from thbridge.files.errors import BadFile

LARGEST_LINES = 1 << 24
"""Maximum size of a file, bytes. Files of 2016 have a few hundred bytes."""


def numbered_lines(path: Path) -> list[tuple[int, str]]:
    """Return the lines that are not empty, stripped, with their numbers from 1."""
    text = read_text(path, LARGEST_LINES)
    # splitlines() is not used: it also splits at characters that editors show within a line, so line numbers would
    # differ.
    numbered = enumerate(text.replace("\r\n", "\n").replace("\r", "\n").split("\n"), start=1)
    return [(number, line.strip()) for number, line in numbered if line.strip()]


def first_line(path: Path, lines: list[tuple[int, str]], key: str, wanted: str) -> tuple[int, str]:
    """Return the first line and its number."""
    if not lines:
        raise BadFile(path, "the file is empty", f"begin the file with {wanted}", line=1, key=key)
    return lines[0]


def count_in(path: Path, number: int, key: str, text: str, least: int) -> int:
    """Return the number that is alone on a line."""
    # isdecimal() and isascii(): int() would also accept signs, underscores, and digits of non-Latin scripts.
    if not (text.isascii() and text.isdecimal()) or len(text) > 6 or int(text) < least:
        raise BadFile(
            path, f"{text!r} is not a number from {least}", f"write only {key} on this line", line=number, key=key
        )
    return int(text)
