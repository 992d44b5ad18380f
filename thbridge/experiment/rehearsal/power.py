"""Statistical power of an experiment: the share of rehearsals with a significant effect, by the number of people.

Each rehearsal is run twice: with all effects in `rehearsal.yaml`, and without the effects on the tested score. Without
these effects, the share of significant results should be equal to the test's significance level.
"""

import functools
import json
import math
from collections import defaultdict
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
from scipy import stats

from sim.numerics.float_array import FloatArray
from sim.numerics.matrices import covariance_of, solution
from thbridge.batch.engines.batch_task import TaskOutcome
from thbridge.batch.engines.engine import Engine, EngineFailed
from thbridge.experiment.design.experiment_file import ExperimentDesign
from thbridge.experiment.folder import ExperimentFolder
from thbridge.experiment.progress import Progress, Run
from thbridge.experiment.questionnaires.scoring import Answer, scores_of
from thbridge.experiment.rehearsal.people import SimulatedPeople
from thbridge.experiment.rehearsal.rehearsal import rehearse
from thbridge.experiment.store.event_log import read_log
from thbridge.experiment.store.events import EventKind, LoggedEvent, RunState
from thbridge.files.disk.json_files import read_json
from thbridge.files.disk.whole import whole_file

LEVEL = 0.05
"""Level of significance of the tests."""
WARM = ("thbridge.experiment.rehearsal.power",)
"""Modules that workers import before their first task."""
MOST_DEATHS = 3
"""After this number of crashed workers at one rehearsal, the estimate stops, because all workers would crash."""


@dataclass(frozen=True, slots=True)
class PowerQuestion:
    """Question of a power estimate.

    Attributes:
        score: name of the tested score.
        factor: factor whose levels are compared.
        people: numbers of people, ascending.
    """

    score: str
    factor: str
    people: tuple[int, ...]


@dataclass(frozen=True, slots=True)
class PowerTask:
    """One rehearsal, without a recording; see `BatchTask`.

    Attributes:
        folder: folder of the experiment.
        results: folder of the results for this question and this experiment.
        question: question to answer.
        simulated: properties of the simulated people.
        seed: random seed of the rehearsal.
        effects: False for a rehearsal without the effects on the tested score.
    """

    folder: Path
    results: Path
    question: PowerQuestion
    simulated: SimulatedPeople
    seed: int
    effects: bool

    @property
    def result(self) -> Path:
        """The file that exists after the task is done."""
        return self.results / ("with" if self.effects else "without") / f"{self.seed}.json"

    @property
    def urgent(self) -> bool:
        """See `BatchTask`."""
        return False

    def carry_out(self, most: int | None = None) -> TaskOutcome:
        """See `BatchTask`."""
        if not self.result.exists():
            kept = self.simulated.effects
            if not self.effects:
                kept = tuple(effect for effect in kept if effect.score != self.question.score)
            found = _rehearsed(replace(self.simulated, effects=kept), self)
            with whole_file(self.result, "free some space, then run the command again", folders=True) as file:
                file.write(json.dumps(found).encode())
        return TaskOutcome(1, 0, (), 0.0)


@dataclass(frozen=True, slots=True)
class PowerEstimate:
    """Share of rehearsals with a significant result.

    Attributes:
        people: number of people.
        rehearsals: number of rehearsals.
        found: number of rehearsals in which the test found a difference at `LEVEL`.
    """

    people: int
    rehearsals: int
    found: int

    @property
    def share(self) -> float:
        """Share of rehearsals with a significant result."""
        return self.found / self.rehearsals

    @property
    def interval(self) -> tuple[float, float]:
        """95 % interval of the share. Source: Wilson, Probable inference (1927)."""
        low, high = stats.binomtest(self.found, self.rehearsals).proportion_ci(0.95, "wilson")
        return float(low), float(high)


def estimate_power(
    tasks: Sequence[PowerTask], engine: Engine[PowerTask], progress: Callable[[int], None] = lambda _done: None
) -> dict[bool, tuple[PowerEstimate, ...]]:
    """Run all rehearsals on an open engine. Return the estimates with the effects (True) and without effects (False).

    Args:
        tasks: tasks of one question.
        engine: engine that runs the tasks.
        progress: receives the number of finished rehearsals.

    Raises:
        BadFile: a folder cannot be read or written.
        EngineFailed: the engine cannot continue.
    """
    deaths: defaultdict[Path, int] = defaultdict(int)
    for task in tasks:
        engine.submit(task)
    done = 0
    for ended in engine.finished():
        if ended.outcome is not None:
            done += 1
            progress(done)
            continue
        deaths[ended.task.result] += 1
        if deaths[ended.task.result] >= MOST_DEATHS:
            raise EngineFailed(f"{MOST_DEATHS} workers crashed at the rehearsal with seed {ended.task.seed}.")
        engine.submit(ended.task)
    found: dict[bool, dict[int, list[float | None]]] = {True: defaultdict(list), False: defaultdict(list)}
    for task in tasks:
        remedy = "Delete this file and run the command again: it repeats this rehearsal"
        values = read_json(task.result, dict[int, float | None], "this is not a result of a rehearsal", remedy)
        for people, value in (values or {}).items():
            found[task.effects][people].append(value)
    return {
        effects: tuple(
            PowerEstimate(people, len(values), sum(value is not None and value < LEVEL for value in values))
            for people, values in sorted(by_people.items())
        )
        for effects, by_people in found.items()
    }


@functools.cache
def _design(folder: Path, _results: Path) -> ExperimentDesign:
    """Return the experiment. A worker reads it only once, because reading takes as long as a rehearsal."""
    return ExperimentFolder(folder).read()


def _rehearsed(people: SimulatedPeople, task: PowerTask) -> dict[int, float | None]:
    """Rehearse with the largest number of people. Return the p-value of the test for each number of people."""
    design, question = _design(task.folder, task.results), task.question
    quota = math.ceil(question.people[-1] / len(design.cells))
    design = replace(design, file=replace(design.file, quota=quota))
    with TemporaryDirectory(prefix="thbridge-power-") as place:
        folder = ExperimentFolder(Path(place))
        rehearse(folder, design, people, task.seed)
        entries = [entry for entry in read_log(folder.log) if isinstance(entry, LoggedEvent)]
    progress = Progress(design).after(entries)
    scores = _scores(design, progress, entries, question.score)
    counted = sorted(
        (run for run in progress.runs.values() if run.state is RunState.COMPLETE), key=lambda run: run.place.number
    )
    found = {}
    for number in question.people:
        # Places are assigned in order, so a smaller experiment would have exactly these people.
        some = [run for run in counted if run.place.number < number]
        value = _p_value(design, some, scores, question.factor)
        found[number] = None if math.isnan(value) else value
    return found


def _scores(
    design: ExperimentDesign, progress: Progress, entries: Sequence[LoggedEvent], score: str
) -> Mapping[str, list[tuple[int | None, float]]]:
    """Return the scores of each person, by id. Each score is a pair: index of the condition, value."""
    given: defaultdict[tuple[str, int], dict[str, Answer]] = defaultdict(dict)
    for entry in entries:
        event = entry.event
        if event.kind == EventKind.ITEM_GIVEN and isinstance(answer := (event.data or {})["answer"], int | float | str):
            given[event.participant, event.step][str((event.data or {})["item"])] = answer
    found: defaultdict[str, list[tuple[int | None, float]]] = defaultdict(list)
    for (person, number), answers in given.items():
        step = progress.runs[person].plan[number - 1]
        value = scores_of(design.forms[step.index], answers).get(score, math.nan)
        if not math.isnan(value):
            found[person].append((step.condition, value))
    return found


def _p_value(
    design: ExperimentDesign, runs: Sequence[Run], scores: Mapping[str, list[tuple[int | None, float]]], factor: str
) -> float:
    """Return the p-value of the hypothesis that all levels of a factor have the same mean. NaN for too few people."""
    if factor in design.conditions[0].levels:
        levels = list(dict.fromkeys(condition.levels[factor] for condition in design.conditions))
        rows = []
        for run in runs:
            of_level: defaultdict[str, list[float]] = defaultdict(list)
            for condition, value in scores.get(run.participant, []):
                if condition is not None:
                    of_level[design.conditions[condition].levels[factor]].append(value)
            if len(of_level) == len(levels):
                rows.append([math.fsum(of_level[level]) / len(of_level[level]) for level in levels])
        return within_p_value(np.array(rows).reshape(-1, len(levels)))
    groups: defaultdict[str, list[float]] = defaultdict(list)
    for run in runs:
        values = [value for _, value in scores.get(run.participant, [])]
        if values:
            groups[design.cells[run.place.cell].levels[factor]].append(math.fsum(values) / len(values))
    return between_p_value([np.array(group) for group in groups.values()])


def within_p_value(rows: FloatArray) -> float:
    """Return the p-value of the hypothesis that all columns of (people, levels) have the same mean.

    Hotelling's test is used on the differences. For two levels, this is the paired t-test. For more levels, the test
    does not require sphericity.

    Source: Hotelling, The generalization of Student's ratio (1931).
    """
    people, levels = rows.shape
    contrasts = levels - 1
    if people <= contrasts + 1:
        return math.nan
    off = rows[:, 1:] - rows[:, :1]
    mean = off.mean(axis=0)
    covariance = covariance_of(off) * (people / (people - 1))
    squared = people * float((mean * solution(covariance, mean[:, np.newaxis])[:, 0]).sum())
    if math.isnan(squared):
        return math.nan  # all people have the same differences
    ratio = squared * (people - contrasts) / (contrasts * (people - 1))
    return float(stats.f.sf(ratio, contrasts, people - contrasts))


def between_p_value(groups: Sequence[FloatArray]) -> float:
    """Return the p-value of the hypothesis that all groups have the same mean.

    The test is Welch's test for two groups, and the analysis of variance for more groups.

    Source: Welch, The generalization of Student's problem (1947).
    """
    if len(groups) < 2 or any(len(group) < 2 for group in groups):
        return math.nan
    variances = [float(group.var(ddof=1)) / len(group) for group in groups]
    if min(variances) <= 0.0:
        return math.nan  # The tests need some variance in each group.
    if len(groups) > 2:
        return float(stats.f_oneway(*groups).pvalue)
    one, other = variances
    freedom = (one + other) * (one + other) / (one * one / (len(groups[0]) - 1) + other * other / (len(groups[1]) - 1))
    ratio = abs(float(groups[0].mean() - groups[1].mean())) / math.sqrt(one + other)
    return float(2.0 * stats.t.sf(ratio, freedom))
