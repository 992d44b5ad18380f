"""The table `events`: all events of a log."""

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

LEFT_OUT = frozenset({"external_id", "code", "parameters"})
"""Names of event data that are never exported, because they could identify people."""


@dataclass(frozen=True, slots=True)
class _TableEvent:
    """An event. `counts` is True if its run counts."""

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
                "number of the event in the log; events with missing numbers were deleted by withdrawals",
                lambda row: row.entry.sequence,
                least=1,
            ),
            text("kind", "kind of the event", lambda row: row.entry.event.kind),
            text(
                "actor",
                "cause of the event: participant, experimenter, robot or program",
                lambda row: row.entry.event.actor,
            ),
            text(
                "participant",
                "id of the person; empty for events without a person",
                lambda row: row.entry.event.participant or None,
            ),
            flag("counts", "true if the event's run is complete and not excluded", lambda row: row.counts),
            count("step", "number of the step, from 1; 0 for events without a step", lambda row: row.entry.event.step),
            text("condition", "condition of the step", lambda row: row.entry.event.condition or None),
            count(
                "cause",
                "sequence number of the event that caused this event; 0 if there is none",
                lambda row: row.entry.event.cause,
            ),
            time(
                "wall",
                "date and time, UTC; clocks may jump, so sort rows by the column sequence",
                lambda row: row.entry.event.clocks.wall,
            ),
            whole(
                "monotonic_ns",
                "clock of the program that logged the event; values of different programs are not comparable",
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
                "time of the Lab Streaming Layer, for synchronization with other devices; empty if no markers were "
                "sent",
                lambda row: row.entry.event.clocks.lsl,
            ),
            text(
                "data",
                f"further data as JSON; {', '.join(sorted(LEFT_OUT))} are never exported",
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
