"""The tables `answers` and `scores`: answers to items, and scores of forms."""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from thbridge.experiment.design.experiment_file import ExperimentDesign
from thbridge.experiment.export.families.attempts import (
    Attempt,
    AttemptSubject,
    ItemTimes,
    attempt_columns,
    between,
)
from thbridge.experiment.export.families.described import (
    ExperimentTable,
    TableOf,
    count,
    flag,
    number,
    seconds,
    text,
)
from thbridge.experiment.progress import Run
from thbridge.experiment.questionnaires.form import MEASURED, Form, Item, Scale, Scoring
from thbridge.experiment.questionnaires.scoring import NOT_APPLICABLE, Answer, keyed, scores_of
from thbridge.experiment.questionnaires.scoring import is_right as judged
from thbridge.experiment.store.events import JsonValue


@dataclass(frozen=True, slots=True)
class _GivenItem:
    """An item that was shown in an attempt."""

    run: Run
    attempt: Attempt
    item: Item
    times: ItemTimes

    @property
    def answer(self) -> Answer | None:
        """The final answer, or None."""
        return _answer(self.times.answer)


@dataclass(frozen=True, slots=True)
class GivenScore:
    """A score of a completed form.

    Attributes:
        run: run of the person.
        attempt: attempt at the form.
        subscale: name of the score.
        items: items of the score.
        value: the score, or None if too few items were answered.
        answered: number of items with a number as the answer.
        scoring: rule by which the score is computed from its items.
    """

    run: Run
    attempt: Attempt
    subscale: str
    items: tuple[Item, ...]
    value: float | None
    answered: int
    scoring: Scoring

    @property
    def share(self) -> float | None:
        """The score scaled to 0 (smallest possible score) to 1 (greatest possible score), or None without a score."""
        if self.value is None:
            return None
        count = len(self.items) if self.scoring is Scoring.MEAN else 1
        least = math.fsum(item.least for item in self.items) / count
        greatest = math.fsum(item.greatest for item in self.items) / count
        return (self.value - least) / (greatest - least)


def answers(design: ExperimentDesign, subjects: Sequence[AttemptSubject]) -> ExperimentTable:
    """Return the table of answers."""

    def items() -> Iterator[_GivenItem]:
        for subject, form in _with_forms(design, subjects):
            known = {item.id: item for item in form.items}
            for name, times in subject.attempt.items.items():
                yield _GivenItem(subject.run, subject.attempt, known[name], times)

    def value(row: _GivenItem) -> float | None:
        is_number = row.item.scale in {*MEASURED, Scale.NUMBER}
        return row.answer if isinstance(row.answer, float) and is_number else None

    def is_right(row: _GivenItem) -> bool | None:
        return judged(row.item, row.times.answer, design.levels_at(row.run.place.cell, row.attempt.step.condition))

    table: TableOf[_GivenItem] = TableOf(
        "answers",
        "an item that a person saw",
        (
            *attempt_columns(design),
            text("item", "id of the item in its form", lambda row: row.item.id),
            text("scale", "type of the answer", lambda row: str(row.item.scale)),
            text(
                "answer",
                "the answer; several options are separated by semicolons; empty if there is no answer",
                lambda row: None if row.answer is None else _words(row.answer),
            ),
            flag(
                "not_applicable",
                "true if the answer is: not applicable",
                lambda row: row.times.answer == NOT_APPLICABLE and row.item.not_applicable,
            ),
            number("value", "", "the answer as a number, not reversed; empty if it is not a number", value),
            number(
                "keyed",
                "",
                "the number for the score, reversed for reversed items",
                lambda row: _known(keyed(row.item, row.answer)) if row.item.score else None,
            ),
            flag("right", "true if the answer is right; empty for items without a right answer", is_right),
            flag("attention", "true if the item is an attention check", lambda row: row.item.attention),
            flag(
                "timed_out",
                "true if the item was closed at its time limit; then the answer at that time counts",
                lambda row: row.times.timed_out,
            ),
            text(
                "options_shown",
                "possible answers in the order on the person's screen, separated by semicolons; empty if all people "
                "see "
                "the form's order",
                lambda row: "; ".join(row.times.options) or None,
            ),
            seconds(
                "seen_s",
                "time from the display of the item to the final answer",
                lambda row: between(row.times.shown, row.times.given),
            ),
            seconds(
                "hesitation_s",
                "time from the display of the item to the person's first action",
                lambda row: between(row.times.shown, row.times.touched),
            ),
            count("changes", "number of changes before the final answer", lambda row: row.times.changes),
            count("pasted", "number of characters pasted into the answer", lambda row: row.times.pasted),
        ),
    )
    return table.of(items())


def attention_checks(design: ExperimentDesign, subjects: Sequence[AttemptSubject]) -> dict[str, list[bool]]:
    """Return the results of all attention checks that were shown, by the participant's id. True means passed.

    A check that was closed without an answer counts as failed. Checks that were not shown do not count.
    """
    passed: dict[str, list[bool]] = {}
    for subject, form in _with_forms(design, subjects):
        levels = design.levels_at(subject.run.place.cell, subject.attempt.step.condition)
        for item in form.items:
            times = subject.attempt.items.get(item.id)
            if item.attention and times is not None and times.given is not None:
                right = judged(item, times.answer, levels)
                if right is not None:
                    passed.setdefault(subject.run.participant, []).append(right)
    return passed


def given_scores(design: ExperimentDesign, subjects: Sequence[AttemptSubject]) -> list[GivenScore]:
    """Return all scores."""
    found = []
    for subject, form in _with_forms(design, subjects):
        items = subject.attempt.items.items()
        given = {name: answer for name, times in items if (answer := _answer(times.answer)) is not None}
        for subscale, score in scores_of(form, given).items():
            of_it = form.subscales[subscale]
            answered = sum(_known(keyed(item, given.get(item.id))) is not None for item in of_it)
            found.append(
                GivenScore(subject.run, subject.attempt, subscale, of_it, _known(score), answered, form.scoring)
            )
    return found


def scores(design: ExperimentDesign, given: Sequence[GivenScore]) -> ExperimentTable:
    """Return the table of scores."""
    table: TableOf[GivenScore] = TableOf(
        "scores",
        "a score of a completed form",
        (
            *attempt_columns(design),
            text("subscale", "name of the score in its form", lambda row: row.subscale),
            number("score", "", "value of the score; empty if too few items were answered", lambda row: row.value),
            count("items", "number of items of the score", lambda row: len(row.items)),
            count("answered", "number of items of the score with a number as the answer", lambda row: row.answered),
        ),
    )
    return table.of(given)


def _with_forms(design: ExperimentDesign, subjects: Sequence[AttemptSubject]) -> Iterator[tuple[AttemptSubject, Form]]:
    for subject in subjects:
        if (form := design.forms.get(subject.attempt.step.index)) is not None:
            yield subject, form


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


def _known(value: float) -> float | None:
    """Return None for NaN, and any other value unchanged."""
    return None if math.isnan(value) else value
