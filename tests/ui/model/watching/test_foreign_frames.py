"""Robots of others say costmaps, plans and particles in frames of their own; all are shown on the map."""

import math

import numpy as np
import pytest

from sim.common.geometry import Pose2
from sim.common.grid import OccupancyGrid
from tests.support.ros.watched_messages import StampedMessage, odometry, tf
from thbridge.ros.messages import pack, types
from ui.model.watching.live import LiveSource
from ui.model.watching.scene import RobotScene, ShownLayers

ODOM_IN_MAP = Pose2(10.0, 20.0, math.pi / 2)
CELLS = OccupancyGrid(np.zeros((3, 4), dtype=np.int8), 0.5, Pose2(1.0, 0.0, 0.0))
POSES = np.array([[1.0, 0.0, 0.0], [2.0, 0.0, math.pi]])


def seen(frame: str) -> RobotScene:
    live = LiveSource()
    live.take(
        [
            tf(1, ("map", "odom", ODOM_IN_MAP), ("odom", "base_link", Pose2(1.0, 0.0, 0.0))),
            odometry(1, Pose2(1.0, 0.0, 0.0)),
            StampedMessage("/particlecloud", types.POSE_ARRAY, 1, pack.pose_array(0, frame, POSES)),
            StampedMessage("/move_base/NavfnROS/plan", types.PATH, 1, pack.path(0, frame, POSES)),
            StampedMessage(
                "/move_base/local_costmap/footprint", types.POLYGON_STAMPED, 1, pack.polygon(0, frame, POSES[:, :2])
            ),
            StampedMessage(
                "/move_base/local_costmap/costmap", types.OCCUPANCY_GRID, 1, pack.occupancy_grid(0, frame, CELLS)
            ),
        ],
        0.0,
    )
    (robot,) = live.scene(ShownLayers(local_costmap=True)).robots
    return robot


def test_poses_in_the_frame_of_odometry_are_carried_onto_the_map() -> None:
    robot = seen("odom")
    assert robot.estimate is not None
    assert robot.estimate.array() == pytest.approx([10.0, 21.0, math.pi / 2])
    assert robot.plan == pytest.approx(np.array([[10.0, 21.0], [10.0, 22.0]]))
    assert robot.footprint == pytest.approx(robot.plan)
    assert robot.cloud == pytest.approx(np.array([[10.0, 21.0, math.pi / 2], [10.0, 22.0, -math.pi / 2]]))
    assert robot.local_costmap is not None
    assert robot.local_costmap.origin.array() == pytest.approx([10.0, 21.0, math.pi / 2])


def test_poses_on_the_map_stay_where_they_are() -> None:
    robot = seen("map")
    assert robot.plan == pytest.approx(POSES[:, :2])
    assert robot.cloud == pytest.approx(np.array([[1.0, 0.0, 0.0], [2.0, 0.0, -math.pi]]))
    assert robot.local_costmap == CELLS


def test_poses_in_a_frame_that_hangs_nowhere_are_not_shown() -> None:
    robot = seen("elsewhere")
    assert (len(robot.plan), len(robot.cloud), len(robot.footprint), robot.local_costmap) == (0, 0, 0, None)
