from dataclasses import replace

from sim.parameters import RecoveryBehavior
from thbridge.ros.names import RobotNames
from thbridge.ros.parameters import leaves, name_of, path_of, robot_tree, tree_of, value_at
from thbridge.study.study_file import Study

ROBOT = RobotNames.of(0)
BODY = Study().world.footprint


def test_parameters_have_the_names_that_ros_gives_them() -> None:
    found = dict(leaves("/robot1", robot_tree(Study().robot, ROBOT, BODY)))
    assert found["/robot1/amcl/laser_max_beams"] == 60
    assert found["/robot1/move_base/controller_frequency"] == 10.0
    assert found["/robot1/move_base/base_global_planner"] == "navfn/NavfnROS"
    assert found["/robot1/move_base/local_costmap/inflation_layer/inflation_radius"] == 0.5
    assert found["/robot1/move_base/TrajectoryPlannerROS/max_vel_x"] == 1.0
    assert found["/robot1/move_base/local_costmap/obstacle_layer/observation_sources"] == "scan"
    assert found["/robot1/move_base/local_costmap/obstacle_layer/scan/clearing"] is True
    assert found["/robot1/localization"] == "amcl"


def test_real_nodes_find_frames_topics_and_plugins() -> None:
    found = dict(leaves("/robot1", robot_tree(Study().robot, ROBOT, BODY)))
    costmap = "/robot1/move_base/local_costmap"
    assert found["/robot1/amcl/base_frame_id"] == found[f"{costmap}/robot_base_frame"] == "robot1/base_footprint"
    assert found["/robot1/amcl/odom_frame_id"] == "robot1/odom"
    assert found[f"{costmap}/rolling_window"] is True
    assert found[f"{costmap}/obstacle_layer/scan/topic"] == "/robot1/scan"
    assert found[f"{costmap}/obstacle_layer/scan/data_type"] == "LaserScan"
    assert found[f"{costmap}/plugins"] == [
        {"name": "static_layer", "type": "costmap_2d::StaticLayer"},
        {"name": "obstacle_layer", "type": "costmap_2d::ObstacleLayer"},
        {"name": "inflation_layer", "type": "costmap_2d::InflationLayer"},
    ]
    assert found[f"{costmap}/footprint"] == [list(corner) for corner in BODY]
    assert f"{costmap}/robot_radius" not in found, "costmap_2d would take it for the footprint"
    assert found["/robot1/move_base/TrajectoryPlannerROS/holonomic_robot"] is False
    assert found["/robot1/move_base/DWAPlannerROS/max_vel_y"] == 0.0
    assert "/robot1/move_base/recovery_behaviors" not in found, "move_base refuses a name that comes twice"


def test_a_robot_that_is_round_for_its_costmaps_has_no_corners() -> None:
    software = replace(Study().robot, local_costmap=replace(Study().robot.local_costmap, robot_radius=0.3))
    found = dict(leaves("/robot1", robot_tree(software, ROBOT, BODY)))
    assert found["/robot1/move_base/local_costmap/robot_radius"] == 0.3
    assert "/robot1/move_base/local_costmap/footprint" not in found
    assert "/robot1/move_base/global_costmap/footprint" in found


def test_layers_that_are_off_are_no_plugins() -> None:
    costmap = Study().robot.local_costmap
    without = replace(costmap, static_layer=replace(costmap.static_layer, enabled=False))
    tree = dict(leaves("", robot_tree(replace(Study().robot, local_costmap=without), ROBOT, BODY)))
    plugins = tree["/move_base/local_costmap/plugins"]
    assert isinstance(plugins, list)
    assert [each["name"] for each in plugins] == ["obstacle_layer", "inflation_layer"]


def test_recovery_behaviours_of_ones_own_have_names_and_types_as_move_base_wants() -> None:
    behaviours = tuple(map(RecoveryBehavior, ("rotate_recovery", "aggressive_reset", "rotate_recovery")))
    navigator = replace(Study().robot.move_base, recovery_behaviors=behaviours)
    tree = robot_tree(replace(Study().robot, move_base=navigator), ROBOT, BODY)
    found = dict(leaves("", tree))
    assert found["/move_base/recovery_behaviors"] == [
        {"name": "rotate_recovery", "type": "rotate_recovery/RotateRecovery"},
        {"name": "aggressive_reset", "type": "clear_costmap_recovery/ClearCostmapRecovery"},
        {"name": "rotate_recovery_2", "type": "rotate_recovery/RotateRecovery"},
    ]


def test_the_place_of_a_parameter_is_found_again_by_its_name() -> None:
    for path in ("amcl.min_particles", "move_base.planner_patience", "local_costmap.inflation_layer.inflation_radius",
                 "NavfnROS.allow_unknown", "localization"):  # fmt: skip
        assert path_of(ROBOT, name_of(ROBOT, path)) == path
    assert name_of(ROBOT, "local_costmap.resolution") == "/robot1/move_base/local_costmap/resolution"
    assert path_of(ROBOT, "/robot2/amcl/min_particles") is None
    assert path_of(ROBOT, "/use_sim_time") is None
    assert path_of(ROBOT, "/robot1/") is None


def test_all_of_a_study_can_be_on_the_parameter_server() -> None:
    tree = tree_of(Study())
    assert tree["robots"] == 2
    assert "costs" not in tree["game"]  # null there, and ROS has no word for it


def test_the_value_at_a_place_is_as_the_server_has_it() -> None:
    assert value_at(Study().robot, "amcl.laser_max_beams") == 60
    assert value_at(Study().robot, "local_costmap.robot_radius") is None
