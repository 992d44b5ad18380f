"""Files of ROS 2's Nav2, in the shape of those that come with it."""

from pathlib import Path

import pytest

from sim.parameters import RobotParameters
from sim.parameters.local_planners import DwaPlannerParameters
from tests.support.ros.nav2_parameters import AMCL, CONTROLLER
from thbridge.files.errors import BadFile
from thbridge.files.ros.parameters import RosParameters, read_ros_parameters

COSTMAPS = """
local_costmap:
  local_costmap:
    ros__parameters:
      update_frequency: 5.0
      publish_frequency: 2.0
      global_frame: odom
      rolling_window: true
      width: 3
      height: 4
      robot_radius: 0.22
      plugins: ["voxel_layer", "inflation_layer"]
      inflation_layer:
        plugin: "nav2_costmap_2d::InflationLayer"
        cost_scaling_factor: 3.0
        inflation_radius: 0.65
      voxel_layer:
        plugin: "nav2_costmap_2d::VoxelLayer"
        observation_sources: scan
        scan:
          topic: /scan
          clearing: True
          marking: True
          data_type: "LaserScan"
          raytrace_max_range: 3.5
          raytrace_min_range: 0.0
          obstacle_max_range: 2.0
global_costmap:
  global_costmap:
    ros__parameters:
      footprint: "[[0.2, 0.2], [-0.2, 0.2], [-0.2, -0.2], [0.2, -0.2]]"
      track_unknown_space: true
      plugins: ["static_layer", "inflation_layer"]
      static_layer:
        plugin: "nav2_costmap_2d::StaticLayer"
        map_subscribe_transient_local: True
      inflation_layer:
        plugin: "nav2_costmap_2d::InflationLayer"
"""
PLANNER = """
planner_server:
  ros__parameters:
    planner_plugins: ["GridBased"]
    GridBased:
      plugin: "nav2_navfn_planner/NavfnPlanner"
      use_astar: true
      allow_unknown: false
bt_navigator:
  ros__parameters: {bt_loop_duration: 10}
"""


def read(folder: Path, text: str) -> RosParameters:
    (folder / "nav2.yaml").write_text(text, encoding="utf-8")
    return read_ros_parameters([folder / "nav2.yaml"], RobotParameters())


def told(found: RosParameters) -> str:
    return "\n".join(found.notices)


def test_amcl_under_its_new_names_and_with_its_new_defaults(tmp_path: Path) -> None:
    found = read(tmp_path, AMCL)
    amcl = found.value.amcl
    assert (amcl.odom_alpha1, amcl.laser_max_beams, amcl.laser_z_hit, amcl.kld_err) == (0.3, 90, 0.7, 0.02)
    assert (amcl.initial_pose_x, amcl.initial_pose_y, amcl.initial_pose_a) == (1.5, -2.0, 0.5)
    assert amcl.odom_model_type == "diff-corrected"
    # ROS 1 has 5000, 0.05 and 0.2 by default.
    assert (amcl.max_particles, amcl.laser_z_rand, amcl.update_min_d) == (2000, 0.5, 0.25)
    assert "max_particles: 2000" in told(found)
    assert "amcl.random_seed" in told(found)
    assert "use_sim_time" not in told(found)
    assert found.value.move_base == RobotParameters().move_base


def test_dwb_and_its_checkers_become_the_planner_by_the_dynamic_window(tmp_path: Path) -> None:
    found = read(tmp_path, CONTROLLER)
    move_base, planner = found.value.move_base, found.value.DWAPlannerROS
    assert move_base.base_local_planner == "dwa_local_planner/DWAPlannerROS"
    assert (move_base.controller_frequency, move_base.oscillation_distance, move_base.oscillation_timeout) == (
        15,
        0.4,
        12,
    )
    assert (planner.max_vel_x, planner.max_vel_trans, planner.vth_samples) == (0.26, 0.26, 30)
    assert (planner.sim_granularity, planner.angular_sim_granularity) == (0.05, 0.025)
    assert (planner.xy_goal_tolerance, planner.yaw_goal_tolerance) == (0.2, 0.15), "the goal checker decides"
    # DWB takes half of a cell's side for the weights of paths and goals.
    assert (planner.path_distance_bias, planner.goal_distance_bias, planner.occdist_scale) == (16.0, 12.0, 0.02)
    assert "FollowPath.decel_lim_x" in told(found)
    assert "controller_server" not in told(found)


def test_costmaps_have_the_layers_that_are_listed(tmp_path: Path) -> None:
    found = read(tmp_path, COSTMAPS)
    local, whole = found.value.local_costmap, found.value.global_costmap
    assert (local.width, local.height, local.robot_radius) == (3.0, 4.0, 0.22)
    assert (local.static_layer.enabled, local.obstacle_layer.enabled, local.inflation_layer.enabled) == (
        False,
        True,
        True,
    )
    (source,) = local.obstacle_layer.observation_sources
    assert (source.raytrace_range, source.obstacle_range, source.clearing) == (3.5, 2.0, True)
    assert local.inflation_layer.inflation_radius == 0.65
    assert (whole.static_layer.enabled, whole.obstacle_layer.enabled) == (True, False)
    assert len(whole.footprint) == 4
    assert "local_costmap.voxel_layer.scan.raytrace_min_range" in told(found)
    assert "robot_radius" not in told(found)


def test_navfn_keeps_its_parameters_and_other_nodes_are_named(tmp_path: Path) -> None:
    found = read(tmp_path, PLANNER)
    navfn = found.value.NavfnROS
    assert (navfn.use_astar, navfn.allow_unknown, navfn.default_tolerance) == (True, False, 0.5)
    assert "have no counterpart here: bt_navigator" in told(found)


@pytest.mark.parametrize("costmap", ["local_costmap", "global_costmap"])
def test_a_costmap_without_plugins_has_the_map_obstacles_and_inflation(tmp_path: Path, costmap: str) -> None:
    text = f"{costmap}:\n  {costmap}:\n    ros__parameters:\n      robot_radius: 0.2\n"
    text += "      obstacle_layer: {observation_sources: scan, scan: {topic: /scan}}\n"
    found = read(tmp_path, text)
    value = getattr(found.value, costmap)
    layers = (value.static_layer, value.obstacle_layer, value.inflation_layer)
    assert [layer.enabled for layer in layers] == [True, True, True]
    assert [source.name for source in value.obstacle_layer.observation_sources] == ["scan"]
    assert f"{costmap} leaves out plugins, so Nav2's default is used: static_layer, obstacle_layer" in told(found)
    assert "obstacle_layer.scan leaves out max_obstacle_height, which is 0 m in Nav2" in told(found)


def test_an_empty_list_of_plugins_is_no_layer(tmp_path: Path) -> None:
    found = read(tmp_path, "global_costmap:\n  global_costmap:\n    ros__parameters: {plugins: []}\n")
    value = found.value.global_costmap
    assert not any(layer.enabled for layer in (value.static_layer, value.obstacle_layer, value.inflation_layer))


@pytest.mark.parametrize(("written", "tracked"), [("", False), ("track_unknown_space: true", True)])
def test_unknown_space_of_the_map_is_free_unless_the_costmap_tracks_it(
    tmp_path: Path, written: str, tracked: bool
) -> None:
    """ROS 1's static layer tracks it by default."""
    text = f"global_costmap:\n  global_costmap:\n    ros__parameters:\n      robot_radius: 0.2\n      {written}\n"
    text += "      static_layer: {enabled: true}\n"
    assert read(tmp_path, text).value.global_costmap.static_layer.track_unknown_space is tracked


def test_a_planner_that_is_left_out_is_navfn_with_its_tolerance(tmp_path: Path) -> None:
    for text in ("{expected_planner_frequency: 5.0}", "{GridBased: {use_astar: true}}"):
        found = read(tmp_path, f"planner_server:\n  ros__parameters: {text}\n")
        assert found.value.NavfnROS.default_tolerance == 0.5
        assert found.value.NavfnROS.use_astar is ("use_astar" in text)
        assert "exists here" not in told(found)


def test_checkers_that_are_left_out_are_those_of_nav2(tmp_path: Path) -> None:
    found = read(tmp_path, "controller_server:\n  ros__parameters: {controller_frequency: 15.0}\n")
    move_base, planner = found.value.move_base, found.value.DWAPlannerROS
    assert (move_base.oscillation_distance, move_base.oscillation_timeout) == (0.5, 10.0)
    assert (planner.xy_goal_tolerance, planner.yaw_goal_tolerance) == (0.25, 0.25)
    assert planner.latch_xy_goal_tolerance
    assert "goal_checker leaves out these parameters, so they have Nav2's defaults" in told(found)


def test_of_several_checkers_the_first_holds(tmp_path: Path) -> None:
    text = CONTROLLER.replace('["general_goal_checker"]', '["exact", "general_goal_checker"]')
    text = text.replace(
        "    controller_plugins", "    exact: {xy_goal_tolerance: 0.05, stateful: false}\n    controller_plugins"
    )
    found = read(tmp_path, text)
    planner = found.value.DWAPlannerROS
    assert (planner.xy_goal_tolerance, planner.yaw_goal_tolerance) == (0.05, 0.25)
    assert not planner.latch_xy_goal_tolerance
    assert "no counterpart here: general_goal_checker" in told(found)


def test_dwb_has_its_own_defaults_and_weights_by_its_critics(tmp_path: Path) -> None:
    text = """
controller_server:
  ros__parameters:
    FollowPath:
      max_vel_x: 0.3
      critics: ["ObstacleFootprint", "PathDist"]
      GoalDist.scale: 24.0
"""
    found = read(tmp_path, text)
    planner, ros1 = found.value.DWAPlannerROS, DwaPlannerParameters()
    assert (planner.min_vel_trans, planner.min_vel_theta, planner.vx_samples) == (0.0, 0.0, 20)
    assert (planner.path_distance_bias, planner.goal_distance_bias, planner.occdist_scale) == (0.5, 0.0, 1.0)
    assert (planner.max_vel_x, planner.max_vel_theta) == (0.3, ros1.max_vel_theta)
    assert "FollowPath leaves out max_speed_xy, max_vel_theta, acc_lim_x, acc_lim_theta, which are 0 in Nav2" in told(
        found
    )
    assert "FollowPath.GoalDist.scale (not in critics)" in told(found)


@pytest.mark.parametrize("namespace", ["robot1:\n", "/robot1:\n"])
def test_nodes_in_a_namespace_are_found(tmp_path: Path, namespace: str) -> None:
    text = namespace + "".join(f"  {line}\n" for line in AMCL.strip().splitlines())
    assert read(tmp_path, text).value.amcl.laser_max_beams == 90


def test_controllers_that_are_not_here_are_named(tmp_path: Path) -> None:
    found = read(tmp_path, CONTROLLER.replace("dwb_core::DWBLocalPlanner", "nav2_mppi_controller::MPPIController"))
    assert "FollowPath (nav2_mppi_controller::MPPIController)" in told(found)
    assert found.value.DWAPlannerROS.xy_goal_tolerance == 0.2


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("bt_navigator:\n  ros__parameters: {a: 1}\n", "no node of this file of ROS 2 has a counterpart here"),
        ("amcl:\n  ros__parameters: {max_beams: many}\n", "line 2"),
        ("amcl:\n  ros__parameters: {robot_model_type: ackermann}\n", "'ackermann' is not a motion model"),
    ],
)
def test_faults_are_told_with_their_place(tmp_path: Path, text: str, message: str) -> None:
    with pytest.raises(BadFile) as found:
        read(tmp_path, text)
    assert message in str(found.value)
    assert "nav2.yaml" in str(found.value)


@pytest.mark.parametrize("written", ["", "static_layer", "{static_layer: true}"])
def test_plugins_that_are_no_list_are_a_fault(tmp_path: Path, written: str) -> None:
    """The robot would drive without its map."""
    text = f"global_costmap:\n  global_costmap:\n    ros__parameters:\n      plugins: {written}\n"
    with pytest.raises(
        BadFile, match=r"line 4, global_costmap\.plugins: not a list of layers\. Write for example \[static_"
    ):
        read(tmp_path, text)


@pytest.mark.parametrize("node", ["amcl:\n  ros__parameters:\n", "amcl:\n  ros__parameters: {}\n"])
def test_a_node_without_parameters_has_the_defaults_of_nav2(tmp_path: Path, node: str) -> None:
    assert read(tmp_path, node).value.amcl.max_particles == 2000


def test_names_with_dots_are_of_layers(tmp_path: Path) -> None:
    text = """
global_costmap:
  global_costmap:
    ros__parameters:
      plugins: [static_layer, lasers]
      lasers.plugin: nav2_costmap_2d::ObstacleLayer
      lasers.observation_sources: scan
      lasers.scan.obstacle_max_range: 3.5
      lasers: {enabled: false}
"""
    layer = read(tmp_path, text).value.global_costmap.obstacle_layer
    assert [(source.name, source.obstacle_range) for source in layer.observation_sources] == [("scan", 3.5)]
    assert not layer.enabled


@pytest.mark.parametrize(
    ("plugin", "reason"),
    [
        ("nav2_smac_planner/SmacPlannerHybrid", "no planner in planner_plugins"),
        ("", "no planner in planner_plug"),
    ],
)
def test_a_planner_that_is_not_here_is_named_also_alone_in_its_file(tmp_path: Path, plugin: str, reason: str) -> None:
    own = f"GridBased: {{plugin: {plugin}}}" if plugin else "Other: {tolerance: 0.1}"
    text = f"planner_server:\n  ros__parameters:\n    planner_plugins: [GridBased]\n    {own}\n"
    found = read(tmp_path, text)
    assert (found.value, reason in told(found)) == (RobotParameters(), True)


@pytest.mark.parametrize("node", ["amcl", "planner_server"])
def test_nodes_of_two_robots_are_a_fault(tmp_path: Path, node: str) -> None:
    text = "".join(f"robot{number}:\n  {node}:\n    ros__parameters: {{}}\n" for number in (1, 2))
    with pytest.raises(BadFile, match=rf"line 5: {node} appears again for a second robot\. Write the nodes of one"):
        read(tmp_path, text)
