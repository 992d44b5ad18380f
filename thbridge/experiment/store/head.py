"""The head of a log: the length and chain of the log, and the names of its files.

SQLite writes new rows to a write-ahead log (WAL) and copies them into the database later, at a checkpoint. If the
program is killed, both files are needed. But SQLite combines any two files with these names. For example, if a user
copies another database over the database of a killed program, SQLite applies the old WAL without any notice. Therefore
the head names both files: the database by its digest, the WAL by the random salts that SQLite writes into it at each
restart.

A process may be killed between any two changes of these files. So the head is always written before a file changes: its
name for this file is then `ANY` until the new name is known.
"""

import contextlib
import hashlib
import shlex
import sqlite3
from dataclasses import dataclass
from pathlib import Path
from typing import Final

from thbridge.files.disk.regular_files import content_of, open_regular, size_of
from thbridge.files.disk.whole import write_whole
from thbridge.files.errors import BadFile

ANY: Final = "any"
"""Name in a head that matches any file."""
NONE: Final = "none"
"""Name in a head if there is no write-ahead log, because the log was closed."""

LARGEST_LOG = 1 << 28
"""Largest size of a log and of a write-ahead log, in bytes: about 1000 people with some hundred events each."""
LARGEST_HEAD = 1000
"""Largest size of a head, in bytes."""

_WAL_HEADER = 32
"""Size of a write-ahead log's header, in bytes. The salts are bytes 16 to 23 (SQLite's file format, section 4.1)."""
_WRITE_VERSION, _WITH_WAL = 18, 2
"""Position and value of the header byte of a database that uses a write-ahead log (section 1.3.3)."""


@dataclass(frozen=True, slots=True)
class LogHead:
    """Head of a log: its length, its chain and its files.

    Attributes:
        length: number of events in the log.
        chain: chain of the last event.
        database: SHA-256 of the database in hexadecimal, or `ANY`.
        wal: salts of the write-ahead log in hexadecimal, `ANY`, or `NONE`.
    """

    length: int
    chain: bytes
    database: str = ANY
    wal: str = NONE

    def write(self, log: Path, *, synced: bool = True) -> None:
        """Write the head into the folder of its log.

        Raises:
            BadFile: the head cannot be written.
        """
        line = f"{self.length} {self.chain.hex()} {self.database} {self.wal}"
        write_whole(head_path(log), f"{line} {_sum(line)}\n".encode(), synced=synced)


def head_path(log: Path) -> Path:
    """Return the path of a log's head."""
    return log.with_name(log.name + "-head")


def wal_path(log: Path) -> Path:
    """Return the path of a log's write-ahead log."""
    return log.with_name(log.name + "-wal")


def read_head(log: Path) -> LogHead:
    """Read the head of a log.

    Raises:
        BadFile: the head is missing or damaged.
    """
    head = head_path(log)
    try:
        content = content_of(head, LARGEST_HEAD).decode()
        line, _, checksum = content.removesuffix("\n").rpartition(" ")
        if content != f"{line} {_sum(line)}\n" or checksum != _sum(line):
            raise ValueError
        # Heads of earlier releases do not name the files.
        length, chain, database, wal = (*line.split(), ANY, ANY)[:4]
        return LogHead(int(length), bytes.fromhex(chain), database, wal)
    except (OSError, ValueError):
        raise BadFile(head, "the head of the log is missing or damaged", restore_remedy(log)) from None


def restoring_path(log: Path) -> Path:
    """Return the path of the file that exists while a backup replaces a log."""
    return log.with_name(log.name + "-restoring")


def check_files(log: Path) -> None:
    """Check that the files of a log belong together. Another program may be writing the log.

    Raises:
        BadFile: a restore was interrupted, or the write-ahead log belongs to another log.
    """
    if restoring_path(log).exists():
        again = _restore(log)
        raise BadFile(log, "the restore of this study was interrupted", f"Run it again with the same backup: `{again}`")
    seen = b""
    while True:
        try:
            content = content_of(head_path(log), LARGEST_HEAD)
            if size_of(log) > LARGEST_LOG:
                return
            head = read_head(log)
            wal = wal_name(log)
            foreign = wal is not None and (head.wal not in {ANY, wal} or _is_foreign(_bytes_of(log), head))
        except (OSError, sqlite3.Error, BadFile):
            # `read_log` reports missing or damaged files.
            return
        if not foreign:
            return
        if content == seen:
            problem = f"this file and {wal_path(log).name} do not belong together: one was replaced or changed"
            raise BadFile(log, problem, restore_remedy(log))
        # Another program may have changed a file after the head was read.
        seen = content


def database_name(log: Path) -> str:
    """Return the name of the database in the head. Raises sqlite3.Error."""
    return _name(_bytes_of(log))


def wal_name(log: Path) -> str | None:
    """Return the name of the write-ahead log in the head, or None if it does not exist. Raises OSError, BadFile."""
    with contextlib.suppress(FileNotFoundError), open_regular(wal_path(log)) as file:
        header = file.read(_WAL_HEADER)
        if len(header) == _WAL_HEADER:
            return header[16:24].hex()
    return None


def restore_remedy(log: Path) -> str:
    """Return the remedy for a damaged log, as a clause."""
    return f"Restore the newest backup that `thbridge study status` can read: `{_restore(log)}`"


def _restore(log: Path) -> str:
    return shlex.join(["thbridge", "study", "restore", "BACKUP", "--to", str(log.parent.parent)])


def _is_foreign(database: bytes, head: LogHead) -> bool:
    # A copy made by `copy_log` has no write-ahead log.
    return database[_WRITE_VERSION] != _WITH_WAL or head.database not in {ANY, _name(database)}


def _bytes_of(log: Path) -> bytes:
    """Return the bytes of the database, without its write-ahead log.

    SQLite itself reads the bytes. If this function opened and closed the file, this process would lose its locks.
    """
    uri = f"{log.absolute().as_uri()}?mode=ro&immutable=1"
    with contextlib.closing(sqlite3.connect(uri, uri=True)) as database:
        return database.serialize()


def _name(database: bytes) -> str:
    return hashlib.sha256(database).hexdigest()


def _sum(line: str) -> str:
    return hashlib.sha256(line.encode()).hexdigest()
