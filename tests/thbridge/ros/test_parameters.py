from thbridge.ros.names import RobotNames
from thbridge.ros.parameters import leaves, name_of, path_of, robot_tree, tree_of, value_at
from thbridge.study.study_file import Study

ROBOT = RobotNames.of(0)


def test_parameters_have_the_names_that_ros_gives_them() -> None:
    found = dict(leaves("/robot1", robot_tree(Study().robot)))
    assert found["/robot1/amcl/laser_max_beams"] == 60
    assert found["/robot1/move_base/controller_frequency"] == 10.0
    assert found["/robot1/move_base/base_global_planner"] == "navfn/NavfnROS"
    assert found["/robot1/move_base/local_costmap/inflation_layer/inflation_radius"] == 0.5
    assert found["/robot1/move_base/TrajectoryPlannerROS/max_vel_x"] == 1.0
    assert found["/robot1/move_base/local_costmap/obstacle_layer/observation_sources"] == "scan"
    assert found["/robot1/move_base/local_costmap/obstacle_layer/scan/clearing"] is True
    assert found["/robot1/localization"] == "amcl"


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
