"""The paragraph of a paper's methods: who took part, who was left out and why, orders, durations, software."""

import statistics
from collections import Counter
from collections.abc import Iterable, Mapping

from thbridge.experiment.design.experiment_file import ExperimentDesign
from thbridge.experiment.export.tables import ExperimentTable
from thbridge.experiment.progress import Progress, RunState
from thbridge.experiment.questionnaires.scoring import Answer, reliability_of


def methods_text(
    design: ExperimentDesign,
    progress: Progress,
    tables: Mapping[str, ExperimentTable],
    versions: Mapping[str, str],
    registered: str,
) -> str:
    """Return the text; gaps that the log cannot fill are marked [so].

    Args:
        design: the experiment.
        progress: where everybody is.
        tables: its tables, by name.
        versions: of the programs.
        registered: sentence on the preregistration.
    """
    runs = list(progress.runs.values())
    counted = [run for run in runs if run.state is RunState.COMPLETE]
    others = Counter(f"{run.state}: {run.reason}" if run.reason else str(run.state) for run in runs)
    for complete in [name for name in others if name.startswith(str(RunState.COMPLETE))]:
        del others[complete]
    lines = [
        f"# {design.file.title}",
        "",
        f"Of {design.allocation.size} people planned, {len(runs)} began and {len(counted)} are analysed.",
    ]
    if others:
        lines.append(f"Not analysed: {_listed(f'{count} ({reason})' for reason, count in sorted(others.items()))}.")
    lines += [
        "[How people were recruited and paid; age and gender as they were asked.]",
        _design_sentence(design),
        *_cells(design, progress),
        *_durations(tables["steps"]),
        *_reliabilities(design, tables["answers"]),
        f"The robots were simulated and shown in a window (thbridge {versions.get('thbridge', '[version]')}, "
        f"Python {versions.get('python', '')}). {registered} [Where the data is.]",
        "",
    ]
    return "\n".join(lines)


def _listed(words: Iterable[str]) -> str:
    return ", ".join(words)


def _design_sentence(design: ExperimentDesign) -> str:
    within, between = design.conditions[0].levels, design.cells[0].levels
    parts = []
    if within:
        parts.append(f"{_listed(within)} within people ({len(design.conditions)} conditions)")
    if between:
        parts.append(f"{_listed(between)} between people ({len(design.cells)} groups)")
    order = {"balanced": "a balanced Latin square", "cyclic": "a Latin square", "fixed": "a fixed order"}
    varied, came = " and ".join(parts) or "nothing", order[design.file.order]
    return f"Varied were {varied}; orders came from {came}, dealt in blocks by seed {design.file.seed}."


def _cells(design: ExperimentDesign, progress: Progress) -> list[str]:
    counts = Counter(
        (run.place.cell, run.place.order) for run in progress.runs.values() if run.state is RunState.COMPLETE
    )
    told = []
    for index, cell in enumerate(design.cells):
        by_order = [counts[index, order] for order in range(len(design.orders))]
        told.append(f"{cell.name or 'All people'}: {sum(by_order)} people, by order {_listed(map(str, by_order))}.")
    return told


def _durations(steps: ExperimentTable) -> list[str]:
    trials = [float(row["duration_s"] or 0.0) for row in steps.rows if row["kind"] == "trial" and row["run_counts"]]
    known = [seconds for seconds in trials if seconds == seconds]  # noqa: PLR0124 - NaN: a trial that was resumed
    if not known:
        return []
    return [f"A game took {statistics.median(known):.0f} s (median; {min(known):.0f} to {max(known):.0f} s)."]


def _reliabilities(design: ExperimentDesign, answers: ExperimentTable) -> list[str]:
    told = []
    for form in {form.title: form for form in design.forms.values()}.values():
        for name, items in form.subscales.items():
            wanted = {item.id for item in items}
            people: dict[tuple[object, ...], dict[str, Answer]] = {}
            for row in answers.rows:
                if row["item"] in wanted and row["run_counts"] and isinstance(row["value"], float):
                    key = (row["participant"], row["step"], row["attempt"])
                    people.setdefault(key, {})[str(row["item"])] = row["value"]
            found = reliability_of(items, list(people.values()))
            alpha, omega = (f"{one:.2f}" if one == one else "[too few]" for one in (found.alpha, found.omega))  # noqa: PLR0124
            told.append(
                f"{name}: {found.items} items, Cronbach's alpha {alpha}, McDonald's omega {omega} "
                f"(one factor; {found.people} forms)."
            )
    return told
