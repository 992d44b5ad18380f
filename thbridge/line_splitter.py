"""Split of a byte stream into lines, in bounded memory; all our text protocols consist of lines."""

from __future__ import annotations

from dataclasses import dataclass

LINE_LIMIT = 64 * 1024
"""Length of the longest accepted line, in bytes, without the line feed."""


@dataclass(frozen=True, slots=True)
class OverlongLine:
    """Line that was longer than the limit, so its content was dropped.

    Attributes:
        length: number of bytes before the line feed.
    """

    length: int


class LineSplitter:
    """Splitter of a byte stream into lines, in bounded memory. The stream may arrive in segments of any size.

    A line ends with LF or CRLF. Bytes that are not UTF-8 become U+FFFD. Bytes after the last line feed may be an
    incomplete line, so they are kept for the next call.
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
