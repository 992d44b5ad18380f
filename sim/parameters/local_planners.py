"""Local planners, under the names of base_local_planner and dwa_local_planner.

The defaults are ROS noetic's: those of the .cfg files where a parameter stands in one, since dynamic_reconfigure lays
them over the defaults in code before the first command.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import ClassVar

from sim.parameters.declaration import live, param

_SIDEWAYS = "these robots have differential drive and cannot go sideways"
_ALWAYS_PRUNED = "whether the part of a plan that was driven is cut off: here it always is"
_UNUSED = "ROS's planner reads it and uses it nowhere"


@dataclass(frozen=True, slots=True)
class TrajectoryPlannerParameters:
    """The local planner that rolls out trajectories, under base_local_planner's names.

    Differs: its goal tolerances may change while it runs, as DWAPlannerROS's may in ROS too.
    """

    acc_lim_x: float = live(2.5, "acceleration the planner counts on", "m/s^2", 0.01, 100)
    acc_lim_theta: float = live(3.2, "angular acceleration the planner counts on", "rad/s^2", 0.01, 100)
    max_vel_x: float = live(0.55, "greatest forward speed", "m/s", 0, 20)
    min_vel_x: float = live(0.0, "least forward speed while moving", "m/s", 0, 20)
    max_vel_theta: float = live(1.0, "greatest rate of turn to the left", "rad/s", 0, 20)
    min_vel_theta: float = live(-1.0, "greatest rate of turn to the right, negative", "rad/s", -20, 0)
    min_in_place_vel_theta: float = live(0.4, "least rate of turn in place", "rad/s", 0, 20)
    escape_vel: float = live(-0.1, "speed of backing up where nothing leads on; negative is backwards", "m/s", -2, 2)
    escape_reset_dist: float = live(0.1, "how far it backs up before it tries to go on", "m", 0, 5)
    escape_reset_theta: float = live(math.pi / 2, "or how far it turns", "rad", 0, 5)
    sim_time: float = live(1.7, "seconds a trajectory is rolled out", "s", 0.1, 10)
    sim_granularity: float = live(0.025, "distance between checked points of a trajectory", "m", 0.005, 5)
    angular_sim_granularity: float = live(0.025, "turn between checked points of a trajectory", "rad", 0.005, 1.5708)
    vx_samples: int = live(20, "forward speeds tried", "", 1, 300)
    vtheta_samples: int = live(20, "rates of turn tried", "", 1, 300)
    dwa: bool = live(False, "try only what is reached by the next command, not by the end of sim_time")
    path_distance_bias: float = live(0.6, "weight of keeping to the path", "", 0, 100)
    goal_distance_bias: float = live(0.8, "weight of getting to the goal", "", 0, 100)
    occdist_scale: float = live(0.01, "weight of keeping off obstacles", "", 0, 10)
    meter_scoring: bool = param(False, "the two biases count metres; else cells of the costmap")
    heading_lookahead: float = live(0.325, "distance along the path of the point it turns to in place", "m", 0, 5)
    heading_scoring: bool = live(False, "score where a trajectory heads early on, not where it ends")
    heading_scoring_timestep: float = live(0.1, "how early on that is", "s", 0, 1)
    simple_attractor: bool = live(False, "score the straight distance to the goal, not the way around obstacles")
    oscillation_reset_dist: float = live(0.05, "having moved so far it may turn the other way round", "m", 0, 5)
    xy_goal_tolerance: float = live(0.10, "how near the goal counts as reached", "m", 0.001, 5)
    yaw_goal_tolerance: float = live(0.05, "how well the heading must agree at the goal", "rad", 0.001, 3.15)
    latch_xy_goal_tolerance: bool = param(False, "once at the goal, only turn")

    renamed: ClassVar[Mapping[str, str]] = {
        "pdist_scale": "path_distance_bias",
        "gdist_scale": "goal_distance_bias",
    }
    ros_only: ClassVar[Mapping[str, str]] = {
        "acc_lim_y": _SIDEWAYS,
        "holonomic_robot": f"whether sideways speeds are tried; {_SIDEWAYS}",
        "y_vels": f"the sideways speeds tried; {_SIDEWAYS}",
        "prune_plan": _ALWAYS_PRUNED,
        "stop_time_buffer": _UNUSED,
        "world_model": "the model of obstacles; ROS itself has `costmap` alone",
        "point_grid": "settings of a model of obstacles that ROS no longer has",
        "max_rotational_vel": "an old name of max_vel_theta, which wins over it in ROS",
        "min_in_place_rotational_vel": "an old name of min_in_place_vel_theta, which wins over it in ROS",
        "backup_vel": "an old name of escape_vel, which wins over it in ROS",
        "restore_defaults": "a button of dynamic_reconfigure",
        "publish_cost_grid_pc": "whether the grid of costs is shown",
        "global_frame_id": "the frame in which costs are shown",
    }


@dataclass(frozen=True, slots=True)
class DwaPlannerParameters:
    """The local planner by the dynamic window, under dwa_local_planner's names."""

    acc_lim_x: float = live(2.5, "acceleration the planner counts on", "m/s^2", 0.01, 100)
    acc_lim_theta: float = live(3.2, "angular acceleration the planner counts on", "rad/s^2", 0.01, 100)
    max_vel_trans: float = live(0.55, "greatest speed", "m/s", 0, 20)
    min_vel_trans: float = live(0.1, "a slower one is only tried with min_vel_theta", "m/s", 0, 20)
    max_vel_x: float = live(0.55, "greatest forward speed", "m/s", -20, 20)
    min_vel_x: float = live(0.0, "least forward speed; negative backwards", "m/s", -20, 20)
    max_vel_theta: float = live(1.0, "greatest rate of turn", "rad/s", 0, 20)
    min_vel_theta: float = live(0.4, "least rate of turn in place", "rad/s", 0, 20)
    sim_time: float = live(1.7, "seconds a trajectory is rolled out", "s", 0.1, 10)
    sim_granularity: float = live(0.025, "distance between checked points of a trajectory", "m", 0.005, 5)
    angular_sim_granularity: float = live(0.1, "turn between checked points of a trajectory", "rad", 0.005, 1.5708)
    vx_samples: int = live(3, "forward speeds tried", "", 1, 300)
    vth_samples: int = live(20, "rates of turn tried", "", 1, 300)
    use_dwa: bool = live(True, "try only what is reached by the next command, not by the end of sim_time")
    path_distance_bias: float = live(0.6, "weight of keeping body and nose to the path", "1/m", 0, 1000)
    goal_distance_bias: float = live(0.8, "weight of getting body and nose to the goal", "1/m", 0, 1000)
    occdist_scale: float = live(0.01, "weight of keeping off obstacles", "", 0, 10)
    sum_scores: bool = param(False, "add up the obstacle costs along a trajectory; else its worst counts")
    twirling_scale: float = live(0.0, "weight of turning little", "s/rad", 0, 1000)
    forward_point_distance: float = live(0.325, "where the nose is, forward of the centre", "m", 0, 5)
    cheat_factor: float = param(
        1.0, "the nose need not keep to the path within forward_point_distance of the goal, times its root", "", 0, 100
    )
    scaling_speed: float = live(0.25, "faster than this the footprint is grown", "m/s", 0, 20)
    max_scaling_factor: float = live(0.2, "by which share it is grown at max_vel_trans", "", 0, 10)
    oscillation_reset_dist: float = live(0.05, "having moved so far it may turn back again", "m", 0, 5)
    oscillation_reset_angle: float = live(0.2, "or turned so far", "rad", 0, 7)
    xy_goal_tolerance: float = live(0.1, "how near the goal counts as reached", "m", 0.001, 5)
    yaw_goal_tolerance: float = live(0.1, "how well the heading must agree at the goal", "rad", 0.001, 3.15)
    latch_xy_goal_tolerance: bool = param(False, "once at the goal, only turn")
    trans_stopped_vel: float = live(0.1, "slower than this counts as standing", "m/s", 0.001, 20)
    theta_stopped_vel: float = live(0.1, "turning slower than this counts as standing", "rad/s", 0.001, 20)

    ros_only: ClassVar[Mapping[str, str]] = {
        "acc_lim_y": _SIDEWAYS,
        "max_vel_y": _SIDEWAYS,
        "min_vel_y": _SIDEWAYS,
        "vy_samples": _SIDEWAYS,
        "acc_lim_trans": _UNUSED,
        "stop_time_buffer": _UNUSED,
        "prune_plan": _ALWAYS_PRUNED,
        "max_trans_vel": "an old name of max_vel_trans, which ROS no longer reads",
        "min_trans_vel": "an old name of min_vel_trans, which ROS no longer reads",
        "max_rot_vel": "an old name of max_vel_theta, which ROS no longer reads",
        "min_rot_vel": "an old name of min_vel_theta, which ROS no longer reads",
        "acc_limit_trans": "an old name of acc_lim_trans, which ROS no longer reads",
        "trans_stopped_velocity": "an old name of trans_stopped_vel, which ROS no longer reads",
        "rot_stopped_vel": "an old name of theta_stopped_vel, which ROS no longer reads",
        "penalize_negative_x": "an old weight, which ROS no longer reads",
        "odom_topic": "the topic of odometry",
        "global_frame_id": "the frame in which trajectories are shown",
        "publish_cost_grid_pc": "whether the grid of costs is shown",
        "publish_traj_pc": "whether all trajectories tried are shown",
        "restore_defaults": "a button of dynamic_reconfigure",
    }
