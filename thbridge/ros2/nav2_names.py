"""Names of the robots' parameters in Nav2, with their names in ROS 1.

Source: the declarations in ros-navigation/navigation2: nav2_amcl/src/amcl_node.cpp, nav2_costmap_2d/src and /plugins,
nav2_navfn_planner, nav2_controller/src and /plugins, nav2_dwb_controller/dwb_plugins and dwb_critics.
"""

from collections.abc import Mapping

AMCL: Mapping[str, str] = {
    **{f"alpha{number}": f"odom_alpha{number}" for number in range(1, 6)},
    **{
        name: f"laser_{name}"
        for name in ("max_beams", "z_hit", "z_short", "z_max", "z_rand", "sigma_hit", "lambda_short")
    },
    "pf_err": "kld_err",
    "pf_z": "kld_z",
    "initial_pose.x": "initial_pose_x",
    "initial_pose.y": "initial_pose_y",
    "initial_pose.yaw": "initial_pose_a",
    **{
        name: name
        for name in (
            *("beam_skip_distance", "beam_skip_error_threshold", "beam_skip_threshold", "do_beamskip"),
            *("laser_likelihood_max_dist", "laser_max_range", "laser_min_range", "laser_model_type"),
            *("max_particles", "min_particles", "recovery_alpha_fast", "recovery_alpha_slow", "resample_interval"),
            *("update_min_a", "update_min_d", "base_frame_id", "global_frame_id", "odom_frame_id", "tf_broadcast"),
            *("transform_tolerance", "save_pose_rate", "first_map_only"),
        )
    },
}
"""Names of amcl's parameters in ROS 1, by their names in Nav2."""

DWB: Mapping[str, str] = {
    "max_speed_xy": "max_vel_trans",
    "min_speed_xy": "min_vel_trans",
    "min_speed_theta": "min_vel_theta",
    "linear_granularity": "sim_granularity",
    "angular_granularity": "angular_sim_granularity",
    "vtheta_samples": "vth_samples",
    "trans_stopped_velocity": "trans_stopped_vel",
    "BaseObstacle.scale": "occdist_scale",
    "BaseObstacle.sum_scores": "sum_scores",
    "PathAlign.forward_point_distance": "forward_point_distance",
    **{
        name: name
        for name in (
            *("acc_lim_x", "acc_lim_y", "acc_lim_theta", "max_vel_x", "max_vel_y", "min_vel_x", "min_vel_y"),
            *("max_vel_theta", "sim_time", "vx_samples", "vy_samples", "xy_goal_tolerance"),
        )
    },
}
"""Names of DWAPlannerROS's parameters, by their names in Nav2's DWB."""

HALVED: Mapping[str, str] = {"PathDist.scale": "path_distance_bias", "GoalDist.scale": "goal_distance_bias"}
"""Weights per cell. DWB multiplies them by half of a cell's side, ROS 1 by the full side (dwb_critics,
map_grid.cpp)."""

GOAL_CHECKER: Mapping[str, str] = {
    "xy_goal_tolerance": "xy_goal_tolerance",
    "yaw_goal_tolerance": "yaw_goal_tolerance",
    "stateful": "latch_xy_goal_tolerance",
}
"""Names of DWAPlannerROS's parameters, by their names in Nav2's SimpleGoalChecker."""

PROGRESS_CHECKER: Mapping[str, str] = {
    "required_movement_radius": "oscillation_distance",
    "movement_time_allowance": "oscillation_timeout",
}
"""Names of move_base's parameters, by their names in Nav2's SimpleProgressChecker."""

NAVFN: Mapping[str, str] = {
    "tolerance": "default_tolerance",
    "use_astar": "use_astar",
    "allow_unknown": "allow_unknown",
}
"""Names of NavfnROS's parameters, by their names in Nav2's NavfnPlanner."""

SOURCE: Mapping[str, str] = {"obstacle_max_range": "obstacle_range", "raytrace_max_range": "raytrace_range"}
"""Names of the parameters of an observation source in ROS 1, by their names in Nav2."""

TRAJECTORY: Mapping[str, str] = {
    "linear_granularity": "sim_granularity",
    "angular_granularity": "angular_sim_granularity",
    **{
        name: name
        for name in (
            *("acc_lim_x", "acc_lim_theta", "max_vel_x", "min_vel_x", "max_vel_theta"),
            *("sim_time", "vx_samples", "vtheta_samples"),
        )
    },
}
"""Names of TrajectoryPlannerROS's parameters, by their names in Nav2's DWB. Its weights have other meanings."""

STATIC_LAYER = "static_layer"
OF_THE_MAP = ("lethal_cost_threshold", "unknown_cost_value", "trinary_costmap", "use_maximum")
"""Parameters of the static layer that belong to the costmap in Nav2."""
