"""State "clearing" of move_base: recovery behaviors, run one after another, and their commands."""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace

from sim.common.geometry import Pose2
from sim.common.observations import STANDSTILL, TICK, Neighbour, Twist
from sim.numerics import noise
from sim.robot.navigator.controller import Controller
from sim.robot.navigator.costmaps import Costmaps
from sim.robot.navigator.goal_execution import GoalExecution
from sim.robot.navigator.goals import Goal, NoPath
from sim.robot.navigator.recovery import LONGEST_RECOVERY, RecoveryFactory, RecoverySituation, RunningRecovery
from sim.robot.navigator.rotated_map import RotatedMap
from sim.robot.navigator.states import Clearing
from sim.robot.part_failure import PartFailed


class ClearingCycle:
    """State "clearing" of one robot's move_base.

    Args:
        execution: execution of the robot's goal.
        controller: controller of the robot.
        costmaps: costmaps of the robot.
        rotated: the map.
        recoveries: installed recovery behaviors, by name.
        seed: random seed of recovery behaviors.
    """

    def __init__(
        self,
        execution: GoalExecution,
        controller: Controller,
        costmaps: Costmaps,
        rotated: RotatedMap,
        recoveries: Mapping[str, RecoveryFactory],
        seed: int,
    ) -> None:
        self._execution = execution
        self._controller = controller
        self._costmaps = costmaps
        self._rotated = rotated
        self._recoveries = recoveries
        self._seed = seed

    def recover(self, tick: int, pose: Pose2, why: Callable[[Goal], NoPath]) -> None:
        """Try the next recovery behavior. If no behavior is left, give the goal up."""
        self._execution.oscillation.restart(tick)
        self._execution.progress.restart_stay()
        self._execution.progress.restart_patience(tick)
        self._execution.progress.last_valid = tick
        behaviour = self._execution.recovery.next()
        if behaviour is None:
            if self._execution.goal is not None:
                self._execution.end(why(self._execution.goal))
            else:
                self._execution.stop("way given")
        elif behaviour == "rotate_recovery":
            self._execution.stop("recovery", Clearing(math.tau, self._execution.standing()))
        elif behaviour in self._recoveries:
            self._begin(behaviour, tick)
        else:
            self._costmaps.clear_outside(pose.x, pose.y, self._execution.recovery.reset_side(behaviour))

    def _begin(self, name: str, tick: int) -> None:
        """Begin an installed recovery behavior."""
        try:
            behavior = self._recoveries[name](int(noise.key(self._seed, "recovery", name, str(tick))))
        except PartFailed as failed:
            self._execution.fault = str(failed)
        else:
            self._execution.stop("recovery", Clearing(0.0, self._execution.standing(), behavior, tick))

    def run(self, state: Clearing, tick: int, pose: Pose2, twist: Twist, bodies: Sequence[Neighbour]) -> None:
        """Choose a command of the recovery behavior."""
        if state.behavior is None:
            self._turn(state, pose, twist, bodies)
        else:
            self._behave(state, state.behavior, tick, pose, twist, bodies)

    def _turn(self, state: Clearing, pose: Pose2, twist: Twist, bodies: Sequence[Neighbour]) -> None:
        """Choose a command for a full turn in place, as far as the turn is safe."""
        drive = self._controller.rotate_recovery(pose, twist, bodies)
        left = state.turn_left - abs(drive.command.angular) * self._controller.control_ticks * TICK
        if left > 0.0 and not drive.stuck:
            self._execution.command = drive.command
            self._execution.enter("command due", replace(state, turn_left=left))
        else:
            self._execution.stop("recovery ended", state.then)

    def _behave(
        self,
        state: Clearing,
        behavior: RunningRecovery,
        tick: int,
        pose: Pose2,
        twist: Twist,
        bodies: Sequence[Neighbour],
    ) -> None:
        """Choose the command of an installed recovery behavior. If it is not safe, the robot stands."""
        controller, seconds = self._controller, (tick - state.began) * TICK
        scan = None if controller.pending is None else controller.pending.scan
        controller.update_costmap(pose, bodies)
        goal = None if self._execution.goal is None else self._rotated.pose_in_grid(self._execution.goal.base_in_map)
        # An installed behavior must not change the arrays of the navigator.
        costs, footprint = controller.costmap.costs.copy(), controller.costmap.footprint.copy()
        for array in (costs, footprint):
            array.setflags(write=False)
        now = RecoverySituation(seconds, pose, twist, goal, scan, costs, controller.costmap.frame, footprint)
        try:
            command = None if seconds > LONGEST_RECOVERY else behavior.command(now)
        except PartFailed as failed:
            command, self._execution.fault = None, str(failed)
        if command is None:
            self._execution.stop("recovery ended", state.then)
            return
        safe = controller.planner.safe(pose, twist, command, controller.surroundings(pose, bodies))
        self._execution.command = command if safe else STANDSTILL
        self._execution.enter("command due", state)
