"""Parameters and footprint for `thbridge drive`."""

import json
import math
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from sim.common.traversability import Polygon, area, crosses_itself, inside
from sim.parameters import RobotParameters, WorldParameters, param
from thbridge.files.ros.defaults import RosDefault, ros_defaults
from thbridge.files.ros.parameters import namespace_in, parse_ros_files
from thbridge.files.yaml.load import load_tree
from thbridge.files.yaml.tree import Section, parse, read_text
from ui.terminal import BAD_INPUT, fail


@dataclass(frozen=True, slots=True)
class DriveParameters:
    """Sections that a file of parameters may hold."""

    world: WorldParameters = param(WorldParameters(), "bodies, motors and sensors")
    robot: RobotParameters = param(RobotParameters(), "the software that drives")


@dataclass(frozen=True, slots=True)
class ParameterFiles:
    """Parameters of some files, with what there is to tell of them.

    Attributes:
        parameters: all parameters.
        notices: sentences about parameters without effect.
        defaults: ROS's defaults that hold because files of ROS leave these parameters out.
    """

    parameters: DriveParameters
    notices: tuple[str, ...]
    defaults: tuple[RosDefault, ...]


def read_parameters(files: list[Path]) -> ParameterFiles:
    """Parameters of the files; those of ROS first, so that sections of a study win, as in a study."""
    ours = {file: _is_ours(file) for file in files}
    hunts = RobotParameters()
    of_ros = parse_ros_files([file for file in files if not ours[file]])
    start = of_ros.start(hunts)
    ros = of_ros.over(start)
    given, notices, written = DriveParameters(robot=ros.value), ros.notices, set(ros.written)
    for file in files:
        if ours[file]:
            loaded = load_tree(file, parse(file, read_text(file)), DriveParameters, given)
            given, notices = loaded.value, notices + loaded.notices
            written.update(line.removeprefix("robot.") for line in loaded.lines)
    return ParameterFiles(given, notices, ros_defaults(given.robot, start, hunts, written))


def _is_ours(file: Path) -> bool:
    """Return True when a file has sections of a study, and not parameters of ROS."""
    if namespace_in(file)[0]:
        return False
    tree = parse(file, read_text(file), ros=True)
    return isinstance(tree, Section) and any(key.text in {"world", "robot"} for key, _ in tree.entries)


def corners_in(text: str) -> Polygon:
    """The footprint that a text describes."""
    try:
        corners = tuple((float(x), float(y)) for x, y in json.loads(text))
    except (ValueError, TypeError):
        corners = ()
    numbers = [number for corner in corners for number in corner]
    around = corners and bool(inside(corners, np.zeros(1), np.zeros(1))[0])
    if not numbers or not all(map(math.isfinite, numbers)) or area(corners) == 0.0 or crosses_itself(corners):
        fail(BAD_INPUT, f"--footprint: {text!r} is no polygon. Write its corners in turn, [[x, y], [x, y], ...].")
    if not around:
        fail(BAD_INPUT, "--footprint: these corners do not surround (0, 0), the robot's centre. Move them around it.")
    return corners
