"""`thbridge plan`: paths over any map."""

import dataclasses
import math
import time
from enum import StrEnum
from pathlib import Path
from typing import Annotated

import numpy as np
import typer
from rich.table import Table

from sim.common.geometry import FloatArray
from thbridge.files.csv_files import read_columns
from thbridge.files.map_files import read_grid
from thbridge.offline.plan import INFLATION, RADIUS, PlanResult
from thbridge.offline.plan import plan as planned
from ui.options import AsJson, announce_compiling
from ui.terminal import BAD_INPUT, bad_input, fail, out, print_json

COLUMNS = ("start_x", "start_y", "goal_x", "goal_y")

Place = tuple[float, float]


class SearchAlgorithm(StrEnum):
    """Order in which the wave spreads: Dijkstra's, or A*'s."""

    NAVFN = "navfn"
    ASTAR = "astar"


def plan(
    map_yaml: Annotated[Path, typer.Option("--map", help="A map.yaml, as map_server reads it.")],
    start: Annotated[Place | None, typer.Option(help="Where the robot is, map frame, metres.", metavar="X Y")] = None,
    goal: Annotated[Place | None, typer.Option(help="Where it shall go, map frame, metres.", metavar="X Y")] = None,
    batch: Annotated[
        Path | None, typer.Option(help=f"Many of both: a CSV file with the header `{','.join(COLUMNS)}`.")
    ] = None,
    inflation: Annotated[
        float, typer.Option(help="How far from walls it costs to be, m; at least the radius. Our robot's by default.")
    ] = INFLATION,
    radius: Annotated[
        float, typer.Option(help="Radius of the robot, m; nearer to walls it never is. Our robot's by default.")
    ] = RADIUS,
    planner: Annotated[
        SearchAlgorithm, typer.Option(help="navfn in Dijkstra's order, or in A*'s: quicker, its paths a little longer.")
    ] = SearchAlgorithm.NAVFN,
    as_json: AsJson = False,
) -> None:
    """Find paths for a round robot over any map, as ROS's navfn does; unknown space may be crossed.

    Prints a table, or one JSON object {"queries": [{"found", "length", "milliseconds", "reason", "code"}, ...]} in the
    order asked: metres, the time that planning took, and why there is no path.
    """
    for option, value in (("--inflation", inflation), ("--radius", radius)):
        if not 0.0 <= value <= 50.0:
            fail(BAD_INPUT, f"{option}: {value:g} is not between 0 and 50. Write metres, such as 0.3.")
    with bad_input():
        grid = read_grid(map_yaml)
        queries = _queries(start, goal, batch)
    announce_compiling()
    answers = planned(grid, queries, radius, inflation, planner.value, time.perf_counter)
    if as_json:
        print_json({"queries": [dataclasses.asdict(answer) for answer in answers]})
    else:
        out.print(_table(queries, answers))


def _queries(start: Place | None, goal: Place | None, batch: Path | None) -> FloatArray:
    if batch is not None and start is None and goal is None:
        return read_columns(batch, COLUMNS)
    if batch is not None or start is None or goal is None:
        remedy = "Write --start X Y --goal X Y, or --batch FILE.csv"
        fail(BAD_INPUT, f"--start, --goal, --batch: either the first two are needed, or the third alone. {remedy}.")
    for option, place in (("--start", start), ("--goal", goal)):
        if not all(map(math.isfinite, place)):
            fail(BAD_INPUT, f"{option}: not a finite number. Write metres, such as 1.5.")
    return np.array([[*start, *goal]])


def _table(queries: FloatArray, answers: list[PlanResult]) -> Table:
    table = Table("from", "to", "path")
    for column in ("m", "ms"):
        table.add_column(column, justify="right")
    for (x, y, u, v), answer in zip(queries.tolist(), answers, strict=True):
        table.add_row(
            f"({x:g}, {y:g})",
            f"({u:g}, {v:g})",
            "found" if answer.reason is None else f"none: {answer.reason}",
            "" if answer.length is None else f"{answer.length:.2f}",
            f"{answer.milliseconds:.2f}",
        )
    return table
