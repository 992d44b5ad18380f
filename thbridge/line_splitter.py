"""Lines of a byte stream, in bounded memory: the framing of all our text protocols."""

from __future__ import annotations

from dataclasses import dataclass

LINE_LIMIT = 64 * 1024
"""Length of the longest accepted line, in bytes before its line feed."""


@dataclass(frozen=True, slots=True)
class OverlongLine:
    """Line longer than the limit; its content was dropped.

    Attributes:
        length: bytes before its line feed.
    """

    length: int


class LineSplitter:
    """Splitter of a byte stream into lines, in bounded memory; the stream may come in segments of any size.

    A line ends with LF or CRLF. Bytes that are not UTF-8 become U+FFFD. Bytes after the last line feed are kept for the
    next call and never returned as a line, because the line may be incomplete.
    """

    def __init__(self, limit: int = LINE_LIMIT) -> None:
        self._limit = limit
        self._held = bytearray()
        self._length = 0

    def feed(self, data: bytes) -> list[str | OverlongLine]:
        """Return the lines that `data` completes, without their line ends."""
        *ended, rest = data.split(b"\n")
        lines: list[str | OverlongLine] = []
        for piece in ended:
            self._extend(piece)
            lines.append(self._finish())
        self._extend(rest)
        return lines

    def _extend(self, piece: bytes) -> None:
        self._length += len(piece)
        if self._length <= self._limit:
            self._held += piece
        else:
            self._held.clear()

    def _finish(self) -> str | OverlongLine:
        length, self._length = self._length, 0
        if length > self._limit:
            return OverlongLine(length)
        line = self._held.removesuffix(b"\r").decode("utf-8", errors="replace")
        self._held.clear()
        return line
