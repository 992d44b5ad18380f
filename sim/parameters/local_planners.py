"""Parameters of local planners, with the names of base_local_planner and dwa_local_planner.

The defaults are those of ROS noetic. If a parameter is in a .cfg file, the default in this file is used here, because
dynamic_reconfigure overwrites the defaults in code before the first command.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import ClassVar

from sim.parameters.declaration import live, param

_SIDEWAYS = "these robots have a differential drive and cannot move sideways"
_ALWAYS_PRUNED = "cut off the part of a plan that was already driven; here always done"
_UNUSED = "ROS's planner reads this parameter but does not use it"


@dataclass(frozen=True, slots=True)
class TrajectoryPlannerParameters:
    """The local planner that rolls out trajectories. Its parameters are named as in base_local_planner.

    Difference from ROS: the goal tolerances may change while the planner runs. In ROS this is only possible for
    DWAPlannerROS.
    """

    acc_lim_x: float = live(2.5, "maximum acceleration that the planner assumes", "m/s^2", 0.01, 100)
    acc_lim_theta: float = live(3.2, "maximum angular acceleration that the planner assumes", "rad/s^2", 0.01, 100)
    max_vel_x: float = live(0.55, "maximum forward velocity", "m/s", 0, 20)
    min_vel_x: float = live(0.0, "minimum forward velocity while moving", "m/s", 0, 20)
    max_vel_theta: float = live(1.0, "maximum angular velocity to the left", "rad/s", 0, 20)
    min_vel_theta: float = live(-1.0, "maximum angular velocity to the right, as a negative number", "rad/s", -20, 0)
    min_in_place_vel_theta: float = live(0.4, "minimum angular velocity when turning in place", "rad/s", 0, 20)
    escape_vel: float = live(
        -0.1, "velocity for backing up when no trajectory is valid; negative means backward", "m/s", -2, 2
    )
    escape_reset_dist: float = live(0.1, "distance to back up before the planner tries to drive on", "m", 0, 5)
    escape_reset_theta: float = live(
        math.pi / 2,
        "angle to turn before the planner tries to drive on; escape_reset_dist also suffices",
        "rad",
        0,
        5,
    )
    sim_time: float = live(1.7, "simulated duration of a trajectory", "s", 0.1, 10)
    sim_granularity: float = live(0.025, "distance between the checked points of a trajectory", "m", 0.005, 5)
    angular_sim_granularity: float = live(
        0.025, "rotation between the checked points of a trajectory", "rad", 0.005, 1.5708
    )
    vx_samples: int = live(20, "number of forward velocities tried", "", 1, 300)
    vtheta_samples: int = live(20, "number of angular velocities tried", "", 1, 300)
    dwa: bool = live(
        False,
        "sample velocities that can be reached before the next command (dynamic window); if false, within sim_time",
    )
    path_distance_bias: float = live(0.6, "weight of staying close to the path", "", 0, 100)
    goal_distance_bias: float = live(0.8, "weight of approaching the goal", "", 0, 100)
    occdist_scale: float = live(0.01, "weight of avoiding obstacles", "", 0, 10)
    meter_scoring: bool = param(
        False, "interpret path_distance_bias and goal_distance_bias per meter; if false, per cell of the costmap"
    )
    heading_lookahead: float = live(
        0.325, "distance along the path of the point that the robot faces when it turns in place", "m", 0, 5
    )
    heading_scoring: bool = live(
        False, "score trajectories by their heading at heading_scoring_timestep, not by their end point"
    )
    heading_scoring_timestep: float = live(
        0.1, "time along the trajectory at which heading_scoring evaluates the heading", "s", 0, 1
    )
    simple_attractor: bool = live(False, "score the straight distance to the goal instead of the path around obstacles")
    oscillation_reset_dist: float = live(
        0.05, "distance moved before the robot may turn in the opposite direction", "m", 0, 5
    )
    xy_goal_tolerance: float = live(0.10, "distance at which the goal position counts as reached", "m", 0.001, 5)
    yaw_goal_tolerance: float = live(0.05, "tolerance of the heading at the goal", "rad", 0.001, 3.15)
    latch_xy_goal_tolerance: bool = param(False, "after reaching the goal position, only turn")

    renamed: ClassVar[Mapping[str, str]] = {
        "pdist_scale": "path_distance_bias",
        "gdist_scale": "goal_distance_bias",
    }
    ros_only: ClassVar[Mapping[str, str]] = {
        "acc_lim_y": _SIDEWAYS,
        "holonomic_robot": f"try sideways velocities; {_SIDEWAYS}",
        "y_vels": f"sideways velocities to try; {_SIDEWAYS}",
        "prune_plan": _ALWAYS_PRUNED,
        "stop_time_buffer": _UNUSED,
        "world_model": "model of obstacles; ROS itself only has `costmap`",
        "point_grid": "settings of an obstacle model that ROS has removed",
        "max_rotational_vel": "old name of max_vel_theta; in ROS it overrides the new name",
        "min_in_place_rotational_vel": "old name of min_in_place_vel_theta; in ROS it overrides the new name",
        "backup_vel": "old name of escape_vel; in ROS it overrides the new name",
        "restore_defaults": "a button of dynamic_reconfigure",
        "publish_cost_grid_pc": "publish the grid of costs",
        "global_frame_id": "frame of the published costs",
    }


@dataclass(frozen=True, slots=True)
class DwaPlannerParameters:
    """The local planner with the dynamic window approach. Its parameters are named as in dwa_local_planner."""

    acc_lim_x: float = live(2.5, "maximum acceleration that the planner assumes", "m/s^2", 0.01, 100)
    acc_lim_theta: float = live(3.2, "maximum angular acceleration that the planner assumes", "rad/s^2", 0.01, 100)
    max_vel_trans: float = live(0.55, "maximum translational velocity", "m/s", 0, 20)
    min_vel_trans: float = live(
        0.1,
        "minimum translational velocity; slower commands are tried only if they turn at min_vel_theta or faster",
        "m/s",
        0,
        20,
    )
    max_vel_x: float = live(0.55, "maximum forward velocity", "m/s", -20, 20)
    min_vel_x: float = live(0.0, "minimum forward velocity; negative means backward", "m/s", -20, 20)
    max_vel_theta: float = live(1.0, "maximum angular velocity", "rad/s", 0, 20)
    min_vel_theta: float = live(0.4, "minimum angular velocity when turning in place", "rad/s", 0, 20)
    sim_time: float = live(1.7, "simulated duration of a trajectory", "s", 0.1, 10)
    sim_granularity: float = live(0.025, "distance between the checked points of a trajectory", "m", 0.005, 5)
    angular_sim_granularity: float = live(
        0.1, "rotation between the checked points of a trajectory", "rad", 0.005, 1.5708
    )
    vx_samples: int = live(3, "number of forward velocities tried", "", 1, 300)
    vth_samples: int = live(20, "number of angular velocities tried", "", 1, 300)
    use_dwa: bool = live(
        True,
        "sample velocities that can be reached before the next command (dynamic window); if false, within sim_time",
    )
    path_distance_bias: float = live(
        0.6, "weight of keeping center and nose of the robot close to the path", "1/m", 0, 1000
    )
    goal_distance_bias: float = live(0.8, "weight of bringing center and nose of the robot to the goal", "1/m", 0, 1000)
    occdist_scale: float = live(0.01, "weight of avoiding obstacles", "", 0, 10)
    sum_scores: bool = param(False, "add up the obstacle costs along a trajectory; if false, use the highest one")
    twirling_scale: float = live(0.0, "weight of penalizing rotation", "s/rad", 0, 1000)
    forward_point_distance: float = live(0.325, "distance of the nose, in front of the robot's center", "m", 0, 5)
    cheat_factor: float = param(
        1.0,
        "ignore the nose's distance to the path within forward_point_distance * sqrt(cheat_factor) of the goal",
        "",
        0,
        100,
    )
    scaling_speed: float = live(0.25, "velocity above which the footprint is enlarged", "m/s", 0, 20)
    max_scaling_factor: float = live(0.2, "enlargement of the footprint at max_vel_trans, as a proportion", "", 0, 10)
    oscillation_reset_dist: float = live(0.05, "distance moved before the robot may reverse its direction", "m", 0, 5)
    oscillation_reset_angle: float = live(
        0.2,
        "angle turned before the robot may reverse its direction; oscillation_reset_dist also suffices",
        "rad",
        0,
        7,
    )
    xy_goal_tolerance: float = live(0.1, "distance at which the goal position counts as reached", "m", 0.001, 5)
    yaw_goal_tolerance: float = live(0.1, "tolerance of the heading at the goal", "rad", 0.001, 3.15)
    latch_xy_goal_tolerance: bool = param(False, "after reaching the goal position, only turn")
    trans_stopped_vel: float = live(0.1, "velocity below which the robot counts as standing", "m/s", 0.001, 20)
    theta_stopped_vel: float = live(
        0.1, "angular velocity below which the robot counts as standing", "rad/s", 0.001, 20
    )

    ros_only: ClassVar[Mapping[str, str]] = {
        "acc_lim_y": _SIDEWAYS,
        "max_vel_y": _SIDEWAYS,
        "min_vel_y": _SIDEWAYS,
        "vy_samples": _SIDEWAYS,
        "acc_lim_trans": _UNUSED,
        "stop_time_buffer": _UNUSED,
        "prune_plan": _ALWAYS_PRUNED,
        "max_trans_vel": "old name of max_vel_trans; ROS no longer reads this name",
        "min_trans_vel": "old name of min_vel_trans; ROS no longer reads this name",
        "max_rot_vel": "old name of max_vel_theta; ROS no longer reads this name",
        "min_rot_vel": "old name of min_vel_theta; ROS no longer reads this name",
        "acc_limit_trans": "old name of acc_lim_trans; ROS no longer reads this name",
        "trans_stopped_velocity": "old name of trans_stopped_vel; ROS no longer reads this name",
        "rot_stopped_vel": "old name of theta_stopped_vel; ROS no longer reads this name",
        "penalize_negative_x": "old weight; ROS no longer reads it",
        "odom_topic": "topic of odometry",
        "global_frame_id": "frame of the published trajectories",
        "publish_cost_grid_pc": "publish the grid of costs",
        "publish_traj_pc": "publish all trajectories tried",
        "restore_defaults": "a button of dynamic_reconfigure",
    }
