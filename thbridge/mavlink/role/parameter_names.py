"""MAVLink names of the study's parameters: at most 16 characters of A-Z, 0-9 and _.

A MAVLink name consists of a short prefix for the parameter's path and a short form of the parameter's name. If the
table `_OWN` contains the parameter's name, it gives the short form. Otherwise each word is shortened. For example,
`GC_INFL_RADIUS` is `global_costmap.inflation_layer.inflation_radius`. Ground stations group parameters by the part
before the first `_`. Each node, costmap and planner of ROS has a group. The group SIM contains the noise of simulated
sensors, as in ArduPilot.
"""

from collections.abc import Mapping

LONGEST = 16
"""Maximum length of a parameter's name in MAVLink (`param_id`)."""

_BEGINNINGS: Mapping[str, str] = {
    "amcl.": "AMCL",
    "amcl.laser_": "AMCL",  # amcl's groups of parameters
    "amcl.odom_": "AMCL",
    "amcl.beam_skip_": "AMCL_BSKIP",
    "ekf.": "EKF",
    "ekf.laser_": "EKF",
    "ekf.odom_": "EKF",
    "global_costmap.": "GC",
    "global_costmap.static_layer.": "GC_STATIC",
    "global_costmap.obstacle_layer.": "GC_OBS",
    "global_costmap.inflation_layer.": "GC_INFL",
    "local_costmap.": "LC",
    "local_costmap.static_layer.": "LC_STATIC",
    "local_costmap.obstacle_layer.": "LC_OBS",
    "local_costmap.inflation_layer.": "LC_INFL",
    "GlobalPlanner.": "GP",
    "TrajectoryPlannerROS.": "TP",
    "DWAPlannerROS.": "DWA",
    "move_base.": "MB",
    "world.": "SIM",
    "world.odometry.": "SIM_ODOM",
    "world.laser.": "SIM_LASER",
    "world.laser.range_": "SIM_LASER",
}
"""Short forms of the prefixes of paths. The longest matching prefix is used."""

_OWN: Mapping[str, str] = {
    "recovery_alpha_slow": "RECOV_SLOW",
    "recovery_alpha_fast": "RECOV_FAST",
    "laser_model_type": "LASER_MODEL",
    "odom_model_type": "ODOM_MODEL",
    "odom_noise_learning_rate": "NOISE_LEARN",
    "laser_likelihood_max_dist": "LIKELI_DIST",
    "footprint_clearing_enabled": "FOOT_CLR",
    "combination_method": "COMBINE",
    "obstacle_range": "RANGE",
    "raytrace_range": "RAYTRACE",
    "inflation_radius": "RADIUS",
    "cost_scaling_factor": "COST_SCL",
    "inflate_unknown": "UNKNOWN",
    "orientation_window_size": "ORIENT_WIN",
    "min_in_place_vel_theta": "MIN_INPL_TH",
    "path_distance_bias": "PATH_BIAS",
    "goal_distance_bias": "GOAL_BIAS",
    "heading_scoring_timestep": "HDG_TIMESTEP",
    "base_global_planner": "GLOBAL_PLAN",
    "base_local_planner": "LOCAL_PLAN",
    "max_planning_retries": "PLAN_RETRIES",
    "recovery_behavior_enabled": "RECOV_ENABLE",
    "clearing_rotation_allowed": "CLEAR_ROTATE",
    "make_plan_add_unreachable_goal": "PLAN_ADD_GOAL",
    "shutdown_costmaps": "SHUT_COSTMAPS",
}
"""Short forms of complete names. Even with shortened words, these names would be too long or repeat their prefix."""

_WORDS: Mapping[str, str] = {
    "angle": "ANG",
    "angular": "ANG",
    "attractor": "ATTR",
    "conservative": "CONS",
    "controller": "CTRL",
    "distance": "DIST",
    "dropout": "DROP",
    "enabled": "ENABLE",
    "escape": "ESC",
    "factor": "FAC",
    "footprint": "FOOT",
    "forward": "FWD",
    "frequency": "FREQ",
    "granularity": "GRAN",
    "heading": "HDG",
    "interval": "INTV",
    "lambda": "LAMB",
    "linear": "LIN",
    "orientation": "ORIENT",
    "oscillation": "OSC",
    "padding": "PAD",
    "particles": "PART",
    "planner": "PLAN",
    "point": "PT",
    "publish": "PUB",
    "resample": "RESAMP",
    "reset": "RST",
    "scale": "SCL",
    "scaling": "SCL",
    "stopped": "STOP",
    "theta": "TH",
    "threshold": "THR",
    "tolerance": "TOL",
    "trans": "TRN",
    "update": "UPD",
    "vtheta": "VTH",
}

GROUPS: Mapping[str, str] = {
    "AMCL": "amcl",
    "EKF": "Kalman filter",
    "GC": "costmap of the whole map",
    "LC": "costmap that moves with the robot",
    "GP": "global_planner",
    "TP": "base_local_planner",
    "DWA": "dwa_local_planner",
    "MB": "move_base",
    "SIM": "true noise of the simulated sensors",
}
"""Name of each group for people, by the prefix of the group."""


def group_of(name: str) -> str:
    """Return the prefix of a name's group, which is a key of `GROUPS`."""
    return name.partition("_")[0]


def name_of(path: str) -> str:
    """Return the name of the parameter at a path.

    Raises:
        ValueError: the name is too long for MAVLink. Add a shorter form to a table above.
    """
    beginning = max((each for each in _BEGINNINGS if path.startswith(each)), key=len)
    whole = path.rpartition(".")[2]
    rest = _OWN.get(whole) or "_".join(_WORDS.get(word, word.upper()) for word in path[len(beginning) :].split("_"))
    name = f"{_BEGINNINGS[beginning]}_{rest}"
    if len(name) > LONGEST:
        raise ValueError(f"{name}, for {path}, has more than {LONGEST} characters")
    return name
