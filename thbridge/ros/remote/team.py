"""Team of real robots. Subclasses add the connection to a graph of ROS 1 or ROS 2."""

import logging
from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence
from typing import cast

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
from sim.parameters import RobotParameters, WorldParameters
from sim.snapshot import TeamSnapshot
from thbridge.ros import names
from thbridge.ros.messages import types
from thbridge.ros.messages.stamps import tick_of
from thbridge.ros.reconfigure import DescribedParameter, values_config
from thbridge.ros.remote.changes import RobotPart, SettledState, sentence_of_change
from thbridge.ros.remote.clock import RosClock
from thbridge.ros.remote.robot import RemoteRobot, missing_of
from thbridge.ros.topics import RosMessage, Topic

PLACEMENT_TOLERANCE = 0.5
"""A robot has to be moved if its distance from its start pose is above this, meters."""

_log = logging.getLogger(__name__)


class RemoteTeam(ABC):
    """Team of real robots. It implements `thbridge.roles.simr.team.RobotTeam`, and logs changes that people must know.

    Args:
        robots: state and messages of each robot.
        offset: time by which odometry is ahead of the scans. Its default is the value at the start.
        wall: returns the time of the wall clock, nanoseconds.

    Attributes:
        robots: state and messages of each robot.
        clock: time of the graph. None until it is known whether the time is simulated.
    """

    def __init__(self, robots: Sequence[RemoteRobot], offset: DescribedParameter, wall: Callable[[], int]) -> None:
        self.robots = tuple(robots)
        self.clock: RosClock | None = None
        self._wall = wall
        self._offset = offset
        self._unrecorded_offset: bytes | None = None
        self.correct_odometry(cast(float, offset.default))
        self._last: TeamSnapshot | None = None
        self._silent: tuple[SettledState[frozenset[RobotPart]], ...] = tuple(
            SettledState(frozenset()) for _ in self.robots
        )
        self._resent = [0] * len(self.robots)
        self._clock_stands = SettledState(False)
        self._unsupported: set[str] = set()

    # The connection to the graph

    @abstractmethod
    async def start(self) -> object:
        """Join the graph. Robots may appear later. Return the reason if this is not possible."""

    @abstractmethod
    async def stop(self) -> None:
        """Stop the robots, and leave the graph."""

    @abstractmethod
    def _send(self, robot: int, message: RosMessage) -> None:
        """Send a message to a robot."""

    @abstractmethod
    def _record(self, message: RosMessage) -> None:
        """Record a message of this program, in the form of ROS 1."""

    # The team

    @property
    def size(self) -> int:
        """Number of robots."""
        return len(self.robots)

    @property
    def parameters(self) -> tuple[RobotParameters, ...]:
        """Empty, because real robots run their own software."""
        return ()

    @property
    def worlds(self) -> tuple[WorldParameters, ...]:
        """Empty, because the real world has no parameters."""
        return ()

    def now(self) -> int | None:
        """Return the ROS time in nanoseconds, or None while it is unknown."""
        return None if self.clock is None or not self.clock.runs else self.clock.now(self._wall())

    @property
    def joined(self) -> bool:
        """True after the graph was found."""
        return self.clock is not None

    def missing(self) -> list[str]:
        """Return the reasons why the robots cannot be commanded yet. Each reason is one sentence."""
        return missing_of(self.robots)

    def step(self, inputs: Sequence[TeamInput] = ()) -> TeamSnapshot:
        """Carry out the inputs and return the current state of the robots. The tick is computed from ROS time.

        Raises:
            ValueError: the robots cannot be commanded yet. See `missing`.
        """
        now_ns = self.now()
        if now_ns is None:
            raise ValueError("the time is not known yet")
        self.tell_changes()
        for item in inputs:
            self._take(item, now_ns)
        outputs = [robot.step(now_ns) for robot in self.robots]
        self._send_all()
        if self._unrecorded_offset is not None:
            topic = Topic(f"{names.FLEET}/parameter_updates", types.CONFIG, latched=True)
            self._record(RosMessage(topic, now_ns, self._unrecorded_offset))
            self._unrecorded_offset = None
        known = tuple(output for output in outputs if output is not None)
        if len(known) < len(outputs):
            raise ValueError(f"not all robots are ready yet: {'; '.join(self.missing())}")
        commands = [output.navigation.command for output in known]
        velocities = np.array([(command.linear, command.angular) for command in commands])
        self._last = TeamSnapshot(tick_of(now_ns), None, known, velocities)
        return self._last

    def correct_odometry(self, seconds: float) -> None:
        """Set the time by which odometry is ahead of the scans, and record it as a message of dynamic_reconfigure."""
        for robot in self.robots:
            robot.stamp_odometry_later(round(seconds * 1e9))
        self._unrecorded_offset = values_config([(self._offset, seconds)])

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

    def _stop_robots(self) -> None:
        now_ns = self.now()
        if now_ns is not None:
            for robot in self.robots:
                robot.stop(now_ns)
        self._send_all()

    def _send_all(self) -> None:
        for robot, remote in enumerate(self.robots):
            messages, remote.outgoing = remote.outgoing, []
            for message in messages:
                self._send(robot, message)
                self._record(message)

    def _take(self, item: TeamInput, now_ns: int) -> None:
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
