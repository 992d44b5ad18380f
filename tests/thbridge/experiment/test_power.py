"""The power of an experiment, estimated by rehearsals."""

from pathlib import Path

import numpy as np
import pytest
from scipy import stats

from tests.support.programs.inline_engine import InlineEngine
from tests.support.slow import slow
from tests.support.studies.experiment_files import write_experiment
from thbridge.batch.engines.engine import EngineFailed
from thbridge.experiment.rehearsal.people import PutInEffect, SimulatedPeople
from thbridge.experiment.rehearsal.power import (
    PowerQuestion,
    PowerTask,
    between_p_value,
    estimate_power,
    within_p_value,
)

DESIGN = (
    "title: x\nwithin: {robots: [1, 2]}\nbetween: {noise.preset: [none, bad wheels]}\nquota: 4\nsteps:\n"
    "  - {step: trial, each_condition: true}\n  - {step: form, form: workload, each_condition: true}\n"
)


def tasks(root: Path, factor: str, effect: PutInEffect, count: int) -> list[PowerTask]:
    (root / "study").mkdir()
    write_experiment(root / "study", DESIGN)
    people = SimulatedPeople(effects=(effect,), plays=False)
    question = PowerQuestion("workload", factor, (4, 8, 16))
    return [
        PowerTask(root / "study", root / "results", question, people, seed, effects)
        for seed in range(count)
        for effects in (True, False)
    ]


@pytest.mark.parametrize(
    ("factor", "level", "shift"),
    [("robots", "2", 0.1), *slow(("noise.preset", "bad wheels", 0.25))],
    ids=["within", "between"],
)
def test_more_people_find_more_and_nothing_is_found_where_nothing_is(
    tmp_path: Path, factor: str, level: str, shift: float
) -> None:
    asked = tasks(tmp_path, factor, PutInEffect("workload", shift, {factor: level}), 6)
    deaths = iter([True])
    found = estimate_power(asked, InlineEngine(lambda _task: next(deaths, False)))
    shares = [estimate.share for estimate in found[True]]
    assert [estimate.people for estimate in found[True]] == [4, 8, 16]
    assert shares == sorted(shares)
    assert shares[-1] > 0.6
    assert all(estimate.share <= 0.34 for estimate in found[False])
    low, high = found[True][-1].interval
    assert low < shares[-1] <= high + 1e-9
    # What is there is not rehearsed again.
    times = {task.result: task.result.stat().st_mtime_ns for task in asked}
    assert estimate_power(asked, InlineEngine()) == found
    assert {task.result: task.result.stat().st_mtime_ns for task in asked} == times


def test_workers_that_die_of_every_rehearsal_are_told(tmp_path: Path) -> None:
    with pytest.raises(EngineFailed, match="3 workers crashed"):
        estimate_power(tasks(tmp_path, "robots", PutInEffect("workload"), 1), InlineEngine(lambda _task: True))


def test_the_test_of_two_levels_is_the_paired_t_test() -> None:
    rows = np.random.default_rng(3).normal(size=(12, 2)) + np.array([0.0, 0.7])
    assert within_p_value(rows) == pytest.approx(stats.ttest_rel(rows[:, 1], rows[:, 0]).pvalue)


def test_tests_keep_their_level_with_three_levels_of_unlike_spread() -> None:
    chance, spread = np.random.default_rng(4), np.array([1.0, 3.0, 0.3])
    values = [within_p_value(chance.normal(size=(10, 3)) * spread) for _ in range(2000)]
    assert np.mean(np.array(values) < 0.05) == pytest.approx(0.05, abs=0.015)
    groups = [[chance.normal(size=8), chance.normal(size=8), chance.normal(size=8)] for _ in range(1000)]
    assert np.mean([between_p_value(group) < 0.05 for group in groups]) == pytest.approx(0.05, abs=0.02)


def test_the_test_of_two_groups_is_welchs() -> None:
    chance = np.random.default_rng(5)
    groups = [chance.normal(size=9), 3.0 * chance.normal(size=14) + 1.0]
    assert between_p_value(groups) == pytest.approx(stats.ttest_ind(*groups, equal_var=False).pvalue)


def test_too_few_people_find_nothing() -> None:
    assert np.isnan(within_p_value(np.zeros((2, 2))))
    assert np.isnan(between_p_value([np.zeros(1), np.zeros(3)]))
