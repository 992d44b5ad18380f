"""Names of recordings that belong to one running program.

A claim is a lock on a small file beside the bag, `.NAME.bag.lock`, which says whose it is. The system lifts the lock
when its program ends, however it does; a file that is left over means nothing.
"""

import datetime
import fcntl
import os
import sys
from pathlib import Path
from typing import IO

from thbridge.files.disk.own_links import own_target
from thbridge.files.errors import BadFile

_claims: dict[Path, IO[str]] = {}
"""The lock files that this program holds."""


def lock_of(bag: Path) -> Path:
    """Path of the lock file that belongs to a bag."""
    return bag.with_name(f".{bag.name}.lock")


def claim(bag: Path) -> None:
    """Claim the name of a recording, with its parts, journal and telemetry log; to claim it again does nothing.

    Raises:
        BadFile: it belongs to another running program; the message says to which, and since when. Or a link of another
            account leads to its folder.
        OSError: there is no such folder, or it cannot be written.
    """
    path = _lock_path(bag)
    if path in _claims:
        return
    while True:
        file = open(path, "a+", encoding="utf-8", opener=_without_links)  # noqa: SIM115 - it is held
        try:
            fcntl.flock(file.fileno(), fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            file.seek(0)
            owner = file.read().strip() or "another program"
            file.close()
            raise BadFile(bag, f"{owner} is recording there", "choose another name, or wait until it ends") from None
        # Whoever held it before may have removed the file just now: then the lock is on nothing.
        if path.exists() and os.fstat(file.fileno()).st_ino == path.stat().st_ino:
            break
        file.close()
    since = datetime.datetime.now().astimezone().isoformat(sep=" ", timespec="seconds")
    _claims[path] = file
    file.truncate(0)
    file.write(f"process {os.getpid()} ({Path(sys.argv[0]).name}), since {since},\n")
    try:
        file.flush()
    except OSError:
        release(bag)
        raise


def release(bag: Path) -> None:
    """Give the name of a recording free; without a claim this does nothing."""
    path = _lock_path(bag)
    file = _claims.pop(path, None)
    if file is not None:
        path.unlink(missing_ok=True)
        file.close()


def _lock_path(bag: Path) -> Path:
    return own_target(bag.parent) / lock_of(bag).name


def _without_links(path: str, flags: int) -> int:
    """Open a lock file, which is emptied afterwards: a link in its place could lead to any file."""
    return os.open(path, flags | os.O_NOFOLLOW, 0o666)
