"""Table of all events of a log."""

import json
from collections.abc import Sequence
from dataclasses import dataclass

from thbridge.experiment.export.families.described import (
    ExperimentTable,
    TableOf,
    count,
    flag,
    number,
    text,
    time,
    whole,
)
from thbridge.experiment.progress import Progress
from thbridge.experiment.store.events import LoggedEvent, RunState

LEFT_OUT = frozenset({"external_id", "code"})
"""Data of events that is never exported, because it could identify people."""


@dataclass(frozen=True, slots=True)
class _TableEvent:
    """An event, and whether the run that it belongs to counts."""

    entry: LoggedEvent
    counts: bool


def log_events(progress: Progress, events: Sequence[LoggedEvent]) -> ExperimentTable:
    """Return the table of events."""
    table: TableOf[_TableEvent] = TableOf(
        "events",
        "an event of the log",
        (
            whole(
                "sequence",
                "number of the event in the log; missing numbers were deleted by withdrawals",
                lambda row: row.entry.sequence,
                least=1,
            ),
            text("kind", "what happened", lambda row: row.entry.event.kind),
            text("actor", "who caused it", lambda row: row.entry.event.actor),
            text(
                "participant",
                "id of the person; empty if it is about no person",
                lambda row: row.entry.event.participant or None,
            ),
            flag("counts", "whether it belongs to a run that is complete and not excluded", lambda row: row.counts),
            count("step", "number of the step, from 1; 0: none", lambda row: row.entry.event.step),
            text("condition", "condition of the step", lambda row: row.entry.event.condition or None),
            count("cause", "sequence of the event that caused it; 0: none", lambda row: row.entry.event.cause),
            time(
                "wall",
                "date and time, UTC; wall clocks jump, so order by sequence",
                lambda row: row.entry.event.clocks.wall,
            ),
            whole(
                "monotonic_ns",
                "clock of the program that logged it; not comparable between programs",
                lambda row: row.entry.event.clocks.monotonic_ns,
                "ns",
            ),
            number(
                "simulated_s",
                "s",
                "simulated time; empty outside of games",
                lambda row: row.entry.event.clocks.simulated,
            ),
            number(
                "lsl_s",
                "s",
                "clock of the Lab Streaming Layer, for recordings of other devices; empty if no markers were sent",
                lambda row: row.entry.event.clocks.lsl,
            ),
            text(
                "data",
                f"further data, as JSON; without {' and '.join(sorted(LEFT_OUT))}",
                lambda row: json.dumps(
                    {name: value for name, value in (row.entry.event.data or {}).items() if name not in LEFT_OUT},
                    ensure_ascii=False,
                ),
            ),
        ),
    )

    def counts(person: str) -> bool:
        run = progress.runs.get(person)
        return run is not None and run.state is RunState.COMPLETE

    return table.of(_TableEvent(entry, counts(entry.event.participant)) for entry in events)
