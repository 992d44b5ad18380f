"""Withdrawal of a person: nothing of them stays in the log, recordings, exports and backups that a study knows of."""

import shutil
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from thbridge.experiment.backup import back_up, holds
from thbridge.experiment.conductor import Conductor, Draw
from thbridge.experiment.design.experiment_file import ExperimentDesign
from thbridge.experiment.export.folder import remake_export
from thbridge.experiment.export.manifest import exports_with, last_event_of, missing_exports, people_of
from thbridge.experiment.folder import ExperimentFolder
from thbridge.experiment.store.event_log import ExperimentLog, read_log
from thbridge.experiment.store.events import Clocks, LogEntry, LoggedEvent
from thbridge.files.errors import BadFile, reason_of


class NobodyWithdraws(Exception):  # noqa: N818 - it is told as a sentence
    """The study has nothing of a person of this id or code."""


@dataclass(slots=True)
class Withdrawal:
    """Withdrawal that was carried out.

    Attributes:
        participant: id of the person.
        done: sentences on what was deleted or made anew.
        left: sentences on what somebody has to do, since no program can.
        failed: sentences on what could not be done, and is to be tried again.
    """

    participant: str
    done: list[str] = field(default_factory=list)
    left: list[str] = field(default_factory=list)
    failed: list[str] = field(default_factory=list)


def withdraw(
    study: ExperimentFolder,
    design: ExperimentDesign,
    named: str,
    versions: Mapping[str, str],
    changed: Sequence[str] | None,
    clocks: Callable[[], Clocks],
    draw: Draw,
) -> Withdrawal:
    """Delete everything of a person; what was interrupted or failed is done when this is called again.

    Args:
        study: its folder; no other program may be running it.
        design: the study.
        named: the person's id, or their completion code.
        versions: of the programs, for exports that are made anew.
        changed: what differs from the registered study, likewise; None: it was not registered.
        clocks: the time now.
        draw: source of chance.

    Raises:
        NobodyWithdraws: nothing is known of the person.
        BadFile: the log or a list of folders cannot be read or written, or another program runs the study.
    """
    known = study.entries()
    with ExperimentLog(study.log) as log:
        conductor = Conductor(design, log, clocks, draw)
        runs = conductor.progress.runs
        participant = next((run.participant for run in runs.values() if run.code == _plain(named)), named)
        recordings = study.recordings / participant
        held, backups = exports_with(study, participant), study.backups_known.paths()
        listed = [export for export in held if participant in (people_of(export) or ())]
        if not (
            participant in runs or recordings.exists() or listed or any(_holds(path, participant) for path in backups)
        ):
            raise NobodyWithdraws(named)
        told = Withdrawal(participant)
        if participant in runs:
            conductor.withdraw(participant)
    told.done.append(f"{study.log}: all events of {participant} are deleted.")
    entries = read_log(study.log)
    told.left += _named_elsewhere(entries, participant)
    if recordings.exists():
        try:
            shutil.rmtree(recordings)
            told.done.append(f"{recordings}: deleted.")
        except OSError as error:
            told.failed.append(f"{recordings}: it cannot be deleted ({reason_of(error)}). Delete it yourself.")
    last = known[-1].sequence if known else 0
    for export in held:
        if (of := last_event_of(export)) is not None and of > last:
            told.failed.append(
                f"{export}: it was made of a log with {of} events, and this one has {last}: this is an older copy of "
                f"that study. The export still has data of {participant}: withdraw them there, too."
            )
            continue
        _remake(study, design, entries, export, versions, changed, told)
    for backup in backups:
        if not backup.is_dir():
            told.left.append(f"{backup}: a backup was written here, and is here no more. Delete what is left of it.")
            continue
        try:
            back_up(study, backup)
            told.done.append(f"{backup}: this backup is brought up to date, without {participant}.")
        except BadFile as fault:
            told.failed.append(f"{fault} {backup} may still have data of {participant}.")
    for export in missing_exports(study):
        told.left.append(
            f"{export}: an export was written here, and is here no more. If it was moved, delete it there."
        )
    return told


def _plain(code: str) -> str:
    """Return a code without the blank with which it is shown, and in its own letters."""
    return code.replace(" ", "").upper()


def _holds(backup: Path, participant: str) -> bool:
    """Return True where a backup is known to have data of somebody."""
    try:
        return holds(ExperimentFolder(backup), participant)
    except BadFile:
        return False


def _named_elsewhere(entries: Sequence[LogEntry], participant: str) -> list[str]:
    """Sentences on events of others that name somebody; the study would be another one without them."""
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
    told: Withdrawal,
) -> None:
    if people_of(export) is None:
        told.left.append(
            f"{export}: an export was written here, and its manifest.json is missing or damaged. Look whether there is "
            f"something of {told.participant}, and delete it."
        )
        return
    try:
        others = remake_export(study, design, entries, export, versions, changed)
    except BadFile as fault:
        told.failed.append(f"{fault} This export may still have data of {told.participant}.")
        return
    told.done.append(f"{export}: this export is made anew, without {told.participant}. Run its scripts again.")
    for path in others:
        named = [file for file in (path, *path.rglob("*")) if file.is_file() and _names(file, told.participant)]
        told.left += [
            f"{file} is none of the export's files, and names {told.participant}. Delete that." for file in named
        ]
        if not named:
            told.left.append(f"{path} is none of the export's files. Look whether it has data of {told.participant}.")


def _names(file: Path, participant: str) -> bool:
    """Return True where a file has an id as plain text, or cannot be read."""
    try:
        return participant.encode() in file.read_bytes()
    except OSError:
        return True
