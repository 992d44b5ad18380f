"""Drives by parameter files of ROS in the ways in which labs write them, unchanged."""

import dataclasses
from pathlib import Path

import numpy as np
import pytest

from sim.common.geometry import Pose2
from sim.common.grid import OccupancyGrid
from sim.parameters import RobotParameters, WorldParameters
from thbridge.files.map_files import read_map
from thbridge.files.ros.parameters import RosParameters, read_ros_parameters
from thbridge.offline.drive import DriveResult, DriveTask, drive

BODY = "[[0.25, 0.2], [-0.25, 0.2], [-0.25, -0.2], [0.25, -0.2]]"
LIMITS = "max_vel_x: 0.6, max_vel_theta: 1.2, acc_lim_x: 2.0, acc_lim_theta: 4.0, sim_time: 1.5"
ROLLOUT = (
    f"TrajectoryPlannerROS: {{{LIMITS}, vx_samples: 6, holonomic_robot: false, meter_scoring: true, pdist_scale: 0.8}}"
)
FRONT = "{data_type: LaserScan, topic: scan, marking: true, clearing: true}"

STYLES: dict[str, dict[str, str]] = {
    # The common list has no map; the global costmap has a list of its own.
    "plugins without a static layer": {
        "common.yaml": f"""
            footprint: {BODY}
            footprint_padding: 0.02
            plugins:
            - {{name: seen, type: "costmap_2d::ObstacleLayer"}}
            - {{name: around, type: "costmap_2d::InflationLayer"}}
            seen:
              observation_sources: front
              front: {FRONT}
            around: {{inflation_radius: 0.3}}
            """,
        "local.yaml": "local_costmap: {global_frame: odom, static_map: false, rolling_window: true, width: 5.0}",
        "global.yaml": """
            global_costmap:
              static_map: true
              plugins:
              - {name: walls, type: "costmap_2d::StaticLayer"}
              - {name: seen, type: "costmap_2d::ObstacleLayer"}
              - {name: around, type: "costmap_2d::InflationLayer"}
            """,
        "planner.yaml": ROLLOUT,
        "move_base.yaml": "controller_frequency: 10.0\nplanner_frequency: 1.0\nshutdown_costmaps: false\n",
    },
    "everything under move_base": {
        "all.yaml": f"""
            move_base:
              base_local_planner: base_local_planner/TrajectoryPlannerROS
              controller_frequency: 10.0
              recovery_behaviors: [{{name: reset, type: clear_costmap_recovery/ClearCostmapRecovery}}]
              reset: {{reset_distance: 2.0}}
              NavfnROS: {{allow_unknown: false}}
              {ROLLOUT}
              global_costmap:
                footprint: {BODY}
                static_map: true
                inflation_radius: 0.4
              local_costmap:
                footprint: {BODY}
                rolling_window: true
                obstacle_range: 3.0
                observation_sources: front
                front: {FRONT}
            amcl: {{min_particles: 300, odom_alpha1: 0.1}}
            """,
    },
    "before plugins": {
        "common.yaml": f"""
            map_type: costmap
            obstacle_range: 2.5
            raytrace_range: 3.0
            footprint: {BODY}
            observation_sources: front
            front: {FRONT}
            inflation_radius: 0.4
            """,
        "global.yaml": "global_costmap: {static_map: true, update_frequency: 2.0, robot_base_frame: base_link}",
        "local.yaml": "local_costmap: {static_map: false, rolling_window: true, resolution: 0.025, width: 4}",
        "planner.yaml": ROLLOUT,
    },
    "rolling window and dynamic window": {
        "common.yaml": f"""
            footprint: {BODY}
            observation_sources: front
            front: {FRONT}
            inflation_radius: 0.5
            cost_scaling_factor: 5.0
            """,
        "global.yaml": "global_costmap: {static_map: true}",
        "local.yaml": "local_costmap: {rolling_window: true, width: 3, height: 3}",
        "planner.yaml": f"""
            base_local_planner: dwa_local_planner/DWAPlannerROS
            DWAPlannerROS:
              {{{LIMITS}, max_vel_trans: 0.6, path_distance_bias: 32.0, goal_distance_bias: 20.0,
                max_vel_rot: 1.0, max_trans_vel: 0.5}}
            TebLocalPlannerROS: {{max_vel_x: 0.4, weight_obstacle: 50}}
            """,
    },
    "flat files in namespaces": {
        "global_costmap:common.yaml": f"""
            footprint: {BODY}
            walls: {{map_topic: /map}}
            seen: {{observation_sources: front, front: {FRONT}}}
            """,
        "local_costmap:common.yaml": "",
        "global_costmap:static.yaml": """
            track_unknown_space: true
            plugins:
            - {name: walls, type: "costmap_2d::StaticLayer"}
            - {name: inflation, type: "costmap_2d::InflationLayer"}
            """,
        "local_costmap:rolling.yaml": """
            rolling_window: true
            plugins:
            - {name: seen, type: "costmap_2d::VoxelLayer"}
            - {name: inflation, type: "costmap_2d::InflationLayer"}
            inflation: {inflation_radius: 0.4}
            virtual_walls_map: {map_topic: /virtual_walls/map}
            """,
        "planner.yaml": f"controller_frequency: 10.0\n{ROLLOUT}\n",
        "amcl.yaml": "min_particles: 200\nodom_model_type: diff-corrected\ngui_publish_rate: 10.0\n",
    },
}


def parameters_in(folder: Path, style: str) -> RosParameters:
    paths = []
    for name, text in STYLES[style].items():
        paths.append(folder / name)
        file = folder / name.rpartition(":")[2]
        # Common files are loaded into both costmaps.
        if text:
            file.write_text(text)
    return read_ros_parameters(paths, RobotParameters())


def world() -> WorldParameters:
    return dataclasses.replace(WorldParameters(), footprint=((0.25, 0.2), (-0.25, 0.2), (-0.25, -0.2), (0.25, -0.2)))


def two_rooms() -> OccupancyGrid:
    """6 m x 4 m, a wall across the middle with a door of 1.1 m."""
    cells = np.zeros((80, 120), np.int8)
    cells[[0, -1]] = cells[:, [0, -1]] = 100
    cells[:29, 60:62] = cells[51:, 60:62] = 100
    return OccupancyGrid(cells, 0.05, Pose2(0.0, 0.0, 0.0))


@pytest.mark.parametrize("style", STYLES)
def test_a_door_is_passed_by_files_as_labs_write_them(tmp_path: Path, style: str) -> None:
    read = parameters_in(tmp_path, style)
    task = DriveTask(Pose2(1.0, 1.0, 0.0), Pose2(5.0, 3.0, 0.0), any_heading=True, timeout=60.0)
    outcome = drive(two_rooms(), world(), read.value, task, 1)
    assert isinstance(outcome, DriveResult)
    assert (outcome.reached, outcome.collided) == (True, False)
    assert all(f"{tmp_path}/" in notice and ", line " in notice for notice in read.notices)
    # What they say holds: none drives as fast as hunts do.
    assert outcome.distance / outcome.seconds < 0.6


@pytest.mark.parametrize(
    ("style", "told"),
    [
        (
            "plugins without a static layer",
            ("static_map has no effect, as in ROS", "rolling_window", "holonomic_robot"),
        ),
        ("everything under move_base", ("recovery behavior reset is used as conservative_reset", "front.topic")),
        ("before plugins", ("map_type", "local_costmap.resolution", "robot_base_frame")),
        ("rolling window and dynamic window", ("TebLocalPlannerROS", "max_trans_vel", "max_vel_rot")),
        ("flat files in namespaces", ("virtual_walls_map", "gui_publish_rate", "static_layer.map_topic")),
    ],
)
def test_what_there_is_not_here_is_named(tmp_path: Path, style: str, told: tuple[str, ...]) -> None:
    notices = " ".join(parameters_in(tmp_path, style).notices)
    assert not [name for name in told if name not in notices]


@pytest.mark.parametrize("style", STYLES)
def test_layers_are_those_that_ros_would_have(tmp_path: Path, style: str) -> None:
    """The map in the global costmap alone; the laser in the local one."""
    robot = parameters_in(tmp_path, style).value
    assert robot.global_costmap.static_layer.enabled
    assert not robot.local_costmap.static_layer.enabled
    assert robot.local_costmap.obstacle_layer.enabled
    assert [source.name for source in robot.local_costmap.obstacle_layer.observation_sources] == ["front"]
    assert not robot.local_costmap.track_unknown_space


@pytest.mark.slow
@pytest.mark.parametrize("style", STYLES)
def test_eight_rooms_of_the_office_are_reached(tmp_path: Path, style: str) -> None:
    office = read_map(Path(__file__).parents[3] / "maps" / "office")
    robot, here, reached = parameters_in(tmp_path, style).value, office.starts[0], []
    for number in (1, 8, 2, 7, 3, 5, 6, 4):
        goal = office.rooms[number - 1].goal
        outcome = drive(office.grid, world(), robot, DriveTask(here, goal, any_heading=True, timeout=300.0), 1)
        assert isinstance(outcome, DriveResult)
        reached.append((outcome.reached, outcome.collided))
        here = goal
    assert reached == [(True, False)] * 8
