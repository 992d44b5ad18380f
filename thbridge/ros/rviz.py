"""rviz configuration that shows a whole team: map, robots, scans, particle clouds, plans, costmaps.

Source: files that rviz 1.14 has saved. rviz has defaults for all settings that are omitted here.
"""

from collections.abc import Iterator, Mapping, Sequence
from io import StringIO
from typing import TypeAlias

from ruamel.yaml import YAML

from sim.common.geometry import Pose2
from sim.common.grid import OccupancyGrid
from sim.parameters import RobotParameters
from thbridge.ros import names
from thbridge.ros.names import MAP_FRAME, RobotNames
from thbridge.ros.topics import Planners, RobotTopics

Value: TypeAlias = "bool | int | float | str | Sequence[Value] | Mapping[str, Value]"
Section: TypeAlias = dict[str, Value]

COLOURS = ("0; 114; 178", "213; 94; 0", "0; 158; 115", "204; 121; 167", "230; 159; 0", "86; 180; 233", "120; 94; 240")
"""One color per robot. Color-blind people can distinguish them (Okabe and Ito, without yellow, which is too pale)."""

WINDOW = (1280, 900)
"""Width and height in pixels."""

_SHARE_OF_WINDOW = 0.9
"""Fraction of the view that the map fills."""
_PANEL = 320
"""Width of the list of displays in pixels."""
_PANELS = (
    "000000ff00000000fd00000001000000000000012c00000320fc0200000001fb000000100044006900730070006c0061"
    "00790073010000004100000320000000dd00ffffff000003c00000032000000004000000040000000800000008fc0000"
    "000100000002000000010000000a0054006f006f006c00730100000000ffffffff0000000000000000"
)
"""Positions of the panels in Qt's format (QMainWindow::saveState). The list of displays is at the left, 300 pixels
wide. Without this value, it would cover the map."""


def configuration(software: Sequence[RobotParameters], grid: OccupancyGrid) -> str:
    """Return the configuration file for a team on this map, seen from above; see `sections`."""
    return write_sections(sections(software, grid))


def sections(software: Sequence[RobotParameters], grid: OccupancyGrid) -> Section:
    """Return the content of the configuration file.

    Args:
        software: parameters of each robot. The topics of a robot's plans contain the names of its planners.
        grid: the map. It determines the center and the scale of the view.
    """
    team = [RobotNames.of(number) for number in range(len(software))]
    topics = [RobotTopics(robot, Planners.of(own)) for robot, own in zip(team, software, strict=True)]
    groups = [_robot(robot, of, colour_of(index)) for index, (robot, of) in enumerate(zip(team, topics, strict=True))]
    return {
        "Panels": [
            {"Class": "rviz/Displays", "Name": "Displays", "Tree Height": 500},
        ],
        "Visualization Manager": {
            "Class": "",
            "Displays": [*_shared(team), *groups],
            "Enabled": True,
            "Global Options": {"Background Color": "255; 255; 255", "Fixed Frame": MAP_FRAME, "Frame Rate": 30},
            "Name": "root",
            "Tools": [
                {"Class": "rviz/Interact"},
                {"Class": "rviz/MoveCamera"},
                {"Class": "rviz/Select"},
                {"Class": "rviz/Measure"},
                *(tool for of in topics for tool in _tools(of)),
            ],
            "Value": True,
            "Views": {"Current": _from_above(grid)},
        },
        "Window Geometry": {"Width": WINDOW[0], "Height": WINDOW[1], "QMainWindow State": _PANELS},
    }


def write_sections(whole: Section) -> str:
    """Return the text of a configuration file with this content."""
    text = StringIO()
    yaml = YAML()
    yaml.indent(mapping=2, sequence=4, offset=2)
    yaml.dump(whole, text)
    return text.getvalue()


def colour_of(robot: int) -> str:
    """Return a robot's color in the form of rviz files: red, green and blue from 0 to 255."""
    return COLOURS[robot % len(COLOURS)]


def _display(kind: str, name: str, topic: str | None, enabled: bool, **properties: Value) -> Section:
    """Return a display. In rviz, both Enabled and Value store whether the display is switched on."""
    given = {key.replace("_", " "): value for key, value in properties.items()}
    about = {} if topic is None else {"Topic": topic}
    return {"Class": f"rviz/{kind}", "Name": name, "Enabled": enabled, "Value": enabled, **about, **given}


def _shared(team: Sequence[RobotNames]) -> Iterator[Section]:
    yield _display("Map", "map", names.MAP, True, Color_Scheme="map", Alpha=0.6, Draw_Behind=True)
    yield _display("MarkerArray", "things", None, True, **{"Marker Topic": names.THINGS})
    yield _display("MarkerArray", "rooms", None, True, **{"Marker Topic": names.ROOMS})
    # Only one frame of each robot is shown, because more names would hide the map.
    shown = {MAP_FRAME: False} | {
        frame: frame == robot.base_link
        for robot in team
        for frame in (robot.odom, robot.base_footprint, robot.base_link, robot.base_laser)
    }
    frames: Section = {"All Enabled": False, **{frame: {"Value": on} for frame, on in shown.items()}}
    yield _display("TF", "robots", None, True, Frames=frames, Marker_Scale=1.0, Show_Arrows=False, Show_Names=True)


def _robot(robot: RobotNames, of: RobotTopics, colour: str) -> Section:
    costmaps = [
        _display("Map", name, topic.name, shown, Color_Scheme="costmap", Alpha=0.35)
        for name, topic, shown in (
            ("global costmap", of.global_costmap, False),
            ("local costmap", of.local_costmap, True),
        )
    ]
    displays = [
        *costmaps,
        _display(
            "LaserScan", "scan", of.scan.name, True, Color_Transformer="FlatColor", Color=colour,
            Style="Points", **{"Size (Pixels)": 3},
        ),
        _display(
            "PoseArray", "particles", of.particlecloud.name, True, Color=colour, Shape="Arrow (Flat)",
            Alpha=0.4, Arrow_Length=0.25,
        ),
        _display(
            "Path", "plan", of.plan.name, True, Color=colour, Line_Style="Billboards", Line_Width=0.06,
        ),
        _display("Path", "local plan", of.local_plan.name, True, Color="0; 0; 0", Line_Width=0.03),
        _display("Polygon", "footprint", of.local_footprint.name, True, Color=colour),
        _display(
            "PoseWithCovariance", "estimate", of.amcl_pose.name, True, Color=colour, Alpha=0.8,
            Shape="Arrow", Head_Length=0.2, Head_Radius=0.12, Shaft_Length=0.4, Shaft_Radius=0.04,
        ),
        _display(
            "Odometry", "truth", of.base_pose_ground_truth.name, False, Keep=1,
            Shape={"Value": "Arrow", "Color": "0; 0; 0", "Alpha": 0.6}, Covariance={"Value": False},
        ),
    ]  # fmt: skip
    return {"Class": "rviz/Group", "Name": robot.namespace[1:], "Enabled": True, "Displays": displays}


def _tools(of: RobotTopics) -> Iterator[Section]:
    """Yield the two tools of a robot. In rviz, these tools have topics, but no names."""
    yield {"Class": "rviz/SetInitialPose", "Topic": of.initialpose.name}
    yield {"Class": "rviz/SetGoal", "Topic": of.simple_goal.name}


def _from_above(grid: OccupancyGrid) -> Section:
    """Return the view of the complete map. rviz's scale is in pixels per meter."""
    width, height = grid.cols * grid.resolution, grid.rows * grid.resolution
    scale = _SHARE_OF_WINDOW * min((WINDOW[0] - _PANEL) / width, (WINDOW[1] - 120) / height)
    middle = grid.origin.compose(Pose2(width / 2, height / 2, 0.0))
    return {
        "Class": "rviz/TopDownOrtho",
        "Name": "Current View",
        "Target Frame": MAP_FRAME,
        "Angle": 0.0,
        "Scale": round(scale, 2),
        "X": round(middle.x, 3),
        "Y": round(middle.y, 3),
    }
