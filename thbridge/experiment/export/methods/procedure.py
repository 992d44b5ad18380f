"""Text on the procedure: steps of a participant, consent, checks with attempts and failures, durations."""

import itertools
from collections.abc import Iterator, Sequence

from thbridge.experiment.design.experiment_file import ExperimentDesign, name_of
from thbridge.experiment.design.steps import Failed, PracticeTerm, ResumeRule, StepEntry, StepKind
from thbridge.experiment.export.methods.markdown import (
    Spread,
    counted,
    joined,
    listed,
    paragraph,
    sentence,
    spread,
    table,
)
from thbridge.experiment.export.methods.measures import scale_words
from thbridge.experiment.export.methods.participants import consent_versions
from thbridge.experiment.export.methods.settings import practice_settings
from thbridge.experiment.export.tables import ExperimentRecords
from thbridge.experiment.store.events import RunState, StepOutcome


def procedure_section(records: ExperimentRecords, people: str) -> Iterator[str]:
    """Yield the lines of the section. `people` is "participants" or "simulated participants"."""
    design = records.design
    yield "### Procedure"
    yield ""
    asked = f"Before the first step, {people} entered the code that a recruiting service had given them."
    yield from paragraph(
        asked if design.file.recruiting.ask else "", f"Each of the {people} went through these steps in this order:"
    )
    yield from _steps(design)
    yield from _consent(records, people)
    for index, entry in enumerate(design.file.steps):
        if entry.step is StepKind.CHECK:
            yield from _check(records, index, entry, people)
    yield from table("Durations of those analyzed", ("Step", "n", "Median", "Least", "Greatest"), _durations(records))
    kinds = {entry.step for entry in design.file.steps}
    repeated = any(entry.step is StepKind.CHECK and entry.attempts > 1 for entry in design.file.steps)
    yield from paragraph(
        "The step of a game includes its start and the page with its result."
        if kinds & {StepKind.PRACTICE, StepKind.TRIAL}
        else "",
        "If steps were repeated after a failed check, each repetition counts." if repeated else "",
        "Steps that a crash interrupted have no duration."
        if any(subject.attempt.resumed for subject in records.subjects)
        else "",
    )


def _steps(design: ExperimentDesign) -> Iterator[str]:
    numbered = enumerate(design.file.steps)
    number = 0
    for each, block in itertools.groupby(numbered, key=lambda pair: pair[1].each_condition):
        if each and len(design.conditions) > 1:
            number += 1
            yield f"{number}. For each condition, in the participant's order:"
            yield from (f"    * {_step(design, index, entry)}" for index, entry in block)
            continue
        for index, entry in block:
            number += 1
            yield f"{number}. {_step(design, index, entry)}"
    yield ""


def _step(design: ExperimentDesign, index: int, entry: StepEntry) -> str:
    form = design.forms.get(index)
    title = "" if form is None else f" ({form.title})"
    match entry.step:
        case StepKind.INSTRUCTIONS:
            words = f"Instructions on screen ({entry.text})"
        case StepKind.CONSENT:
            words = f"Consent on screen ({entry.text})"
        case StepKind.PRACTICE:
            words = f"Practice game of at most {entry.max_seconds:g} s, {_practice(design, index, entry)}"
        case StepKind.CHECK:
            words = f"Comprehension check{title}"
        case StepKind.TRIAL:
            words = f"Game of at most {entry.max_seconds:g} s"
        case StepKind.FORM:
            words = f"Questionnaire{title}"
        case StepKind.PAUSE:
            words = "Pause of any length"
        case StepKind.DEBRIEF:
            scores = "with the score and the best possible score of each game" if entry.results else ""
            leavers = "also for participants who left or were excluded" if entry.when_leaving else ""
            words = ", ".join(filter(None, (f"Debriefing on screen ({entry.text})", scores, leavers)))
    only = " and ".join(f"{item} was answered “{answer}”" for item, answer in entry.when.items())
    rule = {
        ResumeRule.EXACT: "",
        ResumeRule.BEGINNING: "restarted after a crash",
        ResumeRule.NEVER: "ended the run after a crash",
    }
    levels = joined([f"{factor}={level}" for factor, level in entry.only_at.items()])
    notes = [f"only at {levels}" if levels else "", f"only if {only}" if only else "", rule[entry.resume]]
    text = "; ".join(note for note in notes if note)
    return f"{words}; {text}." if text else f"{words}."


def _practice(design: ExperimentDesign, index: int, entry: StepEntry) -> str:
    """Return the settings of a practice game and its requirements, in words."""
    own = [f"{key}: {value}" for key, value in practice_settings(design, index)]
    but = f", except for {', '.join(own)}" if own else ""
    demands = [
        f"{number:g} {_DONE[PracticeTerm(term)]}{'' if number == 1.0 else 's'}"
        for term, number in ((term, float(each)) for term, each in entry.at_least.items())
        if number > 0.0
    ]
    done = f"; participants could continue after at least {joined(demands)}" if demands else ""
    each = entry.each_condition and len(design.conditions) > 1
    first = "first " if len(design.conditions) > 1 else ""
    which = "that condition" if each else f"the participant's {first}condition"
    return f"in the settings of {which}{but}, with another random seed{done}"


_DONE = {
    PracticeTerm.SECONDS: "second",
    PracticeTerm.MOVES: "move",
    PracticeTerm.PICTURES: "picture",
    PracticeTerm.IDENTIFIED: "named treasure",
    PracticeTerm.DIALOGUES: "dialogue",
}
"""Noun for one unit of each requirement of practice games."""


def _consent(records: ExperimentRecords, people: str) -> Iterator[str]:
    design, steps = records.design, records.design.file.steps
    asked = next((index for index, entry in enumerate(steps) if entry.step is StepKind.CONSENT), None)
    if asked is None and design.file.consent_elsewhere:
        yield from paragraph(sentence(design.file.consent_elsewhere, ""))
        return
    if asked is None:
        yield from paragraph(f"[How {people} gave informed consent: no step of the program asked for it.]")
        return
    versions = consent_versions(records)
    texts = ", ".join(f"{digest[:12]}... (n = {number})" for digest, number in versions.most_common())
    first_data = next(
        (index for index, entry in enumerate(steps) if entry.step in {StepKind.TRIAL, StepKind.FORM}), len(steps)
    )
    when = "before any data was collected" if asked < first_data else "after data had been collected"
    yield from paragraph(
        f"The program asked for consent on screen, {when}. The study ended for people who did not agree.",
        f"All analyzed people saw the same version of the text, with SHA-256 {texts}." if len(versions) == 1 else "",
        f"The text was changed during the study. Versions by SHA-256, with n: {texts}." if len(versions) > 1 else "",
    )


def _check(records: ExperimentRecords, index: int, entry: StepEntry, people: str) -> Iterator[str]:
    """Yield sentences about a check: questions, rule for passing, attempts and failures."""
    design, form = records.design, records.design.forms[index]
    asked = [item for item in form.items if item.is_checked]
    needed = len(asked) if entry.right is None else entry.right
    tries = "once" if entry.attempts == 1 else f"up to {entry.attempts} times"
    again = f", repeating from the step {entry.repeat} after a failure" if entry.repeat and entry.attempts > 1 else ""
    failed = (
        "Participants who failed the last attempt were excluded."
        if entry.failed is Failed.EXCLUDE
        else "Participants who failed the last attempt continued. The data mark these participants."
    )
    yield from paragraph(
        f"The check *{form.title}* had {counted(len(asked), 'question')} with a right answer; it took "
        f"{counted(needed, 'right answer')} to pass. It could be tried {tries}{again}. {failed}",
        *_results(records, index, people),
    )
    rows = [(item.text, scale_words(item), _right(item.correct, item.correct_by_condition)) for item in asked]
    yield from table(
        f"Questions of {form.title or name_of(index, entry)}", ("Question", "Answers", "Right answer"), rows
    )
    if any(item.correct_by_condition for item in asked) and design.conditions:
        yield from paragraph(
            "If the right answer depended on the condition, the answer that was right in the participant's condition "
            "counted."
        )


def _right(correct: str | None, by_condition: object) -> str:
    ways = dict(by_condition) if isinstance(by_condition, dict) else {}
    text = [f"{level}: {answer}" for level, answer in ways.items()]
    return listed([*text, *([f"else: {correct}" if text else correct] if correct is not None else [])])


def _results(records: ExperimentRecords, index: int, people: str) -> Iterator[str]:
    """Yield the number of people who passed a check, by attempt. All conditions are counted together."""
    tried: dict[tuple[str, int], list[StepOutcome]] = {}
    for subject in records.subjects:
        step, outcome = subject.attempt.step, subject.attempt.outcome
        if step.index == index and outcome in {StepOutcome.DONE, StepOutcome.FAILED}:
            tried.setdefault((subject.run.participant, step.number), []).append(outcome)
    if not tried:
        yield f"None of the {people} has answered it yet."
        return
    each = len({person for person, _ in tried}) < len(tried)
    first = sum(outcomes[0] is StepOutcome.DONE for outcomes in tried.values())
    later = sum(outcomes[-1] is StepOutcome.DONE for outcomes in tried.values()) - first
    attempts = sum(len(outcomes) for outcomes in tried.values())
    failures = sum(outcome is StepOutcome.FAILED for outcomes in tried.values() for outcome in outcomes)
    who = f"{len(tried)} times that it was asked" if each else f"{len(tried)} {people} who answered it"
    yield (
        f"Of {who}, {first} passed at the first attempt, {later} at a later attempt, and {len(tried) - first - later} "
        f"did not pass ({counted(attempts, 'attempt')}, {counted(failures, 'failure')})."
    )


def _durations(records: ExperimentRecords) -> Sequence[tuple[str, *Spread]]:
    own = [subject for subject in records.subjects if subject.run.state is RunState.COMPLETE]
    rows: list[tuple[str, *Spread]] = []
    for name in dict.fromkeys(subject.attempt.step.name for subject in own):
        known = [
            seconds
            for subject in own
            if subject.attempt.step.name == name
            and subject.attempt.outcome is not StepOutcome.PASSED_OVER
            and (seconds := subject.attempt.duration) is not None
        ]
        if known:
            rows.append((name, *spread(known)))
    whole = _whole(records)
    return [*rows, ("all steps of a participant", *spread(whole))] if whole else rows


def _whole(records: ExperimentRecords) -> list[float]:
    """Return the total time in all steps of each analyzed person. People with an interrupted step are left out."""
    of_person: dict[str, list[float | None]] = {}
    for subject in records.subjects:
        if subject.run.state is RunState.COMPLETE:
            of_person.setdefault(subject.run.participant, []).append(subject.attempt.duration)
    return [sum(each or 0.0 for each in times) for times in of_person.values() if None not in times]
