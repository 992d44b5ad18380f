"""Files of compiled code. They are executed, so only their owner may change them, and damaged files are not loaded."""

import hashlib
import logging
import os
import re
import shutil
import stat
from collections.abc import Iterable
from contextlib import suppress
from functools import cache as once
from pathlib import Path
from tempfile import NamedTemporaryFile, TemporaryDirectory, TemporaryFile, gettempdir

from sim.numerics.sources import ROOT

_LOGGER = logging.getLogger(__name__)
_DIGEST = 32
"""Length of the checksum at the start of a file, bytes."""
_VERSION = re.compile(r"(?P<module>.+)-[0-9a-f]{16}")
"""Pattern of the names of folders with a module's compiled code."""
KEPT_DAYS = 30
"""Days after which unused compiled code is deleted."""
KEPT_VERSIONS = 16
"""Maximum number of stored versions of a module. The most recently used versions are kept."""


@once
def cache_folder() -> Path:
    """Return the folder of all compiled code. It belongs to the user, so all checkouts share it.

    If this account cannot write to it, or other accounts can, return a folder next to the sources or a temporary
    folder. The folder's name is always `kernels`.
    """
    # Without a home directory, the result starts with a tilde, while pathlib would raise an exception.
    home = os.path.expanduser("~/.cache")  # noqa: PTH111
    usual = Path(os.environ.get("XDG_CACHE_HOME") or home, "thbridge")
    users = Path(os.environ.get("NUMBA_CACHE_DIR") or usual, "kernels")
    return private_folder((users, ROOT / "sim" / "__pycache__" / "kernels"))


def private_folder(candidates: Iterable[Path]) -> Path:
    """Return the first folder that only this account can change.

    If there is no such folder, try a temporary folder that all programs of this account share. If that fails too,
    return a folder that this process deletes when it ends. A notice names each folder that other accounts can change.
    """
    for folder in (*candidates, Path(gettempdir(), f"thbridge-{os.getuid()}", "kernels")):
        # Without a home directory, the path of a cache starts with a tilde and is not absolute.
        if folder.is_absolute():
            with suppress(OSError):
                _make_private(folder)
                TemporaryFile(dir=folder).close()
                fault = _fault_of(folder)
                if fault is None:
                    return folder.resolve()
                _notify(f"Compiled code is not kept in {folder}: {fault}.")
    own = Path(_of_this_process().name, "kernels")
    _make_private(own)
    return own


def read(path: Path) -> bytes | None:
    """Return the content of a file of compiled code, or None if it does not exist, is damaged, or is not private.

    A file that is damaged or that other accounts can change is deleted with a notice, so that its code is compiled
    again.
    """
    try:
        # Do not follow links, which may lead to files of other accounts, and do not wait for pipes.
        with open(path, "rb", opener=lambda name, _: os.open(name, os.O_NOFOLLOW | os.O_NONBLOCK)) as file:
            is_private = _is_private(path.parent.lstat()) and _is_private(os.fstat(file.fileno()))
            digest, content = file.read(_DIGEST), file.read()
    except OSError:
        return None
    if is_private and digest == _digest(path, content):
        return content
    kept = path.parent.parent
    fault = "is damaged" if is_private else "could be changed by other accounts"
    _notify(f"Compiled code in {kept} {fault}. It is compiled again.")
    with suppress(OSError):
        if is_private:
            path.unlink()
        else:
            shutil.rmtree(path.parent)
    return None


def write(path: Path, content: bytes) -> None:
    """Write a file of compiled code. After an interruption, no incomplete file remains.

    Raises:
        OSError: it cannot be written.
    """
    make_folder(path.parent)
    with NamedTemporaryFile(dir=path.parent, delete=False) as file:
        try:
            file.write(_digest(path, content) + content)
            file.flush()
            os.fsync(file.fileno())
            Path(file.name).replace(path)
        except BaseException:
            Path(file.name).unlink(missing_ok=True)
            raise


def make_folder(folder: Path) -> None:
    """Make the folder of a module's compiled code, and delete old versions of it.

    Raises:
        OSError: it cannot be made.
    """
    if not folder.exists():
        _make_private(folder)
        _tidy(folder)


@once
def mark_used(folder: Path) -> None:
    """Record that a program uses the content of a folder, so that it is not deleted."""
    with suppress(OSError):
        os.utime(folder)


def _make_private(folder: Path) -> None:
    """Make a folder and its parents so that only this account can enter them, regardless of the umask."""
    if not folder.exists():
        _make_private(folder.parent)
        folder.mkdir(mode=stat.S_IRWXU, exist_ok=True)


def _fault_of(folder: Path) -> str | None:
    """Return the reason why another account could change a folder's content or a parent; None if this is impossible.

    As ssh and sudo require, all folders must belong to this account or to root. Others may write only where they cannot
    replace files of other accounts (the sticky bit of /tmp).
    """
    real = folder.resolve()
    for level in (*reversed(folder.parents), folder, *reversed(real.parents), real):
        state = level.lstat()
        if state.st_uid not in _TRUSTED:
            return f"{level} belongs to another account"
        is_sticky = state.st_mode & stat.S_ISVTX and level not in (folder, real)
        if not stat.S_ISLNK(state.st_mode) and not is_sticky and not _is_private(state):
            return f"other accounts can write to {level} (chmod go-w {level})"
    return None


_TRUSTED = {os.getuid(), 0}


def _is_private(state: os.stat_result) -> bool:
    """Return True if no other account can change a file or folder."""
    return state.st_uid in _TRUSTED and not state.st_mode & (stat.S_IWGRP | stat.S_IWOTH)


def _digest(path: Path, content: bytes) -> bytes:
    """Return the checksum of a file. It includes the name, so that a renamed file is not accepted."""
    return hashlib.blake2b(path.name.encode() + b"\0" + content, digest_size=_DIGEST).digest()


@once
def _notify(notice: str) -> None:
    """Log a notice only once, even if it applies to many files."""
    _LOGGER.warning(notice)


@once
def _of_this_process() -> TemporaryDirectory[str]:
    return TemporaryDirectory(prefix="thbridge-")


def _tidy(new: Path) -> None:
    """Delete code that has not been used for a long time, and old versions of the new folder's module."""
    named = {folder: match["module"] for folder in new.parent.iterdir() if (match := _VERSION.fullmatch(folder.name))}
    used = {folder: folder.stat().st_mtime for folder in named}
    versions = sorted((folder for folder in named if named[folder] == named[new]), key=used.__getitem__)
    unused = {folder for folder, when in used.items() if when < used[new] - KEPT_DAYS * 86400}
    for folder in unused.union(versions[:-KEPT_VERSIONS]):
        shutil.rmtree(folder, ignore_errors=True)
