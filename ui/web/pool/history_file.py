"""History of a game, kept for the next process of the same game, or for the next time that a person has their seat."""

import logging
from collections.abc import Iterator
from pathlib import Path
from typing import Literal

import msgspec

from ui.model.playing.screen import HistoryLine

_log = logging.getLogger(__name__)


class _Line(msgspec.Struct, array_like=True):
    """Line of the file."""

    speaker: Literal["robot", "you", "teammate", "game"]
    robot: int | None
    text: str
    teammate: str = ""


_LINES = msgspec.json.Decoder(_Line)


class HistoryInMemory:
    """History of a game that no other process resumes; it implements `KeptLines`."""

    def __init__(self) -> None:
        self._lines: list[HistoryLine] = []

    def read(self) -> tuple[HistoryLine, ...]:
        """See `KeptLines`."""
        return tuple(self._lines)

    def add(self, line: HistoryLine) -> None:
        """See `KeptLines`."""
        self._lines.append(line)

    def clear(self) -> None:
        """See `KeptLines`."""
        self._lines.clear()


class HistoryFile:
    """File with one line of JSON for each line of a history; it implements `KeptLines`.

    A process that is killed loses no line, because each line is written at once. A disk failure ends no game: people
    then lose only the beginning of the history after a kill.
    """

    def __init__(self, path: Path) -> None:
        self._path = path

    def read(self) -> tuple[HistoryLine, ...]:
        """See `KeptLines`."""
        return tuple(self._read())

    def add(self, line: HistoryLine) -> None:
        """See `KeptLines`."""
        try:
            with self._path.open("ab", buffering=0) as file:
                teammate = (line.teammate,) if line.teammate else ()
                file.write(msgspec.json.encode((line.speaker, line.robot, line.text, *teammate)) + b"\n")
        except OSError as error:
            _log.warning("the history of a game is not kept: %s", error)

    def clear(self) -> None:
        """See `KeptLines`."""
        self._path.unlink(missing_ok=True)

    def _read(self) -> Iterator[HistoryLine]:
        for line in self._path.read_bytes().splitlines() if self._path.exists() else ():
            try:
                kept = _LINES.decode(line)
                yield HistoryLine(kept.speaker, kept.robot, kept.text, kept.teammate)
            except msgspec.MsgspecError:
                return  # The disk was full.
