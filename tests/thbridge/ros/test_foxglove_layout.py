import json
import re
from pathlib import Path

import numpy as np

from sim.common.geometry import IDENTITY
from sim.common.grid import OccupancyGrid
from sim.parameters import RobotParameters
from sim.parameters.move_base import MoveBaseParameters
from sim.world.sensors import mount_of
from tests.support.project import ROOT
from thbridge.files.map_files import read_map
from thbridge.files.resources import shipped
from thbridge.files.ros.definitions import Definitions
from thbridge.ros.foxglove_layout import foxglove_layout
from thbridge.ros.names import RobotNames
from thbridge.ros.publisher import TeamPublisher
from thbridge.ros.topics import Planners
from thbridge.study.study_file import Study

SOFTWARE = RobotParameters(move_base=MoveBaseParameters(base_local_planner="dwa_local_planner/DWAPlannerROS"))
GRID = OccupancyGrid(np.zeros((20, 40), dtype=np.int8), 0.5, IDENTITY)


def layout(robots: int) -> dict:
    return json.loads(foxglove_layout([SOFTWARE] * robots, GRID))


def test_all_that_is_shown_is_published_and_has_the_fields_that_are_plotted() -> None:
    found = layout(3)["configById"]
    study = Study(robots=3)
    publisher = TeamPublisher(3, mount_of(study.world.laser), 0.1, [Planners.of(SOFTWARE)] * 3)
    types = {topic.name: topic.msgtype for topic in publisher.topics}
    assert set(found["3D!team"]["topics"]) <= set(types)
    paths = [line["value"] for panel in ("Plot!errors", "Plot!energy") for line in found[panel]["paths"]]
    assert len(paths) == 7
    for path in paths:
        topic, _, field = path.partition(".")
        own = Definitions().of(types[topic]).text.partition("=" * 80)[0]
        assert re.search(rf"^\w+ {field}\b", own, re.MULTILINE)
    assert found["RosOut!log"]["topicToRender"] in types


def test_every_robot_is_shown_in_a_colour_of_its_own_with_all_it_perceives_and_plans() -> None:
    scene = layout(3)["configById"]["3D!team"]
    colours = set()
    for robot in range(3):
        for topic in ("scan", "particlecloud", "amcl_pose", "move_base/NavfnROS/plan",
                      "move_base/DWAPlannerROS/local_plan", "move_base/local_costmap/costmap",
                      "move_base/local_costmap/footprint"):  # fmt: skip
            assert scene["topics"][RobotNames.of(robot).topic(topic)]["visible"]
        colours.add(scene["topics"][RobotNames.of(robot).topic("scan")]["flatColor"])
    assert len(colours) == 3
    assert not any(topic.startswith("/robot4") for topic in scene["topics"])


def test_the_camera_sees_the_whole_map() -> None:
    camera = layout(1)["configById"]["3D!team"]["cameraState"]
    assert camera["targetOffset"] == [10.0, 5.0, 0]
    assert 20 / 1.2 < camera["distance"] < 20


def test_each_panel_of_the_window_is_there_once() -> None:
    whole = layout(2)

    def panels(part: object) -> list[str]:
        if isinstance(part, dict):
            return panels(part["first"]) + panels(part["second"])
        return [part]

    assert sorted(panels(whole["layout"])) == sorted(whole["configById"])


def test_the_file_that_comes_with_the_documents_is_what_the_program_writes() -> None:
    study = Study(robots=3)
    place = read_map(shipped().find("maps", study.map, Path()))
    assert (ROOT / "docs" / "thbridge.foxglove.json").read_text() == foxglove_layout([study.robot] * 3, place.grid), (
        "run: thbridge ros foxglove --robots 3 --to docs/thbridge.foxglove.json"
    )
