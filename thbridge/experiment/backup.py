"""Backups of a study: its log, verified, and its files and recordings, while a program may be running it.

A backup is a study's folder itself, without exports: what can be done with the one can be done with the other.
"""

import shutil
from collections.abc import Iterable, Iterator
from pathlib import Path

from thbridge.experiment.export.manifest import known_exports
from thbridge.experiment.folder import EXPORTS, STORE, ExperimentFolder
from thbridge.experiment.progress import EventKind
from thbridge.experiment.store.event_log import copy_log, read_log
from thbridge.experiment.store.events import LogEntry, LoggedEvent
from thbridge.files.disk.new_file import new_file
from thbridge.files.disk.synced import make_folder
from thbridge.files.errors import BadFile, reason_of
from thbridge.recording.recordings import digest_of


def back_up(study: ExperimentFolder, to: Path) -> tuple[str, ...]:
    """Write a backup, or bring one up to date; the study's folder keeps where it is.

    Of people who are in the log, no recording of the backup is ever deleted; those of others, who withdrew, are.

    Returns:
        Sentences about recordings that are not in the backup as the log has them.

    Raises:
        BadFile: the study's log is damaged, there is something else in the folder, or it cannot be written.
    """
    copy = ExperimentFolder(to)
    if to.resolve().is_relative_to(study.root.resolve()):
        raise BadFile(to, "it is in the study's own folder, and would be lost with it", "Name another by --to")
    try:
        # A backup that a power cut has ended may have the folder of its log alone.
        if to.exists() and not copy.log.exists() and any(path.name != STORE for path in to.iterdir()):
            raise BadFile(
                to, "there is something in this folder that is no backup", "Name a new or an empty one by --to"
            )
        study.backups_known.add(to)
        make_folder(copy.log.parent)
        copy_log(study.log, copy.log)
        people = {entry.event.participant for entry in _events(read_log(copy.log))}
        exports = {*known_exports(study), (study.root / EXPORTS).resolve()}
        for path in _files(study.root, {(study.root / STORE).resolve(), *exports}):
            _copy(path, to / path.relative_to(study.root))
        for folder in copy.recordings.iterdir() if copy.recordings.is_dir() else ():
            if folder.is_dir() and folder.name not in people:
                shutil.rmtree(folder)
    except OSError as error:
        raise BadFile(
            to, f"it cannot be written ({reason_of(error)})", "Make room there, or name another by --to"
        ) from None
    return tuple(_missing(copy))


def holds(backup: ExperimentFolder, participant: str) -> bool:
    """Return True where a backup has data of a person.

    Raises:
        BadFile: its log is damaged.
    """
    own = any(event.event.participant == participant for event in _events(read_log(backup.log)))
    return own or (backup.recordings / participant).exists()


def _events(entries: Iterable[LogEntry]) -> Iterator[LoggedEvent]:
    return (entry for entry in entries if isinstance(entry, LoggedEvent))


def _files(folder: Path, without: set[Path]) -> Iterator[Path]:
    """Yield the files below a folder, but for those in some folders."""
    for path in sorted(folder.iterdir()):
        if path.resolve() in without:
            continue
        if path.is_dir():
            yield from _files(path, without)
        else:
            yield path


def _copy(path: Path, to: Path) -> None:
    """Copy a file whole, unless it was copied before and has not changed since."""
    now = path.stat()
    if to.exists() and (to.stat().st_size, to.stat().st_mtime_ns) == (now.st_size, now.st_mtime_ns):
        return
    make_folder(to.parent)
    with new_file(to, path, overwrite=True) as part:
        shutil.copy2(path, part)


def _missing(copy: ExperimentFolder) -> Iterator[str]:
    for entry in _events(read_log(copy.log)):
        data = entry.event.data or {}
        if entry.event.kind != EventKind.GAME_PLAYED or "bag" not in data:
            continue
        try:
            if digest_of(copy.root / str(data["bag"])) != data.get("sha256"):
                yield f"{data['bag']} is not what was recorded."
        except OSError:
            yield f"{data['bag']} is missing: neither the study nor the backup has it."
