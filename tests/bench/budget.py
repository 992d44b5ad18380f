"""Budgets of speed: figures as ratios to a fixed reference of the same run, held against `budgets.toml`.

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


def cpu_seconds(work: Callable[[], object]) -> float:
    """Processor time of one call, all threads."""
    began = time.process_time()
    work()
    return time.process_time() - began


def reference() -> None:
    """Some 25 ms of work that never changes: it depends on nothing of the project."""
    table: dict[int, float] = {}
    for i in range(60_000):
        table[i % 997] = table.get(i % 991, 0.0) * 0.5 + i
    values = np.arange(200_000, dtype=np.float64)
    for _ in range(6):
        values = np.sqrt(values * 1.0001 + 1.0)
        values = values[np.argsort(values, kind="stable")[::-1]]


class Budgets:
    """The figures of one run, each judged when it is told.

    Attributes:
        figures: what was measured, by name; written into the file by `pytest --write-budgets`.
    """

    def __init__(self, *, write: bool) -> None:
        self.figures: dict[str, float] = {}
        self._write = write
        self._budgets: dict[str, float] = tomllib.loads(FILE.read_text()) if FILE.exists() else {}
        reference()

    def time(self, name: str, seconds: float) -> None:
        """Judge processor time: its ratio to the reference, which is measured now, at its best of nine."""
        self.ratio(name, seconds / min(cpu_seconds(reference) for _ in range(9)))

    def ratio(self, name: str, ratio: float) -> None:
        """Judge a ratio to something else of this run; less is better.

        Raises:
            AssertionError: it is over its budget by more than `SLACK`, or has none.
        """
        self.figures[name] = ratio
        if self._write:
            return
        assert name in self._budgets, (
            f"{name} has no budget: measured {ratio:.4g}; `make bench ARGS=--write-budgets` adds it"
        )
        budget = self._budgets[name]
        assert ratio <= SLACK * budget, (
            f"{name}: {ratio:.4g} times the reference, {ratio / budget:.2f} times its budget"
        )

    def save(self) -> None:
        """Write what was measured into the file; figures that were not measured stay."""
        if not self._write:
            return
        figures = dict(sorted((self._budgets | self.figures).items()))
        FILE.write_text(
            "# Processor time as a ratio to a fixed reference of the same run, or to a peer; see budget.py.\n"
            "# Written by `make bench ARGS=--write-budgets` on a quiet machine; a bench test fails beyond 1.3 times.\n"
            + "".join(f'"{name}" = {figure:.4g}\n' for name, figure in figures.items())
        )
