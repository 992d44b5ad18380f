"""Parameter files of Nav2."""

AMCL = """
amcl:
  ros__parameters:
    use_sim_time: True
    alpha1: 0.3
    max_beams: 90
    z_hit: 0.7
    pf_err: 0.02
    robot_model_type: "nav2_amcl::DifferentialMotionModel"
    set_initial_pose: true
    initial_pose: {x: 1.5, y: -2.0, z: 0.0, yaw: 0.5}
    scan_topic: scan
    random_seed: 5
"""
CONTROLLER = """
controller_server:
  ros__parameters:
    controller_frequency: 15.0
    failure_tolerance: 0.3
    progress_checker_plugins: ["progress_checker"]
    progress_checker:
      plugin: "nav2_controller::SimpleProgressChecker"
      required_movement_radius: 0.4
      movement_time_allowance: 12.0
    goal_checker_plugins: ["general_goal_checker"]
    general_goal_checker:
      plugin: "nav2_controller::SimpleGoalChecker"
      xy_goal_tolerance: 0.2
      yaw_goal_tolerance: 0.15
      stateful: True
    controller_plugins: ["FollowPath"]
    FollowPath:
      plugin: "dwb_core::DWBLocalPlanner"
      min_vel_x: 0.0
      max_vel_x: 0.26
      max_vel_theta: 1.0
      max_speed_xy: 0.26
      acc_lim_x: 2.5
      acc_lim_theta: 3.2
      decel_lim_x: -2.5
      vtheta_samples: 30
      linear_granularity: 0.05
      xy_goal_tolerance: 0.9
      critics: ["RotateToGoal", "BaseObstacle", "PathDist", "GoalDist"]
      BaseObstacle.scale: 0.02
      PathDist: {scale: 32.0}
      GoalDist.scale: 24.0
"""
