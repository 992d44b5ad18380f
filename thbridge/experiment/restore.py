"""Restore of a study from a backup: its log, recordings and files. No earlier file of the study is lost.

The study folder `replaced-N` in the store keeps all replaced files. If a restore is killed, either no file was
replaced, or all commands refuse the study until the restore is run again. If a participant withdrew after the backup,
the restore also deletes their data: the digests of deleted events identify this participant in the backup.
"""

import json
import shutil
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import msgspec

from thbridge.experiment.backup import copy_folder, missing_recordings
from thbridge.experiment.export.manifest import known_exports
from thbridge.experiment.folder import EXPORTS, RECORDINGS, REPLACED, STORE, ExperimentFolder
from thbridge.experiment.store.event_log import (
    copy_log,
    deleted_digests,
    lock_log,
    log_digests,
    read_log,
    replace_log,
)
from thbridge.experiment.store.events import EventKind, LoggedEvent
from thbridge.experiment.store.head import head_path, restoring_path, wal_path
from thbridge.experiment.store.pending_withdrawals import PendingWithdrawal
from thbridge.files.disk.regular_files import content_of
from thbridge.files.disk.synced import make_folder, sync_file, sync_folder
from thbridge.files.disk.whole import write_whole
from thbridge.files.errors import BadFile, reason_of

_LARGEST = 1000
"""Largest size, in bytes, of the file that exists during a restore. This file contains one name."""


@dataclass(frozen=True, slots=True)
class RestorePlan:
    """Plan of a restore.

    Attributes:
        backup: the backup.
        study: the study that the backup replaces.
        events: number of events in the backup.
        damage: reason why the study's own log cannot be used; empty if this log is intact or does not exist.
        newer: number of events in an intact log of the study that are not in the backup.
        withdrawn: participants in the backup who withdrew after the backup.
    """

    backup: ExperimentFolder
    study: ExperimentFolder
    events: int
    damage: str
    newer: int
    withdrawn: tuple[PendingWithdrawal, ...]


def plan_restore(backup: Path, to: Path | None) -> RestorePlan:
    """Return the plan of a restore.

    Args:
        backup: the backup's folder.
        to: the folder of the study. If None, it is the folder that was backed up.

    Raises:
        BadFile: the folder has no complete backup, or the backup cannot be restored to `to`.
    """
    copy = ExperimentFolder(backup)
    if not copy.file.is_file() or not copy.log.exists():
        raise BadFile(backup, "this is not a backup of a study", "Name the folder that `thbridge study backup` wrote")
    entries, digests = read_log(copy.log), log_digests(copy.log)
    study = ExperimentFolder(_origin(copy) if to is None else to)
    _check_place(copy, study)
    damage, own = "", list[bytes]()
    try:
        if study.log.exists() or restoring_path(study.log).exists():
            read_log(study.log)
            own = log_digests(study.log)
    except BadFile as fault:
        damage = str(fault)
    common = next((at for at, pair in enumerate(zip(own, digests, strict=False)) if pair[0] != pair[1]), len(digests))
    deleted = {*study.withdrawn_events.read(), *deleted_digests(study.log)}
    for old in study.replaced():
        deleted.update(deleted_digests(old.log))
    events = [
        (entry.event, digest)
        for entry, digest in zip(entries, digests, strict=True)
        if isinstance(entry, LoggedEvent) and entry.event.participant
    ]
    people = {event.participant for event, digest in events if digest in deleted and event.kind != EventKind.NOTE}
    codes = {
        event.participant: str((event.data or {}).get("code", ""))
        for event, _ in events
        if event.kind == EventKind.RUN_ENDED
    }
    withdrawn = tuple(PendingWithdrawal(each, codes.get(each, "")) for each in sorted(people))
    return RestorePlan(copy, study, len(entries), damage, max(len(own) - common, 0), withdrawn)


def restore(plan: RestorePlan) -> tuple[Path | None, tuple[str, ...]]:
    """Restore a study. Afterwards, withdrawals that are newer than the backup are pending; see `finish_withdrawals`.

    Args:
        plan: result of `plan_restore`.

    Returns:
        The folder with the replaced files, or None if no file was replaced; and sentences about files that are missing
        in the backup.

    Raises:
        BadFile: a program runs the study, the study has changed since the plan was made, or the study cannot be
            written.
    """
    backup, study = plan.backup, plan.study
    try:
        make_folder(study.log.parent)
        with lock_log(study.log):
            if plan_restore(backup.root, study.root) != plan:
                raise BadFile(study.root, "the study was changed during the command", "Run the command again")
            kept = _begun(study) or _keep(study)
            shutil.rmtree(study.restoring, ignore_errors=True)
            make_folder(study.restoring)
            copy_log(backup.log, study.restoring / "log")
            for withdrawal in plan.withdrawn:
                study.pending_withdrawals.add(withdrawal)
            study.backups_known.add(backup.root)
            backup.add_withdrawn_to(study)
            write_whole(restoring_path(study.log), (json.dumps({"kept": kept.root.name}) + "\n").encode())
            replace_log(study.log, study.restoring / "log")
            _keep_files(backup, study, kept)
            without = {(backup.root / name).resolve() for name in (STORE, EXPORTS)}
            lacking = [*copy_folder(backup.root, study.root, backup.root.resolve(), without)]
            shutil.rmtree(study.restoring)
            if not any(path.is_file() for path in kept.root.rglob("*")):
                shutil.rmtree(kept.root)
            restoring_path(study.log).unlink()
            sync_folder(study.log.parent)
    except OSError as error:
        remedy = "Free some space there, or give your account the right to write there. Then run the command again"
        raise BadFile(study.root, f"the study cannot be written ({reason_of(error)})", remedy) from None
    return (kept.root if kept.root.exists() else None), (*lacking, *missing_recordings(study))


def _origin(copy: ExperimentFolder) -> Path:
    places = copy.origins.paths()
    if not places:
        raise BadFile(
            copy.root, "this backup does not contain the path of its study", "Name the study's folder with --to"
        )
    return places[-1]


def _check_place(copy: ExperimentFolder, study: ExperimentFolder) -> None:
    """Raise BadFile if a backup cannot be restored to the folder of this study."""
    one, other = copy.root.resolve(), study.root.resolve()
    if one.is_relative_to(other) or other.is_relative_to(one):
        problem = f"this folder is the backup {copy.root}, or one of the two is inside the other"
        raise BadFile(study.root, problem, "Name another folder with --to")
    if study.root.exists() and not study.root.is_dir():
        raise BadFile(study.root, "this is not a folder", "Name the folder of the study with --to")
    is_study = study.file.exists() or study.log.exists() or restoring_path(study.log).exists()
    if study.root.is_dir() and not is_study and any(path.name != STORE for path in study.root.iterdir()):
        problem = "this folder has files that do not belong to a study"
        raise BadFile(study.root, problem, "Name the folder of the study, or a new or empty folder, with --to")


class _RestoringFile(msgspec.Struct):
    """Content of the file that exists during a restore.

    Attributes:
        kept: name of the folder that keeps the replaced files.
    """

    kept: str


def _begun(study: ExperimentFolder) -> ExperimentFolder | None:
    """Return the folder with the files that an interrupted restore replaced, or None if no restore was interrupted."""
    path = restoring_path(study.log)
    try:
        name = msgspec.json.decode(content_of(path, _LARGEST), type=_RestoringFile).kept
    except FileNotFoundError:
        return None
    except BadFile as fault:
        raise BadFile(path, fault.problem, "Delete this file, and run the command again") from None
    except (ValueError, RecursionError):
        name = ""
    return next((kept for kept in study.replaced() if kept.root.name == name), None) or _keep(study)


def _keep(study: ExperimentFolder) -> ExperimentFolder:
    """Copy the log and the planned files of a study into a new folder `replaced-N`. If this fails, no copy remains."""
    shutil.rmtree(study.restoring, ignore_errors=True)
    part = study.restoring / "kept"
    make_folder(part / STORE)
    logs = (study.log, wal_path(study.log), head_path(study.log))
    if study.log.exists():
        for path in (*(path for path in _files(study) if path.relative_to(study.root).parts[0] != RECORDINGS), *logs):
            if path.is_file():
                other = part / path.relative_to(study.root)
                make_folder(other.parent)
                shutil.copy2(path, other)
                sync_file(other)
                sync_folder(other.parent)
    numbers = [int(old.root.name.removeprefix(REPLACED)) for old in study.replaced()]
    kept = ExperimentFolder(study.log.parent / f"{REPLACED}{max(numbers, default=0) + 1}")
    part.rename(kept.root)
    sync_folder(study.log.parent)
    return kept


def _keep_files(backup: ExperimentFolder, study: ExperimentFolder, kept: ExperimentFolder) -> None:
    """Move replaced files, and recordings that the backup lacks, to the folder for replaced files."""
    for path in [*_files(study)]:
        name = path.relative_to(study.root)
        there = backup.root / name
        if there.is_file() and not path.is_symlink() and _stamp(there) == _stamp(path):
            continue
        if not there.exists() and name.parts[0] != RECORDINGS:
            continue
        other = kept.root / name
        if other.exists():
            # Either `_keep` copied this file, or an interrupted restore moved it.
            path.unlink()
        else:
            make_folder(other.parent)
            shutil.move(path, other)
        if name.parts[0] == RECORDINGS and not any(path.parent.iterdir()):
            path.parent.rmdir()
        for folder in (path.parent, other.parent):
            if folder.is_dir():
                sync_folder(folder)


def _files(study: ExperimentFolder) -> Iterator[Path]:
    """Yield the files of a study, except those of its store and exports."""
    without = {*known_exports(study), (study.root / EXPORTS).resolve(), (study.root / STORE).resolve()}
    folders = [study.root]
    while folders:
        for path in sorted(folders.pop().iterdir()):
            if path.is_dir() and (not path.is_symlink() or path == study.recordings):
                if path.resolve() not in without:
                    folders.append(path)
            else:
                yield path


def _stamp(path: Path) -> tuple[int, int]:
    status = path.stat()
    return status.st_size, status.st_mtime_ns
