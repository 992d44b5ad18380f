"""The tables `participants` and `steps`: people, and their attempts at steps."""

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
    """A run with its attempts and the results of its attention checks."""

    run: Run
    attempts: Sequence[Attempt]
    attention: Sequence[bool]

    @property
    def consent(self) -> Attempt | None:
        """The consent step that the person answered last, or None."""
        asked = [each for each in self.attempts if each.step.entry.step is StepKind.CONSENT]
        # If a person declines, the run ends during this step. So the step has no outcome.
        answered = [each for each in asked if each.consent is not None or each.outcome is StepOutcome.DONE]
        return answered[-1] if answered else None

    @property
    def agreed(self) -> bool | None:
        """True if the person gave consent, False if they declined, None if no step asked for consent."""
        if self.consent is None:
            return None
        answer = {} if self.consent.consent is None else self.consent.consent
        return bool(answer.get("agrees", self.consent.outcome is StepOutcome.DONE))

    @property
    def debriefed(self) -> bool | None:
        """True if the person finished a debriefing, None if the study has no debriefing."""
        if all(step.entry.step is not StepKind.DEBRIEF for step in self.run.plan):
            return None
        read = (each.outcome is StepOutcome.DONE for each in self.attempts if each.step.entry.step is StepKind.DEBRIEF)
        return any(read)

    def logged_of_consent(self, name: str) -> str | None:
        """Return a value from the logged answer to the consent question, or None."""
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
        "a person who started the study",
        (
            *run_columns(design),
            text(
                "state",
                "state of the run: under way, complete, declined, left or excluded",
                lambda row: str(row.run.state),
            ),
            text("reason", "reason why the person left or was excluded", lambda row: row.run.reason or None),
            text(
                "front_end",
                "program in which the person took part: window (of the kiosk) or browser; empty for simulated people "
                "and in logs of earlier releases",
                lambda row: row.run.front_end or None,
            ),
            count("place", "number of the place, from 0", lambda row: row.run.place.number),
            text(
                "cell",
                "combination of levels of all factors between people; empty if there are no factors between people",
                lambda row: design.cells[row.run.place.cell].name or None,
            ),
            text("order", "conditions in the order of this person", order),
            time(
                "began",
                "date and time of the start, UTC",
                lambda row: row.attempts[0].began if row.attempts else None,
            ),
            time(
                "ended",
                "date and time of the end of the last step, UTC",
                lambda row: row.attempts[-1].ended or None if row.attempts else None,
            ),
            seconds(
                "duration_s", "total time in all steps, from the program's clock; empty if a step was resumed", duration
            ),
            flag(
                "agreed",
                "true if the person agreed to take part; empty if no step asked for consent",
                lambda row: row.agreed,
            ),
            time(
                "agreed_at",
                "date and time of the answer to the consent question, UTC",
                lambda row: None if row.consent is None else row.consent.consent_at or row.consent.ended,
            ),
            text(
                "consent_sha256",
                "SHA-256 of the consent text that the person answered; empty if it is not in the log",
                lambda row: row.logged_of_consent("version"),
            ),
            count("attention_checks", "number of attention checks that the person saw", lambda row: len(row.attention)),
            count("attention_passed", "number of passed attention checks", lambda row: sum(row.attention)),
            flag(
                "debriefed",
                "true if the person read a debriefing; empty if the study has no debriefing",
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
                "outcome of the attempt: done, failed, passed over (skipped) or lost; empty if the attempt has not "
                "ended",
                lambda row: None if row.attempt.outcome is None else str(row.attempt.outcome),
            ),
            time("began", "date and time of the start, UTC", lambda row: row.attempt.began),
            seconds(
                "duration_s",
                "time in the step, from the program's clock (for a text: reading time); empty if it was resumed",
                lambda row: row.attempt.duration,
            ),
            count(
                "read_again",
                "number of times that the person opened the instructions again",
                lambda row: row.attempt.read_again,
            ),
            count(
                "resumed", "number of times that the step was resumed after a crash", lambda row: row.attempt.resumed
            ),
            count("away", "number of times that another window got the keyboard focus", lambda row: row.attempt.away),
            seconds(
                "away_s", "time for which other windows had the keyboard focus", lambda row: row.attempt.away_ns / 1e9
            ),
        ),
    )
    return table.of(subjects)
