"""Markdown of the methods text: paragraphs, lists, tables, and numbers with nouns."""

import statistics
from collections.abc import Iterable, Sequence

Spread = tuple[int, str, str, str]
"""Number of values, median, smallest value, greatest value."""


def paragraph(*sentences: str) -> list[str]:
    """Return the lines of a paragraph with all sentences that are not empty. If all are empty, return no lines."""
    said = " ".join(" ".join(each.split()) for each in sentences if each)
    return [said, ""] if said else []


def listing(items: Iterable[str]) -> list[str]:
    """Return the lines of a list. Without items, return no lines."""
    lines = [f"* {' '.join(item.split())}" for item in items]
    return [*lines, ""] if lines else []


def table(caption: str, header: Sequence[str], rows: Iterable[Sequence[object]]) -> list[str]:
    """Return the lines of a caption and its table. Without rows, return no lines."""
    lines = [_row(row) for row in rows]
    return [f"*{caption}*", "", _row(header), f"|{'---|' * len(header)}", *lines, ""] if lines else []


def _row(cells: Sequence[object]) -> str:
    # Texts of researchers may contain bars and several lines.
    return f"| {' | '.join(' '.join(str(cell).replace('|', chr(92) + '|').split()) for cell in cells)} |"


def counted(number: int, one: str, several: str = "") -> str:
    """Return a number with a noun: "1 item", "2 items"."""
    return f"{number} {one if number == 1 else several or one + 's'}"


def joined(words: Sequence[str], last: str = "and") -> str:
    """Return words as an enumeration: "a, b, and c"."""
    if len(words) < 3:
        return f" {last} ".join(words)
    return f"{', '.join(words[:-1])}, {last} {words[-1]}"


def listed(answers: Iterable[str]) -> str:
    """Return answers as a list in a sentence, without their final periods."""
    return "; ".join(answer.removesuffix(".") for answer in answers)


def sentence(text: str, gap: str) -> str:
    """Return the researcher's text as a sentence with a final period. If the text is empty, return [`gap`]."""
    said = text.strip()
    if not said:
        return f"[{gap}]"
    return said if said[-1] in ".!?]" else f"{said}."


def spread(values: Sequence[float]) -> Spread:
    """Return the number, median, minimum and maximum of times in seconds, as texts."""
    return len(values), f"{statistics.median(values):.0f} s", f"{min(values):.0f} s", f"{max(values):.0f} s"
