"""Path planning for a round robot on any map, without sensors."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal

import numpy as np

from sim.common.geometry import Pose2
from sim.common.grid import OccupancyGrid
from sim.numerics.float_array import FloatArray
from sim.parameters import InflationParameters, NavfnParameters, RobotParameters, StaticParameters
from sim.robot.costmap.costs import CostFrame, Costs, Window
from sim.robot.costmap.inflation import InflationLayer
from sim.robot.costmap.static import StaticLayer
from sim.robot.global_planning.navfn import Navfn
from sim.robot.global_planning.path import Path, PlanRefusalCode
from sim.robot.global_planning.potential_planner import PotentialPlanner

_COSTMAP = RobotParameters().global_costmap

Algorithm = Literal["navfn", "astar"]


@dataclass(frozen=True, slots=True)
class PlanResult:
    """Result of one query.

    Attributes:
        found: True if there is a path.
        length: length of the path, meters, or None without a path.
        milliseconds: planning time, without compilation.
        reason: sentence with the reason why there is no path, or None if there is a path.
        code: code of the reason, for programs, or None if there is a path.
    """

    found: bool
    length: float | None
    milliseconds: float
    reason: str | None
    code: PlanRefusalCode | None


def costmap(grid: OccupancyGrid, radius: float, inflation: float) -> Costs:
    """Return (rows, cols) costs of a map: its occupied cells and the costs around them (inflation).

    Args:
        grid: the map.
        radius: radius of the robot, meters.
        inflation: inflation radius, meters. If it is smaller than `radius`, `radius` is used.
    """
    parameters = InflationParameters(
        inflation_radius=max(inflation, radius), cost_scaling_factor=_COSTMAP.inflation_layer.cost_scaling_factor
    )
    costs = np.zeros(grid.cells.shape, np.uint8)
    whole = Window(0, 0, grid.rows, grid.cols)
    StaticLayer(StaticParameters(), grid).write(costs, (0, 0), whole)
    InflationLayer(parameters, grid.resolution, radius).write(costs, (0, 0), whole)
    return costs


def plan(
    grid: OccupancyGrid,
    queries: FloatArray,
    radius: float,
    inflation: float,
    algorithm: Algorithm,
    seconds: Callable[[], float],
) -> list[PlanResult]:
    """Plan a path for each query, in the order of queries.

    Args:
        grid: the map. Its origin may be rotated.
        queries: (n, 4) x and y of the start, x and y of the goal, map frame, meters; n at least 1.
        radius: see `costmap`.
        inflation: see `costmap`.
        algorithm: order in which navfn visits cells: "navfn" for Dijkstra's order, "astar" for the order of A*.
        seconds: clock that measures planning times, seconds.
    """
    planner = PotentialPlanner(Navfn(NavfnParameters(use_astar=algorithm == "astar")))
    costs = costmap(grid, radius, inflation)
    # Planners need maps without rotation, so queries are converted to the frame of the grid.
    to_grid = grid.origin.inverse()
    ends = np.column_stack([to_grid.transform(queries[:, :2]), to_grid.transform(queries[:, 2:])]).tolist()
    frame = CostFrame(0.0, 0.0, grid.resolution)
    # This first plan contains compilation and allocations, so that the measured times do not.
    planner.plan(np.zeros((9, 9), np.uint8), CostFrame(0.0, 0.0, 1.0), Pose2(2.5, 2.5, 0.0), Pose2(6.5, 6.5, 0.0))
    ends_in_grid = [(Pose2(x, y, 0.0), Pose2(u, v, 0.0)) for x, y, u, v in ends]
    planner.plan(costs, frame, *ends_in_grid[0])
    return [_answer(planner, costs, frame, start, goal, seconds) for start, goal in ends_in_grid]


def _answer(
    planner: PotentialPlanner, costs: Costs, frame: CostFrame, start: Pose2, goal: Pose2, seconds: Callable[[], float]
) -> PlanResult:
    begin = seconds()
    result = planner.plan(costs, frame, start, goal)
    milliseconds = 1e3 * (seconds() - begin)
    if isinstance(result, Path):
        return PlanResult(True, result.length, milliseconds, None, None)
    return PlanResult(False, None, milliseconds, result.sentence, result.code)
