"""Files of costmap parameters as people have them for ROS robots."""

from pathlib import Path

import pytest

from sim.parameters import LocalCostmapParameters, ObservationSource, RobotParameters
from thbridge.files.errors import BadFile
from thbridge.files.yaml.load import load_text
from thbridge.study.study_file import Study, read_study_text
from thbridge.study.text import resolved

PATH = Path("costmap.yaml")

LAYERED = """
footprint: "[[0.2, 0.2], [-0.2, 0.2], [-0.2, -0.2]]"
plugins:
  - {name: static_layer, type: "costmap_2d::StaticLayer"}
  - {name: obstacle_layer, type: "costmap_2d::ObstacleLayer"}
rolling_window: true
obstacle_layer:
  observation_sources: front rear
  front: {data_type: LaserScan, topic: scan, marking: true, clearing: true, inf_is_valid: true}
  rear: {clearing: true, marking: false, raytrace_range: 4.0}
inflation_layer: {inflation_radius: 0.7}
"""

FLAT = """
map_type: costmap
static_map: false
obstacle_range: 3.0
raytrace_range: 3.5
inflation_radius: 1.0
cost_scaling_factor: 3.0
observation_sources: scan
scan: {sensor_frame: base_scan, data_type: LaserScan, topic: scan, marking: true, clearing: true}
"""


def test_layers_with_named_sources_and_a_footprint_as_text() -> None:
    loaded = load_text(PATH, LAYERED, LocalCostmapParameters)
    costmap = loaded.value
    assert costmap.footprint == ((0.2, 0.2), (-0.2, 0.2), (-0.2, -0.2))
    assert costmap.obstacle_layer.observation_sources == (
        ObservationSource(name="front", clearing=True, inf_is_valid=True),
        ObservationSource(name="rear", clearing=True, marking=False, raytrace_range=4.0),
    )
    assert costmap.inflation_layer.inflation_radius == 0.7
    assert any("plugins has no effect here" in notice for notice in loaded.notices)


def test_names_beside_the_layers_are_handed_down_as_costmap_2d_does() -> None:
    costmap = load_text(PATH, FLAT, LocalCostmapParameters).value
    assert not costmap.static_layer.enabled
    assert (costmap.obstacle_layer.obstacle_range, costmap.obstacle_layer.raytrace_range) == (3.0, 3.5)
    assert (costmap.inflation_layer.inflation_radius, costmap.inflation_layer.cost_scaling_factor) == (1.0, 3.0)
    assert costmap.obstacle_layer.observation_sources == (ObservationSource(clearing=True),)


def test_what_is_handed_down_wins_over_what_the_layer_says() -> None:
    text = "inflation_radius: 0.2\ninflation_layer: {inflation_radius: 0.9, cost_scaling_factor: 2.0}\n"
    layer = load_text(PATH, text, LocalCostmapParameters).value.inflation_layer
    assert (layer.inflation_radius, layer.cost_scaling_factor) == (0.2, 2.0)


def test_a_fault_in_what_is_handed_down_is_told_at_its_line() -> None:
    with pytest.raises(BadFile) as caught:
        load_text(PATH, "width: 4.0\nobstacle_range: far\n", LocalCostmapParameters)
    assert (caught.value.line, caught.value.key) == (2, "obstacle_layer.obstacle_range")


def test_a_source_that_is_there_by_default_can_be_set_without_being_named() -> None:
    text = "robot: {local_costmap: {obstacle_layer: {scan: {obstacle_range: 2.0}}}}\n"
    layer = read_study_text(PATH, text).robot.local_costmap.obstacle_layer
    (before,) = RobotParameters().local_costmap.obstacle_layer.observation_sources
    (after,) = layer.observation_sources
    assert (after.obstacle_range, after.clearing, after.inf_is_valid) == (2.0, before.clearing, before.inf_is_valid)
    assert layer.explained_distance == RobotParameters().local_costmap.obstacle_layer.explained_distance


def test_sources_are_written_as_they_are_read() -> None:
    text = "robot: {global_costmap: {obstacle_layer: {observation_sources: a b, a: {marking: false}}}}\n"
    study = read_study_text(PATH, text)
    assert read_study_text(PATH, resolved(study)) == study != Study()


def test_a_section_under_a_name_that_is_no_source_is_unknown() -> None:
    with pytest.raises(BadFile, match="unknown key"):
        load_text(PATH, "obstacle_layer: {observation_sources: a, b: {marking: true}}\n", LocalCostmapParameters)
