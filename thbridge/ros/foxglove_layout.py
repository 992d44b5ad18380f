"""Foxglove layout that shows a whole team: map, robots, scans, particle clouds, costmaps, plans, plots, log.

Source: layouts that Foxglove has exported. Foxglove has defaults for all settings that are omitted here.
"""

import json
from collections.abc import Iterator, Mapping, Sequence
from typing import TypeAlias

from sim.common.geometry import Pose2
from sim.common.grid import OccupancyGrid
from sim.parameters import RobotParameters
from thbridge.ros import names
from thbridge.ros.names import MAP_FRAME, RobotNames
from thbridge.ros.rviz import colour_of
from thbridge.ros.topics import SCORE, Planners, RobotTopics

Value: TypeAlias = "bool | int | float | str | Sequence[Value] | Mapping[str, Value]"
Section: TypeAlias = dict[str, Value]

_SCENE, _ERRORS, _ENERGY, _LOG = "3D!team", "Plot!errors", "Plot!energy", "RosOut!log"
"""Ids of the panels: type in Foxglove, and our name."""
_SHARE_OF_SCENE = 0.9
"""Fraction of the scene that the map fills."""
_ASPECT = 1.2
"""Approximate ratio of width to height of the scene in a full-screen window."""


def foxglove_layout(software: Sequence[RobotParameters], grid: OccupancyGrid) -> str:
    """Return the layout file for a team on this map, seen from above.

    Args:
        software: parameters of each robot. The topics of a robot's plans contain the names of its planners.
        grid: the map. It determines the center and the distance of the view.
    """
    team = [RobotNames.of(number) for number in range(len(software))]
    topics = [RobotTopics(robot, Planners.of(own)) for robot, own in zip(team, software, strict=True)]
    errors = [
        _line(f"{of.position_error.name}.data", team[robot].namespace[1:], _hex(robot))
        for robot, of in enumerate(topics)
    ]
    energy = [
        _line(f"{of.battery.name}.charge", team[robot].namespace[1:], _hex(robot)) for robot, of in enumerate(topics)
    ]
    score = _line(f"{SCORE.name}.score", "score", "#000000")
    whole: Section = {
        "configById": {
            _SCENE: _scene(team, topics, grid),
            _ERRORS: _plot("position error, meters", errors),
            _ENERGY: _plot("energy, score", [*energy, score]),
            _LOG: {"topicToRender": names.ROSOUT, "minLogLevel": 1, "searchTerms": []},
        },
        "globalVariables": {},
        "userNodes": {},
        "playbackConfig": {"speed": 1},
        "layout": {
            "direction": "row",
            "first": _SCENE,
            "second": {
                "direction": "column",
                "first": _ERRORS,
                "second": {"direction": "column", "first": _ENERGY, "second": _LOG, "splitPercentage": 50},
                "splitPercentage": 33,
            },
            "splitPercentage": 65,
        },
    }
    return json.dumps(whole, indent=2) + "\n"


def _scene(team: Sequence[RobotNames], topics: Sequence[RobotTopics], grid: OccupancyGrid) -> Section:
    shown: Section = {
        names.MAP: {"visible": True, "colorMode": "map", "alpha": 0.6},
        names.ROOMS: {"visible": True},
        names.THINGS: {"visible": True},
    }
    for index, of in enumerate(topics):
        shown |= dict(_of_robot(of, _hex(index)))
    # Only one frame of each robot is shown, because more axes would hide the map.
    axes = {robot.base_link for robot in team}
    frames = {
        frame for robot in team for frame in (robot.odom, robot.base_footprint, robot.base_link, robot.base_laser)
    }
    return {
        "followTf": MAP_FRAME,
        "followMode": "follow-none",
        "cameraState": _from_above(grid),
        "scene": {"backgroundColor": "#ffffff", "transforms": {"axisScale": 0.4, "labelSize": 0.15, "lineWidth": 0}},
        "transforms": {f"frame:{frame}": {"visible": frame in axes} for frame in sorted({MAP_FRAME, *frames})},
        "topics": shown,
        "layers": {},
    }


def _of_robot(of: RobotTopics, colour: str) -> Iterator[tuple[str, Section]]:
    """Yield the settings of a robot's topics in the scene."""
    yield of.scan.name, {"visible": True, "colorMode": "flat", "flatColor": colour, "pointSize": 3}
    arrow: Section = {"type": "arrow", "arrowScale": [0.25, 0.03, 0.03], "gradient": [f"{colour}66", f"{colour}66"]}
    yield of.particlecloud.name, {"visible": True, **arrow}
    yield of.plan.name, {"visible": True, "type": "line", "lineWidth": 0.06, "gradient": [colour, colour]}
    yield of.local_plan.name, {"visible": True, "type": "line", "lineWidth": 0.03, "gradient": ["#000000", "#000000"]}
    yield of.local_footprint.name, {"visible": True, "lineWidth": 0.04, "color": colour}
    yield of.amcl_pose.name, {
        "visible": True, "type": "arrow", "arrowScale": [0.6, 0.08, 0.08], "color": colour,
        "showCovariance": True, "covarianceColor": f"{colour}55",
    }  # fmt: skip
    for costmap, visible in ((of.local_costmap, True), (of.global_costmap, False)):
        yield costmap.name, {"visible": visible, "colorMode": "costmap", "alpha": 0.35}


def _line(path: str, label: str, colour: str) -> Section:
    return {"value": path, "enabled": True, "label": label, "color": colour, "timestampMethod": "receiveTime"}


def _plot(title: str, lines: Sequence[Section]) -> Section:
    return {
        "paths": lines, "foxglovePanelTitle": title, "showLegend": True, "legendDisplay": "floating",
        "showPlotValuesInLegend": False, "showXAxisLabels": True, "showYAxisLabels": True, "isSynced": True,
        "xAxisVal": "timestamp", "sidebarDimension": 240,
    }  # fmt: skip


def _hex(robot: int) -> str:
    """Return a robot's color in Foxglove's form."""
    return "#" + "".join(f"{int(part):02x}" for part in colour_of(robot).split("; "))


def _from_above(grid: OccupancyGrid) -> Section:
    """Return the camera above the middle of the map. The height of the view is `distance`, meters."""
    width, height = grid.cols * grid.resolution, grid.rows * grid.resolution
    middle = grid.origin.compose(Pose2(width / 2, height / 2, 0.0))
    return {
        "perspective": False,
        "distance": round(max(height, width / _ASPECT) / _SHARE_OF_SCENE, 2),
        "phi": 0,
        "thetaOffset": 0,
        "target": [0, 0, 0],
        "targetOffset": [round(middle.x, 3), round(middle.y, 3), 0],
        "targetOrientation": [0, 0, 0, 1],
        "fovy": 45,
        "near": 0.5,
        "far": 5000,
    }
