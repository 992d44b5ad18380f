"""`thbridge plan`: paths over any map."""

import dataclasses
import time
from enum import StrEnum
from pathlib import Path
from typing import Annotated

import typer

from ui.command_line.options import AsJson
from ui.command_line.terminal import BAD_INPUT, bad_input, fail, out, print_json

INFLATION = 0.5
"""Inflation radius of our robot's global costmap, meters."""
RADIUS = 0.26
"""Inscribed radius of our robot, meters."""
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
    order asked: meters, the time that planning took, and why there is no path.
    """
    from thbridge.offline.plan import plan as planned
    from ui.command_line.grids import grid_at
    from ui.commands.offline.queries import answers_table, read_queries
    from ui.first_start.compiling import announce_compiling

    for option, value in (("--inflation", inflation), ("--radius", radius)):
        if not 0.0 <= value <= 50.0:
            fail(BAD_INPUT, f"{option}: {value:g} is not between 0 and 50. Write metres, such as 0.3.")
    with bad_input():
        grid = grid_at(map_yaml)
        queries = read_queries(start, goal, batch)
    announce_compiling()
    answers = planned(grid, queries, radius, inflation, planner.value, time.perf_counter)
    if as_json:
        print_json({"queries": [dataclasses.asdict(answer) for answer in answers]})
    else:
        out.print(answers_table(queries, answers))
