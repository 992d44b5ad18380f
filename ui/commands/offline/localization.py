"""Arguments, filter runs and output of `thbridge localize`."""

import dataclasses
import itertools
import math
import time
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from sim.common.geometry import Pose2
from sim.common.grid import OccupancyGrid
from sim.numerics.elementary import wrap_angle
from sim.parameters import RobotParameters, with_ros_defaults
from sim.robot.localization.estimate import Localizer
from sim.robot.localization.wrong_pose import WRONG_DISTANCE, WRONG_TURN
from thbridge.app.compose.installed_parts import installed_parts
from thbridge.files.disk.whole import write_whole
from thbridge.files.progress import Tell
from thbridge.files.ros.defaults import RosDefault, ros_defaults
from thbridge.files.ros.parameters import parse_ros_files
from thbridge.hunt.refusals import RequestRefused
from thbridge.offline.localize import LocalizationResult, localize
from thbridge.offline.localizers import recorded_localizer, warm_up
from thbridge.offline.recording import LocalizationBag, unstamped_sentence
from thbridge.offline.scan_headings import ScanHeadings
from thbridge.offline.time_offset import TimeOffset
from thbridge.offline.tum import tum_line
from thbridge.ros.odometry_faults import RecordedFault, fault_sentences
from ui.command_line.pictures import write_picture
from ui.command_line.terminal import BAD_INPUT, fail, show

if TYPE_CHECKING:
    from matplotlib.figure import Figure

LONGEST_GIVEN = 10.0
"""Maximum time offset that can be given, seconds."""
WARNED = 0.05
"""Minimum time offset that causes a warning, seconds."""
MOST_STRETCHES = 10
"""Maximum number of printed lines about periods in which the robot was lost."""


def pose_in(triple: tuple[float, float, float]) -> Pose2:
    """Return three numbers as a pose."""
    if not np.isfinite(triple).all():
        fail(BAD_INPUT, f"{triple} is not a pose. Write three finite numbers X Y YAW.")
    x, y, yaw = triple
    return Pose2(x, y, wrap_angle(yaw))


def read_localization_parameters(
    files: list[Path], localization: str
) -> tuple[RobotParameters, tuple[str, ...], tuple[RosDefault, ...]]:
    """Return a localizer's parameters from ROS files, messages about them, and defaults of amcl that differ in hunts.

    Parameters of amcl that no file sets have ROS's defaults, even if there are no files.
    """
    hunts = RobotParameters()
    of_ros = parse_ros_files(files)
    start = dataclasses.replace(of_ros.start(hunts), amcl=with_ros_defaults(hunts.amcl))
    ros = of_ros.over(start)
    defaults = ros_defaults(ros.value, start, hunts, ros.written) if files and localization == "amcl" else ()
    software = dataclasses.replace(ros.value, localization=localization)
    return software, ros.notices, tuple(default for default in defaults if default.name.startswith("amcl."))


AUTO = "auto"
"""Value of --time-offset with which a first run of the filter estimates the offset."""


def time_offset_in(text: str) -> float | None:
    """Return the time offset in the value of an option, in seconds; None for `AUTO`."""
    if text == AUTO:
        return None
    try:
        seconds = float(text)
    except ValueError:
        seconds = math.inf
    if not abs(seconds) <= LONGEST_GIVEN:
        problem = f"--time-offset: {text} is not a time offset."
        fail(BAD_INPUT, f"{problem} Write {AUTO}, or seconds between -{LONGEST_GIVEN:g} and {LONGEST_GIVEN:g}.")
    return seconds


def corrected_localization(
    recording: LocalizationBag,
    grid: OccupancyGrid,
    software: RobotParameters,
    start: Pose2 | None,
    seed: int,
    offset: float | None,
    tell: Tell,
) -> tuple[LocalizationResult | RequestRefused, float]:
    """Run the filter with an offset added to the stamps of odometry; return its result, and the offset.

    Args:
        recording: bag with scans and odometry.
        grid: map of the robot's surroundings.
        software: parameters and choice of the filter.
        start: pose of the robot at the beginning. If None, it may be anywhere.
        seed: random seed.
        offset: time offset, seconds. If None, a first run estimates it; if the estimate fails, it is 0.
        `tell`: function that receives the progress.
    """
    if offset is None:
        first = run_localization(recording, grid, software, start, seed, tell)
        if isinstance(first, RequestRefused) or first.time_offset is None:
            return first, 0.0
        offset = first.time_offset.seconds
    later = dataclasses.replace(recording, odometry=recording.odometry.later(offset)) if offset else recording
    return run_localization(later, grid, software, start, seed, tell), offset


def run_localization(
    recording: LocalizationBag,
    grid: OccupancyGrid,
    software: RobotParameters,
    start: Pose2 | None,
    seed: int,
    tell: Tell,
) -> LocalizationResult | RequestRefused:
    """Run the filter over a recording; `tell` receives the progress."""
    parts = installed_parts([software])

    def begin() -> Localizer:
        return recorded_localizer(software, grid, recording.laser.mount, start, seed, parts)

    warm_up(begin(), software, recording.laser.scan(0, recording.laser.first))
    done = itertools.count(1)
    return localize(
        begin(),
        recording.laser,
        recording.odometry,
        recording.scans(),
        time.process_time,
        lambda: tell("scans", next(done), recording.messages),
        ScanHeadings(grid, recording.laser.mount),
    )


def trajectory_text(result: LocalizationResult) -> str:
    """Return the trajectory in TUM format."""
    return "".join(f"{tum_line(update.stamp_ns, update.base_in_map)}\n" for update in result.updates)


def write_text(path: Path, text: str, option: str) -> None:
    """Write a text to the file that an option names."""
    write_whole(path, text.encode("ascii"), f"choose another file with {option}")


def write_localization_picture(path: Path, result: LocalizationResult, grid: OccupancyGrid, bag: Path) -> None:
    """Draw the path on the map."""

    def draw() -> "Figure":
        from thbridge.offline.localization_picture import localization_picture  # imports matplotlib

        return localization_picture(result, grid, bag.name)

    write_picture(draw, path, "--plot")


def localized_as_json(
    recording: LocalizationBag, result: LocalizationResult, applied: float, notices: tuple[str, ...]
) -> dict[str, object]:
    """Return the result, with the corrected time offset, as a JSON object."""
    pose, offset = result.last.base_in_map, result.time_offset
    return {
        "updates": len(result.updates),
        "lost_updates": sum(update.lost for update in result.updates),
        "lost_stretches": [
            {"updates": stretch.updates, "start": stretch.start_ns / 1e9, "end": stretch.end_ns / 1e9}
            for stretch in result.lost_stretches
        ],
        "cpu_seconds": result.cpu_seconds,
        "final_pose": [pose.x, pose.y, pose.theta],
        "covariance": result.last.covariance.tolist(),
        "lost": result.last.lost,
        "p_wrong": result.last.p_wrong,
        "scans": result.scans,
        "skipped": {str(reason): count for reason, count in result.skipped.items()},
        "scan_topic": recording.scan_topic,
        "scans_unstamped": result.unstamped,
        "scan_faults": [_fault_as_json(fault) for fault in result.scan_faults],
        "odometry": recording.odometry_source,
        "odometry_unstamped": recording.odometry.unstamped,
        "odometry_faults": [_fault_as_json(fault) for fault in recording.odometry.faults],
        "time_offset": None
        if offset is None
        else {"seconds": offset.seconds + applied, "deviation": offset.deviation, "turns": offset.turns},
        "time_offset_applied": applied,
        "laser_pose": recording.laser.mount.laser_in_base.array().tolist(),
        "upside_down": recording.laser.upside_down,
        "notices": list(notices),
    }


def _fault_as_json(fault: RecordedFault) -> dict[str, object]:
    return {
        "kind": str(fault.kind),
        "stamp": fault.stamp_ns / 1e9,
        "recorded": fault.received_ns / 1e9,
        "meters": fault.distance,
        "radians": fault.turn,
        "seconds": fault.seconds,
    }


def show_localized(recording: LocalizationBag, result: LocalizationResult, applied: float) -> None:
    """Print the result, with the corrected time offset."""
    last = result.last
    pose, deviations = last.base_in_map, np.sqrt(np.diag(last.covariance)).tolist()
    place = f"x {pose.x:.3f} m, y {pose.y:.3f} m, yaw {pose.theta:.3f} rad"
    spread = f"standard deviations {deviations[0]:.3f} m, {deviations[1]:.3f} m, {deviations[2]:.3f} rad"
    show(f"At the end the robot is at {place} ({spread}).")
    if last.lost:
        show("The filter considers this pose wrong: the robot is lost.")
    if last.p_wrong is not None:
        wrong = f"more than {WRONG_DISTANCE:g} m or {WRONG_TURN:g} rad wrong"
        show(f"The probability that this pose is {wrong} is {last.p_wrong:.3f}.")
    _show_lost(result)
    each = 1000 * result.cpu_seconds / max(1, len(result.updates))
    show(f"{len(result.updates)} updates from {result.scans} scans, {each:.2f} ms of processor time per update.")
    for reason, count in result.skipped.items():
        show(f"{count} scans were omitted: {reason}.")
    if result.unstamped:
        show(unstamped_sentence(recording.scan_topic, result.unstamped))
    for sentence in fault_sentences(recording.scan_topic, result.scan_faults, recording.odometry.begin_ns):
        show(sentence)
    show(offset_sentence(result.time_offset, applied))
    show(f"Scans: {recording.scan_topic}. Odometry: {recording.odometry_source}.")


def offset_sentence(offset: TimeOffset | None, applied: float) -> str:
    """Return sentences about the time offset between odometry and scans.

    Args:
        offset: estimate from a run in which `applied` was added to the stamps of odometry; None if there is no
            estimate.
        applied: corrected offset, seconds.
    """
    corrected = f" An offset of {applied:.3f} s is corrected." if applied else ""
    if offset is None:
        return f"The time offset between odometry and scans is unknown, because the robot turned too little.{corrected}"
    seconds = offset.seconds + applied
    leads = "ahead of" if seconds >= 0.0 else "behind"
    return (
        f"The odometry is {abs(seconds):.3f} s {leads} the scans (standard deviation {offset.deviation:.3f} s). Its "
        f"turns are {offset.turns:.2f} times the real turns.{corrected}"
    )


def offset_warning(result: LocalizationResult) -> str | None:
    """Return a warning about an offset that was not corrected; None if the offset is small or uncertain."""
    offset = result.time_offset
    if offset is None or abs(offset.seconds) < max(WARNED, 2.0 * offset.deviation):
        return None
    return (
        f"The clocks of odometry and scans differ by {abs(offset.seconds):.3f} s. "
        f"Correct this with --time-offset {AUTO}, or in the program that stamps the messages."
    )


def _show_lost(result: LocalizationResult) -> None:
    """Print when the robot was lost."""
    stretches, first_ns = result.lost_stretches, result.updates[0].stamp_ns if result.updates else 0
    if not stretches:
        show("The robot was not lost at any update.")
        return
    lost = sum(stretch.updates for stretch in stretches)
    show(f"The robot was lost at {lost} of {len(result.updates)} updates. Periods, in seconds after the first update:")
    for stretch in stretches[:MOST_STRETCHES]:
        start, end = (stretch.start_ns - first_ns) / 1e9, (stretch.end_ns - first_ns) / 1e9
        show(f"  {start:.1f} to {end:.1f}, {stretch.updates} updates")
    if len(stretches) > MOST_STRETCHES:
        show(f"  and {len(stretches) - MOST_STRETCHES} more periods (write all updates with --updates).")
