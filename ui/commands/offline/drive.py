"""`thbridge drive`: drive one simulated robot from a start to a goal, on any map."""

import dataclasses
import math
from pathlib import Path
from typing import Annotated

import typer
from typer.core import TyperCommand

from thbridge.files.yaml.angles import radians_of
from ui.command_line.options import AsJson
from ui.command_line.terminal import BAD_INPUT, bad_input, fail, note, out, print_json


class GoalWithYaw(TyperCommand):
    """Command whose option --goal accepts two or three numbers."""

    def parse_args(self, ctx: typer.Context, args: list[str]) -> list[str]:  # type: ignore[override]
        """Pass the third number to --goal-yaw."""
        for index, word in enumerate(args):
            if word == "--goal" and _is_number(args[index + 3 : index + 4]):
                args = [*args[: index + 3], "--goal-yaw", *args[index + 3 :]]
                break
        return super().parse_args(ctx, args)


drive_app = typer.Typer(add_completion=False)


def _is_number(words: list[str]) -> bool:
    try:
        return [float(word) if radians_of(word) is None else word for word in words] != []
    except ValueError:
        return False


@drive_app.command(cls=GoalWithYaw)
def drive(
    map_yaml: Annotated[Path, typer.Option("--map", help="Map: a map.yaml of map_server.")],
    start: Annotated[tuple[float, float, float], typer.Option(help="Start pose in the map frame: meters, radians.")],
    goal: Annotated[
        tuple[float, float],
        typer.Option(help="Goal in the map frame: X Y [YAW]; without YAW, any heading is accepted."),
    ],
    goal_yaw: Annotated[float | None, typer.Option(hidden=True)] = None,
    timeout: Annotated[float, typer.Option(help="Stop after this many simulated seconds.", min=0.1)] = 600.0,
    footprint: Annotated[
        str | None, typer.Option(help="Corners of the robot's body, in meters: `[[0.3, 0.2], [-0.3, 0.2], ...]`.")
    ] = None,
    params: Annotated[
        list[Path] | None,
        typer.Option(
            help="Parameters: a ROS YAML file, or a file with the sections `world` and `robot` of a study. If a launch "
            "file sets a namespace, write NAMESPACE:FILE. Can be repeated."
        ),
    ] = None,
    unmapped: Annotated[
        Path | None,
        typer.Option(help="A map.yaml of obstacles that are in the world, but not in the robot's map.", metavar="MAP"),
    ] = None,
    moving: Annotated[
        Path | None, typer.Option(help="YAML file of obstacles that appear, move and vanish, like `things` in a study.")
    ] = None,
    seed: Annotated[int, typer.Option(help="Random seed.", min=0, max=2**31 - 1)] = 1,
    as_json: AsJson = False,
) -> None:
    """Drive one simulated robot on a map, with noisy sensors, localization, planning and recovery."""
    from sim.common.geometry import Pose2
    from sim.world.physics import Misplaced
    from thbridge.app.compose.installed_parts import installed_parts
    from thbridge.files.ros.defaults import sentences_of
    from thbridge.offline.drive import DriveResult, DriveTask
    from thbridge.offline.drive import drive as driven
    from ui.command_line.grids import grid_at
    from ui.commands.offline.drive_files import corners_in, read_moving, read_parameters, read_unmapped
    from ui.first_start.compiling import announce_compiling

    for option, numbers in (("--start", start), ("--goal", (*goal, goal_yaw or 0.0)), ("--timeout", (timeout,))):
        if not all(math.isfinite(number) for number in numbers):
            fail(BAD_INPUT, f"{option}: a value is not a finite number. Write meters, radians or seconds.")
    with bad_input():
        grid = grid_at(map_yaml)
        files = read_parameters(params or [])
        true_grid, told_of_unmapped = (grid, ()) if unmapped is None else read_unmapped(unmapped, grid)
        schedule = () if moving is None else read_moving(moving, grid)
        parts = installed_parts([files.parameters.robot])
    for sentence in (*files.notices, *sentences_of(files.defaults), *told_of_unmapped):
        note(sentence)
    given = files.parameters
    world = given.world if footprint is None else dataclasses.replace(given.world, footprint=corners_in(footprint))
    if footprint is None and (believed := given.robot.local_costmap.footprint) not in {(), world.footprint}:
        corners = [list(corner) for corner in believed]
        problem = "local_costmap.footprint is not the footprint of the simulated body"
        note(f"{problem}. To simulate local_costmap.footprint, add --footprint '{corners}'")
    announce_compiling()
    errand = DriveTask(Pose2(*start), Pose2(*goal, goal_yaw or 0.0), goal_yaw is None, timeout)
    result = driven(grid, world, given.robot, errand, seed, true_grid, schedule, parts)
    if isinstance(result, Misplaced):
        result = DriveResult(False, False, 0.0, 0.0, 0.0, f"the start is not free: {result.sentence}")
    if as_json:
        clearance = result.min_clearance if math.isfinite(result.min_clearance) else None
        values = dataclasses.asdict(result) | {"min_clearance": clearance}
        if params:
            values["notices"] = list(files.notices)
            values["ros_defaults"] = [default.as_json() for default in files.defaults]
        print_json(values)
        return
    out.print("Reached." if result.reached else f"Not reached: {result.reason}.", highlight=False, soft_wrap=True)
    note(
        f"Time {result.seconds:.1f} s, distance {result.distance:.2f} m, least distance to walls "
        f"{result.min_clearance:.3f} m, {'with a collision' if result.collided else 'no collision'}"
    )
