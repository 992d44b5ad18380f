"""Text on participants: numbers of people who started, finished and left; characteristics, recruitment, sample size."""

import statistics
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from thbridge.experiment.allocation.places import NoPlace
from thbridge.experiment.design.experiment_file import ExperimentDesign
from thbridge.experiment.design.steps import StepKind
from thbridge.experiment.export.methods.markdown import joined, paragraph, sentence, table
from thbridge.experiment.export.tables import ExperimentRecords
from thbridge.experiment.progress import Run, failure
from thbridge.experiment.questionnaires.form import Scale
from thbridge.experiment.store.events import EventKind, RunState

END_BY_RESEARCHER = "ended by the researcher"
WITHDRAWN = "withdrawn"
_AGE, _GENDER = {"age"}, {"gender", "sex"}
"""Ids of items about participants' characteristics that a paper must report."""


@dataclass(frozen=True, slots=True)
class PersonOutcome:
    """Outcome of one person who started.

    Attributes:
        fate: a key of `FATES`.
        reason: reason in words; empty if none is needed.
        cell: index of the person's group, or None after a withdrawal.
    """

    fate: str
    reason: str = ""
    cell: int | None = None


FATES = {
    "complete": ("Completed and analyzed", "completed the study and were analyzed"),
    "declined": ("Declined", "declined to take part"),
    "left": ("Left", "left before the end"),
    END_BY_RESEARCHER: ("Ended by the researcher", "had their run ended by the researcher"),
    "excluded": ("Excluded", "were excluded"),
    WITHDRAWN: ("Withdrew, data deleted", "withdrew and had all of their data deleted"),
    "under way": ("Still taking part", "were still taking part at the time of this export"),
}
"""Outcomes of people, in order: name of the table's row, and words for a sentence."""


def participants_section(records: ExperimentRecords, people: str) -> Iterator[str]:
    """Yield the lines of the section. `people` is "participants" or "simulated participants"."""
    file, outcomes = records.design.file, outcomes_of(records)
    planned, is_full = records.design.allocation.size, records.progress.next_place() is NoPlace.FULL
    counts = Counter(outcome.fate for outcome in outcomes)
    ends = [_ended(counts[fate], words) for fate, (_, words) in FATES.items() if counts[fate] or fate == "complete"]
    yield "### Participants"
    yield ""
    yield from paragraph(
        f"The plan required {planned} {people} with complete data. Of {len(outcomes)} {people} who began, "
        f"{joined([*ends[1:], ends[0]])}.",
        "" if is_full else "Data collection was not complete at the time of this export.",
        _dates(records),
    )
    yield from _flow(records, outcomes)
    yield from paragraph(
        "[State who could take part: inclusion and exclusion criteria, such as age, language and experience.]",
        *_characteristics(records),
    )
    yield from paragraph(
        sentence(file.recruitment, "State how, where and when people were recruited, and their payment."),
        sentence(file.ethics, "State which ethics committee approved the study, with the number of the approval."),
    )


def _ended(number: int, words: str) -> str:
    """Return a clause with a number of people and their outcome: "2 were excluded", "1 was excluded"."""
    return f"{number} {words.replace('were ', 'was ') if number == 1 else words}"


def outcomes_of(records: ExperimentRecords) -> list[PersonOutcome]:
    """Return one outcome for each person who started."""
    ended_by = {
        entry.event.participant: entry.event.actor
        for entry in records.events
        if entry.event.kind == EventKind.RUN_ENDED
    }
    outcomes = []
    for run in records.runs:
        by_researcher = run.state is RunState.LEFT and ended_by.get(run.participant) == "experimenter"
        fate = END_BY_RESEARCHER if by_researcher else str(run.state)
        outcomes.append(PersonOutcome(fate, _reason(records.design, run), run.place.cell))
    return outcomes + [PersonOutcome(WITHDRAWN)] * records.withdrawn


def _flow(records: ExperimentRecords, outcomes: Sequence[PersonOutcome]) -> list[str]:
    """Return the lines of the table of outcomes. If there are several groups, the table also has numbers by group."""
    cells = records.design.cells if len(records.design.cells) > 1 else ()

    def numbers(some: Sequence[PersonOutcome]) -> tuple[int | str, ...]:
        each = Counter(outcome.cell for outcome in some)
        are_known = any(outcome.cell is not None for outcome in some)
        return (*(each[index] if are_known else "unknown" for index in range(len(cells))), len(some))

    rows = []
    for fate, (words, _) in FATES.items():
        own = [outcome for outcome in outcomes if outcome.fate == fate]
        for reason in sorted({outcome.reason for outcome in own}):
            rows.append((words, reason, *numbers([outcome for outcome in own if outcome.reason == reason])))
    rows.append(("Began, in total", "", *numbers(outcomes)))
    lines = table("Flow of participants", ("Outcome", "Reason", *(cell.name for cell in cells), "n"), rows)
    if cells and records.withdrawn:
        lines += paragraph("The groups of people who withdrew were deleted with their data.")
    return lines


def _reason(design: ExperimentDesign, run: Run) -> str:
    match run.state:
        case RunState.COMPLETE | RunState.UNDER_WAY:
            return ""
        case RunState.DECLINED:
            return run.reason or "no reason recorded"
        case RunState.EXCLUDED if run.code:
            return f"{run.reason or 'no reason recorded'} (after completing the study)"
    failed = next(
        (step for step in run.plan if step.entry.step is StepKind.CHECK and run.reason == failure(step)), None
    )
    if failed is not None:
        return f"failed the check {design.forms[failed.index].title or failed.name}"
    at = f", at {run.plan[run.step - 1].name}" if run.state is RunState.LEFT and run.step <= len(run.plan) else ""
    return f"{run.reason or 'no reason recorded'}{at}"


def _dates(records: ExperimentRecords) -> str:
    days = sorted(entry.event.clocks.wall[:10] for entry in records.events if entry.event.kind == EventKind.RUN_BEGUN)
    if not days or records.is_rehearsal:
        return ""
    return f"They took part from {days[0]} to {days[-1]}." if days[0] != days[-1] else f"They took part on {days[0]}."


def _characteristics(records: ExperimentRecords) -> Iterator[str]:
    """Yield sentences about age and gender if a form has items with these ids.

    Also yield a note in brackets about all other information, which the author must add.
    """
    ages: dict[str, float] = {}
    genders: dict[str, str] = {}
    asked = {
        item.id: item for form in records.design.forms.values() for item in form.items if item.id in _AGE | _GENDER
    }
    for subject in records.subjects:
        if subject.run.state is not RunState.COMPLETE:
            continue
        for name, times in subject.attempt.items.items():
            if name in _AGE and asked[name].scale is Scale.NUMBER and isinstance(times.answer, int | float):
                ages[subject.run.participant] = float(times.answer)
            elif name in _GENDER and isinstance(times.answer, str):
                genders[subject.run.participant] = times.answer
    if ages:
        values = [*ages.values()]
        deviation = f", SD = {statistics.stdev(values):.1f}" if len(values) > 1 else ""
        yield (
            f"Of those analyzed, {len(values)} stated their age (M = {statistics.fmean(values):.1f}{deviation}, "
            f"range {min(values):g} to {max(values):g})."
        )
    if genders:
        shares = [f"{answer} ({number})" for answer, number in Counter(genders.values()).most_common()]
        yield f"They stated as their gender: {', '.join(shares)}."
    missing = [name for name, known in (("age (M, SD, range)", ages), ("gender", genders)) if not known]
    also = "experience with robots and games, and other important characteristics"
    gap = joined([*missing, also])
    yield f"[{gap[0].upper()}{gap[1:]}, with the questions that you asked.]"


def sample_size_section(records: ExperimentRecords) -> Iterator[str]:
    """Yield the lines of the section."""
    design, file = records.design, records.design.file
    groups = len(design.cells)
    each = f", {file.quota} in each of {groups} groups" if groups > 1 else ""
    yield "### Sample size, power, and precision"
    yield ""
    yield from paragraph(
        f"The planned sample size was {design.allocation.size}{each}.",
        sentence(
            file.sample_size_reason,
            "Reason for this number: a power analysis (state the assumed effect size and its source), the desired "
            "precision, or the available resources. `thbridge study power` estimates power by rehearsals.",
        ),
        "The program was set to admit people until this number of valid runs was reached. If a run did not count, the "
        "next participant got its place.",
        "[State whether anyone looked at the data before the end of data collection.]",
    )


def consent_versions(records: ExperimentRecords) -> Counter[str]:
    """Return the number of analyzed people who agreed to each version of the consent text, by its digest."""
    return Counter(
        str(subject.attempt.consent.get("version", "not recorded"))
        for subject in records.subjects
        if subject.run.state is RunState.COMPLETE
        and subject.attempt.step.entry.step is StepKind.CONSENT
        and subject.attempt.consent is not None
    )
