"""The log of an experiment: events in an SQLite database, each chained to all events before it.

A row has the event as text, a random salt, the digest of both, and the chain: the digest of the previous chain and the
row's own digest. So the digest reveals a changed row, and the chain reveals a row that is missing, added or moved. A
log without its last rows would be shorter and still consistent. Therefore, after each append, the number of rows and
the chain are written to a second file, the head; a log that is shorter than its head is incomplete. The head also
names the database and its write-ahead log, so that two files that do not belong together are refused.

A withdrawal deletes an event but keeps its digest, which reveals nothing without the salt, so the chain stays valid. A
later event of kind WITHDRAWN must name the deleted rows; otherwise the gaps count as damage.

Each append is on the disk before it returns (SQLite's write-ahead log, synchronous=FULL). The log of a rehearsal can
be computed again, so it is written in batches instead.
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
"""Number of events that an unsynced log writes together."""

CHECKPOINT = 4 << 20
"""Size of the write-ahead log, in bytes, at which it is copied into the database."""

APPLICATION = 0x74686578
"""SQLite's application_id of an experiment's log."""
VERSION = 1
_MOST_STEPS = 1 << 28
"""Largest number of steps of SQLite's virtual machine for reading a log; the largest log needs a third of them."""
_STEPS_BETWEEN_CHECKS = 1 << 16
_MOST_BYTES_OF_LETTER = 4
_ROOM = 1 << 20
"""Bytes of the largest log that are reserved for withdrawals; more than a transaction needs in addition to its rows."""

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
"""Source of a given number of random bytes."""


class ExperimentLog:
    """The log of one experiment, open for appending.

    Only one program at a time can have it open. Close it, or use it in `with`.

    Args:
        path: path of the database, which is created if it does not exist. The head is next to it.
        salts: source of the rows' salts.
        synced: False for a log that does not have to outlive its program, such as that of a rehearsal: events are
            written in groups of `BATCH`, and when the log is closed.

    Raises:
        BadFile: it cannot be opened or written, another program has it open, or `read_log` refuses it.
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
            raise BadFile(path, "is missing, but its head exists", restore_remedy(path))
        check_files(path)
        if not new:
            _recover(path)
        # Nothing is ever appended to a damaged log.
        entries = [] if new or _is_just_made(path) else read_log(path)
        try:
            if new:
                _make(path)
            self._database = _opened(path, "rw")
            # A copy has been written in another mode.
            self._database.execute("PRAGMA journal_mode=WAL")
            self._database.execute(f"PRAGMA synchronous={'FULL' if synced else 'OFF'}")
            # The head must record each checkpoint in advance.
            self._database.execute("PRAGMA wal_autocheckpoint=0")
            self._database.execute("PRAGMA journal_size_limit=0")
            self._length, self._chain = len(entries), _last_chain(self._database)
            self._write_head(database_name(path), ANY)
            if any(isinstance(entry, Tombstone) for entry in entries):
                # The program that deleted them may have died before it finished.
                self._wipe()
        except (sqlite3.Error, OSError) as error:
            raise BadFile(
                path, f"cannot be opened ({_reason(error)})", "look at the disk and at the folder's rights"
            ) from None

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def close(self) -> None:
        """Write everything into the database file, and close it.

        Raises:
            BadFile: unwritten events cannot be written; this never happens for a synced log.
        """
        with self._lock:
            try:
                self.flush()
            finally:
                # If there is no space for a new head, the last one is still right.
                with contextlib.suppress(OSError, BadFile):
                    self._write_head(ANY)
                self._database.close()
                with contextlib.suppress(OSError, BadFile):
                    # The write-ahead log stays while another program is reading.
                    if wal_name(self.path) is None:
                        if self._synced:
                            sync_folder(self.path.parent)
                        self._write_head(ANY, NONE)

    def append(self, events: Sequence[NewEvent]) -> list[LoggedEvent]:
        """Append all events or none. When this returns, a synced log has them on the disk.

        Raises:
            BadFile: the disk is full or gone; nothing was appended.
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
        """Write the events that are not written yet. A synced log has none.

        Raises:
            BadFile: the disk is full or gone.
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
        """Return the fault of rows of `size` letters that could not be written: a full disk, or a full log."""
        if _is_full(error):
            (pages,), (page,) = (
                self._database.execute(f"PRAGMA {of}").fetchone() for of in ("page_count", "page_size")
            )
            if pages * page + _MOST_BYTES_OF_LETTER * size + 2 * _ROOM > LARGEST_LOG:
                problem = f"is full: a log has at most {LARGEST_LOG} bytes"
                return BadFile(self.path, problem, "End this study, and start another one in a new folder")
        return BadFile(self.path, f"cannot be written ({_reason(error)})", "free some space on the disk")

    def read(self) -> list[LogEntry]:
        """Read the whole log, as `read_log` does."""
        self.flush()
        return read_log(self.path)

    def delete(self, sequences: Sequence[int], clocks: Clocks) -> None:
        """Delete the content of events for good, including free pages of the file and its write-ahead log.

        An event of kind WITHDRAWN with their numbers is appended in the same transaction.

        Raises:
            BadFile: it cannot be written; nothing was deleted.
        """
        self.flush()
        try:
            # A full log still has reserved space for this.
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
            raise BadFile(self.path, f"cannot be written ({_reason(error)})", "free some space on the disk") from None
        finally:
            _limit(self._database, LARGEST_LOG - _ROOM)

    def _wipe(self) -> None:
        """Rewrite the file, without the remains of deleted rows in its pages."""
        self._write_head(ANY, ANY)
        self._database.execute("VACUUM")
        (blocked, *_) = self._database.execute("PRAGMA wal_checkpoint(TRUNCATE)").fetchone()
        if not blocked:
            self._write_head(database_name(self.path), ANY)
        else:
            raise BadFile(
                self.path, "another program reads it, so it cannot be rewritten", "close that program, and try again"
            )

    @contextlib.contextmanager
    def _transaction(self) -> Iterator[None]:
        self._database.execute("BEGIN IMMEDIATE")
        try:
            yield
            self._database.execute("COMMIT")
        except BaseException:
            # If there is no space, SQLite has already rolled back.
            if self._database.in_transaction:
                self._database.execute("ROLLBACK")
            raise

    def _checkpoint_is_due(self) -> bool:
        try:
            return wal_path(self.path).stat().st_size >= CHECKPOINT
        except FileNotFoundError:
            return False

    def _checkpoint(self) -> None:
        """Copy the write-ahead log into the database, as far as readers allow, without waiting for them."""
        self._write_head(ANY)
        _, frames, copied = self._database.execute("PRAGMA wal_checkpoint(PASSIVE)").fetchone()
        if frames == copied:
            # The next commit may restart the write-ahead log.
            self._write_head(database_name(self.path), ANY)

    def _write_head(self, database: str | None = None, wal: str | None = None) -> None:
        """Write the head. If None, the database keeps its name, and the write-ahead log gets its present name."""
        self._database_name = database or self._database_name
        wal = wal or wal_name(self.path) or ANY
        LogHead(self._length, self._chain, self._database_name, wal).write(self.path, synced=self._synced)


def read_log(path: Path) -> list[LogEntry]:
    """Read a log, even while it is being written.

    Raises:
        BadFile: the file is not a log, or a row was changed, moved or added, or is missing.
    """
    check_files(path)
    try:
        with contextlib.closing(_opened(path, "ro")) as database:
            return _verified(path, database)
    except (sqlite3.Error, OSError, UnicodeDecodeError) as error:
        problem = f"is damaged, or is not the log of an experiment ({_reason(error)})"
        raise BadFile(path, problem, restore_remedy(path)) from None


def copy_log(path: Path, to: Path) -> None:
    """Copy a log as it is now, even while a program is writing it. The copy has its own head and is verified.

    An existing copy is replaced, unless it has events that the log does not have.

    Raises:
        BadFile: one of the two is damaged, the copy belongs to another log, or it cannot be written.
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
                    remedy = "Name another folder: nothing was written to this one"
                    problem = "is not an earlier copy of this study's log, or the study was run there"
                    raise BadFile(to, problem, remedy)
            database.backup(copy)
            copy.execute("PRAGMA journal_mode=DELETE")
            LogHead(_length(copy), _last_chain(copy)).write(new)
        read_log(new)
        # In this order, because a head may be behind its log, but never ahead of it. For a first copy, the head comes
        # first: a log without a head always counts as damaged.
        order = [(new, to), (head_path(new), head_path(to))]
        for one, other in order if to.exists() else reversed(order):
            one.replace(other)
            sync_folder(to.parent)
    except (sqlite3.Error, OSError) as error:
        raise BadFile(to, f"cannot be written ({_reason(error)})", "free some space on the disk") from None
    finally:
        with contextlib.suppress(OSError):
            _remove(new)


def replace_log(path: Path, new: Path) -> None:
    """Replace a log by another one that no program has open. Until this is done, `check_files` refuses the log.

    The caller holds the lock of the log, and has created the file of `restoring_path`.

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
    """Return the system's text for errors that SQLite words differently."""
    if isinstance(error, OSError):
        return reason_of(error)
    return os.strerror(errno.ENOSPC) if _is_full(error) else str(error)


def _is_full(error: Exception) -> bool:
    """Return True if SQLite has no space for a row, on the disk or within its limit of pages."""
    return isinstance(error, sqlite3.Error) and getattr(error, "sqlite_errorcode", None) == sqlite3.SQLITE_FULL


def log_digests(path: Path) -> list[bytes]:
    """Return the digests of all events of a log that `read_log` accepts, including deleted ones.

    Raises:
        BadFile: it cannot be read.
    """
    try:
        with contextlib.closing(_opened(path, "ro")) as database:
            return [bytes(digest) for (digest,) in database.execute("SELECT digest FROM events ORDER BY sequence")]
    except sqlite3.Error as error:
        raise BadFile(path, f"cannot be read ({_reason(error)})", restore_remedy(path)) from None


def deleted_digests(path: Path) -> frozenset[bytes]:
    """Return the digests of the events that withdrawals deleted from a log, as far as it can be read."""
    found: set[bytes] = set()
    # A damaged log can be read up to the damage; its write-ahead log may belong to another log.
    for mode in ("ro", "ro&immutable=1"):
        with contextlib.suppress(sqlite3.Error, OSError, BadFile), contextlib.closing(_opened(path, mode)) as database:
            for (digest,) in database.execute("SELECT digest FROM events WHERE content IS NULL ORDER BY sequence"):
                found.add(bytes(digest))
    return frozenset(found)


class LogFollower:
    """Reader of a growing log: it reads all entries at first, then only new ones, verified as in `read_log`.

    Args:
        path: path of the log, which need not exist yet. It is only opened for each reading.

    Attributes:
        entries: entries read so far.
    """

    def __init__(self, path: Path) -> None:
        self.entries: list[LogEntry] = []
        self._path = path
        self._chain = _START
        self._head = b""

    def poll(self) -> bool:
        """Read new entries. Return False if there are none; this only reads one small file.

        Raises:
            BadFile: as for `read_log`; the same fault is not raised again until something changes.
        """
        head = head_path(self._path)
        try:
            now = content_of(head, LARGEST_HEAD)
        except FileNotFoundError:
            now = b""
        except OSError as error:
            raise BadFile(head, f"cannot be read ({error.strerror})", "Give the right to read it") from None
        if now == self._head:
            return False
        self._head = now
        if not self._grown():
            self.entries = read_log(self._path)
            with contextlib.closing(_opened(self._path, "ro")) as database:
                self._chain = _last_chain(database, len(self.entries))
        return True

    def _grown(self) -> bool:
        """Add the appended entries to the known ones; return False if the whole log must be read."""
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
        raise damaged("is not the log of an experiment")
    (version,) = database.execute("PRAGMA user_version").fetchone()
    if version != VERSION:
        problem = f"is a log of layout {version}, but this release of thbridge reads layout {VERSION}"
        raise BadFile(
            path, problem, "Use the release with which the study was run; its freeze.json and methods.md name it"
        )
    if not _has_our_table(database):
        raise damaged("is not the log of an experiment: its schema is different")
    if database.execute("PRAGMA integrity_check").fetchone() != ("ok",):
        raise damaged("is damaged: SQLite finds errors in its pages")
    # The head is read before the rows, because another program may append between the two.
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
            raise damaged(f"event {sequence} is not the one that was written")
        chains.append(chain)
        if content is None and salt is None:
            entries.append(Tombstone(sequence))
            continue
        if content is None or salt is None or _digest(salt, content) != digest:
            raise damaged(f"event {sequence} is not what was written")
        try:
            event = decoded(content)
        except BadEvent as fault:
            problem = f"event {sequence} is not one that thbridge writes: {fault}"
            newer = "Use the release with which the study was run, if it is newer"
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
    """Return True if a database has only our table: no view, trigger, index or computed column that could do harm."""
    schema = database.execute("SELECT type, name, sql FROM sqlite_schema LIMIT 2").fetchall()
    return [(kind, name, str(sql).split()) for kind, name, sql in schema] == [("table", "events", _TABLE.split())]


def _opened(path: Path, mode: str) -> sqlite3.Connection:
    """Open an untrusted database, so that its contents can neither act nor grow without bounds.

    Args:
        path: path of the database.
        mode: "ro" to read it, "rw" to write it as well.
    """
    for file in (path, path.with_name(path.name + "-wal")):
        # The files are not opened here: closing them would release the locks of this process's own connections.
        if file.exists() and size_of(file) > LARGEST_LOG:
            raise BadFile(file, f"is larger than {LARGEST_LOG} bytes, which no log of a study is", restore_remedy(path))
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
            # Nothing is written that would be too large to read again.
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
    """Roll back a write that a power cut interrupted, which readers cannot do. Readers report any damage."""
    with contextlib.suppress(BadFile, OSError):
        if (wal := wal_name(path)) is not None:
            # Closing the connection below causes a checkpoint.
            replace(read_head(path), database=ANY, wal=wal).write(path)
    with contextlib.suppress(sqlite3.Error), contextlib.closing(_opened(path, "rw")) as database:
        database.execute("SELECT count(*) FROM sqlite_schema").fetchone()


def _is_just_made(path: Path) -> bool:
    """Return True for a log without a head and events: its program died before writing the head."""
    if head_path(path).exists():
        return False
    try:
        with contextlib.closing(_opened(path, "ro")) as database:
            return _has_our_table(database) and _length(database) == 0
    except sqlite3.Error:
        return False


def lock_log(path: Path) -> IO[bytes]:
    """Return an open file that locks the log against other programs; the system unlocks it when this program ends.

    Raises:
        BadFile: another program has the log open, or the folder cannot be written.
    """
    try:
        file = own_target(path.with_name(path.name + "-lock")).open("ab")
    except OSError as error:
        raise BadFile(path, f"cannot be opened ({_reason(error)})", "look at the folder's rights") from None
    try:
        fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except OSError:
        file.close()
        raise BadFile(path, "another program runs this study", "Stop that program first") from None
    return file


def _last_chain(database: sqlite3.Connection, sequence: int = 2**62) -> bytes:
    """Return the chain of the last row, or of the last row up to a number."""
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
