"""Budgets of speed: figures as ratios to a reference of the same run, held against `budgets.toml`.

A second of one machine, or of one hour of it, is not that of another; a ratio of two things measured in the same minute
is. The reference is a fixed piece of work, half interpreter and half numpy, or a peer that does what we do.
"""

import time
import tomllib
from collections.abc import Callable
from pathlib import Path

import numpy as np

FILE = Path(__file__).with_name("budgets.toml")
SLACK = 1.3
"""A figure fails that is more than so many times its budget."""

REFERENCES = 27
"""Calls of the reference before the work, and after it; a third of a second."""


def cpu_seconds(work: Callable[[], object]) -> float:
    """Processor time of one call, all threads."""
    began = time.process_time()
    work()
    return time.process_time() - began


def usual(work: Callable[[], object], times: int) -> float:
    """Processor time of one call, the median of so many."""
    return float(np.median([cpu_seconds(work) for _ in range(times)]))


def best(work: Callable[[], object], times: int) -> float:
    """Processor time of the quickest of so many calls, after one that compiles and warms up."""
    work()
    return min(cpu_seconds(work) for _ in range(times))


def reference() -> None:
    """Some 13 ms of work that never changes: it depends on nothing of the project."""
    table: dict[int, float] = {}
    for i in range(60_000):
        table[i % 997] = table.get(i % 991, 0.0) * 0.5 + i
    values = np.arange(200_000, dtype=np.float64)
    for _ in range(6):
        values = np.sqrt(values * 1.0001 + 1.0)
        values = values[np.argsort(values, kind="stable")[::-1]]


class Budgets:
    """The figures of one run, each judged when it is told.

    Args:
        file: the budgets, by name.
        write: nothing fails, and `save` writes what was measured into the file.
    """

    def __init__(self, file: Path, *, write: bool) -> None:
        self._file = file
        self._write = write
        self._budgets = _read(file)
        self._figures: dict[str, float] = {}
        self._reference_before: float | None = None

    def begin(self) -> None:
        """Measure the reference before the work: a machine shared with others has slow seconds and slow minutes."""
        self._reference_before = usual(reference, REFERENCES)

    def time(self, name: str, seconds: float) -> None:
        """Judge processor time: its ratio to the reference, the mean of before the work and of now."""
        now = usual(reference, REFERENCES)
        before = now if self._reference_before is None else self._reference_before
        self.ratio(name, 2.0 * seconds / (before + now))

    def ratio(self, name: str, ratio: float) -> None:
        """Judge a ratio to something else of this run; less is better.

        Raises:
            AssertionError: it is over its budget by more than `SLACK`, or has none.
        """
        assert name not in self._figures, f"{name} is told twice"
        self._figures[name] = ratio
        if self._write:
            return
        assert name in self._budgets, (
            f"{name} has no budget: measured {ratio:.4g}; `make bench ARGS=--write-budgets` adds it"
        )
        budget = self._budgets[name]
        assert ratio <= SLACK * budget, f"{name}: {ratio:.4g}, {ratio / budget:.2f} times its budget of {budget:.4g}"

    def save(self) -> None:
        """Write what was measured into the file, if asked to; the file keeps the larger figure of its runs.

        Quiet hours differ too: work that waits between its ticks, or that fills the caches, follows the reference only
        in part. What was not measured stays as the file has it now.
        """
        if not self._write:
            return
        kept = _read(self._file)
        largest = {name: max(figure, kept.get(name, figure)) for name, figure in self._figures.items()}
        figures = dict(sorted((kept | largest).items()))
        self._file.write_text(
            "# Processor time as a ratio to a fixed reference of the same run, or to a peer; see budget.py.\n"
            "# The largest of several runs of `make bench ARGS=--write-budgets` on a quiet machine; a bench test\n"
            "# fails beyond 1.3 times. To lower a budget, delete its line first.\n"
            + "".join(f'"{name}" = {figure:.4g}\n' for name, figure in figures.items())
        )


def _read(file: Path) -> dict[str, float]:
    return tomllib.loads(file.read_text()) if file.exists() else {}
