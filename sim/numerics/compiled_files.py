"""Files of compiled code, which is run: only their owner can change them, and a damaged one is never loaded."""

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
"""Bytes of the checksum that a file begins with."""
_VERSION = re.compile(r"(?P<module>.+)-[0-9a-f]{16}")
"""Names of the folders of a module's compiled code."""
KEPT_DAYS = 30
"""Days after which compiled code that no program has used is deleted."""
KEPT_VERSIONS = 16
"""How many versions of a module keep their compiled code, those used last; more than will run at the same time."""


@once
def cache_folder() -> Path:
    """Return the folder of all compiled code: the user's own, so that it outlives a checkout and serves them all.

    Where it cannot be written, or others may write there, it is a folder beside the sources, or a temporary one. Its
    name is always `kernels`.
    """
    # Without a home this begins with a tilde, where pathlib raises an exception.
    home = os.path.expanduser("~/.cache")  # noqa: PTH111
    usual = Path(os.environ.get("XDG_CACHE_HOME") or home, "thbridge")
    users = Path(os.environ.get("NUMBA_CACHE_DIR") or usual, "kernels")
    return private_folder((users, ROOT / "sim" / "__pycache__" / "kernels"))


def private_folder(candidates: Iterable[Path]) -> Path:
    """Return the first of the folders that can be written, into which no other account can put code.

    If there is none, it is a folder for temporary files that all programs of this account share, or one that this
    process deletes at its end. A notice names each folder that others can change.
    """
    for folder in (*candidates, Path(gettempdir(), f"thbridge-{os.getuid()}", "kernels")):
        # Without a home the path of a cache begins with a tilde.
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
    """Return the content of a file of compiled code; None if there is none that is intact and this account's own.

    A file that is not is deleted, with a notice, so that its code is compiled again.
    """
    try:
        # No link, and no pipe that is waited for.
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
    """Write a file of compiled code, whole or not at all.

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
    """Note that a program uses what is in a folder, so that it is not deleted."""
    with suppress(OSError):
        os.utime(folder)


def _make_private(folder: Path) -> None:
    """Make a folder and those above it, which only this account can enter, whatever the umask."""
    if not folder.exists():
        _make_private(folder.parent)
        folder.mkdir(mode=stat.S_IRWXU, exist_ok=True)


def _fault_of(folder: Path) -> str | None:
    """Return why another account can change what is in a folder, by one that is above it or by the folder itself.

    As for ssh and sudo, all are this account's or root's; others may write only where nobody can replace what is not
    theirs (the sticky bit of /tmp).
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
    """Return True for a file or folder that no other account can change."""
    return state.st_uid in _TRUSTED and not state.st_mode & (stat.S_IWGRP | stat.S_IWOTH)


def _digest(path: Path, content: bytes) -> bytes:
    """Return the checksum of a file, which is for its name alone."""
    return hashlib.blake2b(path.name.encode() + b"\0" + content, digest_size=_DIGEST).digest()


@once
def _notify(notice: str) -> None:
    """Log a notice once, however many files it is about."""
    _LOGGER.warning(notice)


@once
def _of_this_process() -> TemporaryDirectory[str]:
    return TemporaryDirectory(prefix="thbridge-")


def _tidy(new: Path) -> None:
    """Delete code that was not used for long, and old versions of the module whose folder is new."""
    named = {folder: match["module"] for folder in new.parent.iterdir() if (match := _VERSION.fullmatch(folder.name))}
    used = {folder: folder.stat().st_mtime for folder in named}
    versions = sorted((folder for folder in named if named[folder] == named[new]), key=used.__getitem__)
    unused = {folder for folder, when in used.items() if when < used[new] - KEPT_DAYS * 86400}
    for folder in unused.union(versions[:-KEPT_VERSIONS]):
        shutil.rmtree(folder, ignore_errors=True)
