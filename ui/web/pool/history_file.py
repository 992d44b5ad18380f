"""File with the history of a game, for the next process of the same game."""

import logging
from collections.abc import Iterator
from pathlib import Path
from typing import Literal

import msgspec

from ui.model.playing.screen import HistoryLine

_log = logging.getLogger(__name__)
_LINES = msgspec.json.Decoder(tuple[Literal["robot", "you", "game"], int | None, str])


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
                file.write(msgspec.json.encode((line.speaker, line.robot, line.text)) + b"\n")
        except OSError as error:
            _log.warning("the history of a game is not kept: %s", error)

    def clear(self) -> None:
        """See `KeptLines`."""
        self._path.unlink(missing_ok=True)

    def _read(self) -> Iterator[HistoryLine]:
        for line in self._path.read_bytes().splitlines() if self._path.exists() else ():
            try:
                yield HistoryLine(*_LINES.decode(line))
            except msgspec.MsgspecError:
                return  # The disk was full.
