"""The nodes of a robot have all its parameters, under Nav2's names, which the reader of Nav2's files understands."""

import json
from dataclasses import replace
from pathlib import Path

import pytest

from sim.parameters import ObservationSource, RobotParameters, declared_parameters
from thbridge.files.ros.parameters import read_ros_parameters
from thbridge.ros.parameters import value_at
from thbridge.ros2.nav2_parameters import NAV2_NODES, nav2_nodes, robot_nodes, session_node
from thbridge.ros2.parameters import ParameterKind, ParameterNode, Value

SOFTWARE = RobotParameters()
WITH_DWB = replace(
    SOFTWARE,
    move_base=replace(
        SOFTWARE.move_base,
        base_local_planner="dwa_local_planner/DWAPlannerROS",
        base_global_planner="global_planner/GlobalPlanner",
    ),
)


def nodes(software: RobotParameters = SOFTWARE, robot: int = 0) -> dict[str, ParameterNode]:
    return {node.name: node for node in robot_nodes(robot, software, 0.05)}


@pytest.mark.parametrize("software", [SOFTWARE, WITH_DWB])
def test_each_live_parameter_belongs_to_one_node(software: RobotParameters) -> None:
    paths = [each.path for node in nodes(software).values() for each in node.parameters.values() if each.path]
    assert sorted(paths) == sorted(each.path for each in declared_parameters() if each.live)


def test_each_fixed_parameter_is_described_once() -> None:
    described = [each for node in nodes().values() for each in node.parameters.values() if each.read_only]
    for declared in declared_parameters():
        if declared.live or value_at(SOFTWARE, declared.path) is None or "observation_sources" in declared.path:
            continue
        holders = [
            each for each in described if each.name == declared.path or each.description.endswith(f"({declared.path})")
        ]
        assert len(holders) == 1, declared.path
        assert declared.help in holders[0].description


def test_values_have_the_declared_type() -> None:
    python = {
        ParameterKind.BOOL: bool,
        ParameterKind.INTEGER: int,
        ParameterKind.DOUBLE: float,
        ParameterKind.STRING: str,
        ParameterKind.STRING_ARRAY: tuple,
    }
    for node in nodes().values():
        assert list(node.parameters) == sorted(node.parameters)
        for name, each in node.parameters.items():
            assert type(each.reported(SOFTWARE)) is python[each.kind], name


def test_every_node_uses_simulated_time() -> None:
    for node in (*nodes().values(), session_node({})):
        assert node.parameters["use_sim_time"].value is True
        assert node.parameters["use_sim_time"].read_only


def test_names_are_those_of_the_robot() -> None:
    third = nodes(robot=2)
    assert (third["amcl"].namespace, third["amcl"].robot) == ("/robot3", 2)
    assert third["local_costmap"].namespace == "/robot3/local_costmap"
    assert third["amcl"].parameters["odom_frame_id"].value == "robot3/odom"
    assert third["local_costmap"].parameters["obstacle_layer.scan.topic"].value == "/robot3/scan"


def test_follow_path_and_grid_based_are_the_planners_at_the_start() -> None:
    for software, controller, planner in (
        (SOFTWARE, "TrajectoryPlannerROS.max_vel_x", "NavfnROS.default_tolerance"),
        (WITH_DWB, "DWAPlannerROS.max_vel_x", "GlobalPlanner.default_tolerance"),
    ):
        own = nodes(software)
        assert own["controller_server"].parameters["FollowPath.max_vel_x"].path == controller
        assert own["planner_server"].parameters["GridBased.tolerance"].description.endswith(f"({planner})")
        assert controller not in own["controller_server"].parameters


def test_a_source_without_a_range_has_the_range_of_its_layer() -> None:
    sources = (ObservationSource("front"), ObservationSource("rear", obstacle_range=1.25))
    layer = replace(SOFTWARE.local_costmap.obstacle_layer, observation_sources=sources)
    software = replace(SOFTWARE, local_costmap=replace(SOFTWARE.local_costmap, obstacle_layer=layer))
    own = nodes(software)["local_costmap"].parameters
    assert own["obstacle_layer.front.obstacle_max_range"].path == "local_costmap.obstacle_layer.obstacle_range"
    assert own["obstacle_layer.rear.obstacle_max_range"].value == 1.25
    assert own["obstacle_layer.observation_sources"].value == "front rear"


def test_external_nodes_are_missing() -> None:
    assert nav2_nodes(external_amcl=False, external_navigation=False) == NAV2_NODES
    assert nav2_nodes(external_amcl=False, external_navigation=True) == (
        "map_server",
        "amcl",
        "lifecycle_manager_localization",
    )
    assert nav2_nodes(external_amcl=True, external_navigation=True) == ("map_server",)


def test_the_session_has_the_rest_of_the_study() -> None:
    node = session_node({"hunt": {"rooms": 4, "limits": [1.5, 2.0]}, "seeds": [[1], [2]], "names": ["a", "b"]})
    assert (node.namespace, node.name, node.robot) == ("/", "thbridge", None)
    values = {name: (each.kind.name, each.value) for name, each in node.parameters.items() if each.name[0] in "hsn"}
    assert values == {
        "hunt.limits": ("DOUBLE_ARRAY", (1.5, 2.0)),
        "hunt.rooms": ("INTEGER", 4),
        "names": ("STRING_ARRAY", ("a", "b")),
        "seeds": ("STRING", "[[1], [2]]"),
        "start_type_description_service": ("BOOL", True),
    }
    assert all(each.read_only for each in node.parameters.values())


def test_the_reader_of_files_understands_a_dump_of_all_nodes(tmp_path: Path) -> None:
    sources = (ObservationSource("front", obstacle_range=1.25, raytrace_range=2.5),)
    layer = replace(SOFTWARE.local_costmap.obstacle_layer, obstacle_range=2.5, observation_sources=sources)
    static = replace(SOFTWARE.local_costmap.static_layer, trinary_costmap=False, use_maximum=True)
    costmap = replace(SOFTWARE.local_costmap, obstacle_layer=layer, static_layer=static, robot_radius=0.3, width=7.5)
    dwa = replace(SOFTWARE.DWAPlannerROS, path_distance_bias=3.7, xy_goal_tolerance=0.3, latch_xy_goal_tolerance=False)
    software = replace(
        SOFTWARE,
        amcl=replace(SOFTWARE.amcl, kld_err=0.07, laser_max_beams=33, odom_model_type="diff-corrected"),
        local_costmap=costmap,
        DWAPlannerROS=dwa,
        NavfnROS=replace(SOFTWARE.NavfnROS, use_astar=True, default_tolerance=0.4),
        move_base=replace(
            SOFTWARE.move_base, base_local_planner="dwa_local_planner/DWAPlannerROS", oscillation_distance=0.8
        ),
    )
    file = tmp_path / "nav2.yaml"
    file.write_text(dump(software))
    read = read_ros_parameters([file], software).value
    assert read.amcl == software.amcl
    assert read.local_costmap == software.local_costmap
    assert read.DWAPlannerROS == software.DWAPlannerROS
    assert read.NavfnROS == software.NavfnROS
    assert read.move_base.oscillation_distance == 0.8


def dump(software: RobotParameters) -> str:
    """Return a file of Nav2 with the parameters that our nodes report."""
    return json.dumps(
        {
            node.name: {"ros__parameters": _nested({n: p.reported(software) for n, p in node.parameters.items()})}
            for node in nodes(software).values()
        }
    )


def _nested(values: dict[str, Value]) -> dict[str, object]:
    tree: dict[str, object] = {}
    for name, value in values.items():
        *sections, last = name.split(".")
        place = tree
        for section in sections:
            inner = place.setdefault(section, {})
            assert isinstance(inner, dict)
            place = inner
        place[last] = list(value) if isinstance(value, tuple) else value
    return tree
