"""Attempts at steps, collected from the log. They are the source of most tables, which share their first columns."""

from collections import defaultdict
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from typing import Protocol

from thbridge.experiment.design.experiment_file import ExperimentDesign, drawn_seed
from thbridge.experiment.design.plan import PlannedStep
from thbridge.experiment.design.steps import StepKind
from thbridge.experiment.export.families.described import (
    CellValue,
    ColumnDescription,
    FactorRole,
    ValuedColumn,
    flag,
    text,
    whole,
)
from thbridge.experiment.groups import GroupSeat
from thbridge.experiment.progress import Progress, Run
from thbridge.experiment.store.events import EventKind, JsonValue, LoggedEvent, RunState, StepOutcome

NO_DATA = frozenset({StepKind.PRACTICE, StepKind.CHECK})
"""Kinds of steps that never count as data."""


@dataclass(slots=True)
class ItemTimes:
    """Times of an item in one attempt at a step, in nanoseconds of the program's clock.

    Attributes:
        shown: time at which the item was first shown, or None.
        touched: time at which the person began to answer, or None.
        given: time at which the person continued to the next item, or None.
        changes: number of changes of the answer before the person continued.
        pasted: number of characters pasted into the answer.
        answer: the answer given, or None.
        timed_out: True if the item was closed at its time limit. Then the present answer counts.
        options: answers of a choice in the order shown; empty if all participants see the same order.
    """

    shown: int | None = None
    touched: int | None = None
    given: int | None = None
    changes: int = 0
    pasted: int = 0
    answer: JsonValue = None
    timed_out: bool = False
    options: tuple[str, ...] = ()


@dataclass(slots=True)
class Attempt:
    """One attempt of a person at a step.

    Attributes:
        step: the step.
        number: number of the attempt, from 1.
        began: wall time of the attempt's start.
        began_ns: time of the attempt's start, from the program's clock.
        ended: wall time of the attempt's end; empty before the end.
        ended_ns: time of the attempt's end, from the program's clock; None before the end.
        outcome: outcome of the attempt; None before the end.
        resumed: number of times that another program resumed the attempt.
        broken_off: number of games that were started in the attempt and abandoned.
        read_again: number of times that the instructions were opened again.
        away_ns: time for which another window had the keyboard focus.
        away: number of times that another window took the focus.
        left_ns: time at which the window lost the focus, or None if the window has the focus.
        items: times of the items, in the order of their appearance.
        game: the log's data about the played game, or None.
        consent: the log's data about the answer to the consent question, or None.
        consent_at: wall time of the answer to the consent question; empty if there is none.
    """

    step: PlannedStep
    number: int
    began: str
    began_ns: int
    ended: str = ""
    ended_ns: int | None = None
    outcome: StepOutcome | None = None
    resumed: int = 0
    broken_off: int = 0
    read_again: int = 0
    away_ns: int = 0
    away: int = 0
    left_ns: int | None = None
    items: dict[str, ItemTimes] = field(default_factory=dict)
    game: Mapping[str, JsonValue] | None = None
    consent: Mapping[str, JsonValue] | None = None
    consent_at: str = ""

    @property
    def duration(self) -> float | None:
        """Time in the step, s. None before the end, and after a resume, because each process has its own clock."""
        return None if self.resumed else between(self.began_ns, self.ended_ns)


def between(begin: int | None, end: int | None) -> float | None:
    """Return the time in seconds between two clock readings in nanoseconds, or None if a reading is missing."""
    return None if begin is None or end is None else (end - begin) / 1e9


def attempts_of(progress: Progress, events: Iterable[LoggedEvent]) -> dict[str, list[Attempt]]:
    """Return all attempts of each person, in order."""
    of_person: defaultdict[str, list[LoggedEvent]] = defaultdict(list)
    for event in events:
        of_person[event.event.participant].append(event)
    return {person: _gathered(run, of_person[person]) for person, run in progress.runs.items()}


def _gathered(run: Run, events: Iterable[LoggedEvent]) -> list[Attempt]:
    found: list[Attempt] = []
    for event in (entry.event for entry in events):
        data, now = event.data or {}, event.clocks.monotonic_ns
        if event.kind == EventKind.STEP_BEGUN:
            number = 1 + sum(one.step.number == event.step for one in found)
            found.append(Attempt(run.plan[event.step - 1], number, event.clocks.wall, now))
        if not found or found[-1].step.number != event.step:
            continue
        attempt = found[-1]
        times = attempt.items.setdefault(str(data["item"]), ItemTimes()) if "item" in data else ItemTimes()
        match event.kind:
            case EventKind.STEP_RESUMED:
                attempt.resumed += 1
                attempt.left_ns = None
            case EventKind.STEP_ENDED:
                attempt.ended, attempt.ended_ns = event.clocks.wall, now
                attempt.outcome = StepOutcome(str(data["outcome"]))
            case EventKind.ITEM_SHOWN:
                times.shown = now if times.shown is None else times.shown
                times.options = tuple(map(str, options)) if isinstance(options := data.get("options"), list) else ()
            case EventKind.ITEM_TOUCHED:
                times.touched = now if times.touched is None else times.touched
            case EventKind.ITEM_CHANGED:
                times.changes += 1
            case EventKind.ITEM_GIVEN | EventKind.ITEM_TIMED_OUT:
                times.given, times.answer = now, data["answer"]
                times.timed_out = event.kind == EventKind.ITEM_TIMED_OUT
            case EventKind.GAME_PLAYED:
                attempt.game = data
            case EventKind.TEXT_PASTED:
                times.pasted += int(str(data.get("characters", 0)))
            case EventKind.CONSENT_ANSWERED:
                attempt.consent, attempt.consent_at = data, event.clocks.wall
            case EventKind.GAME_BROKEN_OFF:
                attempt.broken_off += 1
            case EventKind.INSTRUCTIONS_OPENED:
                attempt.read_again += 1
            case EventKind.FOCUS_LOST:
                attempt.away += 1
                attempt.left_ns = now
            case EventKind.FOCUS_REGAINED if attempt.left_ns is not None:
                attempt.away_ns += now - attempt.left_ns
                attempt.left_ns = None
    return found


# Columns that several tables share


class OfRun(Protocol):
    """Object of a row that belongs to a person."""

    @property
    def run(self) -> Run:
        """The person's run."""


class OfAttempt(OfRun, Protocol):
    """Object of a row that belongs to an attempt at a step."""

    @property
    def attempt(self) -> Attempt:
        """The attempt."""


@dataclass(frozen=True, slots=True)
class RunSubject:
    """A run; see `OfRun`."""

    run: Run


@dataclass(frozen=True, slots=True)
class AttemptSubject:
    """An attempt; see `OfAttempt`."""

    run: Run
    attempt: Attempt


def run_columns(design: ExperimentDesign) -> tuple[ValuedColumn[OfRun], ...]:
    """Return the first columns of each row that belongs to a person."""
    return (
        text("participant", "id of the person", lambda row: row.run.participant),
        flag(
            "counts",
            "true for valid data: the run is complete and not excluded, and the step is neither practice nor a check",
            lambda row: row.run.state is RunState.COMPLETE,
        ),
        *_between_columns(design),
    )


def attempt_columns(design: ExperimentDesign) -> tuple[ValuedColumn[OfAttempt], ...]:
    """Return the first columns of each row that belongs to a step."""
    participant, counts, *factors = run_columns(design)
    seats = seat_columns() if design.has_groups else ()

    def is_data(row: OfAttempt) -> bool:
        return row.run.state is RunState.COMPLETE and row.attempt.step.entry.step not in NO_DATA

    def trial(row: OfAttempt) -> int | None:
        number = row.attempt.step.trial
        return None if number is None else number + 1

    return (
        participant,
        ValuedColumn(counts.described, is_data),
        *seats,
        *factors,
        *_within_columns(design),
        whole("step", "number of the step in the person's order, from 1", lambda row: row.attempt.step.number, least=1),
        text("name", "name of the step, from the experiment's file", lambda row: row.attempt.step.name),
        text("kind", "kind of the step", lambda row: str(row.attempt.step.entry.step)),
        whole(
            "attempt",
            "number of the person's attempt at this step, from 1",
            lambda row: row.attempt.number,
            least=1,
        ),
        whole("trial", "number of the trial in the person's order, from 1; empty for other steps", trial, least=1),
    )


def seat_columns() -> tuple[ValuedColumn[OfAttempt], ...]:
    """Return the columns with the person's group and seat, for studies with games of several people."""

    def taken(row: OfAttempt) -> GroupSeat | None:
        return row.run.seats.get(row.attempt.step.number)

    return (
        text(
            "group",
            "id of the person's group in a game of several people; empty for other steps",
            lambda row: None if (seat := taken(row)) is None else seat.group,
        ),
        text(
            "seat",
            "person's seat in a game of several people; empty for other steps",
            lambda row: None if (seat := taken(row)) is None else seat.seat,
        ),
    )


def _between_columns(design: ExperimentDesign) -> tuple[ValuedColumn[OfRun], ...]:
    def column(factor: str) -> ValuedColumn[OfRun]:
        levels = tuple(dict.fromkeys(cell.levels[factor] for cell in design.cells))
        meaning = "level of this factor between people"
        described = ColumnDescription(factor, "string", "", meaning, role=FactorRole.BETWEEN, levels=levels)
        return ValuedColumn(described, lambda row: design.cells[row.run.place.cell].levels[factor])

    return tuple(map(column, design.cells[0].levels))


def _within_columns(design: ExperimentDesign) -> tuple[ValuedColumn[OfAttempt], ...]:
    def column(factor: str) -> ValuedColumn[OfAttempt]:
        levels = tuple(dict.fromkeys(condition.levels[factor] for condition in design.conditions))
        meaning = "level of this factor within people; empty for steps that belong to no condition"
        described = ColumnDescription(factor, "string", "", meaning, role=FactorRole.WITHIN, levels=levels)

        def level(row: OfAttempt) -> CellValue:
            condition = row.attempt.step.condition
            return None if condition is None else design.conditions[condition].levels[factor]

        return ValuedColumn(described, level)

    return tuple(map(column, design.conditions[0].levels))


def seed_of(design: ExperimentDesign, attempt: Attempt) -> int | None:
    """Return the random seed of a trial's game, or None for other steps."""
    return None if attempt.step.trial is None else drawn_seed(design, attempt.step.trial)
