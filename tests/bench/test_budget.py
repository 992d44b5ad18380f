"""A figure beyond 1.3 times its budget fails, as does one without a budget; writing keeps what was not measured."""

from collections.abc import Callable
from pathlib import Path

import pytest

from tests.bench import budget
from tests.bench.budget import REFERENCES, Budgets, best, reference


@pytest.fixture
def file(tmp_path: Path) -> Path:
    path = tmp_path / "budgets.toml"
    path.write_text('"a beam" = 2.0\n"a plan" = 4.0\n')
    return path


def test_a_figure_may_be_a_little_over_its_budget_and_not_more(file: Path) -> None:
    Budgets(file, write=False).ratio("a beam", 2 * 1.29)
    with pytest.raises(AssertionError, match=r"a beam: 2\.62, 1\.31 times its budget of 2"):
        Budgets(file, write=False).ratio("a beam", 2 * 1.31)


def test_a_figure_without_a_budget_fails(file: Path) -> None:
    with pytest.raises(AssertionError, match=r"a scan has no budget: measured 0\.5"):
        Budgets(file, write=False).ratio("a scan", 0.5)
    with pytest.raises(AssertionError, match="a scan has no budget"):
        Budgets(file.with_name("missing.toml"), write=False).ratio("a scan", 0.5)


def test_two_figures_do_not_share_a_name(file: Path) -> None:
    budgets = Budgets(file, write=False)
    budgets.ratio("a beam", 1.0)
    with pytest.raises(AssertionError, match="told twice"):
        budgets.ratio("a beam", 1.0)


def test_writing_keeps_the_figures_that_were_not_measured(file: Path) -> None:
    budgets = Budgets(file, write=True)
    budgets.ratio("a beam", 3.0)
    budgets.ratio("a scan", 0.123456)
    file.write_text(file.read_text() + '"a frame" = 1.0\n')  # by a run beside this one
    budgets.save()
    assert [line for line in file.read_text().splitlines() if not line.startswith("#")] == [
        '"a beam" = 3',
        '"a frame" = 1',
        '"a plan" = 4',
        '"a scan" = 0.1235',
    ]
    Budgets(file, write=False).ratio("a beam", 3.8)


def test_of_several_runs_the_largest_figure_is_the_budget(file: Path) -> None:
    for figure in (1.5, 2.5, 2.2):
        budgets = Budgets(file, write=True)
        budgets.ratio("a beam", figure)
        budgets.save()
    assert '"a beam" = 2.5' in file.read_text().splitlines()


def test_nothing_is_written_unasked(file: Path) -> None:
    before = file.read_text()
    budgets = Budgets(file, write=False)
    budgets.ratio("a beam", 1.0)
    budgets.save()
    assert file.read_text() == before


def test_time_is_counted_in_references_of_before_and_after(file: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    measured = iter((0.1, 0.3, 0.05, 0.15))

    def timed(work: Callable[[], object], times: int) -> float:
        assert (work, times) == (reference, REFERENCES)
        return next(measured)

    monkeypatch.setattr(budget, "usual", timed)
    budgets = Budgets(file, write=False)
    budgets.begin()
    budgets.time("a beam", 0.4)
    budgets.begin()
    with pytest.raises(AssertionError, match=r"a plan: 5\.4, 1\.35 times"):
        budgets.time("a plan", 0.54)


def test_one_slow_second_does_not_change_the_reference() -> None:
    durations = iter([*[0.0] * 8, *[1.0] * 4])
    clock = iter([end for each in durations for end in (0.0, each)])
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(budget.time, "process_time", lambda: next(clock))
        assert budget.usual(lambda: None, 12) == 0.0


def test_the_work_of_the_reference_takes_time() -> None:
    assert best(reference, 1) > 1e-4
