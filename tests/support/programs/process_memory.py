"""Search for words in the memory of another process."""

import re
from collections.abc import Iterable, Iterator
from pathlib import Path

CHUNK = 1 << 16

_REGION = re.compile(r"([0-9a-f]+)-([0-9a-f]+) (\S+)")


def found_in_memory(pid: int, words: Iterable[str]) -> set[str]:
    """Return the words that are anywhere in memory that a process has written, as text with 1, 2 or 4 bytes per letter.

    Args:
        pid: process id.
        words: ASCII words.

    Raises:
        PermissionError: this system forbids reading another process's memory.
    """
    narrow = {word: word.encode("ascii") for word in words}
    widest = 4 * max(map(len, narrow.values()))
    found: set[str] = set()
    with Path(f"/proc/{pid}/mem").open("rb", buffering=0) as memory:
        for start, end in _written(pid):
            for place in range(start, end, CHUNK):
                try:
                    memory.seek(place)
                    # Chunks overlap, so that a word at a boundary is complete in one of them.
                    data = memory.read(min(CHUNK + widest, end - place))
                except OSError:
                    continue  # the memory has just been freed
                # Without zero bytes, text with 2 or 4 bytes per letter equals text with 1 byte per letter, and
                # little memory remains to be searched.
                data = data.translate(None, b"\0")
                found |= {word for word, form in narrow.items() if form in data}
    return found


def _written(pid: int) -> Iterator[tuple[int, int]]:
    """Yield the regions that the process may write to, and that are at least partly in memory or swapped out."""
    region: tuple[int, int] | None = None
    for line in Path(f"/proc/{pid}/smaps").read_text().splitlines():
        head = _REGION.match(line)
        if head is not None:
            region = (int(head[1], 16), int(head[2], 16)) if head[3].startswith("rw") else None
        elif region is not None and line.startswith(("Rss:", "Swap:")) and int(line.split()[1]) > 0:
            yield region
            region = None
