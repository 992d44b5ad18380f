"""`thbridge localize`: where was the robot, by any bag with scans and odometry."""

import dataclasses
import time
from pathlib import Path
from typing import Annotated

import numpy as np
import typer
from rich.progress import BarColumn, Progress, TextColumn, TimeRemainingColumn

from sim.common.geometry import Pose2, wrap_angle
from sim.common.grid import OccupancyGrid
from sim.parameters import AmclParameters, RobotParameters
from sim.robot.localization.amcl import Amcl
from thbridge.files.errors import BadFile
from thbridge.files.map_files import read_grid
from thbridge.files.ros.parameters import read_ros_parameters
from thbridge.hunt.refusals import RequestRefused
from thbridge.offline.localize import LocalizationResult, localize, warm_up
from thbridge.offline.recording import LocalizationBag, open_recording
from thbridge.offline.tum import tum_line
from ui.options import AsJson, announce_compiling
from ui.terminal import BAD_INPUT, FAILED, bad_input, err, fail, note, out, print_json

ROBOT = "robot1"
"""Key of the filter's random stream; a bag holds one robot's scans on a topic."""

Triple = tuple[float, float, float]


def localize_command(
    bag: Annotated[Path, typer.Argument(help="A ROS 1 bag with scans and odometry.")],
    map_yaml: Annotated[Path, typer.Option("--map", help="The map, a map_server YAML file.")],
    params: Annotated[
        list[Path] | None, typer.Option(help="ROS YAML file with amcl's parameters; may be repeated.")
    ] = None,
    scan_topic: Annotated[
        str | None, typer.Option(help="Topic of the scans (sensor_msgs/LaserScan); by default the only robot's.")
    ] = None,
    odom_topic: Annotated[
        str | None,
        typer.Option(help="Topic of the odometry (nav_msgs/Odometry); by default that robot's, or else tf."),
    ] = None,
    initial_pose: Annotated[
        Triple | None, typer.Option(help="Where the robot starts in the map: metres, radians.", metavar="X Y YAW")
    ] = None,
    anywhere: Annotated[bool, typer.Option("--global", help="The robot may start anywhere on the map.")] = False,
    laser_pose: Annotated[
        Triple | None, typer.Option(help="Where the laser sits on the base; by default as tf says.", metavar="X Y YAW")
    ] = None,
    seed: Annotated[int, typer.Option(help="All chance is keyed by it.", min=0, max=2**31 - 1)] = 1,
    to: Annotated[Path | None, typer.Option("--out", help="Write a TUM trajectory, one line for each update.")] = None,
    as_json: AsJson = False,
) -> None:
    """Localise a robot after the fact (AMCL): where was it in a map, by the scans and the odometry of a bag."""
    if (initial_pose is None) == (not anywhere):
        fail(
            BAD_INPUT,
            "--initial-pose, --global: just one of the two is needed. Write --initial-pose X Y YAW or --global.",
        )
    with bad_input():
        # What the files leave out is as in ROS, not as in our hunts.
        given = read_ros_parameters(params or [], dataclasses.replace(RobotParameters(), amcl=AmclParameters()))
        parameters = given.value.amcl
        grid = read_grid(map_yaml)
        seat = None if laser_pose is None else _pose(laser_pose)
        recording = open_recording(bag, scan_topic, odom_topic, seat)
    notices = (*given.notices, *recording.notices)
    for notice in notices:
        note(notice)
    announce_compiling()
    start = None if initial_pose is None else _pose(initial_pose)
    with bad_input():
        result = _run(recording, grid, parameters, start, seed)
    if isinstance(result, RequestRefused):
        fail(FAILED, result.sentence)
    if to is not None:
        with bad_input():
            _write(to, result)
    if as_json:
        print_json(_told(recording, result, notices))
    else:
        _tell(recording, result)


def _pose(triple: Triple) -> Pose2:
    if not np.isfinite(triple).all():
        fail(BAD_INPUT, f"{triple} is not a pose. Write three finite numbers X Y YAW.")
    x, y, yaw = triple
    return Pose2(x, y, wrap_angle(yaw))


def _run(
    recording: LocalizationBag, grid: OccupancyGrid, parameters: AmclParameters, start: Pose2 | None, seed: int
) -> LocalizationResult | RequestRefused:
    def begin() -> Amcl:
        localizer = Amcl(parameters, grid, recording.laser.mount, seed, ROBOT)
        if start is None:
            localizer.globalize()
        else:
            variances = (parameters.initial_cov_xx, parameters.initial_cov_yy, parameters.initial_cov_aa)
            localizer.start(start, np.diag(variances))
        return localizer

    warm_up(begin(), parameters, recording.laser.scan(0, recording.laser.first))
    bar = Progress(
        TextColumn("{task.completed} of {task.total} scans"),
        BarColumn(),
        TimeRemainingColumn(),
        console=err,
        transient=True,
        disable=not err.is_terminal,
    )
    with bar:
        task = bar.add_task("", total=recording.messages)
        return localize(
            begin(),
            recording.laser,
            recording.odometry,
            recording.scans(),
            time.process_time,
            lambda: bar.advance(task),
        )


def _write(path: Path, result: LocalizationResult) -> None:
    lines = "".join(f"{tum_line(fix.stamp_ns, fix.base_in_map)}\n" for fix in result.updates)
    try:
        path.write_text(lines, encoding="ascii")
    except OSError as error:
        problem = f"it cannot be written ({error.strerror})"
        raise BadFile(path, None, None, problem, "choose another file by --out") from None


def _told(recording: LocalizationBag, result: LocalizationResult, notices: tuple[str, ...]) -> dict[str, object]:
    pose = result.last.base_in_map
    return {
        "updates": len(result.updates),
        "cpu_seconds": result.cpu_seconds,
        "final_pose": [pose.x, pose.y, pose.theta],
        "covariance": result.last.covariance.tolist(),
        "lost": result.last.lost,
        "scans": result.scans,
        "skipped": {str(reason): count for reason, count in result.skipped.items()},
        "scan_topic": recording.scan_topic,
        "odometry": recording.odometry_source,
        "laser_pose": recording.laser.mount.laser_in_base.array().tolist(),
        "upside_down": recording.laser.upside_down,
        "notices": list(notices),
    }


def _tell(recording: LocalizationBag, result: LocalizationResult) -> None:
    last = result.last
    pose, deviations = last.base_in_map, np.sqrt(np.diag(last.covariance)).tolist()
    out.print(f"At the end the robot is at x {pose.x:.3f} m, y {pose.y:.3f} m, yaw {pose.theta:.3f} rad", end="")
    out.print(f" (standard deviations {deviations[0]:.3f}, {deviations[1]:.3f}, {deviations[2]:.3f}).")
    if last.lost:
        out.print("The filter holds that this is wrong: it is lost.")
    each = 1000 * result.cpu_seconds / max(1, len(result.updates))
    out.print(f"{len(result.updates)} updates from {result.scans} scans, {each:.2f} ms of the processor for each.")
    for reason, count in result.skipped.items():
        out.print(f"{count} scans were left out: {reason}.")
    out.print(f"Scans: {recording.scan_topic}. Odometry: {recording.odometry_source}.")
