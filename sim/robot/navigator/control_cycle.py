"""State "controlling" of move_base: a command along the itinerary whenever a command is due."""

from collections.abc import Sequence
from dataclasses import replace

from sim.common.geometry import Pose2
from sim.common.observations import Neighbour, Twist
from sim.robot.navigator.controller import Controller
from sim.robot.navigator.goal_execution import GoalExecution
from sim.robot.navigator.goals import GoalReached
from sim.robot.navigator.states import Controlling


class ControlCycle:
    """State "controlling" of one robot's move_base.

    Args:
        execution: execution of the robot's goal.
        controller: controller of the robot.
    """

    def __init__(self, execution: GoalExecution, controller: Controller) -> None:
        self._execution = execution
        self._controller = controller

    def run(self, state: Controlling, tick: int, pose: Pose2, twist: Twist, bodies: Sequence[Neighbour]) -> None:
        """Choose a command along the itinerary."""
        self._execution.oscillation.watch(tick, pose)
        output = state.follower.step(tick, pose, twist, bodies)
        self._execution.command = output.command
        self._execution.enter("command due", replace(state, output=output))
        # A robot that waits for its right of way does not count as oscillating.
        if output.waiting:
            self._execution.oscillation.pause(self._controller.control_ticks)
        else:
            self._execution.progress.note_driving(self._controller.control_ticks, pose)
        if output.valid:
            self._execution.progress.last_valid = tick
        if not state.gives_way and self._execution.progress.watch(tick, state.follower.remaining):
            self._execution.recovery.restart()
        if output.arrived:
            if self._execution.goal is None or state.gives_way:
                self._execution.stop("way given")
            else:
                self._execution.end(GoalReached(self._execution.goal))
