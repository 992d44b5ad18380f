"""`thbridge localize`: localize a robot in any recording with scans and odometry."""

from pathlib import Path
from typing import Annotated

import typer

from ui.command_line.options import AsJson, ProgressKind, ProgressOption, one_of
from ui.command_line.outputs import STANDARD_OUTPUT, destination, share_no_output, share_outputs
from ui.command_line.recordings import Recording
from ui.command_line.terminal import BAD_INPUT, FAILED, bad_input, fail, note, print_json

Triple = tuple[float, float, float]


FILTERS = ("amcl", "ekf", "ukf")
"""Filters for recordings, with the same names as under `localization` in a study."""


def localize(
    bag: Recording,
    map_yaml: Annotated[Path, typer.Option("--map", help="Map: a map.yaml of map_server.")],
    localization: Annotated[
        str,
        typer.Option(
            metavar="|".join((*FILTERS, "NAME")),
            callback=one_of(FILTERS, "thbridge.localizers"),
            autocompletion=lambda: [*FILTERS],
            help="Filter: `amcl` (particle filter), `ekf` or `ukf` (extended or unscented Kalman filter), or the NAME "
            "of an installed localizer.",
        ),
    ] = "amcl",
    params: Annotated[
        list[Path] | None, typer.Option(help="ROS YAML file with parameters of the filter. Can be repeated.")
    ] = None,
    scan_topic: Annotated[
        str | None,
        typer.Option(help="Topic of the scans (sensor_msgs/LaserScan); default: the topic of the only robot."),
    ] = None,
    odom_topic: Annotated[
        str | None,
        typer.Option(
            help="Topic of the odometry (nav_msgs/Odometry); default: the topic of the same robot, otherwise tf."
        ),
    ] = None,
    initial_pose: Annotated[
        Triple | None,
        typer.Option(help="Pose of the robot at the start, in the map: meters, radians.", metavar="X Y YAW"),
    ] = None,
    anywhere: Annotated[bool, typer.Option("--global", help="Search for the start pose on the whole map.")] = False,
    laser_pose: Annotated[
        Triple | None, typer.Option(help="Pose of the laser on the base; default: from tf.", metavar="X Y YAW")
    ] = None,
    max_odom_speed: Annotated[
        float | None,
        typer.Option(
            help="Fastest speed of the robot, m/s; faster odometry is ignored. Default: estimated from the odometry.",
            min=0.01,
        ),
    ] = None,
    time_offset: Annotated[
        str,
        typer.Option(
            help="Correct odometry that is this many seconds ahead of the scans; `auto` estimates the seconds in a "
            "first run.",
            metavar="auto|SECONDS",
        ),
    ] = "0",
    seed: Annotated[int, typer.Option(help="Random seed.", min=0, max=2**31 - 1)] = 1,
    to: Annotated[
        Path | None,
        typer.Option("--out", help="Output file in TUM format: the path, one line per update. `-` is standard output."),
    ] = None,
    updates: Annotated[
        Path | None,
        typer.Option(
            help="File to write (.csv or .jsonl): all updates, with covariance, agreement, lost flag, and probability "
            "of a wrong pose."
        ),
    ] = None,
    plot: Annotated[
        Path | None,
        typer.Option(help="Picture to write (.png, .svg or .pdf): the path on the map, and where the robot was lost."),
    ] = None,
    progress: ProgressOption = ProgressKind.AUTO,
    as_json: AsJson = False,
) -> None:
    """Compute the path of a robot on a map, from the scans and the odometry in a recording."""
    from thbridge.files.ros.defaults import sentences_of
    from thbridge.hunt.refusals import RequestRefused
    from thbridge.offline.localization_updates import UpdatesFormat, updates_text
    from thbridge.offline.recording import open_recording
    from ui.command_line.grids import grid_at
    from ui.command_line.pictures import PICTURES
    from ui.command_line.progress import shown_progress
    from ui.commands.offline.localization import (
        corrected_localization,
        localized_as_json,
        offset_warning,
        pose_in,
        read_localization_parameters,
        show_localized,
        time_offset_in,
        trajectory_text,
        write_localization_picture,
        write_text,
    )
    from ui.first_start.compiling import announce_compiling

    share_no_output(to, as_json)
    if (initial_pose is None) == (not anywhere):
        fail(
            BAD_INPUT,
            "--initial-pose, --global: exactly one of these options is needed. Write --initial-pose X Y YAW, or "
            "--global.",
        )
    if updates is not None and updates.suffix.lower().strip(".") not in set(UpdatesFormat):
        fail(BAD_INPUT, f"--updates: {updates} has no known format. Write a file name that ends in .csv or .jsonl.")
    if plot is not None and plot.suffix.lower() not in PICTURES:
        fail(BAD_INPUT, f"--plot: {plot} has no known format. Write a file name that ends in {' or '.join(PICTURES)}.")
    share_outputs()
    offset = time_offset_in(time_offset)
    with bad_input():
        software, file_notices, defaults = read_localization_parameters(params or [], localization)
        grid = grid_at(map_yaml)
        seat = None if laser_pose is None else pose_in(laser_pose)
        recording = open_recording(bag, scan_topic, odom_topic, seat, max_odom_speed)
    notices = (*file_notices, *recording.notices)
    for sentence in (*notices, *sentences_of(defaults)):
        note(sentence)
    announce_compiling()
    start = None if initial_pose is None else pose_in(initial_pose)
    with bad_input(), shown_progress(progress, "scans") as tell:
        result, applied = corrected_localization(recording, grid, software, start, seed, offset, tell)
    if isinstance(result, RequestRefused):
        fail(FAILED, result.sentence)
    if (warning := offset_warning(result)) is not None:
        note(warning)
    if to is not None:
        with bad_input(), destination(to) as file:
            write_text(file, trajectory_text(result), "--out")
    with bad_input():
        if updates is not None:
            kind = UpdatesFormat(updates.suffix.lower().strip("."))
            write_text(updates, updates_text(result.updates, kind), "--updates")
        if plot is not None:
            write_localization_picture(plot, result, grid, bag)
    if as_json:
        ros = {"ros_defaults": [default.as_json() for default in defaults]} if params else {}
        print_json(localized_as_json(recording, result, applied, notices) | ros)
    elif to != STANDARD_OUTPUT:
        show_localized(recording, result, applied)
