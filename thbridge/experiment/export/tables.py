"""The tables of an experiment, made of its log alone."""

import json
import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field

import numpy as np

from thbridge.experiment.design.experiment_file import ExperimentDesign
from thbridge.experiment.design.plan import PlannedStep
from thbridge.experiment.progress import EventKind, Progress, Run
from thbridge.experiment.questionnaires.form import MEASURED, Form, Item, Scale
from thbridge.experiment.questionnaires.scoring import Answer, keyed, scores_of
from thbridge.experiment.store.events import JsonValue, LogEntry, LoggedEvent
from thbridge.files.table_files import Column, Values

CellValue = str | int | float | bool | None
Row = dict[str, CellValue]


@dataclass(frozen=True, slots=True)
class ExperimentTable:
    """A table of an experiment.

    Attributes:
        name: of its file.
        meaning: of its rows, as a phrase.
        columns: described.
        rows: a value for each column.
    """

    name: str
    meaning: str
    columns: tuple[Column, ...]
    rows: tuple[Row, ...]

    def values(self) -> list[Values]:
        """Return the values column by column; a missing number is NaN, a missing word is none."""
        return [_column(column, [row[column.name] for row in self.rows]) for column in self.columns]


@dataclass(slots=True)
class _ItemTimes:
    """Times of an item within one attempt at a step, nanoseconds of the program's clock."""

    shown: int | None = None
    touched: int | None = None
    given: int | None = None
    changes: int = 0
    answer: JsonValue = None


@dataclass(slots=True)
class _Attempt:
    """One time that a person went through a step.

    Attributes:
        step: the step.
        number: of the attempt, from 1.
        began: wall time.
        began_ns: by the program's clock.
        ended_ns: likewise; None while it is under way.
        outcome: how it ended; empty while it has not.
        resumed: how often a program went on with it that another one had begun.
        items: the times of its items, in the order in which they came.
    """

    step: PlannedStep
    number: int
    began: str
    began_ns: int
    ended_ns: int | None = None
    outcome: str = ""
    resumed: int = 0
    items: dict[str, _ItemTimes] = field(default_factory=dict)


def tables_of(design: ExperimentDesign, entries: Sequence[LogEntry]) -> tuple[ExperimentTable, ...]:
    """Return all tables of a log.

    Raises:
        BadHistory: the log is not of this experiment.
    """
    progress = Progress(design).after(entries)
    events = [entry for entry in entries if isinstance(entry, LoggedEvent)]
    attempts = {person: _attempts(run, events) for person, run in progress.runs.items()}
    return (
        _people(design, progress, events),
        _steps(design, progress, attempts),
        _answers(design, progress, attempts),
        _scores(design, progress, attempts),
        _events(events),
    )


def _attempts(run: Run, events: Iterable[LoggedEvent]) -> list[_Attempt]:
    found: list[_Attempt] = []
    for event in (entry.event for entry in events if entry.event.participant == run.participant):
        data, now = event.data or {}, event.clocks.monotonic_ns
        if event.kind == EventKind.STEP_BEGUN:
            number = 1 + sum(one.step.number == event.step for one in found)
            found.append(_Attempt(run.plan[event.step - 1], number, event.clocks.wall, now))
        if not found or found[-1].step.number != event.step:
            continue
        attempt = found[-1]
        times = attempt.items.setdefault(str(data["item"]), _ItemTimes()) if "item" in data else _ItemTimes()
        match event.kind:
            case EventKind.STEP_RESUMED:
                attempt.resumed += 1
            case EventKind.STEP_ENDED:
                attempt.ended_ns, attempt.outcome = now, str(data["outcome"])
            case EventKind.ITEM_SHOWN:
                times.shown = now if times.shown is None else times.shown
            case EventKind.ITEM_TOUCHED:
                times.touched = now if times.touched is None else times.touched
            case EventKind.ITEM_CHANGED:
                times.changes += 1
            case EventKind.ITEM_GIVEN:
                times.given, times.answer = now, data["answer"]
    return found


_PERSON = (
    Column("participant", "string", "", "id of the person"),
    Column("run_counts", "bool", "", "whether the run is complete and not excluded"),
)


def _levels(design: ExperimentDesign) -> tuple[tuple[Column, ...], tuple[Column, ...]]:
    """Columns of the factors between people, and of those within."""
    between, within = "level of a factor between people", "level of a factor within people; none outside of conditions"
    return (
        tuple(Column(factor, "string", "", between) for factor in design.cells[0].levels),
        tuple(Column(factor, "string", "", within) for factor in design.conditions[0].levels),
    )


def _of_person(design: ExperimentDesign, run: Run) -> Row:
    return {
        "participant": run.participant,
        "run_counts": run.state == "complete",
        **design.cells[run.place.cell].levels,
    }


def _of_step(design: ExperimentDesign, run: Run, attempt: _Attempt) -> Row:
    step = attempt.step
    none: dict[str, CellValue] = dict.fromkeys(design.conditions[0].levels)
    levels = none if step.condition is None else design.conditions[step.condition].levels
    return {
        **_of_person(design, run),
        **levels,
        "step": step.number,
        "name": step.name,
        "attempt": attempt.number,
        "trial": math.nan if step.trial is None else step.trial + 1,
    }


_STEP = (
    Column("step", "int64", "", "number of the step in the person's order, from 1"),
    Column("name", "string", "", "name of the step in the experiment's file"),
    Column("attempt", "int64", "", "how often the person had come to this step, this time counted"),
    Column("trial", "float64", "", "number of the trial, from 1; none in other steps"),
)


def _people(design: ExperimentDesign, progress: Progress, events: Sequence[LoggedEvent]) -> ExperimentTable:
    between, _ = _levels(design)
    columns = (
        *_PERSON,
        *between,
        Column("state", "string", "", "under way, complete, declined, left or excluded"),
        Column("reason", "string", "", "for leaving or being excluded"),
        Column("place", "int64", "", "number of the place, from 0"),
        Column("order", "string", "", "conditions in the order in which this person meets them"),
        Column("began", "string", "", "date and time, UTC"),
        Column("events", "int64", "", "events of the log that are this person's"),
    )
    rows = []
    for person, run in progress.runs.items():
        own = [entry.event for entry in events if entry.event.participant == person]
        rows.append(
            {
                **_of_person(design, run),
                "state": str(run.state),
                "reason": run.reason,
                "place": run.place.number,
                "order": "; ".join(design.conditions[index].name for index in design.orders[run.place.order]),
                "began": own[0].clocks.wall,
                "events": len(own),
            }
        )
    return ExperimentTable("participants", "one row a person who began", columns, tuple(rows))


def _steps(design: ExperimentDesign, progress: Progress, attempts: dict[str, list[_Attempt]]) -> ExperimentTable:
    between, within = _levels(design)
    columns = (
        *_PERSON,
        *between,
        *within,
        *_STEP,
        Column("kind", "string", "", "what is done in the step"),
        Column("outcome", "string", "", "done, failed, passed over or lost; none while it is under way"),
        Column("began", "string", "", "date and time, UTC"),
        Column("duration_s", "float64", "s", "time in the step, by the program's clock; none where it was resumed"),
        Column("resumed", "int64", "", "how often another program went on with it"),
    )
    rows = [
        {
            **_of_step(design, run, attempt),
            "kind": str(attempt.step.entry.step),
            "outcome": attempt.outcome,
            "began": attempt.began,
            # Another process has another clock.
            "duration_s": math.nan if attempt.resumed else _seconds(attempt.began_ns, attempt.ended_ns),
            "resumed": attempt.resumed,
        }
        for person, run in progress.runs.items()
        for attempt in attempts[person]
    ]
    return ExperimentTable("steps", "one row each time that a person went through a step", columns, tuple(rows))


def _answers(design: ExperimentDesign, progress: Progress, attempts: dict[str, list[_Attempt]]) -> ExperimentTable:
    between, within = _levels(design)
    columns = (
        *_PERSON,
        *between,
        *within,
        *_STEP,
        Column("item", "string", "", "id of the item in its form"),
        Column("scale", "string", "", "how it is answered"),
        Column(
            "answer", "string", "", "the answer as given; of several options, joined by semicolons; none: not answered"
        ),
        Column("value", "float64", "", "the answer as a number, as given; none where it is no number"),
        Column("keyed", "float64", "", "the number that counts for the score: reversed where the form's key says so"),
        Column("right", "string", "", "of a check: yes or no"),
        Column("seen_s", "float64", "s", "from the item being shown to its answer"),
        Column("hesitation_s", "float64", "s", "from the item being shown to the first touch"),
        Column("changes", "int64", "", "how often the answer was changed before it was given"),
    )
    rows = []
    for person, run in progress.runs.items():
        for attempt, form in _with_forms(design, attempts[person]):
            items = {item.id: item for item in form.items}
            for name, times in attempt.items.items():
                rows.append(
                    {
                        **_of_step(design, run, attempt),
                        **_told(items[name], times),
                    }
                )
    return ExperimentTable("answers", "one row an item that was shown", columns, tuple(rows))


def _told(item: Item, times: _ItemTimes) -> Row:
    answer = _answer(times.answer)
    number = answer if isinstance(answer, float) and item.scale in {*MEASURED, Scale.NUMBER} else math.nan
    right = None if item.correct is None else ("yes" if times.answer == item.correct else "no")
    return {
        "item": item.id,
        "scale": str(item.scale),
        "answer": None if answer is None else _words(answer),
        "value": number,
        "keyed": keyed(item, answer) if item.subscale else math.nan,
        "right": right,
        "seen_s": _seconds(times.shown, times.given),
        "hesitation_s": _seconds(times.shown, times.touched),
        "changes": times.changes,
    }


def _scores(design: ExperimentDesign, progress: Progress, attempts: dict[str, list[_Attempt]]) -> ExperimentTable:
    between, within = _levels(design)
    columns = (
        *_PERSON,
        *between,
        *within,
        *_STEP,
        Column("subscale", "string", "", "name of the score in its form"),
        Column("score", "float64", "", "by the form's key; none where too few items were answered"),
        Column("items", "int64", "", "items of the score"),
        Column("answered", "int64", "", "items of it that were answered with a number"),
    )
    rows = []
    for person, run in progress.runs.items():
        for attempt, form in _with_forms(design, attempts[person]):
            given = {name: answer for name, t in attempt.items.items() if (answer := _answer(t.answer)) is not None}
            for subscale, score in scores_of(form, given).items():
                items = form.subscales[subscale]
                answered = sum(not math.isnan(keyed(item, given.get(item.id))) for item in items)
                told: Row = {"subscale": subscale, "score": score, "items": len(items), "answered": answered}
                rows.append({**_of_step(design, run, attempt), **told})
    return ExperimentTable("scores", "one row a score of a form that was filled in", columns, tuple(rows))


def _events(events: Sequence[LoggedEvent]) -> ExperimentTable:
    columns = (
        Column("sequence", "int64", "", "number of the event in the log; those missing were deleted by withdrawals"),
        Column("kind", "string", "", "what happened"),
        Column("actor", "string", "", "who did it"),
        Column("participant", "string", "", "whose run it belongs to; none: nobody's"),
        Column("step", "int64", "", "number of the step, from 1; 0: none"),
        Column("condition", "string", "", "condition of the step"),
        Column("cause", "int64", "", "sequence of the event that it follows from; 0: none"),
        Column("wall", "string", "", "date and time, UTC; wall clocks jump, so order by sequence"),
        Column(
            "monotonic_ns", "int64", "ns", "clock of the program that saw it; of no meaning beside another program's"
        ),
        Column("simulated_s", "float64", "s", "simulated time; none outside of games"),
        Column("data", "string", "", "the rest, as JSON"),
    )
    rows: list[Row] = []
    for entry in events:
        event, clocks = entry.event, entry.event.clocks
        rows.append(
            {
                "sequence": entry.sequence,
                "kind": event.kind,
                "actor": event.actor,
                "participant": event.participant,
                "step": event.step,
                "condition": event.condition,
                "cause": event.cause,
                "wall": clocks.wall,
                "monotonic_ns": clocks.monotonic_ns,
                "simulated_s": math.nan if clocks.simulated is None else clocks.simulated,
                "data": json.dumps(event.data or {}, ensure_ascii=False),
            }
        )
    return ExperimentTable("events", "one row an event of the log", columns, tuple(rows))


def _with_forms(design: ExperimentDesign, attempts: Iterable[_Attempt]) -> Iterator[tuple[_Attempt, Form]]:
    for attempt in attempts:
        if (form := design.forms.get(attempt.step.index)) is not None:
            yield attempt, form


def _answer(given: JsonValue) -> Answer | None:
    if isinstance(given, list):
        return tuple(map(str, given))
    if isinstance(given, int | float) and not isinstance(given, bool):
        return float(given)
    return given if isinstance(given, str) else None


def _words(answer: Answer) -> str:
    if isinstance(answer, tuple):
        return "; ".join(answer)
    return f"{answer:g}" if isinstance(answer, float) else answer


def _seconds(begin: int | None, end: int | None) -> float:
    return math.nan if begin is None or end is None else (end - begin) / 1e9


def _column(column: Column, values: list[CellValue]) -> Values:
    if column.kind == "string":
        return [None if value is None else str(value) for value in values]
    return np.array([math.nan if value is None else value for value in values], dtype=column.kind)
