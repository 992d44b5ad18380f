"""State of the desk, computed from the design and the log of a study with people, and the reports of the host."""

from collections import Counter, defaultdict
from collections.abc import Collection, Iterable, Sequence
from dataclasses import dataclass
from datetime import datetime

from msgspec.structs import replace

from thbridge.experiment.allocation.places import NoPlace
from thbridge.experiment.design.experiment_file import ExperimentDesign
from thbridge.experiment.design.plan import study_of_game
from thbridge.experiment.groups import GroupGame
from thbridge.experiment.progress import Progress, Run, lag_words
from thbridge.experiment.store.events import EventKind, LogEntry, LoggedEvent, NewEvent, RunState
from thbridge.study.seats import seats_of
from ui.model.desk.messages import DeskCell, DeskEvent, DeskGroup, DeskMessage, DeskNote, DeskRun, DeskSeat, DeskState

NO_PLACE = {
    NoPlace.FULL: "The study already has enough runs that count.",
    NoPlace.TAKEN: "All places are taken. If a run in progress ends and does not count, its place becomes free.",
    NoPlace.CLOSED: "Admission is closed.",
}
_BEGINNINGS = frozenset({EventKind.STEP_BEGUN, EventKind.STEP_RESUMED})
_BY_ITSELF = frozenset(EventKind) - {EventKind.NOTE, EventKind.FAREWELL_READ, EventKind.RUN_EXCLUDED}
"""Kinds of events that can be the last event of a run; exclusions are omitted, because they can follow weeks later."""
_BUT_NOTES = _BY_ITSELF | {EventKind.RUN_EXCLUDED}


@dataclass(frozen=True, slots=True)
class ToldToDesk:
    """All data of a desk except the design and the log.

    Attributes:
        now: date and time of day, ISO 8601 in UTC.
        changed: changes since the study was frozen. If None, the study is not frozen.
        kiosk: description of the page that the kiosk shows now.
        troubles: sentences about problems that need attention.
        shown: id of the person whose events the desk shows.
        read_only: reason why the desk cannot send requests; empty if requests are possible.
    """

    now: str
    changed: tuple[str, ...] | None = None
    kiosk: str = ""
    troubles: tuple[str, ...] = ()
    shown: str = ""
    read_only: str = ""


def desk_state(
    design: ExperimentDesign, progress: Progress, entries: Sequence[LogEntry], told: ToldToDesk
) -> DeskState:
    """Return the contents of the desk.

    Args:
        design: the study.
        progress: progress of all people after these entries.
        entries: all entries of the log.
        `told`: all other data.
    """
    own: defaultdict[str, list[LoggedEvent]] = defaultdict(list)
    notes = []
    for entry in entries:
        if isinstance(entry, LoggedEvent):
            event = entry.event
            own[event.participant].append(entry)
            if event.kind == EventKind.NOTE:
                notes.append(DeskNote(event.clocks.wall, event.participant, str((event.data or {}).get("text", ""))))
    runs = list(progress.runs.values())
    place = progress.next_place()
    shown = told.shown if told.shown in progress.runs else ""
    return DeskState(
        title=design.file.title,
        planned=design.allocation.size,
        counted=len(progress.valid),
        cells=_cells(design, runs),
        changed=told.changed,
        runs=tuple(_run(progress, run, own[run.participant], told.now) for run in runs),
        kiosk=told.kiosk,
        troubles=told.troubles,
        notes=tuple(notes),
        messages=tuple(_messages(entries)),
        shown=shown,
        events=tuple(_told_event(progress, entry) for entry in own[shown]) if shown else (),
        no_next=NO_PLACE[place] if isinstance(place, NoPlace) else "",
        rehearsal=any(entry.event.kind == EventKind.REHEARSED for entry in own[""]),
        read_only=told.read_only,
        pace=" ".join(lag_words(progress)),
        groups=tuple(_group(progress, game) for game in progress.groups.values()) if design.has_groups else None,
    )


def _group(progress: Progress, game: GroupGame) -> DeskGroup:
    # All people of a group play the same game.
    run = next((progress.runs[person] for person in game.people.values() if person in progress.runs), None)
    labels = {} if run is None else _labels(progress.design, run, game.step)
    return DeskGroup(
        group=game.group,
        step_name="" if run is None else run.plan[game.step - 1].name,
        seats=tuple(
            DeskSeat(labels.get(seat, seat), str(holder), game.people.get(seat, ""))
            for seat, holder in game.seats.items()
        ),
        played=game.played is not None,
    )


def _labels(design: ExperimentDesign, run: Run, step: int) -> dict[str, str]:
    """Return the words for the seats of a person's game, by the names of the seats."""
    study = study_of_game(design, run.place, run.plan[step - 1])
    return {} if study is None else {seat.name: seat.label for seat in seats_of(study.seats)}


def _messages(entries: Iterable[LogEntry]) -> list[DeskMessage]:
    """Return the messages to people. When a person closes a message, all their earlier messages are closed, too."""
    messages: list[DeskMessage] = []
    for entry in entries:
        if not isinstance(entry, LoggedEvent):
            continue
        event = entry.event
        data = event.data or {}
        if event.kind == EventKind.MESSAGE_SENT:
            author, text = str(data.get("author", "")), str(data.get("text", ""))
            messages.append(DeskMessage(event.clocks.wall, event.participant, author, text, closed=False))
        elif event.kind == EventKind.MESSAGE_CLOSED:
            messages = [replace(it, closed=True) if it.participant == event.participant else it for it in messages]
    return messages


def _cells(design: ExperimentDesign, runs: Iterable[Run]) -> tuple[DeskCell, ...]:
    counts = Counter((run.place.cell, run.state) for run in runs)
    return tuple(
        DeskCell(
            cell.name or "everybody",
            design.file.quota,
            counts[index, RunState.COMPLETE],
            counts[index, RunState.UNDER_WAY],
        )
        for index, cell in enumerate(design.cells)
    )


def _run(progress: Progress, run: Run, events: Sequence[LoggedEvent], now: str) -> DeskRun:
    design = progress.design
    number, steps = progress.step_count(run.participant)
    over = run.state is not RunState.UNDER_WAY
    step = run.plan[run.step - 1] if run.step <= len(run.plan) else None
    missing: tuple[str, ...] = ()
    if run.under_way and not over and step is not None and step.entry.form:
        asked = design.forms[step.index].items
        missing = tuple(item.id for item in asked if item.required and run.given.get(item.id) is None)
    begun = events[0].event.clocks.wall
    game = max(run.seats, default=0)
    taken = run.seats.get(game)
    until = _last(events, _BY_ITSELF) if over else now
    return DeskRun(
        participant=run.participant,
        cell=design.cells[run.place.cell].name or "everybody",
        order=tuple(
            ", ".join(design.conditions[condition].levels.values())
            for condition in design.orders[run.place.order]
            if len(design.conditions) > 1
        ),
        state=str(run.state),
        reason=run.reason,
        step=number,
        steps=steps,
        step_name="" if step is None else step.name,
        step_kind="" if step is None else str(step.entry.step),
        under_way=run.under_way and not over,
        since=_last(events, _BEGINNINGS if run.under_way and not over else _BUT_NOTES),
        minutes=_minutes(begun, until),
        missing=missing,
        lag=run.lag,
        front_end=run.front_end,
        group="" if taken is None else taken.group,
        seat="" if taken is None else _labels(design, run, game).get(taken.seat, taken.seat),
    )


def _last(events: Sequence[LoggedEvent], kinds: Collection[str]) -> str:
    """Return the time of the last event of these kinds; if there is none, return the time of the first event."""
    return next((e.event.clocks.wall for e in reversed(events) if e.event.kind in kinds), events[0].event.clocks.wall)


def _minutes(begin: str, end: str) -> float:
    """Return the minutes between two times; 0 if the clock was set back between them."""
    seconds = (datetime.fromisoformat(end) - datetime.fromisoformat(begin)).total_seconds()
    return max(seconds, 0.0) / 60.0


def _told_event(progress: Progress, entry: LoggedEvent) -> DeskEvent:
    event = entry.event
    return DeskEvent(entry.sequence, event.clocks.wall, event.actor, _words(progress, event))


def _named(progress: Progress, event: NewEvent) -> str:
    """Return the number and name of an event's step; skipped steps are not numbered.

    The kiosk and the table of runs show the same number.
    """
    plan = progress.runs[event.participant].plan
    if not 0 < event.step <= len(plan):
        return ""
    shown = [step.number for step in progress.steps_shown(event.participant)]
    name = plan[event.step - 1].name
    return f"step {shown.index(event.step) + 1}, {name}" if event.step in shown else name


def _words(progress: Progress, event: NewEvent) -> str:
    """Return an event in words, without the answer itself."""
    data = event.data or {}
    step = _named(progress, event)
    item = f"{step}: {data.get('item', '')}"
    match event.kind:
        case EventKind.RUN_BEGUN:
            return "the run begins"
        case EventKind.STEP_BEGUN:
            return f"{step}, begins" + (f" ({event.condition})" if event.condition else "")
        case EventKind.STEP_RESUMED:
            return f"{step}, resumes after a crash at: {data.get('from', '')}"
        case EventKind.ITEM_SHOWN:
            return f"{item} is shown"
        case EventKind.ITEM_TOUCHED:
            return f"{item}: the answer is begun"
        case EventKind.ITEM_CHANGED:
            return f"{item}: the answer is changed"
        case EventKind.ITEM_GIVEN:
            return f"{item} is answered"
        case EventKind.WENT_BACK:
            return f"{step}: the participant goes back to page {data.get('page', '')}"
        case EventKind.TEXT_PASTED:
            return f"{item}: {data.get('characters', '')} characters are pasted into the answer"
        case EventKind.GAME_BROKEN_OFF:
            return f"{step}: the game was interrupted; a new game replaces it"
        case EventKind.RECORDING_CUT_OFF:
            return f"{step}: the recording was cut off; the game continues, and a new recording contains all of it"
        case EventKind.CONSENT_ANSWERED:
            agrees = "agrees" if data.get("agrees") else "does not agree"
            return f"the participant {agrees} to take part"
        case EventKind.RECRUITING_CODE:
            return "the participant gives the code of the recruiting service"
        case EventKind.FOCUS_LOST:
            return f"{step}: the participant switches to another window"
        case EventKind.FOCUS_REGAINED:
            return f"{step}: the participant returns to the study's window"
        case EventKind.FAREWELL_READ:
            return "the participant leaves the last page"
        case EventKind.GROUP_FORMED:
            return f"{step}: the participant takes the seat {data.get('seat', '')} in the group {data.get('group', '')}"
        case EventKind.GAME_PLAYED:
            lag = data.get("most_lag_seconds")
            behind = f"; at most {lag:.1f} s behind real time" if isinstance(lag, int | float) else ""
            return f"{step}: the game is recorded{behind}"
        case EventKind.STEP_ENDED:
            return f"{step}, ends: {data.get('outcome', '')}"
        case EventKind.RUN_ENDED:
            why = data.get("reason") or (f"code {data['code']}" if data.get("code") else "")
            if "excluded" in data:
                why = f"{why}; the run does not count: {data['excluded']}"
            return f"the run ends: {data.get('outcome', '')}" + (f", {why}" if why else "")
        case EventKind.RUN_EXCLUDED:
            return f"the run does not count: {data.get('reason', '')}"
        case EventKind.MESSAGE_SENT:
            return f"message of {data.get('author', '')}: {data.get('text', '')}"
        case EventKind.MESSAGE_CLOSED:
            return "the participant closes the message"
        case EventKind.NOTE:
            return f"note: {data.get('text', '')}"
        case kind:
            return f"{step}: {kind.replace('-', ' ')}".removeprefix(": ")
