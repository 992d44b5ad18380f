"""The command that says what a laser would see on a map."""

import math
from pathlib import Path
from typing import Annotated

import typer

from ui.command_line.options import AsJson
from ui.command_line.terminal import BAD_INPUT, bad_input, fail, print_json

Pose = Annotated[
    tuple[float, float, float] | None,
    typer.Option(help="Where the laser is, in the map frame: metres and radians.", metavar="X Y YAW"),
]


def scan(
    map_yaml: Annotated[Path, typer.Option("--map", help="The map.yaml of a map, as map_server takes it.")],
    pose: Pose = None,
    batch: Annotated[Path | None, typer.Option(help="Many poses: a CSV file with the header `x,y,yaw`.")] = None,
    beams: Annotated[int, typer.Option(help="Number of beams.", min=1, max=100_000)] = 360,
    angle_min: Annotated[float, typer.Option(help="Direction of the first beam from the laser's, rad.")] = -math.pi,
    angle_max: Annotated[
        float | None,
        typer.Option(help="Direction of the last beam, rad, as in a LaserScan. [default: once around, no beam twice]"),
    ] = None,
    range_max: Annotated[float, typer.Option(help="How far the laser sees, m.", min=0.001, max=1e6)] = 10.0,
    as_json: AsJson = False,
) -> None:
    """Say what a laser without noise would see on any map: exact ranges to the occupied cells.

    Prints a line for each pose, or one JSON object {"ranges": [[...], ...]}. A beam that meets nothing within the range
    is `inf`, in JSON null.
    """
    import numpy as np

    from thbridge.files.tables.csv_files import read_columns
    from thbridge.offline.scan import beam_angles
    from thbridge.offline.scan import scan as scan_map
    from ui.command_line.grids import grid_at

    for option, value in (("--angle-min", angle_min), ("--angle-max", angle_max), ("--pose", sum(pose or ()))):
        if value is not None and not math.isfinite(value):
            fail(BAD_INPUT, f"{option}: not a finite number. Write a number, such as 1.5.")
    with bad_input():
        grid = grid_at(map_yaml)
        if (pose is None) == (batch is None):
            remedy = "Write --pose X Y YAW, or --batch FILE.csv"
            fail(BAD_INPUT, f"--pose, --batch: just one of the two is needed. {remedy}.")
        poses = np.array([pose]) if batch is None else read_columns(batch, ("x", "y", "yaw"))
    ranges = scan_map(grid, poses, beam_angles(beams, angle_min, angle_max), range_max)
    if as_json:
        print_json({"ranges": ranges})
        return
    for row in ranges:
        typer.echo(" ".join("inf" if reach is None else f"{reach:.4f}" for reach in row))
