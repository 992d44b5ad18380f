"""`thbridge plan`: plan paths on any map."""

import dataclasses
import time
from enum import StrEnum
from pathlib import Path
from typing import Annotated

import typer

from ui.command_line.options import AsJson
from ui.command_line.terminal import BAD_INPUT, bad_input, fail, out, print_json

INFLATION = 0.5
"""Inflation radius of the global costmap of thbridge's robots, meters."""
RADIUS = 0.26
"""Inscribed radius of thbridge's robots, meters."""
COLUMNS = ("start_x", "start_y", "goal_x", "goal_y")


Place = tuple[float, float]


class SearchAlgorithm(StrEnum):
    """Search order: Dijkstra's (navfn) or A*."""

    NAVFN = "navfn"
    ASTAR = "astar"


def plan(
    map_yaml: Annotated[Path, typer.Option("--map", help="Map: a map.yaml of map_server.")],
    start: Annotated[Place | None, typer.Option(help="Start in the map frame, meters.", metavar="X Y")] = None,
    goal: Annotated[Place | None, typer.Option(help="Goal in the map frame, meters.", metavar="X Y")] = None,
    batch: Annotated[
        Path | None, typer.Option(help=f"CSV file with many starts and goals; header `{','.join(COLUMNS)}`.")
    ] = None,
    inflation: Annotated[
        float, typer.Option(help="Distance from walls within which cells cost more, m; at least the radius.")
    ] = INFLATION,
    radius: Annotated[
        float, typer.Option(help="Radius of the robot, m; paths keep this distance from walls.")
    ] = RADIUS,
    planner: Annotated[
        SearchAlgorithm,
        typer.Option(help="`navfn` searches in Dijkstra's order; `astar` is faster, with slightly longer paths."),
    ] = SearchAlgorithm.NAVFN,
    as_json: AsJson = False,
) -> None:
    """Plan paths for a round robot on any map, like ROS's navfn. Paths may cross unknown space.

    Print a table, or one JSON object {"queries": [{"found", "length", "milliseconds", "reason", "code"}, ...]}. The
    list has an entry for each query, in the same order: length in meters, planning time, and the reason if there is no
    path.
    """
    from thbridge.offline.plan import plan as planned
    from ui.command_line.grids import grid_at
    from ui.commands.offline.queries import answers_table, read_queries
    from ui.first_start.compiling import announce_compiling

    for option, value in (("--inflation", inflation), ("--radius", radius)):
        if not 0.0 <= value <= 50.0:
            fail(BAD_INPUT, f"{option}: {value:g} is not between 0 and 50. Write meters, such as 0.3.")
    with bad_input():
        grid = grid_at(map_yaml)
        queries = read_queries(start, goal, batch)
    announce_compiling()
    answers = planned(grid, queries, radius, inflation, planner.value, time.perf_counter)
    if as_json:
        print_json({"queries": [dataclasses.asdict(answer) for answer in answers]})
    else:
        out.print(answers_table(queries, answers))
