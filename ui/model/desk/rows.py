"""Rows and sentences of the desk."""

from collections.abc import Iterator
from datetime import datetime

from ui.model.desk.messages import DeskEvent, DeskNote, DeskRun, DeskSeat, DeskState

CELLS = ("Cell", "Counted", "Planned", "In progress")
RUNS = ("Participant", "State", "Step or reason", "Group", "Since", "Minutes", "Unanswered", "Cell", "Order")
GROUP_COLUMN = RUNS.index("Group")
"""Column of runs that only studies with games of several people have."""
GROUPS = ("Group", "Game", "Seats")
EVENTS = ("Time", "Event", "Caused by")
NOTES = ("Time", "Subject", "Note")

_STATES = {"complete": "counts", "under way": "in progress"}
"""Words for states of runs, if they differ from the name of the state."""


def local_time(wall: str, form: str = "%d %b %H:%M") -> str:
    """Return a time in ISO 8601 as local time."""
    return datetime.fromisoformat(wall).astimezone().strftime(form)


def ordered_runs(state: DeskState) -> tuple[DeskRun, ...]:
    """Return the runs in the order of the table: runs in progress first, then all others, the latest first."""
    latest_first = state.runs[::-1]
    return tuple(sorted(latest_first, key=lambda run: run.state != "under way"))


def cell_rows(state: DeskState) -> Iterator[tuple[str, ...]]:
    """Yield the rows of cells."""
    for cell in state.cells:
        yield cell.name, str(cell.counted), str(cell.planned), str(cell.under_way)


def run_rows(state: DeskState) -> Iterator[tuple[str, ...]]:
    """Yield the rows of runs."""
    for run in ordered_runs(state):
        yield (
            run.participant,
            _STATES.get(run.state, run.state),
            f"{_numbered(run)}, {_step(run)}" if run.state == "under way" else run.reason,
            ", ".join(filter(None, (run.group, run.seat))),
            local_time(run.since, "%H:%M"),
            f"{run.minutes:.0f}",
            str(len(run.missing)) if run.missing else "",
            run.cell,
            ", then ".join(run.order),
        )


def group_rows(state: DeskState) -> Iterator[tuple[str, ...]]:
    """Yield the rows of games of several people: games in progress first, then all others, the latest first."""
    latest_first = (state.groups or ())[::-1]
    for game in sorted(latest_first, key=lambda each: each.played):
        name = f"{game.step_name} (ended)" if game.played else game.step_name
        yield game.group, name, "; ".join(f"{seat.label}: {_holder(seat)}" for seat in game.seats)


def _holder(seat: DeskSeat) -> str:
    who = seat.participant
    match seat.holder:
        case "person":
            return who or "a person who withdrew"
        case "program":
            return f"a program, {who} is away" if who else "a program"
        case _:
            return f"empty, {who} is away" if who else "empty"


def event_rows(events: tuple[DeskEvent, ...]) -> Iterator[tuple[str, ...]]:
    """Yield the rows of events."""
    for event in events:
        yield local_time(event.wall, "%H:%M:%S"), event.words, event.actor


def note_rows(notes: tuple[DeskNote, ...]) -> Iterator[tuple[str, ...]]:
    """Yield the rows of notes."""
    for note in notes:
        yield local_time(note.wall), note.participant or "the study", note.text


def count_words(state: DeskState) -> str:
    """Return a sentence with the numbers of runs that count, of missing runs, and of runs in progress."""
    under_way = sum(run.state == "under way" for run in state.runs)
    missing = state.planned - state.counted
    left = "none is missing" if missing <= 0 else f"{missing} missing"
    rehearsal = "This is a rehearsal with simulated people. " if state.rehearsal else ""
    return f"{rehearsal}{state.counted} of {state.planned} runs count, {left}, {under_way} in progress."


def freeze_words(state: DeskState) -> str:
    """Return a sentence that says if the study is frozen, and lists the changes since it was frozen."""
    if state.changed is None:
        return "The study is not frozen."
    if not state.changed:
        return "The study is frozen and unchanged."
    return f"The study has changed since it was frozen: {'; '.join(state.changed)}."


def run_words(run: DeskRun) -> str:
    """Return a description of a run, in sentences."""
    group = f"Cell: {run.cell}." if run.cell != "everybody" else ""
    order = f"Order of conditions: {', then '.join(run.order)}." if run.order else ""
    team = f"Group {run.group}: {run.seat}." if run.group else ""
    where = " ".join(filter(None, (group, order, team)))
    if run.lag is not None:
        where += f" Games were at most {run.lag:.1f} s behind real time."
    if run.state != "under way":
        how = _STATES.get(run.state, run.state)
        reason = f": {run.reason}" if run.reason else ""
        return f"{run.participant}: {how}{reason}; {local_time(run.since)}, after {_minutes(run)}. {where}".rstrip()
    missing = f" Required items without an answer: {', '.join(run.missing)}." if run.missing else ""
    at = f"{run.participant}: step {_numbered(run)}, {_step(run)}, since {local_time(run.since)}"
    return f"{at}; {_minutes(run)} so far.{missing} {where}".rstrip()


def _minutes(run: DeskRun) -> str:
    minutes = f"{run.minutes:.0f}"
    return f"{minutes} {'minute' if minutes == '1' else 'minutes'}"


def _numbered(run: DeskRun) -> str:
    return f"{run.step} of {run.steps}"


def _step(run: DeskRun) -> str:
    if not run.step_name:
        return "the end"
    kind = f" ({run.step_kind})" if not run.step_name.startswith(run.step_kind) else ""
    return run.step_name + kind if run.under_way else f"before {run.step_name}{kind}"
