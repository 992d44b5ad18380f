"""Reservation of names of recordings for one running program.

A claim is a lock on a small file next to the bag, `.NAME.bag.lock`, which names its owner. The system releases the lock
when the program ends for any reason, so a file without a lock has no effect.
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
"""Lock files of this program, which must stay open."""


def lock_of(bag: Path) -> Path:
    """Return the path of the lock file that belongs to a bag."""
    return bag.with_name(f".{bag.name}.lock")


def claim(bag: Path) -> None:
    """Claim the name of a recording, with its parts, journal and telemetry log; a second claim does nothing.

    Raises:
        BadFile: another running program has claimed the name (the message names this program and the time of the
            claim), or a link of another account leads to its folder.
        OSError: the folder does not exist, or is not writable.
    """
    path = _lock_path(bag)
    if path in _claims:
        return
    while True:
        file = open(path, "a+", encoding="utf-8", opener=_without_links)  # noqa: SIM115 - it stays open
        try:
            fcntl.flock(file.fileno(), fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            file.seek(0)
            owner = file.read().strip() or "another program"
            file.close()
            raise BadFile(bag, f"{owner} is recording there", "choose another name, or wait until that ends") from None
        # The previous owner may have removed the file in the meantime. In this case, the lock is on a deleted file: try
        # again.
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
    """Release the name of a recording; without a claim this does nothing."""
    path = _lock_path(bag)
    file = _claims.pop(path, None)
    if file is not None:
        path.unlink(missing_ok=True)
        file.close()


def _lock_path(bag: Path) -> Path:
    return own_target(bag.parent) / lock_of(bag).name


def _without_links(path: str, flags: int) -> int:
    """Open a lock file; refuse a link. The file is truncated afterwards, and a link could lead to any file."""
    return os.open(path, flags | os.O_NOFOLLOW, 0o666)
