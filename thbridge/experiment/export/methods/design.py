"""Text on the design of an experiment: factors, assignment of people to groups, orders of conditions."""

from collections import Counter
from collections.abc import Iterator, Mapping

from thbridge.experiment.design.experiment_file import ExperimentDesign, OrderKind, WhoBegins, drawn_seed
from thbridge.experiment.design.steps import StepKind
from thbridge.experiment.export.methods.markdown import counted, joined, paragraph, table
from thbridge.experiment.export.methods.settings import meaning_of
from thbridge.experiment.export.tables import ExperimentRecords
from thbridge.experiment.store.events import RunState


def design_section(records: ExperimentRecords, people: str) -> Iterator[str]:
    """Yield the lines of the section. `people` is "participants" or "simulated participants"."""
    design = records.design
    yield "### Conditions and design"
    yield ""
    yield from paragraph(_kind(design))
    factors = [
        (factor, manipulated, "; ".join(levels), meaning_of(factor, levels))
        for manipulated, found in (("between", _between(design)), ("within", _within(design)))
        for factor, levels in found.items()
    ]
    yield from table("Factors", ("Factor", "Varied", "Levels", "Meaning of the setting"), factors)
    if factors:
        yield from paragraph(
            "[Meaning of each level for the participants, the hypotheses behind the levels, and how you checked that "
            "participants noticed the differences.]"
        )
    yield from paragraph(_assignment(design, people), _order(design, people), _seeds(design))
    if factors:
        yield from paragraph(
            "[State who knew a participant's condition: participants, experimenters, data analysts. State what "
            "participants knew about the hypotheses.]"
        )
    if len(design.orders) > 1:
        yield from table("Analyzed by group and order", ("Group", "Order of conditions", "n"), _places(records))


def _between(design: ExperimentDesign) -> Mapping[str, list[str]]:
    return _levels([cell.levels for cell in design.cells])


def _within(design: ExperimentDesign) -> Mapping[str, list[str]]:
    return _levels([condition.levels for condition in design.conditions])


def _levels(combinations: list[Mapping[str, str]]) -> Mapping[str, list[str]]:
    return {
        factor: list(dict.fromkeys(combination[factor] for combination in combinations)) for factor in combinations[0]
    }


def _kind(design: ExperimentDesign) -> str:
    between, within = _between(design), _within(design)
    if not between and not within:
        return "The study had a single condition: no factor was varied, and no comparison was randomized."
    sizes = " x ".join(str(len(levels)) for levels in (*between.values(), *within.values()))
    crossed = f"{sizes} " if len(between) + len(within) > 1 else ""
    groups = counted(len(design.cells), "group")
    conditions = counted(len(design.conditions), "condition")
    if not within:
        return (
            f"The study had a {crossed}between-participants design with {groups}: each participant played "
            f"{'all games' if _trials(design) > 1 else 'one game'} in the condition of one group."
        )
    if not between:
        return f"The study had a {crossed}within-participants design: each participant played in all {conditions}."
    return (
        f"The study had a {crossed}mixed design. {joined(list(between))} varied between participants ({groups}), "
        f"{joined(list(within))} within participants (each participant played in all {conditions})."
    )


def _trials(design: ExperimentDesign) -> int:
    """Return the number of games of each person."""
    each = [entry.each_condition for entry in design.file.steps if entry.step is StepKind.TRIAL]
    return sum(len(design.conditions) if many else 1 for many in each)


def _assignment(design: ExperimentDesign, people: str) -> str:
    file = design.file
    if len(design.cells) == 1:
        return ""
    begins = "the participant" if file.begins is WhoBegins.PARTICIPANT else "the researcher"
    times = "once" if file.in_block == 1 else f"{file.in_block} times"
    return (
        f"The program assigned {people} to groups at random in blocks of {len(design.cells) * file.in_block}. Each "
        f"group occurs {times} in a block, in a random order (seed {file.seed} in the study's file). The program made "
        f"the assignment when {begins} started the run. If a run did not count, the next participant was assigned to "
        f"the same group."
    )


def _order(design: ExperimentDesign, people: str) -> str:
    count, orders = len(design.conditions), len(design.orders)
    if count == 1:
        return ""
    if design.file.order is OrderKind.FIXED:
        return f"All {people} played the conditions in the same order, so condition and order are confounded."
    square = (
        "a balanced Latin square (Williams, 1949): each condition is equally often at each position, and equally often "
        "directly after each other condition"
        if design.file.order is OrderKind.BALANCED
        else "a cyclic Latin square: each condition is equally often at each position; carry-over is not balanced"
    )
    within = " within each group" if len(design.cells) > 1 else ""
    uneven = (
        f" The {design.file.quota} planned runs{within} are not a multiple of {orders}, so some orders occur one more "
        "time."
        if design.file.quota % orders
        else ""
    )
    return (
        f"The order of conditions was counterbalanced with {orders} orders from {square}. The program assigned the "
        f"orders at random in blocks{within} (seed {design.file.seed}).{uneven}"
    )


def _seeds(design: ExperimentDesign) -> str:
    trials = _trials(design)
    if not trials:
        return ""
    seeds = joined([str(drawn_seed(design, trial)) for trial in range(trials)])
    if trials == 1:
        return f"The game of each participant had the same random seed ({seeds}), and so the same hidden treasures."
    return (
        f"The random seed of a game determines its hidden treasures. The seed depended on the number of the game and "
        f"not on its condition: {seeds}, in this order for all participants."
    )


def _places(records: ExperimentRecords) -> Iterator[tuple[str, str, int]]:
    design = records.design
    runs = (run for run in records.progress.runs.values() if run.state is RunState.COMPLETE)
    counts = Counter((run.place.cell, run.place.order) for run in runs)
    for index, cell in enumerate(design.cells):
        for number, order in enumerate(design.orders):
            names = ", then ".join(design.conditions[one].name for one in order)
            yield cell.name or "all", names, counts[index, number]
