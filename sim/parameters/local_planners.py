"""Local planners, under the names of base_local_planner and dwa_local_planner."""

from dataclasses import dataclass

from sim.parameters.knobs import knob


@dataclass(frozen=True, slots=True)
class TrajectoryPlannerParameters:
    """The local planner, under base_local_planner's names; the values are those of the 2016 study."""

    max_vel_x: float = knob(1.0, "greatest forward speed", "m/s", 0, 20)
    min_vel_x: float = knob(0.1, "least forward speed while moving", "m/s", 0, 20)
    max_vel_theta: float = knob(1.0, "greatest rate of turn", "rad/s", 0, 20)
    min_in_place_vel_theta: float = knob(0.4, "least rate of turn in place", "rad/s", 0, 20)
    acc_lim_x: float = knob(10.0, "acceleration the planner counts on", "m/s^2", 0.01, 100)
    acc_lim_theta: float = knob(10.0, "angular acceleration the planner counts on", "rad/s^2", 0.01, 100)
    sim_time: float = knob(1.7, "seconds a trajectory is rolled out", "s", 0.1, 10)
    sim_granularity: float = knob(0.1, "distance between checked points of a trajectory (ROS: 0.025)", "m", 0.005, 5)
    vx_samples: int = knob(5, "forward speeds tried (ROS: 20)", "", 1, 300)
    vtheta_samples: int = knob(15, "rates of turn tried (ROS: 20)", "", 1, 300)
    pdist_scale: float = knob(0.8, "weight of keeping to the path", "", 0, 10)
    gdist_scale: float = knob(0.6, "weight of getting to the goal", "", 0, 10)
    occdist_scale: float = knob(0.02, "weight of keeping off obstacles", "", 0, 10)
    xy_goal_tolerance: float = knob(0.10, "how near the goal counts as reached", "m", 0.001, 5)
    yaw_goal_tolerance: float = knob(0.05, "how well the heading must agree at the goal", "rad", 0.001, 3.15)
    latch_xy_goal_tolerance: bool = knob(True, "once at the goal, only turn (ROS: false)")
