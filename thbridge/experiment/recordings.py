"""Search for incomplete recordings, which a crash or an early end of a game has left."""

import re
from collections.abc import Iterable, Iterator
from pathlib import Path

from thbridge.experiment.folder import ExperimentFolder
from thbridge.experiment.progress import Progress, Run
from thbridge.experiment.store.events import EventKind, LogEntry, LoggedEvent, NewEvent, RunState
from thbridge.recording.recordings import ACTIVE

_PART = re.compile(r"_[0-9]+(?=\.(bag|mcap)$)")
"""Suffix of the name of a split recording: the number of the file."""
_STEP = re.compile(r"step-([0-9]+)(-attempt-[0-9]+)?(-[0-9]+)?(_[0-9]+)?\.(bag|mcap)(\.active)?")


def moved_aside(bag: Path) -> list[Path]:
    """Return the files that `make_room` has renamed because a recording needed their name, in order."""
    moved = re.compile(rf"{re.escape(bag.stem)}-[0-9]+(_[0-9]+)?{re.escape(bag.suffix)}({re.escape(ACTIVE)})?")
    there = bag.parent.iterdir() if bag.parent.is_dir() else ()
    return sorted(path for path in there if moved.fullmatch(path.name))


def _run_of_group(progress: Progress, group: str) -> Run | None:
    """Return the run of a person of a group whose folder has recordings, or None."""
    people = (game.people.values() for (name, _), game in progress.groups.items() if name == group)
    return next((progress.runs[person] for each in people for person in each if person in progress.runs), None)


def _folder_of(progress: Progress, event: NewEvent) -> str:
    """Return the name of the folder with the recordings of an event's game: the id of the group or of the person."""
    run = progress.runs.get(event.participant)
    seat = None if run is None else run.seats.get(event.step)
    return event.participant if seat is None else seat.group


def notes_on_leftovers(study: ExperimentFolder, progress: Progress, entries: Iterable[LogEntry]) -> Iterator[str]:
    """Yield a sentence about each incomplete recording of a person in the log.

    Args:
        study: the experiment's folder.
        progress: progress after all entries.
        entries: entries of the log.
    """
    events = [entry.event for entry in entries if isinstance(entry, LoggedEvent)]
    whole = {str((event.data or {})["bag"]) for event in events if event.kind == EventKind.GAME_PLAYED}
    why = {
        (_folder_of(progress, event), str((event.data or {})["bag"])): event.kind
        for event in events
        if event.kind in {EventKind.RECORDING_CUT_OFF, EventKind.GAME_BROKEN_OFF}
    }
    for path in sorted(study.recordings.glob("*/*")):
        name, match = path.relative_to(study.root).as_posix(), _STEP.fullmatch(path.name)
        person = path.parent.name
        run = progress.runs.get(person) or _run_of_group(progress, person)
        if match is None or run is None or _PART.sub("", name) in whole:
            continue
        kind = why.get((person, path.name)) or why.get((person, path.name.removesuffix(ACTIVE)))
        if kind == EventKind.RECORDING_CUT_OFF:
            yield f"{name} ends where the program stopped. The game was resumed, and its new recording is complete."
        elif kind is not None:
            yield f"{name} is from an interrupted game. Another game was started instead."
        elif run.state is not RunState.UNDER_WAY or run.step != int(match[1]):
            yield f"{name} is from an unfinished game that is not in the log, because the run ended during the game."
