"""Files as a power cut may leave them: what was synced is whole, all else may be torn, empty or garbage.

SQLite promises with synchronous=FULL that a transaction is on the disk when its commit returns. It syncs the
write-ahead log at each commit, and at a checkpoint before it touches the database; the log begins anew only once the
database is synced. So what a power cut can spoil is the log behind the last commit, the index of the log, which is
never synced, and during a checkpoint, which the head announces, pages of the database that the log still has.
"""

import random
import shutil
import sqlite3
from collections.abc import Sequence
from pathlib import Path

_HEADER, _FRAME = 32, 24
"""Bytes at the beginning of a write-ahead log, and of each of its frames (SQLite's file format, section 4.1)."""


def cut_power(folder: Path, chance: random.Random) -> None:
    """Spoil the files of a study whose programs were all killed just now."""
    log = folder / "store" / "log"
    if log.exists():
        _tear_store(log, chance)
    for active in (folder / "recordings").rglob("*.active"):
        content = active.read_bytes()
        active.write_bytes(content[: chance.randrange(len(content) + 1)])
    for inputs in (folder / "recordings").rglob("*.inputs"):
        _tear_inputs(inputs, chance)


def _tear_store(log: Path, chance: random.Random) -> None:
    head, wal = log.with_name("log-head"), log.with_name("log-wal")
    log.with_name("log-shm").unlink(missing_ok=True)
    log.with_name("log-head.new").write_bytes(head.read_bytes()[: chance.randrange(40)] if head.exists() else b"")
    if not wal.exists() or not head.exists():
        return
    content, page = wal.read_bytes(), int.from_bytes(log.read_bytes()[16:18])
    kept = _synced(log, content, page, int(head.read_text().split()[0]))
    unsynced = content[kept:] or content[-(_FRAME + page) :]
    torn = unsynced[: chance.randrange(len(unsynced) + 1)]
    wal.write_bytes(content[:kept] + chance.choice([torn, bytes(len(torn)), chance.randbytes(len(torn))]))
    if head.read_text().split()[2] != "any":
        return
    with log.open("r+b") as database:
        for number in _pages(content[:kept], page):
            if number > 1 and chance.random() < 0.5:
                database.seek((number - 1) * page + page // 2)
                database.write(chance.randbytes(page // 2))


def _tear_inputs(inputs: Path, chance: random.Random) -> None:
    """Tear the log of a game's inputs behind the last line that was synced: the first one, and those with inputs."""
    lines = inputs.read_bytes().splitlines(keepends=True)
    synced = max((n for n, line in enumerate(lines) if n == 0 or b'"inputs":[]' not in line), default=0) + 1
    torn = b"".join(lines[synced:])
    inputs.write_bytes(b"".join(lines[:synced]) + torn[: chance.randrange(len(torn) + 1)])


def _synced(log: Path, content: bytes, page: int, events: int) -> int:
    """Size of the write-ahead log up to the commit of the last event that the head tells of."""
    commits = [at for at, size in _frames(content, page) if size]
    if not commits:
        return min(len(content), _HEADER)
    if len(commits) > 1 and _count(log, content[: commits[-2]]) >= events:
        # The last commit may have been under way: its event was not told to anybody.
        return commits[-2]
    return commits[-1]


def _count(log: Path, wal: bytes) -> int:
    copy = log.parent / "copy" / "log"
    copy.parent.mkdir()
    shutil.copy(log, copy)
    copy.with_name("log-wal").write_bytes(wal)
    database = sqlite3.connect(copy)
    (count,) = database.execute("SELECT count(*) FROM events").fetchone()
    database.close()
    shutil.rmtree(copy.parent)
    return count


def _frames(content: bytes, page: int) -> list[tuple[int, int]]:
    """End of each frame since the log began anew, and the database's size after it where it commits, else 0."""
    found, at = [], _HEADER
    while at + _FRAME + page <= len(content) and content[at + 8 : at + 16] == content[16:24]:
        found.append((at + _FRAME + page, int.from_bytes(content[at + 4 : at + 8])))
        at += _FRAME + page
    return found


def _pages(content: bytes, page: int) -> Sequence[int]:
    """Numbers of the pages that a write-ahead log has."""
    starts = [end - _FRAME - page for end, _ in _frames(content, page)]
    return sorted({int.from_bytes(content[at : at + 4]) for at in starts})
