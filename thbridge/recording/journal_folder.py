"""The journals of all games of one keeper: a folder with one file per game. The last game may be unfinished."""

import logging
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from thbridge.files.disk.regular_files import content_of
from thbridge.files.disk.synced import make_folder
from thbridge.files.disk.whole import write_whole
from thbridge.files.errors import BadFile
from thbridge.hunt.events import GameStarted, JournalEntry
from thbridge.recording.journal import Journal, journal_path, next_game

_FOLDER_NAME = "folder-name"
_log = logging.getLogger(__name__)


@dataclass(frozen=True, slots=True)
class UnfinishedGame:
    """A game that was interrupted.

    Attributes:
        history: its events and utterances, oldest first, beginning with `GameStarted`.
        torn: True when the last event was incomplete and is lost.
    """

    history: tuple[JournalEntry, ...]
    torn: bool


class JournalStore:
    """Store of the events of the keeper's games; one journal is open at a time.

    Args:
        folder: the folder of the journals; created if it is missing.

    Raises:
        BadFile: the folder cannot be created.
    """

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self._journal: Journal | None = None
        try:
            make_folder(folder)
        except OSError as error:
            problem = f"journals cannot be kept here ({error.strerror})"
            raise BadFile(folder, problem, "choose another folder") from None

    @property
    def last_game(self) -> int:
        """Highest number of a game so far; 0 if there is none."""
        return next_game(self.folder) - 1

    def name_of_folder(self, fresh: str) -> str:
        """Return the unique name of the folder; a folder without a name gets the name `fresh`.

        Raises:
            BadFile: the name cannot be read or written.
        """
        path = self.folder / _FOLDER_NAME
        try:
            if not path.exists():
                write_whole(path, fresh.encode())
            return content_of(path, 1000).decode(errors="replace")
        except OSError as error:
            problem = f"cannot be read or written ({error.strerror})"
            raise BadFile(path, problem, "choose a folder that you may write to, on a disk with free space") from None

    def resume(self) -> UnfinishedGame | None:
        """Resume the last game if it has not ended; return None if there is no such game.

        Raises:
            BadFile: the game's journal cannot be read, or another program is writing the journal.
        """
        if self.last_game == 0:
            return None
        journal, recovered = Journal.resume(journal_path(self.folder, self.last_game))
        if recovered.state.ended is not None:
            journal.close()
            if recovered.torn is not None:
                _log.warning("%s: an event was only partly written after the end of its game and is lost", journal.path)
            return None
        self._journal = journal
        return UnfinishedGame((recovered.started, *recovered.events), recovered.torn is not None)

    def append(self, events: Sequence[JournalEntry]) -> None:
        """Write events to the disk, in order; a `GameStarted` begins the next journal.

        Raises:
            BadFile: a journal cannot be written.
        """
        for event in events:
            if isinstance(event, GameStarted):
                self.close()
                self._journal = Journal.start(self.folder, event)
            elif self._journal is not None:
                self._journal.append((event,))

    def rewind(self) -> None:
        """Drop the events that another process has appended to the open journal; this process is an earlier copy."""
        if self._journal is not None:
            self._journal.rewind()

    def close(self) -> None:
        """Close the open journal, if there is one."""
        if self._journal is not None:
            self._journal.close()
            self._journal = None
