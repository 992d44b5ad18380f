"""The log of an experiment: events in an SQLite database, each with a hash over all earlier events.

A row has the event as text, a random salt, the digest of both, and the chain. The chain is the hash of the previous
chain and the row's digest. So the digest reveals a changed row, and the chain reveals a missing, added or moved row.

If the last rows are missing, the remaining rows are consistent. Therefore each append also writes the number of rows
and the last chain to a second file, the head. A log with fewer rows than its head states is incomplete. The head also
names the database and its write-ahead log, so that readers can refuse files from different logs.

A withdrawal deletes the text and the salt of an event, but keeps the digest. So the chain stays valid, and the digest
reveals nothing about the text. A later event of kind WITHDRAWN must list the deleted rows. Otherwise deleted rows count
as damage.

An append returns after its data are on the disk (SQLite's write-ahead log, synchronous=FULL). The log of a rehearsal is
written in batches instead, because a rehearsal can be repeated.
"""

import contextlib
import errno
import fcntl
import hashlib
import itertools
import json
import os
import sqlite3
from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from pathlib import Path
from typing import IO, Self, TypeAlias, cast

from thbridge.experiment.store.decoding import LARGEST_EVENT, BadEvent, decoded
from thbridge.experiment.store.events import (
    WITHDRAWN,
    Clocks,
    JsonValue,
    LogEntry,
    LoggedEvent,
    NewEvent,
    Tombstone,
)
from thbridge.experiment.store.head import (
    ANY,
    LARGEST_HEAD,
    LARGEST_LOG,
    NONE,
    LogHead,
    check_files,
    database_name,
    head_path,
    read_head,
    restore_remedy,
    wal_name,
    wal_path,
)
from thbridge.files.disk.own_links import own_target
from thbridge.files.disk.regular_files import content_of, size_of
from thbridge.files.disk.synced import sync_folder
from thbridge.files.disk.whole import write_whole
from thbridge.files.errors import BadFile, reason_of

BATCH = 256
"""Number of events in a batch of an unsynced log."""

CHECKPOINT = 4 << 20
"""Size of the write-ahead log, in bytes, at which its rows are copied into the database."""

APPLICATION = 0x74686578
"""SQLite's application_id of an experiment's log."""
VERSION = 1
_MOST_STEPS = 1 << 28
"""Maximum number of steps of SQLite's virtual machine for reading a log. The largest log needs a third of this."""
_STEPS_BETWEEN_CHECKS = 1 << 16
_MOST_BYTES_OF_LETTER = 4
_ROOM = 1 << 20
"""Number of bytes below the size limit that are reserved for withdrawals. A withdrawal's transaction needs less."""

_TABLE = """
CREATE TABLE events (
    sequence INTEGER PRIMARY KEY,
    salt BLOB,
    content TEXT,
    digest BLOB NOT NULL,
    chain BLOB NOT NULL
) STRICT
"""
_START = hashlib.sha256(b"thbridge experiment log 1").digest()
_SALT = 16

_Row: TypeAlias = tuple[int, bytes, str, bytes, bytes]

Salts = Callable[[int], bytes]
"""Function that returns a given number of random bytes."""


class ExperimentLog:
    """The log of one experiment, open for appending.

    Only one program at a time can open a log. Close the log, or use it in a `with` statement.

    Args:
        path: path of the database. If the database does not exist, it is created. The head is in the same folder.
        salts: source of the rows' salts.
        synced: False for a log that may be lost if the program crashes, such as the log of a rehearsal. Then events are
            written in groups of `BATCH`, and when the log is closed.

    Raises:
        BadFile: the log cannot be opened or written, another program has opened it, or `read_log` refuses it.
    """

    def __init__(self, path: Path, salts: Salts = os.urandom, *, synced: bool = True) -> None:
        self.path = path
        self._salts = salts
        self._synced = synced
        self._unwritten: list[_Row] = []
        self._database_name = ANY
        self._lock = lock_log(path)
        new = not path.exists()
        if new and head_path(path).exists():
            raise BadFile(path, "the log is missing, but its head exists", restore_remedy(path))
        check_files(path)
        if not new:
            _recover(path)
        # Read the log first: events must never be appended to a damaged log.
        entries = [] if new or _is_just_made(path) else read_log(path)
        try:
            if new:
                _make(path)
            self._database = _opened(path, "rw")
            # A backup copy was written in another mode.
            self._database.execute("PRAGMA journal_mode=WAL")
            self._database.execute(f"PRAGMA synchronous={'FULL' if synced else 'OFF'}")
            # The head must be written before each checkpoint.
            self._database.execute("PRAGMA wal_autocheckpoint=0")
            self._database.execute("PRAGMA journal_size_limit=0")
            self._length, self._chain = len(entries), _last_chain(self._database)
            self._write_head(database_name(path), ANY)
            if any(isinstance(entry, Tombstone) for entry in entries):
                # The program of the withdrawal may have crashed before it rewrote the file.
                self._wipe()
        except (sqlite3.Error, OSError) as error:
            raise BadFile(
                path, f"the log cannot be opened ({_reason(error)})", "Check the disk and the rights of the folder"
            ) from None

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def close(self) -> None:
        """Write all events and close the database.

        Raises:
            BadFile: unwritten events cannot be written. This never happens for a synced log.
        """
        with self._lock:
            try:
                self.flush()
            finally:
                # If there is no space for a new head, the present head is right, too.
                with contextlib.suppress(OSError, BadFile):
                    self._write_head(ANY)
                self._database.close()
                with contextlib.suppress(OSError, BadFile):
                    # If another program reads the log, the write-ahead log is not deleted.
                    if wal_name(self.path) is None:
                        if self._synced:
                            sync_folder(self.path.parent)
                        self._write_head(ANY, NONE)

    def append(self, events: Sequence[NewEvent]) -> list[LoggedEvent]:
        """Append all events or none. For a synced log, they are on the disk when this function returns.

        Raises:
            BadFile: the disk is full or missing. No event was appended.
        """
        logged: list[LoggedEvent] = []
        rows: list[_Row] = []
        chain = self._chain
        for event in events:
            content, salt = _encoded(event), self._salts(_SALT)
            digest = _digest(salt, content)
            chain = _chained(chain, digest)
            logged.append(LoggedEvent(self._length + len(logged) + 1, event))
            rows.append((logged[-1].sequence, salt, content, digest, chain))
        if self._synced:
            self._write(rows)
        self._length, self._chain = self._length + len(rows), chain
        if self._synced:
            self._write_head()
        else:
            self._unwritten += rows
            if len(self._unwritten) >= BATCH:
                self.flush()
        return logged

    def flush(self) -> None:
        """Write all unwritten events. A synced log never has unwritten events.

        Raises:
            BadFile: the disk is full or missing.
        """
        if self._unwritten:
            self._write(self._unwritten)
            self._unwritten = []
            self._write_head()

    def _write(self, rows: Sequence[_Row]) -> None:
        try:
            if self._checkpoint_is_due():
                self._checkpoint()
            with self._transaction():
                self._database.executemany("INSERT INTO events VALUES (?, ?, ?, ?, ?)", rows)
        except (sqlite3.Error, OSError) as error:
            raise self._unwritable(error, sum(len(content) for _, _, content, _, _ in rows)) from None

    def _unwritable(self, error: sqlite3.Error | OSError, size: int) -> BadFile:
        """Return the fault of rows with `size` characters that could not be written: a full disk, or a full log."""
        if _is_full(error):
            (pages,), (page,) = (
                self._database.execute(f"PRAGMA {of}").fetchone() for of in ("page_count", "page_size")
            )
            if pages * page + _MOST_BYTES_OF_LETTER * size + 2 * _ROOM > LARGEST_LOG:
                problem = f"the log is full: a log has at most {LARGEST_LOG} bytes"
                return BadFile(self.path, problem, "End this study, and start another study in a new folder")
        return BadFile(self.path, f"the log cannot be written ({_reason(error)})", "Free some space on the disk")

    def read(self) -> list[LogEntry]:
        """Read the complete log; see `read_log`."""
        self.flush()
        return read_log(self.path)

    def delete(self, sequences: Sequence[int], clocks: Clocks) -> None:
        """Delete the content of events permanently, also in free pages of the file and in the write-ahead log.

        The same transaction appends an event of kind WITHDRAWN with the numbers of the deleted events.

        Raises:
            BadFile: the log cannot be written. In this case, no event was deleted.
        """
        self.flush()
        try:
            # A full log has reserved space for withdrawals.
            _limit(self._database, LARGEST_LOG)
            self._database.execute("PRAGMA secure_delete=ON")
            with self._transaction():
                self._database.executemany(
                    "UPDATE events SET salt = NULL, content = NULL WHERE sequence = ?", [(one,) for one in sequences]
                )
                content, salt = _encoded(_withdrawal(sequences, clocks)), self._salts(_SALT)
                digest = _digest(salt, content)
                row = (self._length + 1, salt, content, digest, _chained(self._chain, digest))
                self._database.execute("INSERT INTO events VALUES (?, ?, ?, ?, ?)", row)
            self._length, self._chain = self._length + 1, row[-1]
            self._write_head()
            self._wipe()
        except sqlite3.Error as error:
            problem = f"the log cannot be written ({_reason(error)})"
            raise BadFile(self.path, problem, "Free some space on the disk") from None
        finally:
            _limit(self._database, LARGEST_LOG - _ROOM)

    def _wipe(self) -> None:
        """Rewrite the file, so that its pages contain no remains of deleted rows."""
        self._write_head(ANY, ANY)
        self._database.execute("VACUUM")
        (blocked, *_) = self._database.execute("PRAGMA wal_checkpoint(TRUNCATE)").fetchone()
        if not blocked:
            self._write_head(database_name(self.path), ANY)
        else:
            raise BadFile(
                self.path,
                "the log cannot be rewritten, because another program reads it",
                "Close this program, and run the command again",
            )

    @contextlib.contextmanager
    def _transaction(self) -> Iterator[None]:
        self._database.execute("BEGIN IMMEDIATE")
        try:
            yield
            self._database.execute("COMMIT")
        except BaseException:
            # If the disk is full, SQLite has already rolled back.
            if self._database.in_transaction:
                self._database.execute("ROLLBACK")
            raise

    def _checkpoint_is_due(self) -> bool:
        try:
            return wal_path(self.path).stat().st_size >= CHECKPOINT
        except FileNotFoundError:
            return False

    def _checkpoint(self) -> None:
        """Copy the write-ahead log into the database, as far as possible without waiting for readers."""
        self._write_head(ANY)
        _, frames, copied = self._database.execute("PRAGMA wal_checkpoint(PASSIVE)").fetchone()
        if frames == copied:
            # The next commit may restart the write-ahead log.
            self._write_head(database_name(self.path), ANY)

    def _write_head(self, database: str | None = None, wal: str | None = None) -> None:
        """Write the head. If `database` is None, its name does not change. If `wal` is None, use the present name."""
        self._database_name = database or self._database_name
        wal = wal or wal_name(self.path) or ANY
        LogHead(self._length, self._chain, self._database_name, wal).write(self.path, synced=self._synced)


def read_log(path: Path) -> list[LogEntry]:
    """Read a log. Another program may be writing the log.

    Raises:
        BadFile: the file is not a log, or a row is missing or was changed, moved or added.
    """
    check_files(path)
    try:
        with contextlib.closing(_opened(path, "ro")) as database:
            return _verified(path, database)
    except (sqlite3.Error, OSError, UnicodeDecodeError) as error:
        problem = f"this file is damaged, or is not the log of an experiment ({_reason(error)})"
        raise BadFile(path, problem, restore_remedy(path)) from None


def copy_log(path: Path, to: Path) -> None:
    """Copy the present log, and verify the copy. Another program may be writing the log. The copy has its own head.

    An existing copy is replaced, unless the copy has events that are not in the log.

    Raises:
        BadFile: the log or the copy is damaged, the copy belongs to another log, or the copy cannot be written.
    """
    read_log(path)
    new = to.with_name(to.name + "-new")
    try:
        _remove(new)
        with contextlib.closing(_opened(path, "ro")) as database, contextlib.closing(sqlite3.connect(new)) as copy:
            if to.exists():
                read_log(to)
                head = read_head(to)
                if _last_chain(database, head.length) != head.chain or _length(database) < head.length:
                    remedy = "Name another folder. This folder was not changed"
                    problem = "this is not an earlier copy of the study's log, or the study was run in this folder"
                    raise BadFile(to, problem, remedy)
            database.backup(copy)
            copy.execute("PRAGMA journal_mode=DELETE")
            LogHead(_length(copy), _last_chain(copy)).write(new)
        read_log(new)
        # The order matters: a head may have fewer events than its log, but never more. But for a first copy, write the
        # head first, because a log without a head counts as damaged.
        order = [(new, to), (head_path(new), head_path(to))]
        for one, other in order if to.exists() else reversed(order):
            one.replace(other)
            sync_folder(to.parent)
    except (sqlite3.Error, OSError) as error:
        raise BadFile(to, f"the copy cannot be written ({_reason(error)})", "Free some space on the disk") from None
    finally:
        with contextlib.suppress(OSError):
            _remove(new)


def replace_log(path: Path, new: Path) -> None:
    """Replace a log by another log that no program has opened.

    The caller must hold the lock of the log, and must create the file of `restoring_path` before. While this file
    exists, `check_files` refuses the log.

    Raises:
        OSError: a file cannot be renamed or deleted.
    """
    # Earlier releases also refuse a log without its head.
    for old in (
        head_path(path),
        wal_path(path),
        path.with_name(path.name + "-shm"),
        path.with_name(path.name + "-journal"),
    ):
        old.unlink(missing_ok=True)
    sync_folder(path.parent)
    for one, other in ((new, path), (head_path(new), head_path(path))):
        one.replace(other)
        sync_folder(path.parent)


def _remove(path: Path) -> None:
    for each in (path, path.with_name(path.name + "-journal"), head_path(path)):
        each.unlink(missing_ok=True)


def _reason(error: Exception) -> str:
    """Return the text of an error. For a full disk, return the system's text instead of SQLite's text."""
    if isinstance(error, OSError):
        return reason_of(error)
    return os.strerror(errno.ENOSPC) if _is_full(error) else str(error)


def _is_full(error: Exception) -> bool:
    """Return True if SQLite has no space for a row, on the disk or within its limit of pages."""
    return isinstance(error, sqlite3.Error) and getattr(error, "sqlite_errorcode", None) == sqlite3.SQLITE_FULL


def log_digests(path: Path) -> list[bytes]:
    """Return the digests of all events of a log, including deleted events. `read_log` must accept the log.

    Raises:
        BadFile: the log cannot be read.
    """
    try:
        with contextlib.closing(_opened(path, "ro")) as database:
            return [bytes(digest) for (digest,) in database.execute("SELECT digest FROM events ORDER BY sequence")]
    except sqlite3.Error as error:
        raise BadFile(path, f"the log cannot be read ({_reason(error)})", restore_remedy(path)) from None


def deleted_digests(path: Path) -> frozenset[bytes]:
    """Return the digests of the events that withdrawals deleted from a log. Ignore unreadable parts of the log."""
    found: set[bytes] = set()
    # The first part of a damaged log is readable. Its write-ahead log may belong to another log.
    for mode in ("ro", "ro&immutable=1"):
        with contextlib.suppress(sqlite3.Error, OSError, BadFile), contextlib.closing(_opened(path, mode)) as database:
            for (digest,) in database.execute("SELECT digest FROM events WHERE content IS NULL ORDER BY sequence"):
                found.add(bytes(digest))
    return frozenset(found)


class LogFollower:
    """Reader of a growing log: it first reads all entries, then only new entries. It verifies them as `read_log` does.

    Args:
        path: path of the log. The log may not exist yet. It is open only during each reading.

    Attributes:
        entries: entries that were read.
    """

    def __init__(self, path: Path) -> None:
        self.entries: list[LogEntry] = []
        self._path = path
        self._chain = _START
        self._head = b""

    def poll(self) -> bool:
        """Read new entries. Return False if there are no new entries; then only one small file is read.

        Raises:
            BadFile: `read_log` refuses the log. The same fault is not raised again until the log changes.
        """
        head = head_path(self._path)
        try:
            now = content_of(head, LARGEST_HEAD)
        except FileNotFoundError:
            now = b""
        except OSError as error:
            problem = f"the file cannot be read ({error.strerror})"
            raise BadFile(head, problem, "Give your account the right to read it") from None
        if now == self._head:
            return False
        self._head = now
        if not self._grown():
            self.entries = read_log(self._path)
            with contextlib.closing(_opened(self._path, "ro")) as database:
                self._chain = _last_chain(database, len(self.entries))
        return True

    def _grown(self) -> bool:
        """Read only the appended entries. Return False if the complete log must be read."""
        known, chain = len(self.entries), self._chain
        entries: list[LoggedEvent] = []
        try:
            head = read_head(self._path)
            with contextlib.closing(_opened(self._path, "ro")) as database:
                if not 0 < known <= head.length or _last_chain(database, known) != chain:
                    return False
                rows = database.execute(
                    "SELECT sequence, salt, content, digest FROM events"
                    " WHERE sequence BETWEEN ? AND ? ORDER BY sequence",
                    (known + 1, head.length),
                ).fetchall()
        except (sqlite3.Error, BadFile):
            return False
        for sequence, salt, content, digest in rows:
            chain = _chained(chain, digest)
            if content is None or salt is None or _digest(salt, content) != digest:
                return False
            try:
                entries.append(LoggedEvent(sequence, decoded(content)))
            except BadEvent:
                return False
        if chain != head.chain or any(entry.event.kind == WITHDRAWN for entry in entries):
            return False
        self.entries, self._chain = [*self.entries, *entries], chain
        return True


def _verified(path: Path, database: sqlite3.Connection) -> list[LogEntry]:
    def damaged(problem: str) -> BadFile:
        return BadFile(path, problem, restore_remedy(path))

    if database.execute("PRAGMA application_id").fetchone() != (APPLICATION,):
        raise damaged("this is not the log of an experiment")
    (version,) = database.execute("PRAGMA user_version").fetchone()
    if version != VERSION:
        problem = f"the log has layout {version}, but this release of thbridge reads only layout {VERSION}"
        raise BadFile(
            path, problem, "Use the release of thbridge that ran the study; freeze.json and methods.md name the release"
        )
    if not _has_our_table(database):
        raise damaged("this is not the log of an experiment: its database schema is different")
    if database.execute("PRAGMA integrity_check").fetchone() != ("ok",):
        raise damaged("the log is damaged: SQLite finds errors in its pages")
    # The head is read before the rows, because another program may append rows at the same time.
    head = read_head(path)
    entries: list[LogEntry] = []
    chain, chains = _START, [_START]
    allowed: set[int] = set()
    for sequence, salt, content, digest, chained in database.execute(
        "SELECT sequence, salt, content, digest, chain FROM events ORDER BY sequence"
    ):
        if sequence != len(entries) + 1:
            raise damaged(f"event {len(entries) + 1} is missing")
        chain = _chained(chain, digest)
        if chained != chain:
            raise damaged(f"event {sequence} was replaced or moved")
        chains.append(chain)
        if content is None and salt is None:
            entries.append(Tombstone(sequence))
            continue
        if content is None or salt is None or _digest(salt, content) != digest:
            raise damaged(f"event {sequence} was changed")
        try:
            event = decoded(content)
        except BadEvent as fault:
            problem = f"event {sequence} is not a valid event of thbridge: {fault}"
            newer = "If a newer release of thbridge ran the study, use this release"
            raise BadFile(path, problem, f"{newer}. {restore_remedy(path)}") from None
        if event.kind == WITHDRAWN:
            allowed.update(cast("list[int]", (event.data or {})["sequences"]))
        entries.append(LoggedEvent(sequence, event))
    if head.length > len(entries) or chains[head.length] != head.chain:
        raise damaged(f"events {len(entries) + 1} to {head.length} are missing")
    for entry in entries:
        if isinstance(entry, Tombstone) and entry.sequence not in allowed:
            raise damaged(f"event {entry.sequence} was deleted without a withdrawal")
    return entries


def _has_our_table(database: sqlite3.Connection) -> bool:
    """Return True if a database has only our table, without views, triggers, indexes or computed columns."""
    schema = database.execute("SELECT type, name, sql FROM sqlite_schema LIMIT 2").fetchall()
    return [(kind, name, str(sql).split()) for kind, name, sql in schema] == [("table", "events", _TABLE.split())]


def _opened(path: Path, mode: str) -> sqlite3.Connection:
    """Open an untrusted database. Its contents cannot run code or use unlimited memory or time.

    Args:
        path: path of the database.
        mode: "ro" to read, "rw" to read and write.
    """
    for file in (path, path.with_name(path.name + "-wal")):
        # Do not open the files here: closing them would release the locks of this process's own connections.
        if file.exists() and size_of(file) > LARGEST_LOG:
            problem = f"the file has more than {LARGEST_LOG} bytes, the largest size of a study's log"
            raise BadFile(file, problem, restore_remedy(path))
    database = sqlite3.connect(f"{path.absolute().as_uri()}?mode={mode}", uri=True, isolation_level=None)
    try:
        database.setlimit(sqlite3.SQLITE_LIMIT_LENGTH, LARGEST_EVENT)
        database.execute("PRAGMA trusted_schema=OFF")
        database.execute("PRAGMA cell_size_check=ON")
        if mode == "ro":
            checks = itertools.count(1)
            database.set_progress_handler(
                lambda: next(checks) * _STEPS_BETWEEN_CHECKS > _MOST_STEPS, _STEPS_BETWEEN_CHECKS
            )
        else:
            # Readers would refuse a larger log.
            _limit(database, LARGEST_LOG - _ROOM)
    except BaseException:
        database.close()
        raise
    return database


def _limit(database: sqlite3.Connection, size: int) -> None:
    """Limit the size of a database, in bytes."""
    (page,) = database.execute("PRAGMA page_size").fetchone()
    database.execute(f"PRAGMA max_page_count={size // page}")


def _make(path: Path) -> None:
    """Create an empty log, completely or not at all."""
    with contextlib.closing(sqlite3.connect(":memory:")) as database:
        for statement in (f"PRAGMA application_id={APPLICATION}", f"PRAGMA user_version={VERSION}", _TABLE):
            database.execute(statement)
        database.commit()
        write_whole(path, database.serialize())


def _recover(path: Path) -> None:
    """Roll back a write that a power cut interrupted. Readers cannot do this. They report any other damage."""
    with contextlib.suppress(BadFile, OSError):
        if (wal := wal_name(path)) is not None:
            # Closing the connection below causes a checkpoint.
            replace(read_head(path), database=ANY, wal=wal).write(path)
    with contextlib.suppress(sqlite3.Error), contextlib.closing(_opened(path, "rw")) as database:
        database.execute("SELECT count(*) FROM sqlite_schema").fetchone()


def _is_just_made(path: Path) -> bool:
    """Return True for a log without a head and events: the program crashed before it wrote the head."""
    if head_path(path).exists():
        return False
    try:
        with contextlib.closing(_opened(path, "ro")) as database:
            return _has_our_table(database) and _length(database) == 0
    except sqlite3.Error:
        return False


def lock_log(path: Path) -> IO[bytes]:
    """Return an open file that locks the log against other programs. The system unlocks it when this program ends.

    Raises:
        BadFile: another program has the log open, or the folder cannot be written.
    """
    try:
        file = own_target(path.with_name(path.name + "-lock")).open("ab")
    except OSError as error:
        raise BadFile(path, f"the log cannot be opened ({_reason(error)})", "Check the rights of the folder") from None
    try:
        fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except OSError:
        file.close()
        raise BadFile(path, "another program runs this study", "Stop that program first") from None
    return file


def _last_chain(database: sqlite3.Connection, sequence: int = 2**62) -> bytes:
    """Return the chain of the last row, or of the last row with a number up to `sequence`."""
    row = database.execute(
        "SELECT chain FROM events WHERE sequence <= ? ORDER BY sequence DESC LIMIT 1", (sequence,)
    ).fetchone()
    return _START if row is None else cast(bytes, row[0])


def _length(database: sqlite3.Connection) -> int:
    (length,) = database.execute("SELECT coalesce(max(sequence), 0) FROM events").fetchone()
    return cast(int, length)


def _digest(salt: bytes, content: str) -> bytes:
    return hashlib.sha256(salt + content.encode()).digest()


def _chained(chain: bytes, digest: bytes) -> bytes:
    return hashlib.sha256(chain + digest).digest()


def _withdrawal(sequences: Sequence[int], clocks: Clocks) -> NewEvent:
    named: list[JsonValue] = list(sequences)
    return NewEvent(WITHDRAWN, "experimenter", clocks, data={"sequences": named})


def _encoded(event: NewEvent) -> str:
    clocks = event.clocks
    whole: dict[str, JsonValue] = {
        "kind": event.kind,
        "actor": event.actor,
        "wall": clocks.wall,
        "monotonic_ns": clocks.monotonic_ns,
        "simulated": clocks.simulated,
        **({} if clocks.lsl is None else {"lsl": clocks.lsl}),
        "participant": event.participant,
        "step": event.step,
        "condition": event.condition,
        "cause": event.cause,
        "data": dict(event.data or {}),
    }
    return json.dumps(whole, ensure_ascii=False, allow_nan=False, separators=(",", ":"))
