"""Queries and results of `thbridge plan`."""

import math
from pathlib import Path

import numpy as np
from rich.table import Table

from sim.numerics.float_array import FloatArray
from thbridge.files.tables.csv_files import read_columns
from thbridge.offline.plan import PlanResult
from ui.command_line.terminal import BAD_INPUT, fail


def read_queries(start: tuple[float, float] | None, goal: tuple[float, float] | None, batch: Path | None) -> FloatArray:
    """Return the (n, 4) starts and goals that options or a file give."""
    if batch is not None and start is None and goal is None:
        return read_columns(batch, ("start_x", "start_y", "goal_x", "goal_y"))
    if batch is not None or start is None or goal is None:
        remedy = "Write --start X Y --goal X Y, or --batch FILE.csv"
        fail(BAD_INPUT, f"--start, --goal, --batch: give both --start and --goal, or only --batch. {remedy}.")
    for option, place in (("--start", start), ("--goal", goal)):
        if not all(map(math.isfinite, place)):
            fail(BAD_INPUT, f"{option}: a value is not a finite number. Write meters, such as 1.5.")
    return np.array([[*start, *goal]])


def answers_table(queries: FloatArray, answers: list[PlanResult]) -> Table:
    """Return the results as a table."""
    table = Table("from", "to", "path")
    for column in ("length (m)", "time (ms)"):
        table.add_column(column, justify="right")
    for (x, y, u, v), answer in zip(queries.tolist(), answers, strict=True):
        table.add_row(
            f"({x:g}, {y:g})",
            f"({u:g}, {v:g})",
            "found" if answer.reason is None else f"no path: {answer.reason}",
            "" if answer.length is None else f"{answer.length:.2f}",
            f"{answer.milliseconds:.2f}",
        )
    return table
