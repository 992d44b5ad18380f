"""How long costmaps take, on an office of 26 m by 14 m in cells of 0.05 m."""

import time
from collections.abc import Callable
from itertools import cycle

import numpy as np
import pytest

from sim.common.geometry import Pose2
from sim.common.grid import OccupancyGrid
from sim.common.observations import STANDSTILL, LaserMount, Neighbour, Scan
from sim.common.raycast import Raycaster
from sim.parameters import (
    GlobalCostmapParameters,
    InflationParameters,
    LocalCostmapParameters,
    ObservationSource,
    ObstacleParameters,
    StaticParameters,
    WorldParameters,
)
from sim.robot.costmap.costmap_2d import Costmap2D
from sim.robot.costmap.costs import Window
from sim.robot.costmap.inflation import InflationLayer
from sim.robot.costmap.obstacle import CostmapObservation
from sim.robot.costmap.static import StaticLayer
from tests.bench.budget import Budgets

pytestmark = pytest.mark.bench

BODY = np.array(WorldParameters().footprint)
TIMES = 200


def office() -> OccupancyGrid:
    """Rooms of 3.2 m on both sides of a corridor, doors of 1.1 m, a desk in every room."""
    cells = np.zeros((280, 520), np.int8)
    cells[[0, 1, -2, -1], :] = 100
    cells[:, [0, 1, -2, -1]] = 100
    for wall in (110, 168):
        cells[wall : wall + 2, :] = 100
    for col in range(64, 500, 64):
        cells[:112, col : col + 2] = 100
        cells[168:, col : col + 2] = 100
    for col in range(20, 500, 64):
        cells[110:112, col : col + 22] = 0
        cells[168:170, col : col + 22] = 0
        cells[40:56, col : col + 28] = 100
        cells[220:236, col : col + 28] = 100
    return OccupancyGrid(cells, 0.05, Pose2(0.0, 0.0, 0.0))


GRID = office()


def milliseconds(work: Callable[[], object], before: Callable[[], object] = lambda: None) -> tuple[float, float]:
    """CPU time of one call: median and best of many, after one to compile."""
    taken = []
    for _ in range(TIMES + 1):
        before()
        begin = time.process_time()
        work()
        taken.append((time.process_time() - begin) * 1e3)
    return float(np.median(taken[1:])), min(taken[1:])


def judge(what: str, figures: tuple[float, float], budgets: Budgets, capsys: pytest.CaptureFixture[str]) -> None:
    with capsys.disabled():
        print(f"\n{what}: {figures[0]:.2f} ms (best {figures[1]:.2f})", end="")
    budgets.time(f"costmap: {what}", 1e-3 * figures[0])


@pytest.mark.parametrize("radius", [0.5, 0.55, 1.0])
def test_full_inflation(radius: float, budgets: Budgets, capsys: pytest.CaptureFixture[str]) -> None:
    layer = InflationLayer(InflationParameters(inflation_radius=radius), GRID.resolution, 0.26)
    whole = Window(0, 0, GRID.rows, GRID.cols)
    costs = np.zeros(GRID.cells.shape, np.uint8)
    static = StaticLayer(StaticParameters(), GRID)
    figures = milliseconds(lambda: layer.write(costs, (0, 0), whole), lambda: static.write(costs, (0, 0), whole))
    judge(f"inflation of 520 x 280 cells, {radius} m", figures, budgets, capsys)


def neighbours(step: int) -> list[Neighbour]:
    """Ten robots all over the map, each some way on from where it was a step before."""
    return [
        Neighbour(
            robot,
            Pose2(1.5 + 2.3 * robot + 0.2 * (step % 5), (2.0, 7.0, 12.0)[robot % 3], 0.3 * step),
            STANDSTILL,
            BODY,
            np.empty((0, 2)),
            np.empty(0),
        )
        for robot in range(10)
    ]


def test_an_update_with_ten_moved_robots(budgets: Budgets, capsys: pytest.CaptureFixture[str]) -> None:
    costmap = Costmap2D(GlobalCostmapParameters(robot_radius=None), BODY, GRID)
    costmap.update(0.0, 0.0)
    steps = iter([neighbours(step) for step in range(TIMES + 1)])
    figures = milliseconds(lambda: (costmap.update_neighbours(next(steps)), costmap.update(0.0, 0.0)))
    judge("update with ten moved robots", figures, budgets, capsys)


def laser(pose: Pose2) -> Scan:
    mount = LaserMount(Pose2(0.1, 0.0, 0.0), -2.35, 4.7 / 180, 181, 0.05, 8.0)
    at = pose.compose(mount.laser_in_base)
    ranges = Raycaster.of(GRID).ranges(at.array()[np.newaxis], mount.angles(), mount.range_max)[0]
    return Scan(0, mount, ranges.astype(np.float32))


@pytest.mark.parametrize(("side", "robots"), [(4.0, 0), (4.0, 10), (10.0, 0)])
def test_a_rolling_update(side: float, robots: int, budgets: Budgets, capsys: pytest.CaptureFixture[str]) -> None:
    costmap = Costmap2D(LocalCostmapParameters(width=side, height=side, robot_radius=None), BODY, GRID)
    places = cycle(np.linspace(2.0, 20.0, 51))
    costmap.update_neighbours(neighbours(0)[:robots])
    figures = milliseconds(lambda: costmap.update(float(next(places)), 7.0))
    judge(f"rolling update of {side} x {side} m, {robots} robots", figures, budgets, capsys)


def test_taking_in_a_scan(budgets: Budgets, capsys: pytest.CaptureFixture[str]) -> None:
    source = ObservationSource(clearing=True, inf_is_valid=True)
    parameters = ObstacleParameters(observation_sources=(source,), explained_distance=0.2, clear_between_beams=True)
    costmap = Costmap2D(GlobalCostmapParameters(robot_radius=None, obstacle_layer=parameters), BODY, GRID)
    pose = Pose2(10.0, 7.0, 0.3)
    scan = laser(pose)

    def observe() -> None:
        costmap.observe(CostmapObservation(pose, scan, np.empty((0, 3))))

    figures = milliseconds(observe)
    judge("taking in a scan of 181 beams", figures, budgets, capsys)
    figures = milliseconds(
        lambda: costmap.update(0.0, 0.0), lambda: costmap.observe(CostmapObservation(pose, scan, np.empty((0, 3))))
    )
    judge("update after a scan", figures, budgets, capsys)
    with capsys.disabled():
        print()
