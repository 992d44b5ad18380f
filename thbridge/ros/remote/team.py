"""Team of real robots, without the connection to their graph."""

import logging
from collections.abc import Callable, Sequence

import numpy as np

from sim.common.robot_numbers import robot_name
from sim.inputs import (
    TEAM_INPUTS,
    CancelGoal,
    DriveManually,
    PlaceRobot,
    SendGoal,
    SetCharge,
    SetPoseEstimate,
    TeamInput,
)
from sim.team import TeamSnapshot
from thbridge.ros import names
from thbridge.ros.messages.stamps import tick_of
from thbridge.ros.remote.changes import RobotPart, SettledState, sentence_of_change
from thbridge.ros.remote.clock import RosClock
from thbridge.ros.remote.robot import RemoteRobot

PLACEMENT_TOLERANCE = 0.5
"""A robot has to be moved if its distance from its start pose is above this, meters."""

_log = logging.getLogger(__name__)


class RemoteTeam:
    """Real robots and their time. It logs changes that people must know.

    Args:
        robots: state and messages of each robot.
        wall: returns the time of the wall clock, nanoseconds.

    Attributes:
        robots: state and messages of each robot.
        clock: time of the graph. None until it is known whether the time is simulated.
    """

    def __init__(self, robots: Sequence[RemoteRobot], wall: Callable[[], int]) -> None:
        self.robots = tuple(robots)
        self.clock: RosClock | None = None
        self._wall = wall
        self._last: TeamSnapshot | None = None
        self._silent: tuple[SettledState[frozenset[RobotPart]], ...] = tuple(
            SettledState(frozenset()) for _ in self.robots
        )
        self._resent = [0] * len(self.robots)
        self._clock_stands = SettledState(False)
        self._unsupported: set[str] = set()

    def now(self) -> int | None:
        """Return the ROS time in nanoseconds, or None while it is unknown."""
        return None if self.clock is None or not self.clock.runs else self.clock.now(self._wall())

    def tell_changes(self) -> None:
        """Log impossible odometry. Also log parts of robots that became silent or active at least a second ago."""
        if self.clock is None or not self.clock.runs:
            return
        wall_ns = self._wall()
        now_ns = self.clock.now(wall_ns)
        if self._clock_stands.take(self.clock.stands(wall_ns), wall_ns):
            stands = self._clock_stands.settled
            news = "no messages; time continues with this machine's clock" if stands else "messages arrive again"
            _log.warning("%s: %s", names.CLOCK, news)
        for robot, remote in enumerate(self.robots):
            state = self._silent[robot]
            before = state.settled
            if state.take(remote.silent_parts(now_ns), now_ns):
                _log.warning("%s", sentence_of_change(robot_name(robot), remote.names, before, state.settled))
            for notice in remote.take_notices():
                _log.warning("%s: %s", robot_name(robot), notice)
            if remote.resent_goals != self._resent[robot]:
                self._resent[robot] = remote.resent_goals
                _log.warning("%s: its navigation did not report its goal, so the goal is sent again", robot_name(robot))

    def stop(self) -> None:
        """Stop the robots. Their messages must be sent after this."""
        now_ns = self.now()
        if now_ns is not None:
            for robot in self.robots:
                robot.stop(now_ns)

    def take(self, item: TeamInput, now_ns: int) -> None:
        """Carry out an input."""
        match item:
            case SendGoal(robot) | CancelGoal(robot) | DriveManually(robot) | SetPoseEstimate(robot):
                self.robots[robot].take(item, now_ns)
            case SetCharge():
                pass  # The keeper counts the game's energy. A real battery cannot be set.
            case PlaceRobot(robot, pose):
                if (
                    self._last is None
                    or self._last.robots[robot].estimate.base_in_map.distance(pose) > PLACEMENT_TOLERANCE
                ):
                    where = robot_name(robot), pose.x, pose.y
                    _log.warning("%s is not at its start pose: please move it to (%.2f, %.2f)", *where)
            case _:
                name = next(name for name, input_class in TEAM_INPUTS.items() if input_class is type(item))
                if name not in self._unsupported:
                    self._unsupported.add(name)
                    _log.warning("real robots do not support %s", name)

    def snapshot(self, now_ns: int) -> TeamSnapshot | None:
        """Step the robots, and return their current state. Return None if some robots are not ready yet."""
        outputs = [robot.step(now_ns) for robot in self.robots]
        self.tell_changes()
        known = tuple(output for output in outputs if output is not None)
        if len(known) < len(outputs):
            return None
        commands = [output.navigation.command for output in known]
        velocities = np.array([(command.linear, command.angular) for command in commands])
        self._last = TeamSnapshot(tick_of(now_ns), None, known, velocities)
        return self._last
