"""The two costmaps of a robot: each can be cleared and read by its name."""

import numpy as np
import pytest

from sim.common.geometry import Pose2
from sim.common.grid import OccupancyGrid
from sim.parameters import RobotParameters, WorldParameters
from sim.robot.costmap.costs import FREE, LETHAL
from sim.robot.navigator.costmaps import Costmaps
from sim.robot.navigator.rotated_map import RotatedMap
from sim.robot.navigator.stale_neighbours import StaleNeighbours

GRID = OccupancyGrid(np.zeros((200, 200), np.int8), 0.05, Pose2(0.0, 0.0, 0.0))
BASE, NEAR, FAR = Pose2(5.0, 5.0, 0.0), Pose2(5.425, 5.025, 0.0), Pose2(6.025, 5.025, 0.0)


@pytest.mark.parametrize("name", ["global_costmap", "local_costmap"])
@pytest.mark.parametrize(
    ("side", "outside", "kept"),
    [(None, False, []), (1.0, False, [FAR]), (1.0, True, [NEAR]), (-1.0, False, [NEAR, FAR]), (-1.0, True, [])],
)
def test_a_region_of_one_costmap_is_cleared(name, side, outside, kept):
    costmaps = Costmaps(RobotParameters(), np.array(WorldParameters().footprint), RotatedMap(GRID), 0)
    for costmap in (costmaps.global_costmap, costmaps.local_costmap):
        costmap.update(BASE.x, BASE.y)
        for place in (NEAR, FAR):
            row, col = GRID.cell_of(place.x, place.y)
            costmap.obstacles.marks[row - costmap.obstacles.window.row, col - costmap.obstacles.window.col] = LETHAL
    costmaps.clear_region(name, BASE.x, BASE.y, side, outside=outside)
    for each in ("global_costmap", "local_costmap"):
        now = costmaps.at(each, 7, BASE, StaleNeighbours(), None)
        assert [place for place in (NEAR, FAR) if now.cost_at(place) == LETHAL] == (
            kept if each == name else [NEAR, FAR]
        )
        assert (now.tick, now.base_in_map) == (7, BASE)
        assert now.cost_at(Pose2(5.0, 6.5, 0.0)) == FREE
        assert (now.cost_at(Pose2(1.0, 1.0, 0.0)) is None) == (each == "local_costmap")
