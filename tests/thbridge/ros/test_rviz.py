from collections.abc import Iterator
from pathlib import Path

import numpy as np
from ruamel.yaml import YAML

from sim.common.geometry import IDENTITY
from sim.common.grid import OccupancyGrid
from sim.parameters import RobotParameters
from sim.parameters.move_base import MoveBaseParameters
from tests.support.project import ROOT
from thbridge.files.map_files import read_map
from thbridge.files.resources import shipped
from thbridge.ros.rviz import configuration
from thbridge.study.study_file import Study

SOFTWARE = RobotParameters(move_base=MoveBaseParameters(base_local_planner="dwa_local_planner/DWAPlannerROS"))
GRID = OccupancyGrid(np.zeros((20, 40), dtype=np.int8), 0.5, IDENTITY)


def topics(robots: int) -> list[str]:
    whole = YAML(typ="safe").load(configuration([SOFTWARE] * robots, GRID))
    return list(named(whole["Visualization Manager"]))


def named(section: object) -> Iterator[str]:
    if isinstance(section, dict):
        for key, value in section.items():
            if key in ("Topic", "Marker Topic"):
                yield value
            yield from named(value)
    elif isinstance(section, list):
        for item in section:
            yield from named(item)


def test_every_robot_is_shown_with_all_it_perceives_and_plans() -> None:
    found = topics(3)
    for robot in ("/robot1", "/robot2", "/robot3"):
        for topic in ("scan", "particlecloud", "amcl_pose", "move_base/NavfnROS/plan",
                      "move_base/DWAPlannerROS/local_plan",
                      "move_base/local_costmap/costmap", "move_base/global_costmap/costmap",
                      "move_base/local_costmap/footprint", "initialpose", "move_base_simple/goal"):  # fmt: skip
            assert found.count(f"{robot}/{topic}") == 1
    assert "/map" in found
    assert not any(topic.startswith("/robot4") for topic in found)


def test_the_view_holds_the_whole_map() -> None:
    text = YAML(typ="safe").load(configuration([SOFTWARE], GRID))
    view = text["Visualization Manager"]["Views"]["Current"]
    assert (view["X"], view["Y"]) == (10.0, 5.0)
    assert 0.5 * (1280 - 320) / 20 < view["Scale"] <= (1280 - 320) / 20


def test_the_file_that_comes_with_the_documents_is_what_the_program_writes() -> None:
    study = Study(robots=3)
    place = read_map(shipped().find("maps", study.map, Path()))
    assert (ROOT / "docs" / "thbridge.rviz").read_text() == configuration([study.robot] * 3, place.grid), (
        "run: thbridge ros rviz --robots 3 --to docs/thbridge.rviz"
    )
