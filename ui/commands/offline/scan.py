"""`thbridge scan`: compute what a laser sees on a map."""

import math
from pathlib import Path
from typing import Annotated

import typer

from ui.command_line.options import AsJson
from ui.command_line.terminal import BAD_INPUT, bad_input, fail, print_json

Pose = Annotated[
    tuple[float, float, float] | None,
    typer.Option(help="Pose of the laser in the map frame: meters, radians.", metavar="X Y YAW"),
]


def scan(
    map_yaml: Annotated[Path, typer.Option("--map", help="Map: a map.yaml of map_server.")],
    pose: Pose = None,
    batch: Annotated[Path | None, typer.Option(help="CSV file with many poses; header `x,y,yaw`.")] = None,
    beams: Annotated[int, typer.Option(help="Number of beams.", min=1, max=100_000)] = 360,
    angle_min: Annotated[float, typer.Option(help="Angle of the first beam relative to the laser, rad.")] = -math.pi,
    angle_max: Annotated[
        float | None,
        typer.Option(help="Angle of the last beam, rad, as in a LaserScan. [default: a full circle]"),
    ] = None,
    range_max: Annotated[float, typer.Option(help="Greatest range of the laser, m.", min=0.001, max=1e6)] = 10.0,
    as_json: AsJson = False,
) -> None:
    """Compute what a laser without noise sees on any map: exact distances to the occupied cells.

    Print a line for each pose, or one JSON object {"ranges": [[...], ...]}. If a beam hits nothing within the range,
    its value is `inf`, or null in JSON.
    """
    import numpy as np

    from thbridge.files.tables.csv_files import read_columns
    from thbridge.offline.scan import beam_angles
    from thbridge.offline.scan import scan as scan_map
    from ui.command_line.grids import grid_at

    for option, value in (("--angle-min", angle_min), ("--angle-max", angle_max), ("--pose", sum(pose or ()))):
        if value is not None and not math.isfinite(value):
            fail(BAD_INPUT, f"{option}: a value is not a finite number. Write a number, such as 1.5.")
    with bad_input():
        grid = grid_at(map_yaml)
        if (pose is None) == (batch is None):
            remedy = "Write --pose X Y YAW, or --batch FILE.csv"
            fail(BAD_INPUT, f"--pose, --batch: exactly one of these options is needed. {remedy}.")
        poses = np.array([pose]) if batch is None else read_columns(batch, ("x", "y", "yaw"))
    ranges = scan_map(grid, poses, beam_angles(beams, angle_min, angle_max), range_max)
    if as_json:
        print_json({"ranges": ranges})
        return
    for row in ranges:
        typer.echo(" ".join("inf" if reach is None else f"{reach:.4f}" for reach in row))
