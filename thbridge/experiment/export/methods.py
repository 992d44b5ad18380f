"""The paragraph of a paper's methods, and its tables: people, exclusions with reasons, orders, durations, software."""

import statistics
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence

from thbridge.experiment.design.experiment_file import ExperimentDesign
from thbridge.experiment.design.steps import StepKind
from thbridge.experiment.export.families.attempts import NO_DATA, AttemptSubject
from thbridge.experiment.export.tables import ExperimentRecords
from thbridge.experiment.questionnaires.form import Item
from thbridge.experiment.questionnaires.scoring import Answer, reliability_of
from thbridge.experiment.store.events import EventKind, RunState, StepOutcome


def methods_text(records: ExperimentRecords, versions: Mapping[str, str], registered: str) -> str:
    """Return the text; gaps that the log cannot fill are marked [so].

    Args:
        records: of the experiment.
        versions: of the programs.
        registered: sentence on the preregistration.
    """
    design, runs = records.design, [*records.progress.runs.values()]
    counts = Counter(run.state for run in runs)
    agreed = f"{counts[RunState.DECLINED]} declined, {counts[RunState.LEFT]} left, {counts[RunState.EXCLUDED]} were"
    lines = [
        f"# {design.file.title}",
        "",
        f"Of {design.allocation.size} people planned, {len(runs)} began and {counts[RunState.COMPLETE]} are analysed;",
        f"{agreed} excluded, and {counts[RunState.UNDER_WAY]} are under way.",
        design.file.recruitment or "[How people were recruited and paid.]",
        "[Age and gender as they were asked.]",
        _design_sentence(design),
        _medium(records, versions),
        f"{registered} [Where the data is.]",
        "Practice and checks are no data. Steps that a crash cut off have no duration.",
        "",
        *_table(("Not analysed", "reason", "people"), _left_out(records)),
        *_table(("Group", "order", "people analysed"), _places(records)),
        *_table(("Time", "n", "median", "least", "greatest"), _durations(records)),
        *_table(("Score", "condition", "items", "n", "Cronbach's alpha", "McDonald's omega"), _reliabilities(records)),
        "Omega is that of one factor, fitted to correlations by least squares; n are people who answered all items.",
        "",
    ]
    return "\n".join(lines)


def is_rehearsal(records: ExperimentRecords) -> bool:
    """Return True when programs took part in the place of people."""
    return any(entry.event.kind == EventKind.REHEARSED for entry in records.events)


def _medium(records: ExperimentRecords, versions: Mapping[str, str]) -> str:
    software = f"thbridge {versions.get('thbridge', '[version]')}, Python {versions.get('python', '[version]')}"
    if is_rehearsal(records):
        return f"**This was rehearsed by programs: nobody took part.** The robots were simulated ({software})."
    return f"The robots were simulated and shown in a window ({software})."


def _table(header: Sequence[str], rows: Iterable[Sequence[object]]) -> list[str]:
    lines = [f"| {' | '.join(map(str, row))} |" for row in rows]
    return [f"| {' | '.join(header)} |", f"|{'---|' * len(header)}", *lines, ""] if lines else []


def _design_sentence(design: ExperimentDesign) -> str:
    within, between = design.conditions[0].levels, design.cells[0].levels
    parts = []
    if within:
        parts.append(f"{', '.join(within)} within people ({len(design.conditions)} conditions)")
    if between:
        parts.append(f"{', '.join(between)} between people ({len(design.cells)} groups)")
    order = {"balanced": "a balanced Latin square", "cyclic": "a Latin square", "fixed": "a fixed order"}
    varied, came = " and ".join(parts) or "nothing", order[design.file.order]
    return f"Varied were {varied}; orders came from {came}, dealt in blocks by seed {design.file.seed}."


def _left_out(records: ExperimentRecords) -> Sequence[Sequence[object]]:
    others = Counter(
        (str(run.state), run.reason or "none told")
        for run in records.progress.runs.values()
        if run.state not in {RunState.COMPLETE, RunState.UNDER_WAY}
    )
    return [(*key, people) for key, people in sorted(others.items())]


def _places(records: ExperimentRecords) -> Sequence[Sequence[object]]:
    design = records.design
    runs = (run for run in records.progress.runs.values() if run.state is RunState.COMPLETE)
    counts = Counter((run.place.cell, run.place.order) for run in runs)
    return [
        (
            design.cells[cell].name or "all",
            "; ".join(design.conditions[one].name for one in design.orders[order]) or "one condition",
            counts[cell, order],
        )
        for cell in range(len(design.cells))
        for order in range(len(design.orders))
    ]


def _durations(records: ExperimentRecords) -> Sequence[Sequence[object]]:
    own = [subject for subject in records.subjects if subject.run.state is RunState.COMPLETE]
    rows = []
    for name in dict.fromkeys(subject.attempt.step.name for subject in own):
        known = [each for subject in own if subject.attempt.step.name == name and (each := _time(subject)) is not None]
        if known:
            rows.append((f"step {name}", *_spread(known)))
    games = [
        seconds
        for trial in records.trials
        if trial.run.state is RunState.COMPLETE
        and trial.attempt.step.entry.step is StepKind.TRIAL
        and isinstance(seconds := trial.told("sim_seconds"), int | float)
    ]
    return [*rows, ("game, simulated", *_spread(games))] if games else rows


def _time(subject: AttemptSubject) -> float | None:
    return None if subject.attempt.outcome is StepOutcome.PASSED_OVER else subject.attempt.duration


def _spread(known: Sequence[float]) -> tuple[object, ...]:
    return len(known), f"{statistics.median(known):.0f} s", f"{min(known):.0f} s", f"{max(known):.0f} s"


def _reliabilities(records: ExperimentRecords) -> Sequence[Sequence[object]]:
    """Rows of each score, and of each condition in which the form was filled in: so nobody counts twice."""
    items_of: dict[str, tuple[Item, ...]] = {}
    given: dict[tuple[str, str], list[Mapping[str, Answer]]] = {}
    for score in records.scores:
        step = score.attempt.step
        if score.run.state is not RunState.COMPLETE or step.entry.step in NO_DATA:
            continue
        condition = "" if step.condition is None else records.design.conditions[step.condition].name
        times = score.attempt.items
        answers = {
            item.id: float(answer)
            for item in score.items
            if item.id in times and isinstance(answer := times[item.id].answer, int | float)
        }
        items_of[score.subscale] = score.items
        given.setdefault((score.subscale, condition), []).append(answers)
    rows = []
    for (subscale, condition), people in sorted(given.items()):
        found = reliability_of(items_of[subscale], people)
        told = ("[too few]" if one != one else f"{one:.2f}" for one in (found.alpha, found.omega))  # noqa: PLR0124
        rows.append((subscale, condition or "none", found.items, found.people, *told))
    return rows
