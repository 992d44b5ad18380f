"""Trial of a global planner, which compares its paths over costmaps of all kinds with paths of navfn."""

from collections.abc import Iterator, Mapping
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from sim.common.geometry import Pose2
from sim.common.grid import FREE, OCCUPIED, OccupancyGrid
from sim.numerics import noise
from sim.parameters import NavfnParameters, RobotParameters
from sim.robot.costmap.costs import CostFrame
from sim.robot.global_planning.navfn import Navfn
from sim.robot.global_planning.path import Path, PlannerFactory
from sim.robot.global_planning.potential_planner import PotentialPlanner
from sim.robot.part_failure import PartFailed
from thbridge.app.compose.installed_parts import installed_parts
from thbridge.app.trials.plugin_trial import PluginTrial
from thbridge.offline.plan import costmap

_RESOLUTION = 0.05
_FRAME = CostFrame(-1.0, -2.0, _RESOLUTION)
_RADIUS, _INFLATION = 0.2, 0.5
_QUERIES = 6
"""Number of paths to random goals on each map."""


def try_planner(name: str, seed: int, seconds: float) -> PluginTrial:
    """Return the trial of a global planner; `try_participant` describes arguments and errors."""
    trial = PluginTrial("navfn")
    standard = RobotParameters()
    software = replace(standard, move_base=replace(standard.move_base, base_global_planner=name))
    factory = installed_parts([software], trial.caller(seconds)).planners[name]
    for place, cells in _maps(seed).items():
        trial.twice(place, lambda: _plan(trial, place, software, factory, cells, seed))  # noqa: B023 - called at once
    trial.end()
    return trial


def _maps(seed: int) -> Mapping[str, NDArray[np.int8]]:
    """Return the cells of each map: outer walls, and the obstacles that the name of the map describes."""
    empty = np.full((80, 120), FREE, np.int8)
    empty[[0, -1]] = empty[:, [0, -1]] = OCCUPIED
    gap, closed, scattered = empty.copy(), empty.copy(), empty.copy()
    for walls in (gap, closed):
        walls[:, 60] = OCCUPIED
    gap[50:64, 60] = FREE
    key = noise.key(seed, "planner-check")
    for number in range(25):
        row, col = (int(noise.uniform(key, number, axis) * cells) for axis, cells in enumerate(empty.shape))
        scattered[row : row + 4, col : col + 4] = OCCUPIED
    return {
        "An empty room": empty,
        "A wall with a gap": gap,
        "A wall without a gap": closed,
        "A room with scattered boxes": scattered,
    }


def _plan(
    trial: PluginTrial,
    place: str,
    software: RobotParameters,
    factory: PlannerFactory,
    cells: NDArray[np.int8],
    seed: int,
) -> Iterator[str]:
    """Plan paths from one place to reachable and unreachable places, and yield the paths."""
    planner, navfn = factory(software, seed), PotentialPlanner(Navfn(NavfnParameters()))
    costs = costmap(OccupancyGrid(cells, _RESOLUTION, Pose2(0.0, 0.0, 0.0)), _RADIUS, _INFLATION)
    key = noise.key(seed, "planner-check", place)
    start = Pose2(0.0, 0.0, 0.5)
    goals = [
        start,  # The robot is already at its goal.
        Pose2(100.0, 0.0, 0.0),  # Outside the map.
        *(
            Pose2(_FRAME.x + noise.uniform(key, number, 0) * 6.0, _FRAME.y + noise.uniform(key, number, 1) * 4.0, 1.0)
            for number in range(_QUERIES)
        ),
    ]
    for goal in goals:
        asked = (place, f"From ({start.x:.2f}, {start.y:.2f}) to ({goal.x:.2f}, {goal.y:.2f})")
        known = trial.built_in.measure(lambda: navfn.plan(costs, _FRAME, start, goal))  # noqa: B023 - called at once
        try:
            found = planner.plan(costs, _FRAME, start, goal)
        except PartFailed as failed:
            remedy = "For this query, return points from start to goal, or None"
            trial.note(str(failed), remedy, asked)
            yield str(failed)
            continue
        if isinstance(known, Path) and not isinstance(found, Path):
            problem = "the planner finds no path where navfn finds a path"
            trial.note(problem, "Use all cells with costs below INSCRIBED (253)", asked)
        yield repr(found.poses.tolist()) if isinstance(found, Path) else found.code
