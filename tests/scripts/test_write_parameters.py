"""The page of parameters, and that it leaves none of ROS's out."""

import dataclasses
import importlib.util
import subprocess
import sys
from pathlib import Path

import pytest

from sim.parameters import RobotParameters
from tests.support.project import ROOT

SCRIPT = ROOT / "scripts" / "write_parameters.py"

COSTMAP = """
    global_frame robot_base_frame transform_tolerance update_frequency publish_frequency rolling_window width height
    resolution origin_x origin_y footprint robot_radius footprint_padding plugins track_unknown_space
    always_send_full_costmap footprint_topic
    static_map map_type obstacle_range raytrace_range inflation_radius cost_scaling_factor observation_sources
    lethal_cost_threshold unknown_cost_value max_obstacle_height
    static_layer.enabled static_layer.map_topic static_layer.first_map_only static_layer.subscribe_to_updates
    static_layer.track_unknown_space static_layer.use_maximum static_layer.lethal_cost_threshold
    static_layer.unknown_cost_value static_layer.trinary_costmap
    obstacle_layer.enabled obstacle_layer.observation_sources obstacle_layer.transform_tolerance
    obstacle_layer.combination_method obstacle_layer.footprint_clearing_enabled obstacle_layer.max_obstacle_height
    obstacle_layer.track_unknown_space obstacle_layer.obstacle_range obstacle_layer.raytrace_range
    obstacle_layer.origin_z obstacle_layer.z_resolution obstacle_layer.z_voxels obstacle_layer.unknown_threshold
    obstacle_layer.mark_threshold obstacle_layer.publish_voxel_map
    obstacle_layer.NAME.topic obstacle_layer.NAME.sensor_frame obstacle_layer.NAME.observation_persistence
    obstacle_layer.NAME.expected_update_rate obstacle_layer.NAME.data_type obstacle_layer.NAME.min_obstacle_height
    obstacle_layer.NAME.max_obstacle_height obstacle_layer.NAME.inf_is_valid obstacle_layer.NAME.clearing
    obstacle_layer.NAME.marking obstacle_layer.NAME.obstacle_range obstacle_layer.NAME.raytrace_range
    inflation_layer.enabled inflation_layer.inflation_radius inflation_layer.cost_scaling_factor
    inflation_layer.inflate_unknown
"""

NAMES = {
    "amcl": """
        min_particles max_particles kld_err kld_z update_min_d update_min_a resample_interval transform_tolerance
        recovery_alpha_slow recovery_alpha_fast do_beamskip beam_skip_distance beam_skip_threshold
        beam_skip_error_threshold tf_broadcast force_update_after_initialpose force_update_after_set_map
        gui_publish_rate save_pose_rate use_map_topic first_map_only selective_resampling bag_scan_period
        std_warn_level_x std_warn_level_y std_warn_level_yaw
        initial_pose_x initial_pose_y initial_pose_a initial_cov_xx initial_cov_yy initial_cov_aa
        laser_min_range laser_max_range laser_max_beams laser_z_hit laser_z_short laser_z_max laser_z_rand
        laser_sigma_hit laser_lambda_short laser_likelihood_max_dist laser_model_type
        odom_model_type odom_alpha1 odom_alpha2 odom_alpha3 odom_alpha4 odom_alpha5
        odom_frame_id base_frame_id global_frame_id restore_defaults
    """,
    "global_costmap": COSTMAP,
    "local_costmap": COSTMAP,
    "move_base": """
        base_global_planner base_local_planner planner_frequency controller_frequency planner_patience
        controller_patience max_planning_retries conservative_reset_dist recovery_behavior_enabled recovery_behaviors
        clearing_rotation_allowed shutdown_costmaps oscillation_timeout oscillation_distance make_plan_clear_costmap
        make_plan_add_unreachable_goal restore_defaults
    """,
    "NavfnROS": "allow_unknown planner_window_x planner_window_y default_tolerance visualize_potential",
    "GlobalPlanner": """
        allow_unknown use_dijkstra use_quadratic use_grid_path old_navfn_behavior planner_window_x planner_window_y
        default_tolerance publish_scale outline_map lethal_cost neutral_cost cost_factor publish_potential
        orientation_mode orientation_window_size
    """,
    "TrajectoryPlannerROS": """
        acc_lim_x acc_lim_y acc_lim_theta max_vel_x min_vel_x max_vel_theta min_vel_theta min_in_place_vel_theta
        sim_time sim_granularity angular_sim_granularity path_distance_bias goal_distance_bias pdist_scale gdist_scale
        occdist_scale oscillation_reset_dist escape_reset_dist escape_reset_theta vx_samples vtheta_samples
        heading_lookahead holonomic_robot escape_vel dwa heading_scoring heading_scoring_timestep simple_attractor
        y_vels restore_defaults prune_plan xy_goal_tolerance yaw_goal_tolerance latch_xy_goal_tolerance
        stop_time_buffer meter_scoring world_model publish_cost_grid_pc global_frame_id
    """,
    "DWAPlannerROS": """
        max_vel_trans min_vel_trans max_vel_x min_vel_x max_vel_y min_vel_y max_vel_theta min_vel_theta acc_lim_x
        acc_lim_y acc_lim_theta acc_lim_trans prune_plan xy_goal_tolerance yaw_goal_tolerance trans_stopped_vel
        theta_stopped_vel sim_time sim_granularity angular_sim_granularity path_distance_bias goal_distance_bias
        occdist_scale twirling_scale stop_time_buffer oscillation_reset_dist oscillation_reset_angle
        forward_point_distance scaling_speed max_scaling_factor vx_samples vy_samples vth_samples use_dwa
        restore_defaults cheat_factor sum_scores publish_cost_grid_pc publish_traj_pc global_frame_id
        latch_xy_goal_tolerance odom_topic
    """,
    "fake_localization": """
        odom_frame_id base_frame_id global_frame_id delta_x delta_y delta_yaw transform_tolerance
    """,
}
"""Every parameter that ROS noetic's navigation stack reads, by its namespace."""


@pytest.fixture(scope="module")
def script():
    specification = importlib.util.spec_from_file_location("write_parameters", SCRIPT)
    module = importlib.util.module_from_spec(specification)
    sys.modules["write_parameters"] = module
    specification.loader.exec_module(module)
    return module


def test_the_page_is_up_to_date(tmp_path: Path) -> None:
    subprocess.run([sys.executable, SCRIPT, tmp_path / "page.md"], check=True, cwd=ROOT, env={"PYTHONPATH": str(ROOT)})
    assert (tmp_path / "page.md").read_text() == (ROOT / "docs" / "reference" / "parameters.md").read_text(), (
        "run scripts/write_parameters.py"
    )


@pytest.mark.parametrize("section", NAMES)
def test_every_parameter_of_ros_is_there(script, section: str) -> None:
    hunts = getattr(RobotParameters(), section)
    known = {row.name for row in script.rows(type(hunts)(), hunts)}
    assert set(NAMES[section].split()) - known == set()


def test_every_part_of_a_robots_software_has_a_table(script) -> None:
    parts = {field.name for field in dataclasses.fields(RobotParameters) if dataclasses.is_dataclass(field.default)}
    assert parts <= {section for sections in script.TITLES for section in sections}
