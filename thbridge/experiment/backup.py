"""Backups of a study: its verified log, its files and recordings. A backup is possible while a program runs the study.

A backup is a study folder without exports. Every command for a study also works with a backup.
"""

import os
import shutil
from collections.abc import Iterable, Iterator
from pathlib import Path

from thbridge.experiment.export.manifest import known_exports
from thbridge.experiment.folder import EXPORTS, RECORDINGS, STORE, ExperimentFolder
from thbridge.experiment.groups import kept_groups
from thbridge.experiment.store.event_log import copy_log, lock_log, read_log
from thbridge.experiment.store.events import EventKind, LogEntry, LoggedEvent
from thbridge.files.disk.new_file import UNFINISHED, new_file
from thbridge.files.disk.synced import make_folder, sync_folder
from thbridge.files.errors import BadFile, reason_of
from thbridge.recording.recordings import digest_of


def back_up(study: ExperimentFolder, to: Path) -> tuple[str, ...]:
    """Write a new backup, or update an existing backup. The study stores the path of the backup's folder.

    The backup keeps all recordings of people in the log. It deletes recordings of people who withdrew. Links to places
    outside the study are not followed, except a link as the folder of recordings.

    Returns:
        Sentences about files that are not in the backup, and about its recordings that differ from the log.

    Raises:
        BadFile: the study's log is damaged, the backup's folder contains other files, a program uses the backup as a
            study, or the backup cannot be written.
    """
    copy, real = ExperimentFolder(to), to.resolve()
    if any(real.is_relative_to(own.resolve()) for own in (study.root, study.recordings)):
        raise BadFile(
            to,
            "a backup inside the study's folder would be lost together with the study",
            "Name another folder with --to",
        )
    try:
        # After a power cut, a backup may have only the folder of its log.
        if to.exists() and not copy.log.exists() and any(path.name != STORE for path in to.iterdir()):
            raise BadFile(
                to, "this folder has files that do not belong to a backup", "Name a new or empty folder with --to"
            )
        make_folder(copy.log.parent)
        with lock_log(copy.log):
            study.backups_known.add(to)
            copy_log(study.log, copy.log)
            copy.origins.add(study.root)
            study.add_withdrawn_to(copy)
            entries = read_log(copy.log)
            owners = {entry.event.participant for entry in _events(entries)} | kept_groups(entries)
            exports = {*known_exports(study), (study.root / EXPORTS).resolve()}
            without = {(study.root / STORE).resolve(), *exports}
            left_out = [*copy_folder(study.root, to, study.root.resolve(), without)]
            for folder in copy.recordings.iterdir() if copy.recordings.is_dir() else ():
                if folder.is_dir() and folder.name not in owners:
                    (Path.unlink if folder.is_symlink() else shutil.rmtree)(folder)
                    sync_folder(copy.recordings)
            return (*left_out, *missing_recordings(copy))
    except OSError as error:
        raise BadFile(
            to,
            f"the backup cannot be written ({reason_of(error)})",
            "Free some space there, or name another folder with --to",
        ) from None


def _events(entries: Iterable[LogEntry]) -> Iterator[LoggedEvent]:
    return (entry for entry in entries if isinstance(entry, LoggedEvent))


def copy_folder(folder: Path, to: Path, within: Path, without: set[Path]) -> Iterator[str]:
    """Copy a folder with its subfolders, and yield sentences about files that are not copied.

    Args:
        folder: folder to copy.
        to: path of the copy.
        within: resolved folder. Links to targets in this folder are copied as links.
        without: resolved folders that are not copied.
    """
    for path in sorted(folder.iterdir()):
        other, real = to / path.name, Path(os.path.realpath(path))
        if real in without or (path.is_symlink() and any(real.is_relative_to(each) for each in without)):
            continue
        # Recordings are large, so their folder may be a link to another disk, in the study or in the backup.
        is_recordings = path.name == RECORDINGS and path.is_dir() and folder.resolve() == within
        if path.is_symlink() and not is_recordings:
            if not real.is_relative_to(within):
                yield (
                    f"{path} is a link to a target outside the study and is not in the backup. Replace the link by a "
                    "copy of its target."
                )
            elif other.is_dir() and not other.is_symlink():
                yield f"{path} is a link, but the backup has a folder {other}. Delete this folder of the backup."
            else:
                _copy_link(os.path.relpath(real, folder.resolve()), other)
        elif path.is_dir():
            if other.is_symlink() and not is_recordings:
                other.unlink()
            yield from copy_folder(path, other, within if real.is_relative_to(within) else real, without)
        elif path.is_file():
            _copy(path, other)
        else:
            yield f"{path} is not a regular file and is not in the backup."


def _copy_link(target: str, to: Path) -> None:
    """Make a link, unless the same link already exists."""
    if to.is_symlink() and str(to.readlink()) == target:
        return
    make_folder(to.parent)
    part = to.with_name(to.name + UNFINISHED)
    part.unlink(missing_ok=True)
    part.symlink_to(target)
    part.replace(to)
    sync_folder(to.parent)


def _copy(path: Path, to: Path) -> None:
    """Copy a complete file, unless the copy has the same size and time."""
    now, there = path.stat(), None if to.is_symlink() or not to.exists() else to.stat()
    if there is not None and (there.st_size, there.st_mtime_ns) == (now.st_size, now.st_mtime_ns):
        return
    make_folder(to.parent)
    with new_file(to, path, overwrite=True) as part:
        shutil.copy2(path, part)


def missing_recordings(copy: ExperimentFolder) -> Iterator[str]:
    """Yield sentences about recordings of a backup that differ from its log."""
    for entry in _events(read_log(copy.log)):
        data = entry.event.data or {}
        if entry.event.kind != EventKind.GAME_PLAYED or "bag" not in data:
            continue
        try:
            if digest_of(copy.bag_named(data["bag"])) != data.get("sha256"):
                yield f"{data['bag']} was changed after recording: its hash differs from the log."
        except BadFile as fault:
            yield str(fault)
        except OSError:
            yield f"{data['bag']} is missing in both the study and the backup."
