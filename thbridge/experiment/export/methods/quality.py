"""Text on the quality of the data: recordings, crashes, lag, distraction, exclusions and missing answers."""

import statistics
from collections import Counter
from collections.abc import Iterator

from thbridge.experiment.design.steps import Failed, ResumeRule, StepKind
from thbridge.experiment.export.families.trials import RecordingState, Trial
from thbridge.experiment.export.methods.markdown import counted, listing, paragraph, spread, table
from thbridge.experiment.export.tables import ExperimentRecords
from thbridge.experiment.questionnaires.scoring import NOT_APPLICABLE
from thbridge.experiment.store.events import RunState, StepOutcome


def quality_section(records: ExperimentRecords) -> Iterator[str]:
    """Yield the lines of the section."""
    games = [
        trial
        for trial in records.trials
        if trial.run.state is RunState.COMPLETE and trial.attempt.step.entry.step is StepKind.TRIAL
    ]
    yield "### Data collection and quality of measurements"
    yield ""
    yield from paragraph(
        "The program logged every event on disk before it showed the next page. Chained SHA-256 digests verify that "
        "the "
        "log is complete and unchanged.",
        *_games(games),
    )
    yield from paragraph(*_pace(records, games))
    yield from table("Games of those analyzed", ("Measure", "n", "Median", "Least", "Greatest"), _lengths(games))
    yield from paragraph(*_distraction(records))


def _games(games: list[Trial]) -> Iterator[str]:
    if not games:
        return
    kinds = Counter(trial.recording for trial in games)
    whole = kinds[RecordingState.AS_RECORDED]
    if kinds[RecordingState.NONE] == len(games):
        yield "The games were not recorded."
    elif whole == len(games):
        yield f"All {len(games)} games of analyzed people have an intact recording."
    else:
        yield f"Of {len(games)} games of analyzed people, {whole} have an intact recording."
    if resumed := sum(trial.attempt.resumed > 0 for trial in games):
        yield f"A crash interrupted {counted(resumed, 'game')}. The program later resumed from the same point."
    if again := sum(trial.attempt.broken_off > 0 for trial in games):
        yield f"In {counted(again, 'step')}, a game was abandoned after a crash, and another game was played instead."


def _pace(records: ExperimentRecords, games: list[Trial]) -> Iterator[str]:
    if not games:
        return
    bound = records.design.file.most_lag
    lags = [float(lag) for trial in games if isinstance(lag := trial.logged("most_lag_seconds"), int | float)]
    if records.is_rehearsal:
        yield "A rehearsal does not run in real time."
    elif lags:
        yield (
            f"Simulated time was behind real time by at most {max(lags):.1f} s (largest lag of each game: median of "
            f"{counted(len(lags), 'game')} {statistics.median(lags):.1f} s)."
        )
    else:
        yield "The log has only simulated times of these games, no real times."
    if bound is not None:
        slow = sum(run.state is RunState.EXCLUDED and "behind real time" in run.reason for run in records.runs)
        yield (
            f"Runs with a game that was more than {bound:g} s behind did not count. This rule excluded "
            f"{counted(slow, 'run')}."
        )


def _lengths(games: list[Trial]) -> Iterator[tuple[object, ...]]:
    for name, key in (("game, simulated time", "sim_seconds"), ("game, real time", "wall_seconds")):
        known = [float(value) for trial in games if isinstance(value := trial.logged(key), int | float)]
        if known:
            yield (name, *spread(known))


def _distraction(records: ExperimentRecords) -> Iterator[str]:
    own = [subject.attempt for subject in records.subjects if subject.run.state is RunState.COMPLETE]
    away = [attempt for attempt in own if attempt.away]
    if away:
        seconds = sum(attempt.away_ns for attempt in away) / 1e9
        yield f"In {counted(len(away), 'step')}, participants used another window, for {seconds:.0f} s in total."
    pasted = sum(times.pasted > 0 for attempt in own for times in attempt.items.values())
    if pasted:
        yield f"Text was pasted into {counted(pasted, 'answer')}."


def exclusions_section(records: ExperimentRecords) -> Iterator[str]:
    """Yield the lines of the section."""
    file, design = records.design.file, records.design
    yield "### Data diagnostics and exclusions"
    yield ""
    rules = [
        f"Failing the last attempt at the check *{design.forms[index].title}*."
        for index, entry in enumerate(file.steps)
        if entry.step is StepKind.CHECK and entry.failed is Failed.EXCLUDE
    ]
    if any(entry.resume is ResumeRule.NEVER for entry in file.steps):
        rules.append("A crash during a step that must not be interrupted.")
    if file.most_lag is not None:
        rules.append(f"A game that was more than {file.most_lag:g} s behind real time.")
    if rules:
        yield from paragraph("The program excluded runs by these rules of the study's design:")
        yield from listing(rules)
    if file.exclusions:
        yield from paragraph("The researchers excluded runs by these rules:")
        yield from listing(file.exclusions)
    else:
        yield from paragraph(
            "[Rules by which the researchers excluded runs or answers. State whether the rules were set before the "
            "researchers saw the data. Or state that there were no rules.]"
        )
    yield from paragraph("Practice games and checks did not count as data.", *_missing(records))
    yield from paragraph("[How outliers, missing answers and violated assumptions of the tests were handled.]")


def _missing(records: ExperimentRecords) -> Iterator[str]:
    steps = [
        subject.attempt
        for subject in records.subjects
        if subject.run.state is RunState.COMPLETE
        and subject.attempt.step.entry.step is StepKind.FORM
        and subject.attempt.outcome is StepOutcome.DONE
    ]
    asked = empty = optional = inapplicable = 0
    for attempt in steps:
        for item in records.design.forms[attempt.step.index].items:
            times = attempt.items.get(item.id)
            asked += 1
            answer = None if times is None else times.answer
            empty += answer is None
            optional += answer is None and not item.required
            inapplicable += item.not_applicable and answer == NOT_APPLICABLE
    if asked:
        could = f" ({optional} of them to optional items)" if optional else ""
        yield (
            f"Of {counted(asked, 'answer')} to questionnaires, {empty} were empty{could}, and {inapplicable} were not "
            f"applicable."
        )
    scores = [score for score in records.scores if score.run.state is RunState.COMPLETE]
    scores = [score for score in scores if score.attempt.step.entry.step is StepKind.FORM]
    if lacking := sum(score.value is None for score in scores):
        yield f"Of {counted(len(scores), 'score')}, {lacking} had too few answers for the computation."
