"""Files of parameters and obstacles, and the footprint, for `thbridge drive`."""

import json
import math
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from sim.common.grid import OccupancyGrid
from sim.common.traversability import Polygon, area, crosses_itself, inside
from sim.inputs import ScheduledInput
from sim.parameters import RobotParameters, WorldParameters, param
from thbridge.files.disk.text_files import read_text
from thbridge.files.errors import BadFiles
from thbridge.files.ros.defaults import RosDefault, ros_defaults
from thbridge.files.ros.parameters import namespace_in, parse_ros_files
from thbridge.files.yaml.load import load, load_tree
from thbridge.files.yaml.tree import Section, parse
from thbridge.offline.unmapped import with_unmapped
from thbridge.study.things import ThingEntry, faults_of_things, schedule_of
from ui.command_line.grids import grid_at
from ui.command_line.terminal import BAD_INPUT, fail


@dataclass(frozen=True, slots=True)
class DriveParameters:
    """Sections that a file of parameters may contain."""

    world: WorldParameters = param(WorldParameters(), "bodies, motors and sensors")
    robot: RobotParameters = param(RobotParameters(), "the robot's software")


@dataclass(frozen=True, slots=True)
class ParameterFiles:
    """Parameters of some files, with messages about them.

    Attributes:
        parameters: all parameters.
        notices: sentences about parameters that have no effect.
        defaults: ROS's defaults that apply because the ROS files omit these parameters.
    """

    parameters: DriveParameters
    notices: tuple[str, ...]
    defaults: tuple[RosDefault, ...]


def read_parameters(files: list[Path]) -> ParameterFiles:
    """Return the parameters of the files. ROS files are read first, so that sections of a study override them."""
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
    """Return True if a file has sections of a study, False if it has parameters of ROS."""
    if namespace_in(file)[0]:
        return False
    tree = parse(file, read_text(file), ros=True)
    return isinstance(tree, Section) and any(key.text in {"world", "robot"} for key, _ in tree.entries)


@dataclass(frozen=True, slots=True)
class MovingObstacles:
    """Contents of a file of obstacles: things, as in a study."""

    things: tuple[ThingEntry, ...] = param(
        (), "obstacles that no map shows; write each as a line `- {key: value, ...}`"
    )


def read_moving(path: Path, grid: OccupancyGrid) -> tuple[ScheduledInput, ...]:
    """Return the obstacles in a file, which appear, move and vanish on a map.

    Raises:
        BadFiles: all faults of the file, including places outside the map; or a single BadFile.
    """
    loaded = load(path, MovingObstacles)
    things = loaded.value.things
    faults = list(faults_of_things(loaded, things))
    if not things:
        faults.append(
            loaded.fault("things", "there are no things", "Write things: and a line - {name: ..., ...} for each thing")
        )
    for index, entry in enumerate(things):
        key = f"things[{index}]"
        places = [(f"{key}.path[{number}]", point) for number, point in enumerate(entry.path)]
        if entry.at is not None:
            places = [(f"{key}.at", entry.at[:2])]
        for place, (x, y) in places:
            if not grid.contains(*grid.cell_of(x, y)):
                faults.append(
                    loaded.fault(place, f"({x:g}, {y:g}) is outside the map", "Write meters in the map frame")
                )
    if faults:
        raise BadFiles(tuple(faults))
    return schedule_of(things, ())


def read_unmapped(path: Path, grid: OccupancyGrid) -> tuple[OccupancyGrid, tuple[str, ...]]:
    """Return the true map, which includes the obstacles of a file, and warnings.

    Raises:
        BadFile: the file cannot be read, or does not fit the map.
    """
    true_grid, outside = with_unmapped(grid, grid_at(path), path)
    return true_grid, (f"{path}: {outside} occupied cells lie outside the map and are ignored",) if outside else ()


def corners_in(text: str) -> Polygon:
    """Parse a footprint, such as "[[0.3, 0.2], [-0.3, 0.2], ...]". End the command if the text is not a footprint."""
    try:
        corners = tuple((float(x), float(y)) for x, y in json.loads(text))
    except (ValueError, TypeError):
        corners = ()
    numbers = [number for corner in corners for number in corner]
    around = corners and bool(inside(corners, np.zeros(1), np.zeros(1))[0])
    if not numbers or not all(map(math.isfinite, numbers)) or area(corners) == 0.0 or crosses_itself(corners):
        fail(BAD_INPUT, f"--footprint: {text!r} is not a polygon. Write its corners in order: [[x, y], [x, y], ...].")
    if not around:
        fail(
            BAD_INPUT,
            "--footprint: these corners do not surround (0, 0), the robot's center. Choose corners around it.",
        )
    return corners
