"""Cost of one more robot for a team that has many."""

import tracemalloc
from pathlib import Path

from sim.inputs import SendGoal
from sim.parameters import RobotParameters, WorldParameters
from sim.robot.navigator.goals import Goal
from sim.team import Team
from thbridge.files.map_files import read_map

MAPS = Path(__file__).parents[2] / "maps"


def test_robots_share_what_is_the_same_for_all_of_them():
    place = read_map(MAPS / "warehouse12")

    def held(robots: int) -> int:
        """Bytes that a team of so many holds when all have planned."""
        before = tracemalloc.get_traced_memory()[0]
        team = Team(place.grid, WorldParameters(), [RobotParameters()] * robots, place.starts[:robots], 1, 1e9)
        orders = [SendGoal(robot, Goal(robot, place.rooms[robot].goal)) for robot in range(robots)]
        for tick in range(3 * robots):
            team.step(orders if tick == 0 else [])
        return tracemalloc.get_traced_memory()[0] - before

    held(2)
    tracemalloc.start()
    try:
        few, many = held(2), held(10)
    finally:
        tracemalloc.stop()
    # Five costmaps' worth of cells: its own global one, what it saw, walls; and the local one's grids.
    assert (many - few) / 8 < 6 * place.grid.cells.size
