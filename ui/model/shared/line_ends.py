"""Line ends of edited texts: unchanged lines keep their line ends, even if these differ within a file."""

import re
from collections import Counter
from collections.abc import Sequence
from difflib import SequenceMatcher

_END = re.compile("\r\n|[\r\n\u2029]")


def plain_lines(text: str) -> str:
    """Return the text with equal line ends, for an editor."""
    return _END.sub("\n", text)


def with_line_ends_of(read: str, shown: str) -> str:
    """Return a text from an editor with the line ends of the text that the editor opened.

    Args:
        read: the text with the original line ends.
        shown: the text from `plain_lines`, possibly edited. New lines get the most frequent line end.
    """
    ends = _END.findall(read)
    usual = Counter(ends).most_common(1)[0][0] if ends else "\n"
    after = shown.split("\n")
    kept = [usual] * len(after)
    if len(set(ends)) > 1:
        matcher = SequenceMatcher(None, _END.split(read), after, autojunk=False)
        for tag, start, end, start_after, end_after in matcher.get_opcodes():
            if tag in ("equal", "replace"):
                for row, line_end in zip(range(start_after, end_after), ends[start:end], strict=False):
                    kept[row] = line_end
    text = _joined(after, kept)
    # A line end \r directly before \n would become the single line end \r\n.
    return text if plain_lines(text) == shown else _joined(after, [usual] * len(after))


def _joined(lines: Sequence[str], ends: Sequence[str]) -> str:
    """Return lines joined by their line ends."""
    return "".join(line + end for line, end in zip(lines, (*ends[:-1], ""), strict=True))
