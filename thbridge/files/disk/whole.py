"""Files and folders that are written completely or not at all, and survive a power cut after that."""

import glob
import os
import shutil
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import IO

from thbridge.files.disk.own_links import own_target
from thbridge.files.disk.synced import make_folder, put_in_free_place, put_in_place, sync_file, sync_folder
from thbridge.files.errors import BadFile, reason_of

PART = ".part"
"""Suffix of a file that is being written; the name of this file begins with a dot, so that readers skip it."""

REMEDY = "check the folder and the disk"


@contextmanager
def whole_file(
    path: Path,
    remedy: str = REMEDY,
    *,
    exclusive: bool = False,
    folders: bool = False,
    mode: int | None = None,
    synced: bool = True,
) -> Iterator[IO[bytes]]:
    """Yield a file to write. If the block ends without an error, the file is on the disk under its name.

    An existing file of that name is replaced in one step; links and permissions are kept. Devices and pipes are written
    directly. Links are followed if they belong to this account or to root.

    Args:
        path: path of the file.
        remedy: remedy if the file cannot be written, as a clause.
        exclusive: True to keep an existing file and raise an error.
        folders: True to create missing folders above the file.
        mode: permissions of the file. If None, an existing file keeps its permissions, and a new file gets the usual
            permissions.
        synced: False to let the system decide when the file reaches the disk.

    Raises:
        FileExistsError: the file exists, and `exclusive` is True.
        BadFile: the file cannot be written, or a link of another account leads to it; an existing file is unchanged.
    """
    target, part = own_target(path), None
    try:
        if folders:
            make_folder(target.parent)
        if target.exists() and not target.is_file():
            with target.open("wb") as file:
                yield file
            return
        if mode is None and target.exists():
            mode = target.stat().st_mode & 0o7777
        part = _part_of(target)
        with os.fdopen(os.open(part, os.O_WRONLY | os.O_CREAT | os.O_EXCL, mode or 0o666), "wb") as file:
            if mode is not None:
                part.chmod(mode)  # regardless of the umask
            yield file
        if exclusive:
            put_in_free_place(part, target)
        elif synced:
            put_in_place(part, target)
        else:
            part.replace(target)
    except FileExistsError:
        raise
    except OSError as error:
        raise BadFile(path, f"it cannot be written ({reason_of(error)})", remedy) from error
    finally:
        if part is not None:
            with suppress(OSError):
                part.unlink(missing_ok=True)


def write_whole(path: Path, data: bytes, remedy: str = REMEDY, *, mode: int | None = None, synced: bool = True) -> None:
    """Create or replace the file in one step; see `whole_file`.

    Raises:
        BadFile: the file cannot be written; an existing file is unchanged.
    """
    with whole_file(path, remedy, mode=mode, synced=synced) as file:
        file.write(data)


def clear_parts(path: Path) -> None:
    """Delete unfinished versions of a file, left by killed programs. No program may be writing the file."""
    for part in path.parent.glob(f".{glob.escape(path.name)}.*{PART}"):
        part.unlink(missing_ok=True)


@contextmanager
def new_folder(folder: Path, remedy: str = "choose another folder", *, empty: bool = False) -> Iterator[Path]:
    """Yield a folder to fill. After a block without an error, the contents of this folder are in `folder`.

    Args:
        folder: final path of the folder; missing folders above it are created.
        remedy: remedy if the folder already exists or cannot be written, as a clause.
        empty: True to also fill an existing folder that is empty.

    Raises:
        BadFile: the folder already exists, or cannot be written; the unfinished folder is then deleted.
    """
    own_target(folder)
    there = folder.is_dir() and empty
    if there and next(folder.iterdir(), None) is not None:
        raise BadFile(folder, "this folder is not empty", remedy)
    if not there and (folder.exists() or folder.is_symlink()):
        raise BadFile(folder, "the folder already exists", remedy)
    part = None
    try:
        make_folder(folder.absolute().parent)
        # The folder above an existing folder may not be writable, or may be on another disk.
        part = _part_of(folder / "all" if there else folder)
        part.mkdir()
        yield part
        for path in part.rglob("*"):
            (sync_folder if path.is_dir() else sync_file)(path)
        sync_folder(part)
        if there:
            for path in part.iterdir():
                path.rename(folder / path.name)
        else:
            part.rename(folder)
        sync_folder(folder if there else folder.absolute().parent)
    except BadFile as fault:
        if part is None or not fault.path.is_relative_to(part):
            raise
        named = folder / fault.path.relative_to(part)
        raise BadFile(named, fault.problem, fault.remedy, fault.line, fault.key) from None
    except OSError as error:
        raise BadFile(folder, f"it cannot be written ({reason_of(error)})", remedy) from error
    finally:
        if part is not None:
            shutil.rmtree(part, ignore_errors=True)


def _part_of(path: Path) -> Path:
    """Return a path in the same folder that no other program or thread uses."""
    return path.with_name(f".{path.name}.{os.urandom(4).hex()}{PART}")
