"""Files as users of ROS have them."""

import dataclasses
import math
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from sim.parameters import (
    AmclParameters,
    DwaPlannerParameters,
    GlobalCostmapParameters,
    GlobalPlannerParameters,
    LocalCostmapParameters,
    MoveBaseParameters,
    NavfnParameters,
    RobotParameters,
    TrajectoryPlannerParameters,
    parameters_of,
)
from thbridge.files.errors import BadFile, BadFiles
from thbridge.files.ros.defaults import ros_defaults, sentences_of
from thbridge.files.ros.parameters import RosParameters, namespace_in, parse_ros_files, read_ros_parameters

START = RobotParameters()


ROS = RobotParameters(
    amcl=AmclParameters(),
    global_costmap=GlobalCostmapParameters(),
    local_costmap=LocalCostmapParameters(),
    NavfnROS=NavfnParameters(),
    GlobalPlanner=GlobalPlannerParameters(),
    TrajectoryPlannerROS=TrajectoryPlannerParameters(),
    DWAPlannerROS=DwaPlannerParameters(),
    move_base=MoveBaseParameters(),
)


def in_ros(value: RobotParameters) -> dict[str, object]:
    return dict(parameters_of(value))


def read(folder: Path, *texts: str) -> RosParameters:
    paths = [folder / f"{index}.yaml" for index in range(len(texts))]
    for path, text in zip(paths, texts, strict=True):
        path.write_text(text, encoding="utf-8")
    return read_ros_parameters(paths, START)


def fault(folder: Path, *texts: str) -> str:
    with pytest.raises(BadFile) as found:
        read(folder, *texts)
    return str(found.value).replace(str(folder), "")


@pytest.mark.parametrize(
    "text",
    [
        "max_particles: 700\nupdate_min_d: 0.5\n",
        "amcl:\n  max_particles: 700\n  update_min_d: 0.5\n",
        "/amcl: {max_particles: 700, update_min_d: 0.5}\n",
        "amcl/max_particles: 700\namcl/update_min_d: 0.5\n",
    ],
)
def test_a_file_for_a_node_or_for_the_root(tmp_path: Path, text: str) -> None:
    wanted = AmclParameters(max_particles=700, update_min_d=0.5)
    assert read(tmp_path, text).value == dataclasses.replace(START, amcl=wanted)


def test_move_base_with_all_that_lives_in_it(tmp_path: Path) -> None:
    text = """
        move_base:
          controller_frequency: 5
          NavfnROS: {allow_unknown: false}
          local_costmap:
            width: 6.0
        """
    value = read(tmp_path, text).value
    assert value.move_base.controller_frequency == 5.0
    assert value.NavfnROS.allow_unknown is False
    assert value.local_costmap.width == 6.0


def test_costmap_parameters_that_stand_alone_are_for_both_costmaps(tmp_path: Path) -> None:
    common = "robot_radius: 0.2\ninflation_radius: 0.7\n"
    value = read(tmp_path, common, "local_costmap: {inflation_radius: 0.3}\n").value
    assert value.global_costmap.robot_radius == value.local_costmap.robot_radius == 0.2
    assert value.global_costmap.inflation_layer.inflation_radius == 0.7
    assert value.local_costmap.inflation_layer.inflation_radius == 0.3


def test_the_last_file_holds(tmp_path: Path) -> None:
    value = read(tmp_path, "update_min_d: 0.3\nkld_z: 0.9", "update_min_d: 0.4").value
    assert (value.amcl.kld_z, value.amcl.update_min_d) == (0.9, 0.4)


def test_a_mixed_file(tmp_path: Path) -> None:
    """Names that several nodes know go where most of the others belong."""
    text = """
        controller_frequency: 5.0
        planner_patience: 3.0
        TrajectoryPlannerROS:
          max_vel_x: 0.8
        footprint_padding: 0.05
        """
    value = read(tmp_path, text).value
    assert (value.move_base.controller_frequency, value.move_base.planner_patience) == (5.0, 3.0)
    assert value.TrajectoryPlannerROS.max_vel_x == 0.8
    assert value.global_costmap.footprint_padding == 0.05


OLD_FORM = """
obstacle_range: 2.0
raytrace_range: 4.0
footprint: [[0.3, 0.2], [-0.3, 0.2], [-0.3, -0.2], [0.3, -0.2]]
inflation_radius: 0.6
observation_sources: front bump
front: {sensor_frame: laser, data_type: LaserScan, topic: front/scan, marking: true, clearing: true}
bump: {data_type: PointCloud2, topic: bumper, marking: true, clearing: false}
"""


def test_a_costmap_in_the_old_form(tmp_path: Path) -> None:
    read_now = read(tmp_path, OLD_FORM)
    costmap = read_now.value.global_costmap
    assert not costmap.static_layer.enabled
    assert costmap.footprint[0] == (0.3, 0.2)
    assert (costmap.obstacle_layer.obstacle_range, costmap.obstacle_layer.raytrace_range) == (2.0, 4.0)
    assert [source.name for source in costmap.obstacle_layer.observation_sources] == ["front", "bump"]
    assert costmap.inflation_layer.inflation_radius == 0.6
    assert any("front/scan" in notice or "topic" in notice for notice in read_now.notices)


NEW_FORM = """
plugins:
- {name: walls, type: "costmap_2d::StaticLayer"}
- {name: seen, type: "costmap_2d::VoxelLayer"}
- {name: softened, type: "costmap_2d::InflationLayer"}
- {name: people, type: "social_navigation_layers::ProxemicLayer"}
walls: {map_topic: /map}
seen:
  observation_sources: laser
  laser: {data_type: LaserScan, topic: scan, clearing: true}
softened:
  inflation_radius: 0.4
people: {cutoff: 10.0}
"""


def test_layers_of_any_name(tmp_path: Path) -> None:
    read_now = read(tmp_path, NEW_FORM)
    costmap = read_now.value.local_costmap
    assert costmap.static_layer.enabled
    assert costmap.inflation_layer.inflation_radius == 0.4
    assert [source.clearing for source in costmap.obstacle_layer.observation_sources] == [True]
    assert any("people" in notice for notice in read_now.notices)


def test_layers_named_in_another_file(tmp_path: Path) -> None:
    """The list comes in a later file, as with costmap_common and then local_costmap."""
    common = "seen: {raytrace_range: 4.0}\nsoftened: {inflation_radius: 0.4}\nfootprint_padding: 0.02\n"
    value = read(tmp_path, common, "local_costmap:\n" + "".join(f"  {line}\n" for line in NEW_FORM.splitlines())).value
    assert value.global_costmap.obstacle_layer.raytrace_range == 4.0
    assert value.global_costmap.inflation_layer.inflation_radius == 0.4


def test_layers_that_the_list_leaves_out_do_not_count(tmp_path: Path) -> None:
    text = "local_costmap:\n  plugins:\n  - {name: obstacle_layer, type: 'costmap_2d::ObstacleLayer'}\n"
    value = read(tmp_path, text).value
    layers = value.local_costmap
    enabled = (layers.static_layer.enabled, layers.obstacle_layer.enabled, layers.inflation_layer.enabled)
    assert enabled == (False, True, False)
    assert value.global_costmap.static_layer.enabled


def test_two_layers_of_a_kind_are_one(tmp_path: Path) -> None:
    text = """
        local_costmap:
          laser_layer: {observation_sources: scan, scan: {topic: scan}}
          voxel_layer: {observation_sources: depth, depth: {topic: points}}
        """
    read_now = read(tmp_path, text)
    sources = read_now.value.local_costmap.obstacle_layer.observation_sources
    assert [source.name for source in sources] == ["scan", "depth"]
    assert any("voxel_layer" in notice for notice in read_now.notices)


@pytest.mark.parametrize(
    ("written", "value"),
    [
        ("!degrees 90", math.pi / 2),
        ("!degrees '90'", math.pi / 2),
        ("deg(45.0)", math.pi / 4),
        ("rad(pi/3)", math.pi / 3),
        ("!radians 2*pi/4", math.pi / 2),
        ("1", 1.0),
        ("1.", 1.0),
        ("5e-1", 0.5),
    ],
)
def test_numbers_as_ros_writes_them(tmp_path: Path, written: str, value: float) -> None:
    assert read(tmp_path, f"amcl: {{update_min_a: {written}}}").value.amcl.update_min_a == pytest.approx(value)


@given(st.integers(1, 100_000))
def test_a_real_number_without_fraction_is_whole(tmp_path_factory: pytest.TempPathFactory, number: int) -> None:
    folder = tmp_path_factory.mktemp("ros")
    assert read(folder, f"amcl: {{max_particles: {number}.0}}").value.amcl.max_particles == number


@pytest.mark.parametrize(("word", "value"), [("yes", True), ("On", True), ("FALSE", False), ("no", False)])
def test_truth_as_yaml_of_old_writes_it(tmp_path: Path, word: str, value: bool) -> None:
    assert read(tmp_path, f"NavfnROS: {{allow_unknown: {word}}}").value.NavfnROS.allow_unknown is value


def test_anchors_aliases_and_merge_keys(tmp_path: Path) -> None:
    text = """
        global_costmap: &shared
          footprint_padding: &padding 0.03
          inflation_layer: {inflation_radius: 0.9}
        local_costmap:
          <<: *shared
          inflation_layer: {cost_scaling_factor: 3.0}
        TrajectoryPlannerROS: {xy_goal_tolerance: *padding}
        """
    value = read(tmp_path, text).value
    assert value.local_costmap.footprint_padding == value.global_costmap.footprint_padding == 0.03
    assert value.local_costmap.inflation_layer.cost_scaling_factor == 3.0
    assert value.local_costmap.inflation_layer.inflation_radius == 0.55
    assert value.TrajectoryPlannerROS.xy_goal_tolerance == 0.03


def test_aliases_of_aliases_come_to_an_end(tmp_path: Path) -> None:
    levels = "".join(f"l{i}: &l{i} [{', '.join([f'*l{i - 1}'] * 9)}]\n" for i in range(1, 12))
    assert "through aliases" in fault(tmp_path, f"l0: &l0 [1, 2]\n{levels}")


def test_an_alias_within_its_own_anchor(tmp_path: Path) -> None:
    assert "/0.yaml, line 1, a: this alias (*) has no anchor" in fault(tmp_path, "amcl: &a {kld_err: *a}")


def test_a_name_that_stands_twice_has_its_last_value(tmp_path: Path) -> None:
    read_now = read(tmp_path, "kld_err: 0.1\nkld_z: 0.9\nkld_err: 0.2\n")
    assert read_now.value.amcl.kld_err == 0.2
    assert any("line 3: kld_err appears twice" in notice for notice in read_now.notices)


def test_names_that_ros_does_not_read_either(tmp_path: Path) -> None:
    (notice,) = read(tmp_path, "move_base: {recovery_behaviour_enabled: true}").notices
    assert "recovery_behavior_enabled" in notice


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("min_particles: 100\nmax_particels: 500\n", "/0.yaml, line 2, amcl.max_particels: unknown key. The nearest"),
        ("max_particels: 500\n", "The nearest name is max_particles"),
        ("amcl:\n  kld_err: high\n", "/0.yaml, line 2, amcl.kld_err: 'high' is not a number"),
        ("amcl: {kld_err: '0.1'}\n", "in quotes is text, not a number"),
        ("NavfnROS: {allow_unknown: 1}\n", "neither true nor false"),
        ("robot_descriptoin: {a: 1}\n", "/0.yaml, line 1, robot_descriptoin: unknown key"),
        ("- a\n- b\n", "this file is not a section with lines 'name: value'"),
        ("amcl: {kld_err: !thing 3}\n", "this tag (!) is unknown"),
        ("amcl: {update_min_a: deg(x)}\n", "'x' is not an angle"),
        ("amcl: {update_min_a: rad(1/0)}\n", "is not an angle"),
        ("amcl: {<<: 3}\n", "not a section that can be merged"),
    ],
)
def test_a_fault_is_told_with_its_place(tmp_path: Path, text: str, told: str) -> None:
    assert told in fault(tmp_path, text)


def test_faults_of_all_files_are_told_at_once_and_each_once(tmp_path: Path) -> None:
    with pytest.raises(BadFiles) as found:
        read(tmp_path, "footprint_paddin: 0.1\nrobot_radius: 1.0\n", "amcl: {kld_er: 0.1}")
    assert [(fault.path.name, fault.line) for fault in found.value.faults] == [("0.yaml", 1), ("1.yaml", 1)]


def test_recovery_behaviours_of_any_name(tmp_path: Path) -> None:
    text = """
        recovery_behaviors:
        - {name: reset_far, type: clear_costmap_recovery/ClearCostmapRecovery}
        - {name: turn, type: rotate_recovery/RotateRecovery}
        - {name: reset_close, type: clear_costmap_recovery/ClearCostmapRecovery}
        - {name: back_up, type: back_up_recovery/BackUpRecovery}
        reset_far: {reset_distance: 2.0, layer_names: [obstacle_layer]}
        reset_close: {reset_distance: 0.0}
        back_up: {backup_distance: 0.3}
        """
    read_now = read(tmp_path, text)
    behaviours = [behaviour.name for behaviour in read_now.value.move_base.recovery_behaviors]
    assert behaviours == ["conservative_reset", "rotate_recovery", "aggressive_reset"]
    assert read_now.value.move_base.conservative_reset_dist == 2.0
    assert [word for word in ("back_up", "layer_names", "reset_close") if word in " ".join(read_now.notices)] == [
        "back_up",
        "layer_names",
        "reset_close",
    ]


def test_settings_of_the_usual_behaviours(tmp_path: Path) -> None:
    text = "move_base:\n  conservative_reset: {reset_distance: 1.5}\n  aggressive_reset: {reset_distance: 0.5}\n"
    assert read(tmp_path, text).value.move_base.conservative_reset_dist == 1.5


def test_a_recovery_behaviour_without_a_type_must_be_ours(tmp_path: Path) -> None:
    assert "'dance' is not a valid choice" in fault(
        tmp_path, "recovery_behaviors: [{name: dance}]\nplanner_patience: 3.0\n"
    )


SET = {
    "common.yaml": """
        footprint: [[0.2, 0.2], [-0.2, 0.2], [-0.2, -0.2], [0.2, -0.2]]
        obstacle_layer: {observation_sources: scan, scan: {data_type: LaserScan, clearing: true}}
        """,
    "global.yaml": """
        global_costmap:
          plugins:
          - {name: static_layer, type: "costmap_2d::StaticLayer"}
          - {name: obstacle_layer, type: "costmap_2d::ObstacleLayer"}
          - {name: inflation_layer, type: "costmap_2d::InflationLayer"}
        """,
    "local.yaml": """
        local_costmap:
          rolling_window: true
          width: 3.0
          plugins:
          - {name: obstacle_layer, type: "costmap_2d::ObstacleLayer"}
          - {name: inflation_layer, type: "costmap_2d::InflationLayer"}
        """,
    "planner.yaml": "TrajectoryPlannerROS: {max_vel_x: 0.8}",
    "move_base.yaml": "controller_frequency: 5.0\nplanner_patience: 2.0\n",
    "amcl.yaml": "amcl: {min_particles: 500}",
}
"""A complete set of another lab's files."""


def test_what_a_complete_set_leaves_out_is_as_in_ros(tmp_path: Path) -> None:
    """Every parameter that no file has is the default of ROS noetic, though hunts begin with others."""
    read_now = read(tmp_path, *SET.values())
    value = in_ros(read_now.value)
    off = {"local_costmap.static_layer.enabled"}
    left_out = {name: default for name, default in in_ros(ROS).items() if name not in read_now.written | off}
    assert {name: value[name] for name in left_out} == left_out
    assert len(left_out) > 120
    assert not read_now.value.local_costmap.track_unknown_space
    assert not read_now.value.local_costmap.static_layer.enabled
    assert (read_now.value.move_base.controller_frequency, read_now.value.move_base.oscillation_timeout) == (5.0, 0.0)


def test_names_that_ros_does_not_have_stay(tmp_path: Path) -> None:
    value = read(tmp_path, *SET.values()).value
    assert (value.localization, value.ekf) == (START.localization, START.ekf)
    assert value.global_costmap.robots_layer == START.global_costmap.robots_layer
    assert value.local_costmap.obstacle_layer.explained_distance == 0.2


def test_a_file_for_one_node_leaves_the_other_as_it_is(tmp_path: Path) -> None:
    assert read(tmp_path, "amcl: {min_particles: 500}").value == dataclasses.replace(
        START, amcl=AmclParameters(min_particles=500)
    )
    value = read(tmp_path, "TrajectoryPlannerROS: {max_vel_x: 0.8}").value
    assert value.amcl == START.amcl
    assert value.TrajectoryPlannerROS == TrajectoryPlannerParameters(max_vel_x=0.8)
    assert value.move_base == MoveBaseParameters()


def test_a_costmap_without_a_word_keeps_map_laser_and_body(tmp_path: Path) -> None:
    costmap = read(tmp_path, "TrajectoryPlannerROS: {max_vel_x: 0.8}").value.global_costmap
    assert costmap.static_layer.enabled
    assert costmap.obstacle_layer.observation_sources == START.global_costmap.obstacle_layer.observation_sources
    assert costmap.robot_radius is None
    assert (costmap.track_unknown_space, costmap.inflation_layer.inflation_radius) == (False, 0.55)


@pytest.mark.parametrize(
    ("text", "has_map"),
    [
        ("footprint_padding: 0.1", False),
        ("static_map: true", True),
        ("static_map: false", False),
        ("static_map: false\nplugins: [{name: walls, type: 'costmap_2d::StaticLayer'}]", True),
        ("static_map: true\nplugins: [{name: seen, type: 'costmap_2d::ObstacleLayer'}]", False),
    ],
)
def test_the_map_is_in_a_costmap_as_in_ros(tmp_path: Path, text: str, has_map: bool) -> None:
    """By its list of plugins; without one, as before Hydro, by static_map."""
    assert read(tmp_path, text).value.global_costmap.static_layer.enabled is has_map


def test_a_costmap_hands_its_unknown_space_down(tmp_path: Path) -> None:
    text = "track_unknown_space: false\nstatic_layer: {track_unknown_space: true}\nfootprint_padding: 0.1\n"
    assert read(tmp_path, text).value.global_costmap.static_layer.track_unknown_space is False


def test_a_costmap_without_sources_sees_nothing(tmp_path: Path) -> None:
    assert read(tmp_path, "local_costmap: {static_map: true}").value.local_costmap.obstacle_layer == (
        dataclasses.replace(START.local_costmap.obstacle_layer, obstacle_range=2.5, observation_sources=())
    )


def told_of(folder: Path, *texts: str) -> list[str]:
    for index, text in enumerate(texts):
        (folder / f"{index}.yaml").write_text(text)
    files = parse_ros_files([folder / f"{index}.yaml" for index in range(len(texts))])
    start = files.start(START)
    now = files.over(start)
    return list(sentences_of(ros_defaults(now.value, start, START, now.written)))


def test_the_defaults_that_hunts_do_not_have_are_told_by_section(tmp_path: Path) -> None:
    told = told_of(tmp_path, *SET.values())
    assert [sentence.partition(":")[0] for sentence in told] == [
        "amcl",
        "global_costmap and local_costmap",
        "global_costmap",
        "local_costmap",
        "TrajectoryPlannerROS",
        "move_base",
    ]
    assert told[0] == (
        "amcl: parameters left out, with ROS's defaults (the values of hunts in brackets): max_particles 5000 (1000),"
        " kld_err 0.01 (0.05), laser_max_beams 30 (60), laser_sigma_hit 0.2 (0.1)"
    )
    assert "track_unknown_space false (true)" in told[1]
    assert "height 10.0 (4.0)" in told[3]
    everything = " ".join(told)
    assert not [word for word in ("max_vel_x", "min_particles", "robot_radius", "DWAPlanner") if word in everything]


def test_what_stands_in_a_file_is_no_default_though_it_has_its_value(tmp_path: Path) -> None:
    assert "kld_err" not in " ".join(told_of(tmp_path, "amcl: {kld_err: 0.01}"))


def test_a_file_may_be_named_with_its_namespace(tmp_path: Path) -> None:
    (tmp_path / "costmap.yaml").write_text("footprint_padding: 0.07\nwidth: 3.0\n")
    value = read_ros_parameters([tmp_path / "local_costmap:costmap.yaml"], START).value
    assert (value.local_costmap.footprint_padding, value.global_costmap.footprint_padding) == (0.07, 0.01)
    assert value.local_costmap.width == 3.0


def test_a_colon_alone_makes_no_namespace(tmp_path: Path) -> None:
    named = tmp_path / "amcl:x.yaml"
    named.write_text("kld_err: 0.2\n")
    assert namespace_in(named) == ("", named)
    assert namespace_in(Path("a:b/c.yaml")) == ("", Path("a:b/c.yaml"))
    assert namespace_in(Path("global_costmap:/a/c.yaml")) == ("global_costmap", Path("/a/c.yaml"))
    assert namespace_in(Path("a:b/move_base:c/d.yaml")) == ("move_base", Path("a:b/c/d.yaml"))


def test_a_planner_that_only_a_launch_file_chooses_is_told(tmp_path: Path) -> None:
    planner = "DWAPlannerROS: {max_vel_x: 0.2}\n"
    (notice,) = read(tmp_path, planner).notices
    assert "DWAPlannerROS has no effect" in notice
    assert "base_local_planner: dwa_local_planner/DWAPlannerROS" in notice
    assert read(tmp_path, planner, "base_local_planner: dwa_local_planner/DWAPlannerROS").notices == ()


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("TebLocalPlannerROS: {max_vel_x: 0.4}\nNavfnROS: {allow_unknown: true}\n", "TebLocalPlannerROS has no effect"),
        ("TrajectoryPlannerROS: {max_vel_y: 0.0}", "max_vel_y has no effect"),
        (
            "plugins: [{name: a, type: 'costmap_2d::ObstacleLayer'}]\nvirtual_walls_map: {x: 1}\n",
            "no `plugins` lists it",
        ),
        (
            "inflater: {robot_radius: 0.3, inflation_radius: 0.7}\nstatic_map: true\n",
            "inflater.robot_radius has no effect",
        ),
    ],
)
def test_what_ros_does_not_read_either_is_told_and_no_fault(tmp_path: Path, text: str, told: str) -> None:
    assert told in " ".join(read(tmp_path, text).notices)


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("TrajectoryPlanerROS: {max_vel_x: 0.4}", "TrajectoryPlanerROS: unknown key"),
        ("plugins: [{name: walls, type: 'costmap_2d::StaticLayer'}]\nwals: {use_maximum: true}\n", "wals: unknown key"),
        (
            "base_local_planner: teb_local_planner/TebLocalPlannerROS\nplanner_patience: 1.0\n",
            "'teb_local_planner/TebLocalPlannerROS' is not a valid choice",
        ),
    ],
)
def test_names_that_are_nearly_right_are_faults(tmp_path: Path, text: str, told: str) -> None:
    assert told in fault(tmp_path, text)


@pytest.mark.parametrize(
    ("text", "told"),
    [
        (
            "robot_state_publisher: {publish_frequency: 50.0}\n",
            "robot_state_publisher has no effect here: no node ",
        ),
        ("use_sim_time: true\n", "use_sim_time has no effect here: it belongs to the whole"),
        ("rosversion: '1.16'\nroslaunch: {uris: {host_x: 'http://x:1/'}}\nrun_id: abc\n", "run_id has no effect here"),
        ("common: &common {kld_err: 0.1}\nmore: {<<: *common}\n", "common has no effect here"),
    ],
)
def test_what_is_not_of_these_nodes_has_no_effect_and_is_told(tmp_path: Path, text: str, told: str) -> None:
    whole = read(tmp_path, f"{text}amcl: {{max_particles: 700}}\n")
    assert whole.value == read(tmp_path, "amcl: {max_particles: 700}\n").value
    assert any(told in notice for notice in whole.notices)


@pytest.mark.parametrize(
    ("written", "number"),
    [("0x0A", 10), ("0b1010", 10), ("012", 10), ("!!int 10", 10), ("!!float 10", 10), ("!!int 0x0a", 10)],
)
def test_numbers_as_ros_reads_them(tmp_path: Path, written: str, number: int) -> None:
    value = read(
        tmp_path, f"TrajectoryPlannerROS: {{vx_samples: {written}, max_vel_x: !!float 1, dwa: !!bool true}}"
    ).value
    assert value.TrajectoryPlannerROS.vx_samples == number
    assert (value.TrajectoryPlannerROS.max_vel_x, value.TrajectoryPlannerROS.dwa) == (1.0, True)


def test_what_a_launch_file_fills_in_is_told_so(tmp_path: Path) -> None:
    told = fault(tmp_path, "amcl: {kld_err: $(arg error)}\n")
    assert told.startswith(
        "/0.yaml, line 1, amcl.kld_err: $(arg error) is a placeholder of a launch file. Write a number"
    )


def test_a_list_of_sources_is_one_fault(tmp_path: Path) -> None:
    text = "local_costmap:\n  obstacle_layer:\n    observation_sources: [scan]\n    scan: {topic: /scan}\n"
    assert fault(tmp_path, text).endswith("observation_sources: not a text. Write names separated by blanks.")


NODES_OF_A_ROBOT = "{amcl: {max_particles: 700}, move_base: {TrajectoryPlannerROS: {max_vel_x: 0.4}}}"


@pytest.mark.parametrize(
    "text",
    [
        f"robot1: {NODES_OF_A_ROBOT}\nuse_sim_time: false\n",
        f"/lab/robot1: {NODES_OF_A_ROBOT}\nrosversion: x\n",
        f"/: {NODES_OF_A_ROBOT}\n",
    ],
)
def test_a_dump_of_a_robot_with_a_namespace_is_of_that_robot(tmp_path: Path, text: str) -> None:
    value = read(tmp_path, text).value
    assert (value.amcl.max_particles, value.TrajectoryPlannerROS.max_vel_x) == (700, 0.4)


@pytest.mark.parametrize("robots", [("robot1", "robot2"), ("lab/a", "lab/b")])
def test_a_dump_of_several_robots_is_a_fault(tmp_path: Path, robots: tuple[str, str]) -> None:
    text = "".join(f"{robot}: {NODES_OF_A_ROBOT}\n" for robot in robots)
    names = ", ".join(robot.rpartition("/")[2] for robot in robots)
    assert f"the file has the parameters of several robots: {names}. Write the parameters" in fault(tmp_path, text)


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("amcl: {use_sim_time: true, max_particles: 700}\n", "amcl.use_sim_time has no effect here: it belongs to"),
        ("x: &most 700\namcl: {max_particles: *most}\n", "x has no effect here: no node here reads it"),
        ("arm: {mesh: !!binary aGVsbG8=}\namcl: {max_particles: 700}\n", "arm has no effect here: no node here reads"),
        ("map_server: {file: $(find lab)/map.yaml}\namcl: {max_particles: 700}\n", "map_server has no effect here"),
    ],
)
def test_more_that_is_not_of_these_nodes_has_no_effect_and_is_told(tmp_path: Path, text: str, told: str) -> None:
    whole = read(tmp_path, text)
    assert whole.value.amcl.max_particles == 700
    assert any(told in notice for notice in whole.notices)


@pytest.mark.parametrize(("written", "number"), [("1_00", 100), ("1_0.0", 10), ("+10", 10), ("0x1F", 31)])
def test_more_numbers_as_ros_reads_them(tmp_path: Path, written: str, number: int) -> None:
    value = read(tmp_path, f"TrajectoryPlannerROS: {{vx_samples: {written}}}").value
    assert value.TrajectoryPlannerROS.vx_samples == number


@pytest.mark.parametrize("written", ["$(env PARTICLES)", "${particles}"])
def test_what_other_launch_files_fill_in_is_told_so(tmp_path: Path, written: str) -> None:
    told = fault(tmp_path, f"amcl:\n  max_particles: {written}\n")
    assert f"line 2, amcl.max_particles: {written} is a placeholder of a launch file. Write a whole" in told


@pytest.mark.parametrize("written", ["static_layer", "[static_layer, inflation_layer]"])
def test_plugins_without_types_are_a_fault(tmp_path: Path, written: str) -> None:
    """The robot would drive without its map."""
    told = fault(tmp_path, f"global_costmap:\n  plugins: {written}\n")
    assert (
        "line 2, global_costmap.plugins: not a list of layers with name and type. Write for example [{name: walls"
        in told
    )


def test_a_misspelled_parameter_next_to_sections_is_a_fault(tmp_path: Path) -> None:
    assert "robot_radus: unknown key" in fault(tmp_path, "global_costmap: {static_map: true}\nrobot_radus: 0.3\n")
