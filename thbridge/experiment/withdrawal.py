"""Withdrawal of a participant: deletion of all their data from the log, recordings, exports and known backups.

The store has a list of unfinished withdrawals. A withdrawal is added to the list before the deletion starts, and
removed when everything is deleted. If the program is killed, or a backup cannot be reached, the next command for the
study first finishes the withdrawal.
"""

import itertools
import mmap
import re
import shutil
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from thbridge.experiment.backup import back_up
from thbridge.experiment.conductor import sequences_of
from thbridge.experiment.design.experiment_file import ExperimentDesign
from thbridge.experiment.design.recruiting import digest_of_code
from thbridge.experiment.export.folder import clear_remains, remake_export
from thbridge.experiment.export.manifest import exports_with, known_exports, last_event_of, missing_exports, people_of
from thbridge.experiment.folder import ExperimentFolder
from thbridge.experiment.groups import GROUP, withdrawn_groups
from thbridge.experiment.progress import Progress
from thbridge.experiment.store.event_log import ExperimentLog, deleted_digests, read_log
from thbridge.experiment.store.events import Clocks, LogEntry, LoggedEvent
from thbridge.experiment.store.pending_withdrawals import PendingWithdrawal
from thbridge.files.disk.inside import fault_of_name
from thbridge.files.disk.synced import sync_folder
from thbridge.files.errors import BadFile, reason_of

_ID = re.compile(r"[A-Za-z0-9][A-Za-z0-9_-]{0,63}")
"""Pattern of participants' ids. A folder with a matching name may belong to a participant."""


class NobodyWithdraws(Exception):  # noqa: N818 - people read it as a sentence
    """Request for a withdrawal with an id or code that no participant, or more than one participant, has."""


@dataclass(frozen=True, slots=True)
class WithdrawalPlan:
    """Plan of a withdrawal: all data that will be deleted.

    Attributes:
        withdrawal: the participant and their code.
        log_entries: number of entries of the log to delete.
        recordings: number of the files of the participant and of their groups, and their total size in bytes, by folder
            of recordings.
        exports: exports that will be written again.
        backups: backups that will be updated.
        missing: original folders of exports and backups that no longer exist.
    """

    withdrawal: PendingWithdrawal
    log_entries: int
    recordings: Mapping[Path, tuple[int, int]]
    exports: tuple[Path, ...]
    backups: tuple[Path, ...]
    missing: tuple[Path, ...]


@dataclass(slots=True)
class Withdrawal:
    """Result of a withdrawal, which may be partial.

    Attributes:
        participant: id of the participant.
        code: the participant's completion code; empty if there is none.
        done: sentences about data that were deleted or written again.
        left: sentences about tasks that a person must do.
        failed: sentences about failures. The next command tries again.
    """

    participant: str
    code: str
    done: list[str] = field(default_factory=list)
    left: list[str] = field(default_factory=list)
    failed: list[str] = field(default_factory=list)


def plan_withdrawal(study: ExperimentFolder, design: ExperimentDesign, named: str) -> WithdrawalPlan:
    """Return the plan of a withdrawal.

    Args:
        study: folder of the study.
        design: the study.
        named: the participant's id or completion code. Case and blanks do not matter.

    Raises:
        NobodyWithdraws: no participant, or more than one participant, has this id or code.
        BadFile: the log or a list of folders cannot be read.
    """
    entries = study.entries()
    runs = Progress(design).after(entries).runs
    codes = {run.participant: run.code for run in runs.values()}
    wanted = plain(named)
    known = {*codes, *_people_elsewhere(study)}
    found = [each for each in known if each == named.strip()] or sorted(
        each for each in known if wanted and wanted in {plain(each), plain(codes.get(each, ""))}
    )
    if len(found) != 1:
        raise NobodyWithdraws(named)
    (participant,) = found
    link = ""
    if design.file.recruiting.codes is not None and participant in runs and runs[participant].external_id:
        link = digest_of_code(runs[participant].external_id).hex()
    recordings = {}
    groups = sorted({taken.group for taken in runs[participant].seats.values()}) if participant in runs else []
    for folder, owner in itertools.product((study, *study.replaced()), (participant, *groups)):
        if (path := _recordings(folder, owner)) is not None and path.exists():
            sizes = [file.stat().st_size for file in path.rglob("*") if file.is_file()]
            recordings[path] = (len(sizes), sum(sizes))
    backups = study.backups_known.paths()
    return WithdrawalPlan(
        PendingWithdrawal(participant, codes.get(participant, ""), link),
        len(sequences_of(entries, participant)),
        recordings,
        exports_with(study, participant),
        tuple(path for path in backups if path.is_dir()),
        (*missing_exports(study), *(path for path in backups if not path.is_dir())),
    )


def withdraw(
    study: ExperimentFolder,
    design: ExperimentDesign,
    withdrawal: PendingWithdrawal,
    versions: Mapping[str, str],
    changed: Sequence[str] | None,
    clocks: Callable[[], Clocks],
) -> Withdrawal:
    """Delete all data of a participant. If this is interrupted or fails, `finish_withdrawals` finishes it later.

    Args:
        study: folder of the study; no other program may be running it.
        design: the study.
        withdrawal: the participant who withdraws, and their code.
        versions: versions of the programs, for exports that are written again.
        changed: changes since the study was registered, for these exports. If None, the study was not registered.
        clocks: function that returns the current time.

    Raises:
        BadFile: the log or a list cannot be read or written, or another program runs the study.
    """
    with ExperimentLog(study.log) as log:
        study.pending_withdrawals.add(withdrawal)
        return finish_withdrawal(study, design, log, withdrawal, versions, changed, clocks)


def finish_withdrawals(
    study: ExperimentFolder,
    design: ExperimentDesign,
    versions: Mapping[str, str],
    changed: Sequence[str] | None,
    clocks: Callable[[], Clocks],
) -> list[Withdrawal]:
    """Finish all unfinished withdrawals; see `withdraw`."""
    if not (pending := study.pending_withdrawals.read()):
        return []
    with ExperimentLog(study.log) as log:
        return [finish_withdrawal(study, design, log, each, versions, changed, clocks) for each in pending]


def finish_withdrawal(
    study: ExperimentFolder,
    design: ExperimentDesign,
    log: ExperimentLog,
    withdrawal: PendingWithdrawal,
    versions: Mapping[str, str],
    changed: Sequence[str] | None,
    clocks: Callable[[], Clocks],
) -> Withdrawal:
    """Finish one unfinished withdrawal, with the log open; see `withdraw`."""
    participant = withdrawal.participant
    result = Withdrawal(participant, withdrawal.code)
    known = log.read()
    last = known[-1].sequence if known else 0
    if sequences := sequences_of(known, participant):
        log.delete(sequences, clocks())
    study.withdrawn_events.add(deleted_digests(study.log))
    study.tickets.forget(participant)
    if withdrawal.link:
        study.withdrawn_links.add([bytes.fromhex(withdrawal.link)])
    result.done.append(f"{study.log}: all events of {participant} were deleted.")
    entries = log.read()
    result.left += _named_elsewhere(entries, participant)
    _delete_recordings(study, participant, result)
    _delete_recordings_of_groups(study, entries, result)
    # A killed restore may have left copies of the log.
    shutil.rmtree(study.restoring, ignore_errors=True)
    for old in study.replaced():
        _withdraw_from_replaced(old, result, clocks)
    for export in known_exports(study):
        clear_remains(export)
    for export in exports_with(study, participant):
        if (of := last_event_of(export)) is not None and of > last:
            result.failed.append(
                f"{export}: this export is from a log with {of} events, but the log here has only {last} events. So "
                f"this study is an older copy. The export still has data of {participant}: delete the export, or "
                "withdraw the participant in the newer study, too."
            )
            continue
        _remake(study, design, entries, export, versions, changed, result)
    for export in missing_exports(study):
        result.failed.append(f"{export}: an export was written here, but this folder no longer exists.")
    for backup in study.backups_known.paths():
        if not backup.is_dir():
            result.failed.append(f"{backup}: a backup was written here, but this folder no longer exists.")
            continue
        try:
            result.left += back_up(study, backup)
            result.done.append(f"{backup}: this backup was updated and has no data of {participant}.")
        except BadFile as fault:
            if _may_hold(ExperimentFolder(backup), participant):
                result.failed.append(f"{fault} {backup} may still have data of {participant}.")
            else:
                result.left.append(f"{fault} {backup} has no data of {participant}.")
    if not result.failed:
        study.pending_withdrawals.remove(withdrawal)
    return result


def plain(word: str) -> str:
    """Return an id or code in capitals and without blanks."""
    return "".join(word.split()).upper()


def _people_elsewhere(study: ExperimentFolder) -> Iterator[str]:
    """Yield the ids of participants in recordings, exports, backups and replaced files."""
    backups = [ExperimentFolder(path) for path in study.backups_known.paths()]
    for folder in (study, *backups, *study.replaced()):
        if folder.recordings.is_dir():
            names = (path.name for path in folder.recordings.iterdir() if _ID.fullmatch(path.name))
            yield from (name for name in names if not name.startswith(GROUP))
    for folder in (*backups, *study.replaced()):
        try:
            events = [entry.event for entry in read_log(folder.log) if isinstance(entry, LoggedEvent)]
        except BadFile:
            continue
        yield from (event.participant for event in events if event.participant)
    for export in known_exports(study):
        yield from (each for each in people_of(export) or () if _ID.fullmatch(each))


def _recordings(folder: ExperimentFolder, participant: str) -> Path | None:
    """Return the folder of a participant's recordings. Return None if the id (in a damaged log) is not a valid name.

    Raises:
        BadFile: a link leads out of the folder.
    """
    return None if fault_of_name(participant) else folder.recordings_of(participant)


def _delete_recordings_of_groups(folder: ExperimentFolder, entries: Sequence[LogEntry], result: Withdrawal) -> None:
    """Delete the recordings of games in which people who withdrew played with others."""
    for group in sorted(withdrawn_groups(entries)):
        _delete_recordings(folder, group, result)


def _delete_recordings(folder: ExperimentFolder, owner: str, result: Withdrawal) -> None:
    """Delete the recordings of a participant or group."""
    try:
        recordings = _recordings(folder, owner)
        if recordings is None or not recordings.exists():
            return
        shutil.rmtree(recordings)
        sync_folder(recordings.parent)
    except BadFile as fault:
        result.failed.append(str(fault))
    except OSError as error:
        result.failed.append(
            f"{recordings}: cannot delete this folder ({reason_of(error)}). Delete the folder yourself."
        )
    else:
        result.done.append(f"{recordings}: this folder was deleted.")


def _withdraw_from_replaced(old: ExperimentFolder, result: Withdrawal, clocks: Callable[[], Clocks]) -> None:
    """Delete a participant's data from files that a restore has replaced."""
    _delete_recordings(old, result.participant, result)
    if not old.log.exists():
        return
    try:
        with ExperimentLog(old.log) as log:
            if sequences := sequences_of(log.read(), result.participant):
                log.delete(sequences, clocks())
                result.done.append(f"{old.log}: all events of {result.participant} were deleted.")
            _delete_recordings_of_groups(old, log.read(), result)
    except BadFile as fault:
        if any(_names(path, result.participant) for path in old.log.parent.iterdir() if path.is_file()):
            result.failed.append(
                f"{fault} A restore has replaced this log. The log may have data of {result.participant}: "
                f"copy the data that you need, and delete {old.root}."
            )


def _may_hold(backup: ExperimentFolder, participant: str) -> bool:
    """Return True if a backup has data of a participant or cannot be read."""
    try:
        return bool(sequences_of(read_log(backup.log), participant)) or _has_recordings(backup, participant)
    except BadFile:
        return True


def _has_recordings(folder: ExperimentFolder, participant: str) -> bool:
    path = _recordings(folder, participant)
    return path is not None and path.exists()


def _named_elsewhere(entries: Sequence[LogEntry], participant: str) -> list[str]:
    """Return sentences about other people's events that name a participant. These events are kept."""
    return [
        f"Event {entry.sequence} ({entry.event.kind} of {entry.event.participant}) names {participant}. The log keeps "
        "this event."
        for entry in entries
        if isinstance(entry, LoggedEvent) and participant in repr(entry.event.data)
    ]


def _remake(
    study: ExperimentFolder,
    design: ExperimentDesign,
    entries: Sequence[LogEntry],
    export: Path,
    versions: Mapping[str, str],
    changed: Sequence[str] | None,
    result: Withdrawal,
) -> None:
    if people_of(export) is None:
        result.left.append(
            f"{export}: the manifest.json of this export is missing or damaged. Check whether the export has data of "
            f"{result.participant}, and delete the export."
        )
        return
    try:
        others = remake_export(study, design, entries, export, versions, changed)
    except BadFile as fault:
        result.failed.append(f"{fault} This export may still have data of {result.participant}.")
        return
    result.done.append(f"{export}: this export was written again, without {result.participant}. Run its scripts again.")
    for path in others:
        named = [file for file in (path, *path.rglob("*")) if file.is_file() and _names(file, result.participant)]
        result.left += [
            f"{file} does not belong to the export and names {result.participant}. Delete this file." for file in named
        ]
        if not named:
            result.left.append(
                f"{path} does not belong to the export. Check whether this file has data of {result.participant}."
            )


def _names(file: Path, participant: str) -> bool:
    """Return True if a file contains an id as plain text or cannot be read."""
    try:
        if not file.stat().st_size:
            return False
        with file.open("rb") as opened, mmap.mmap(opened.fileno(), 0, access=mmap.ACCESS_READ) as content:
            return content.find(participant.encode()) >= 0
    except OSError:
        return True
