"""Parameters and footprint for `thbridge drive`."""

import json
import math
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from sim.common.traversability import Polygon, area, crosses_itself, inside
from sim.parameters import RobotParameters, WorldParameters, param
from thbridge.files.ros.parameters import read_ros_parameters
from thbridge.files.yaml.load import load_tree
from thbridge.files.yaml.tree import Section, parse, read_text
from ui.terminal import BAD_INPUT, fail, note


@dataclass(frozen=True, slots=True)
class DriveParameters:
    """Sections that a file of parameters may hold."""

    world: WorldParameters = param(WorldParameters(), "bodies, motors and sensors")
    robot: RobotParameters = param(RobotParameters(), "the software that drives")


def read_parameters(files: list[Path]) -> DriveParameters:
    """Parameters of the files; those of ROS first, so that sections of a study win, as in a study."""
    ours = {file: _is_ours(file) for file in files}
    ros = read_ros_parameters([file for file in files if not ours[file]], RobotParameters())
    given, notices = DriveParameters(robot=ros.value), ros.notices
    for file in files:
        if ours[file]:
            loaded = load_tree(file, parse(file, read_text(file)), DriveParameters, given)
            given, notices = loaded.value, notices + loaded.notices
    for notice in notices:
        note(notice)
    return given


def _is_ours(file: Path) -> bool:
    """Return True when a file has sections of a study, and not parameters of ROS."""
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
