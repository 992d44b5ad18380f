"""Tables of people and of their steps."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from thbridge.experiment.design.experiment_file import ExperimentDesign
from thbridge.experiment.design.steps import StepKind
from thbridge.experiment.export.families.attempts import (
    Attempt,
    AttemptSubject,
    attempt_columns,
    run_columns,
)
from thbridge.experiment.export.families.described import ExperimentTable, TableOf, count, flag, seconds, text, time
from thbridge.experiment.export.families.forms import attention_checks
from thbridge.experiment.progress import Progress, Run
from thbridge.experiment.store.events import StepOutcome


@dataclass(frozen=True, slots=True)
class _Person:
    """A run with its attempts, and whether each attention check was passed."""

    run: Run
    attempts: Sequence[Attempt]
    attention: Sequence[bool]

    @property
    def consent(self) -> Attempt | None:
        """The answered question for consent."""
        asked = [each for each in self.attempts if each.step.entry.step is StepKind.CONSENT]
        # A person who declines leaves at once, so the step has no end.
        answered = [each for each in asked if each.consent is not None or each.outcome is StepOutcome.DONE]
        return answered[-1] if answered else None

    @property
    def agreed(self) -> bool | None:
        """The person's answer, or None if they were not asked."""
        if self.consent is None:
            return None
        answer = {} if self.consent.consent is None else self.consent.consent
        return bool(answer.get("agrees", self.consent.outcome is StepOutcome.DONE))

    @property
    def debriefed(self) -> bool | None:
        """True once the person has read a debriefing to its end; None if the study has none."""
        if all(step.entry.step is not StepKind.DEBRIEF for step in self.run.plan):
            return None
        read = (each.outcome is StepOutcome.DONE for each in self.attempts if each.step.entry.step is StepKind.DEBRIEF)
        return any(read)

    def told_of_consent(self, name: str) -> str | None:
        """Return a value that the log has for the person's answer, or None."""
        answer = None if self.consent is None or self.consent.consent is None else self.consent.consent.get(name)
        return None if answer is None else str(answer)


def participants(
    design: ExperimentDesign, progress: Progress, attempts: Mapping[str, Sequence[Attempt]]
) -> ExperimentTable:
    """Return the table of people."""

    def duration(person: _Person) -> float | None:
        known = [each.duration for each in person.attempts]
        return math.fsum(each or 0.0 for each in known) if known and None not in known else None

    def order(person: _Person) -> str:
        return "; ".join(design.conditions[index].name for index in design.orders[person.run.place.order])

    table: TableOf[_Person] = TableOf(
        "participants",
        "a person who began",
        (
            *run_columns(design),
            text("state", "under way, complete, declined, left or excluded", lambda row: str(row.run.state)),
            text("reason", "reason for leaving or being excluded", lambda row: row.run.reason or None),
            count("place", "number of the place, from 0", lambda row: row.run.place.number),
            text(
                "cell",
                "combination of levels of all factors between people; empty if no factor differs between them",
                lambda row: design.cells[row.run.place.cell].name or None,
            ),
            text("order", "conditions in the order in which this person meets them", order),
            time("began", "date and time, UTC", lambda row: row.attempts[0].began if row.attempts else None),
            time(
                "ended",
                "date and time of the last step's end, UTC",
                lambda row: row.attempts[-1].ended or None if row.attempts else None,
            ),
            seconds("duration_s", "time in all steps, by the program's clock; empty if a step was resumed", duration),
            flag("agreed", "whether the person agreed to take part; empty: not asked", lambda row: row.agreed),
            time(
                "agreed_at",
                "date and time of the answer, UTC",
                lambda row: None if row.consent is None else row.consent.consent_at or row.consent.ended,
            ),
            text(
                "consent_sha256",
                "SHA-256 of the text that the person agreed to or declined; empty if the log does not have it",
                lambda row: row.told_of_consent("version"),
            ),
            count(
                "attention_checks", "number of attention checks that the person reached", lambda row: len(row.attention)
            ),
            count("attention_passed", "number of these with the right answer", lambda row: sum(row.attention)),
            flag(
                "debriefed",
                "whether the person read a debriefing; empty: the study has none",
                lambda row: row.debriefed,
            ),
        ),
    )
    subjects = [AttemptSubject(progress.runs[person], each) for person, its in attempts.items() for each in its]
    passed = attention_checks(design, subjects)
    return table.of(_Person(run, attempts[person], passed.get(person, ())) for person, run in progress.runs.items())


def steps(design: ExperimentDesign, subjects: Sequence[AttemptSubject]) -> ExperimentTable:
    """Return the table of attempts at steps."""
    table: TableOf[AttemptSubject] = TableOf(
        "steps",
        "an attempt of a person at a step",
        (
            *attempt_columns(design),
            text(
                "outcome",
                "done, failed, passed over or lost; empty while it is under way",
                lambda row: None if row.attempt.outcome is None else str(row.attempt.outcome),
            ),
            time("began", "date and time, UTC", lambda row: row.attempt.began),
            seconds(
                "duration_s",
                "time in the step, by the program's clock (for a text: reading time); empty if it was resumed",
                lambda row: row.attempt.duration,
            ),
            count(
                "read_again",
                "number of times that the instructions were read again",
                lambda row: row.attempt.read_again,
            ),
            count("resumed", "number of times that another program resumed it", lambda row: row.attempt.resumed),
            count("away", "number of times that another window took the focus", lambda row: row.attempt.away),
            seconds("away_s", "time for which other windows had the focus", lambda row: row.attempt.away_ns / 1e9),
        ),
    )
    return table.of(subjects)
