"""Trial of a recovery behavior in places with much and with little free space; it must end in each place."""

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from sim.common.geometry import Pose2
from sim.common.grid import FREE, OCCUPIED, OccupancyGrid
from sim.common.observations import STANDSTILL, TICK, Twist
from sim.parameters import MoveBaseParameters, RecoveryBehavior, RobotParameters, WorldParameters
from sim.robot.costmap.costs import INSCRIBED
from sim.robot.navigator.controller import Controller
from sim.robot.navigator.costmaps import Costmaps
from sim.robot.navigator.recovery import LONGEST_RECOVERY, RecoveryFactory, RecoverySituation
from sim.robot.navigator.rotated_map import RotatedMap
from sim.robot.part_failure import PartFailed
from thbridge.app.compose.installed_parts import installed_parts
from thbridge.app.trials.plugin_trial import PluginTrial

_CELLS, _RESOLUTION = 120, 0.05
_START = Pose2(3.0, 3.0, 0.0)
_PLACES = {
    "in the open": (),
    "before a wall": ((0, 120, 70, 74),),
    "with a wall behind": ((0, 120, 46, 50),),
    "in a dead end": ((0, 120, 70, 74), (44, 48, 0, 120), (72, 76, 0, 120)),
    "enclosed": ((0, 120, 70, 74), (0, 120, 46, 50), (46, 50, 0, 120), (70, 74, 0, 120)),
}
"""Walls of each place, as ranges of rows and columns of cells."""


def try_recovery(name: str, seed: int, seconds: float) -> PluginTrial:
    """Return the trial of a recovery behavior; `try_participant` describes arguments and errors."""
    trial = PluginTrial("rotate_recovery")
    software = RobotParameters(move_base=MoveBaseParameters(recovery_behaviors=(RecoveryBehavior(name),)))
    factory = installed_parts([software], trial.caller(seconds)).recoveries[name]
    for place, walls in _PLACES.items():
        for goal in (Pose2(5.0, 3.0, 0.0), None):
            title = f"A robot {place}, {'without a goal' if goal is None else 'with a goal ahead'}"
            trial.twice(title, lambda: _run(trial, title, factory, walls, goal, seed))  # noqa: B023 - at once
    trial.end()
    return trial


def _run(
    trial: PluginTrial,
    title: str,
    factory: RecoveryFactory,
    walls: tuple[tuple[int, int, int, int], ...],
    goal: Pose2 | None,
    seed: int,
) -> Iterator[str]:
    """Run the behavior once, with ideal wheels, and yield the commands."""
    cells = np.full((_CELLS, _CELLS), FREE, np.int8)
    for row, row_end, col, col_end in walls:
        cells[row:row_end, col:col_end] = OCCUPIED
    controller = _controller(OccupancyGrid(cells, _RESOLUTION, Pose2(0.0, 0.0, 0.0)))
    controller.update_costmap(_START, ())
    costs, footprint = controller.costmap.costs.copy(), controller.costmap.footprint.copy()
    for array in (costs, footprint):
        array.setflags(write=False)
    now = RecoverySituation(0.0, _START, STANDSTILL, goal, None, costs, controller.costmap.frame, footprint)
    try:
        behavior = factory(seed)
        while now.seconds <= LONGEST_RECOVERY:
            command = behavior.command(now)
            trial.built_in.measure(lambda: controller.rotate_recovery(now.base_in_map, now.twist, ()))  # noqa: B023
            yield repr(command)
            if command is None:
                return
            now = _after(now, command, controller.control_ticks * TICK)
    except PartFailed as failed:
        remedy = "At this place, return a finite Twist, or None at the end of the behavior"
        trial.note(str(failed), remedy, (title, f"After {now.seconds:.1f} s, at {now.base_in_map}"))
        return
    problem = f"the behavior has not ended after {LONGEST_RECOVERY:g} s"
    trial.note(problem, "Return None as soon as the behavior is finished, or the robot cannot move", (title,))


def _controller(grid: OccupancyGrid) -> Controller:
    software = RobotParameters()
    costmaps = Costmaps(software, np.array(WorldParameters().footprint), RotatedMap(grid), 0)
    return Controller(software, grid, costmaps, 0)


def _after(now: RecoverySituation, command: Twist, period: float) -> RecoverySituation:
    """Return the situation after a command. A command that leads too near to a wall has no effect."""
    ahead = Pose2(command.linear * period, 0.0, command.angular * period)
    there = now.base_in_map.compose(ahead)
    frame, costs = now.frame, now.costs
    row, col = (int((at - low) / frame.resolution) for at, low in ((there.y, frame.y), (there.x, frame.x)))
    free = 0 <= row < costs.shape[0] and 0 <= col < costs.shape[1] and costs[row, col] < INSCRIBED
    seconds = now.seconds + period
    if not free:
        return replace(now, seconds=seconds, twist=STANDSTILL)
    return replace(now, seconds=seconds, base_in_map=there, twist=command)
