"""The journal: one file per game, one event per line; each event is on the disk before it is published.

A game that was interrupted by a crash or a power failure is recovered from its journal. The last line may be incomplete
and is then dropped. Damage anywhere else is an error: each line has its length and a checksum, chained to all earlier
lines (`checked_lines`). Journals of 0.1.0 have no checksums, and are read without a check.
"""

import contextlib
import fcntl
import os
import re
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import IO, Self

from thbridge.files.disk.own_links import own_target
from thbridge.files.disk.regular_files import content_of
from thbridge.files.disk.synced import make_folder, put_in_free_place
from thbridge.files.errors import BadFile
from thbridge.hunt.codec import from_json, to_json
from thbridge.hunt.events import DialogueOpened, GameStarted, JournalEntry, JournalOnly
from thbridge.hunt.game import GameState, apply, begin
from thbridge.recording.append import append_whole
from thbridge.recording.checked_lines import DamagedLine, checked, has_sum, verified

_NAME = re.compile(r"game-(\d+)\.jsonl")


@dataclass(frozen=True, slots=True)
class RecoveredGame:
    """A game as read from its journal.

    Attributes:
        started: the first event.
        events: all other events and the utterances, in order.
        state: the state after all events.
        size: bytes of the complete lines of the file, each with its newline.
        checksum: checksum of the last line; None if the journal has no checksums.
        torn: the incomplete last line, which was being written when the program was killed, or None. This line is not
            in `events`.
    """

    started: GameStarted
    events: tuple[JournalEntry, ...]
    state: GameState
    size: int
    checksum: str | None
    torn: bytes | None


def journal_path(folder: Path, game: int) -> Path:
    """Return the path of the journal of a game."""
    return folder / f"game-{game:04d}.jsonl"


def next_game(folder: Path) -> int:
    """Return the number of the next game: one more than the highest number in this folder, or 1."""
    numbers = [int(found.group(1)) for path in folder.glob("game-*.jsonl") if (found := _NAME.fullmatch(path.name))]
    return max(numbers, default=0) + 1


def read_journal(path: Path) -> RecoveredGame:
    """Read a journal, also if it is still being written.

    Raises:
        BadFile: the file cannot be read, does not begin with the start of a game, or has a line that is no event of
            this game. An incomplete last line is no fault.
    """
    try:
        content = content_of(path)
    except OSError as error:
        raise BadFile(path, f"cannot be read ({error.strerror})", "name the journal of a game") from None
    lines, checksum, size, torn = _lines(path, content)
    started: GameStarted | None = None
    state: GameState | None = None
    events: list[JournalEntry] = []
    for number, line in enumerate(lines, start=1):
        try:
            event = from_json(line.decode())
            if state is None:
                if not isinstance(event, GameStarted):
                    raise ValueError("the journal does not begin with the start of a game")
                started, state = event, begin(event)
                continue
            if isinstance(event, GameStarted):
                raise ValueError("a second game starts in the journal of the first game")
            if isinstance(event, DialogueOpened):
                if not (state.has_robot(event.robot) and state.has_room(event.room)):
                    raise ValueError(f"robot {event.robot} or {event.room} does not exist in this game")
            elif not isinstance(event, JournalOnly):
                state = apply(state, event)
        except ValueError as error:
            raise BadFile(path, str(error), _remedy(number), line=number) from None
        events.append(event)
    if started is None or state is None:
        raise BadFile(path, "this journal has no start of a game", "remove the file; nothing is lost")
    return RecoveredGame(started, tuple(events), state, size, checksum, torn)


def _lines(path: Path, content: bytes) -> tuple[list[bytes], str | None, int, bytes | None]:
    """Return the complete lines without checksums, the last checksum, the size of these lines, and a torn last line."""
    whole, newline, torn = content.rpartition(b"\n")
    written = whole.split(b"\n") if newline else []
    size = len(whole) + 1 if newline else 0
    if not any(map(has_sum, [*written, torn])):
        return written, None, size, torn or None
    lines, checksum = [], ""
    for number, line in enumerate(written, start=1):
        try:
            body, checksum = verified(line, checksum)
        except DamagedLine as damage:
            raise BadFile(path, str(damage), _remedy(number), line=number) from None
        lines.append(body)
    # The last line may be complete except for its newline, which may be missing or damaged.
    for candidate in (torn, torn[:-1]):
        with contextlib.suppress(DamagedLine):
            body, checksum = verified(candidate, checksum)
            return [*lines, body], checksum, size + len(candidate) + 1, None
    return lines, checksum, size, torn or None


class Journal:
    """Journal of one game, to which events are appended. The file stays open and locked; call `close` or use `with`."""

    def __init__(self, path: Path, file: IO[bytes]) -> None:
        self.path = path
        self._file = file
        self._checksum: str | None = ""
        self._size = 0

    @classmethod
    def start(cls, folder: Path, started: GameStarted) -> Self:
        """Begin the journal of a new game. If the folder is missing, create it.

        Raises:
            BadFile: a journal with this number already exists, or the new journal cannot be written.
        """
        path = journal_path(folder, started.game)
        # The file gets its name only with its first event, because a journal without events would block the next game.
        part = path.with_name(f".{path.name}.{os.getpid()}.part")
        try:
            make_folder(folder)
            part.unlink(missing_ok=True)
            file = part.open("xb", buffering=0)
        except OSError as error:
            raise _not_writable(path, error) from None
        journal = cls(path, file)
        with contextlib.ExitStack() as unfinished:
            unfinished.callback(part.unlink, missing_ok=True)
            unfinished.callback(journal.close)
            journal._lock()
            journal.append((started,))
            try:
                put_in_free_place(part, path)
            except FileExistsError:
                problem = "the journal of this game already exists"
                raise BadFile(path, problem, "start the game with the next number") from None
            except OSError as error:
                raise _not_writable(path, error) from None
            unfinished.pop_all()
        return journal

    @classmethod
    def resume(cls, path: Path) -> tuple[Self, RecoveredGame]:
        """Resume the journal of an interrupted game: recover the game, and remove an incomplete last line.

        Raises:
            BadFile: as for `read_journal`; or another program is writing the journal.
        """
        try:
            file = own_target(path).open("r+b", buffering=0)
        except OSError as error:
            raise _not_writable(path, error) from None
        journal = cls(path, file)
        try:
            journal._lock()
            recovered = read_journal(path)
            file.truncate(recovered.size)
            file.seek(recovered.size - 1)
            file.write(b"\n")
            journal._checksum = recovered.checksum
            journal._size = recovered.size
            os.fsync(file.fileno())
        except BaseException:
            file.close()
            raise
        return journal, recovered

    def append(self, events: Sequence[JournalEntry]) -> None:
        """Write events, in order. The events are on the disk when the function returns.

        Raises:
            BadFile: the disk is full or unavailable. Lines that were written are then removed again if possible.
        """
        lines, checksum = [], self._checksum
        for event in events:
            line = to_json(event).encode()
            if checksum is not None:
                line, checksum = checked(line.decode(), checksum)
            lines.append(line + b"\n")
        content = b"".join(lines)
        try:
            append_whole(self._file, content, synced=True)
        except OSError as error:
            raise _not_writable(self.path, error) from None
        self._checksum = checksum
        self._size += len(content)

    def rewind(self) -> None:
        """Drop the events that another process has appended; this process is an earlier copy of it."""
        self._file.truncate(self._size)
        self._file.seek(self._size)

    def close(self) -> None:
        """Release the file and its lock. A second call does nothing."""
        self._file.close()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def _lock(self) -> None:
        try:
            fcntl.flock(self._file.fileno(), fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError:
            self._file.close()
            raise BadFile(
                self.path, "another program is writing this journal", "stop the other server, or start a new game"
            ) from None


def _not_writable(path: Path, error: OSError) -> BadFile:
    remedy = "choose a folder that you may write to, on a disk with free space"
    return BadFile(path, f"cannot be written ({error.strerror})", remedy)


def _remedy(line: int) -> str:
    if line == 1:
        return "restore the file from a copy, or start a new game"
    return f"restore the file from a copy, or keep its first {line - 1} lines; later events are then lost"
