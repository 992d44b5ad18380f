"""Withdrawal of a participant: all their data is deleted from the study's log, recordings, exports and known backups.

The withdrawal enters a list in the store before anything is deleted, and leaves it when all is deleted. So a
withdrawal that was killed, or could not reach a backup, is finished later: each command of a study first finishes it.
"""

import mmap
import re
import shutil
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from thbridge.experiment.backup import back_up
from thbridge.experiment.conductor import sequences_of
from thbridge.experiment.design.experiment_file import ExperimentDesign
from thbridge.experiment.export.folder import clear_remains, remake_export
from thbridge.experiment.export.manifest import exports_with, known_exports, last_event_of, missing_exports, people_of
from thbridge.experiment.folder import ExperimentFolder
from thbridge.experiment.progress import Progress
from thbridge.experiment.store.event_log import ExperimentLog, deleted_digests, read_log
from thbridge.experiment.store.events import Clocks, LogEntry, LoggedEvent
from thbridge.experiment.store.pending_withdrawals import PendingWithdrawal
from thbridge.files.disk.inside import fault_of_name
from thbridge.files.disk.synced import sync_folder
from thbridge.files.errors import BadFile, reason_of

_ID = re.compile(r"[A-Za-z0-9][A-Za-z0-9_-]{0,63}")
"""Id of a participant, used where only the name of a folder suggests one."""


class NobodyWithdraws(Exception):  # noqa: N818 - people read it as a sentence
    """A withdrawal of a participant with an id or code that the study does not have."""


@dataclass(frozen=True, slots=True)
class WithdrawalPlan:
    """Plan of a withdrawal: everything that it will delete.

    Attributes:
        withdrawal: the participant with their code.
        log_entries: number of entries of the log to delete.
        recordings: number and bytes of the files in the participant's recordings, by folder.
        exports: exports to write again.
        backups: backups to bring up to date.
        missing: exports and backups that no longer exist where they were written.
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
        code: their completion code; empty if there is none.
        done: sentences on what was deleted or written again.
        left: sentences on what a person has to do, because no program can.
        failed: sentences on what failed and will be tried again later.
    """

    participant: str
    code: str
    done: list[str] = field(default_factory=list)
    left: list[str] = field(default_factory=list)
    failed: list[str] = field(default_factory=list)


def plan_withdrawal(study: ExperimentFolder, design: ExperimentDesign, named: str) -> WithdrawalPlan:
    """Return what is deleted if a participant withdraws.

    Args:
        study: folder of the study.
        design: the study.
        named: the participant's id or completion code, in any case and with any blanks.

    Raises:
        NobodyWithdraws: the study has no participant with this id or code, or several.
        BadFile: the log or a list of folders cannot be read.
    """
    entries = study.entries()
    codes = {run.participant: run.code for run in Progress(design).after(entries).runs.values()}
    wanted = plain(named)
    known = {*codes, *_people_elsewhere(study)}
    found = [each for each in known if each == named.strip()] or sorted(
        each for each in known if wanted and wanted in {plain(each), plain(codes.get(each, ""))}
    )
    if len(found) != 1:
        raise NobodyWithdraws(named)
    (participant,) = found
    recordings = {}
    for folder in (study, *study.replaced()):
        if (path := _recordings(folder, participant)) is not None and path.exists():
            sizes = [file.stat().st_size for file in path.rglob("*") if file.is_file()]
            recordings[path] = (len(sizes), sum(sizes))
    backups = study.backups_known.paths()
    return WithdrawalPlan(
        PendingWithdrawal(participant, codes.get(participant, "")),
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
    """Delete all data of a participant. `finish_withdrawals` later finishes what is interrupted or fails.

    Args:
        study: folder of the study; no other program may be running it.
        design: the study.
        withdrawal: the participant who withdraws, with their code.
        versions: versions of the programs, for exports that are written again.
        changed: differences from the registered study, for these exports. If None, the study was not registered.
        clocks: return the current time.

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
    """Finish all withdrawals that have begun; see `withdraw`."""
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
    """Finish one of the withdrawals that have begun, with the log open; see `withdraw`."""
    participant = withdrawal.participant
    result = Withdrawal(participant, withdrawal.code)
    known = log.read()
    last = known[-1].sequence if known else 0
    if sequences := sequences_of(known, participant):
        log.delete(sequences, clocks())
    study.withdrawn_events.add(deleted_digests(study.log))
    result.done.append(f"{study.log}: all events of {participant} are deleted.")
    entries = log.read()
    result.left += _named_elsewhere(entries, participant)
    _delete_recordings(study, result)
    # Copies of the log that a restore left when it was killed before it replaced anything.
    shutil.rmtree(study.restoring, ignore_errors=True)
    for old in study.replaced():
        _withdraw_from_replaced(old, result, clocks)
    for export in known_exports(study):
        clear_remains(export)
    for export in exports_with(study, participant):
        if (of := last_event_of(export)) is not None and of > last:
            result.failed.append(
                f"{export}: it was made from a log with {of} events, but this log has {last}: this is an older copy of "
                f"that study. The export still has data of {participant}: withdraw them there, too, or delete it."
            )
            continue
        _remake(study, design, entries, export, versions, changed, result)
    for export in missing_exports(study):
        result.failed.append(f"{export}: an export was written here, but it no longer exists.")
    for backup in study.backups_known.paths():
        if not backup.is_dir():
            result.failed.append(f"{backup}: a backup was written here, but it no longer exists.")
            continue
        try:
            result.left += back_up(study, backup)
            result.done.append(f"{backup}: this backup is up to date again, without {participant}.")
        except BadFile as fault:
            if _may_hold(ExperimentFolder(backup), participant):
                result.failed.append(f"{fault} {backup} may still have data of {participant}.")
            else:
                result.left.append(f"{fault} {backup} has no data of {participant}.")
    if not result.failed:
        study.pending_withdrawals.remove(withdrawal)
    return result


def plain(word: str) -> str:
    """Return an id or a code without the blanks with which it is shown, in capitals."""
    return "".join(word.split()).upper()


def _people_elsewhere(study: ExperimentFolder) -> Iterator[str]:
    """Yield ids of participants in recordings, exports, backups and replaced files, even if the log lacks them."""
    backups = [ExperimentFolder(path) for path in study.backups_known.paths()]
    for folder in (study, *backups, *study.replaced()):
        if folder.recordings.is_dir():
            yield from (path.name for path in folder.recordings.iterdir() if _ID.fullmatch(path.name))
    for folder in (*backups, *study.replaced()):
        try:
            events = [entry.event for entry in read_log(folder.log) if isinstance(entry, LoggedEvent)]
        except BadFile:
            continue
        yield from (event.participant for event in events if event.participant)
    for export in known_exports(study):
        yield from (each for each in people_of(export) or () if _ID.fullmatch(each))


def _recordings(folder: ExperimentFolder, participant: str) -> Path | None:
    """Return the folder of a participant's recordings, or None if their id cannot be a name (in a damaged log).

    Raises:
        BadFile: a link leads out of the folder.
    """
    return None if fault_of_name(participant) else folder.recordings_of(participant)


def _delete_recordings(folder: ExperimentFolder, result: Withdrawal) -> None:
    try:
        recordings = _recordings(folder, result.participant)
        if recordings is None or not recordings.exists():
            return
        shutil.rmtree(recordings)
        sync_folder(recordings.parent)
    except BadFile as fault:
        result.failed.append(str(fault))
    except OSError as error:
        result.failed.append(f"{recordings}: it cannot be deleted ({reason_of(error)}). Delete it yourself.")
    else:
        result.done.append(f"{recordings}: deleted.")


def _withdraw_from_replaced(old: ExperimentFolder, result: Withdrawal, clocks: Callable[[], Clocks]) -> None:
    """Delete a participant's data from files that a backup has replaced."""
    _delete_recordings(old, result)
    if not old.log.exists():
        return
    try:
        with ExperimentLog(old.log) as log:
            if sequences := sequences_of(log.read(), result.participant):
                log.delete(sequences, clocks())
                result.done.append(f"{old.log}: all events of {result.participant} are deleted.")
    except BadFile as fault:
        if any(_names(path, result.participant) for path in old.log.parent.iterdir() if path.is_file()):
            result.failed.append(
                f"{fault} A backup has replaced this log. It may have data of {result.participant}: "
                f"copy what you need from it, and delete {old.root}."
            )


def _may_hold(backup: ExperimentFolder, participant: str) -> bool:
    """Return True if a backup has data of a participant, or cannot be read."""
    try:
        return bool(sequences_of(read_log(backup.log), participant)) or _has_recordings(backup, participant)
    except BadFile:
        return True


def _has_recordings(folder: ExperimentFolder, participant: str) -> bool:
    path = _recordings(folder, participant)
    return path is not None and path.exists()


def _named_elsewhere(entries: Sequence[LogEntry], participant: str) -> list[str]:
    """Return sentences on events of other people that name a participant. They stay, because the study needs them."""
    return [
        f"Event {entry.sequence} ({entry.event.kind} of {entry.event.participant}) names {participant}, and stays."
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
            f"{export}: an export was written here, and its manifest.json is missing or damaged. Check whether it has "
            f"data of {result.participant}, and delete it."
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
            f"{file} is not one of the export's files, and names {result.participant}. Delete it." for file in named
        ]
        if not named:
            result.left.append(
                f"{path} is not one of the export's files. Check whether it has data of {result.participant}."
            )


def _names(file: Path, participant: str) -> bool:
    """Return True if a file contains an id as plain text, or cannot be read."""
    try:
        if not file.stat().st_size:
            return False
        with file.open("rb") as opened, mmap.mmap(opened.fileno(), 0, access=mmap.ACCESS_READ) as content:
            return content.find(participant.encode()) >= 0
    except OSError:
        return True
