"""Requests to the robots from outside the game, and their effects."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

from sim.common.observations import TICKS_PER_SECOND
from sim.inputs import (
    CancelGoal,
    DriveManually,
    PutThing,
    RemoveThing,
    SendGoal,
    SetPoseEstimate,
    SetSoftwareParameters,
    SetWorldParameters,
    TeamInput,
)
from sim.parameters.reconfiguration import ParameterRejection
from sim.snapshot import TeamSnapshot
from thbridge.roles.shared.robot_requests import ParameterValue, RobotRequest, SetParameters, Tuning
from thbridge.roles.simr.team import RobotTeam
from thbridge.ros.actionlib import ActionRequest, MoveBaseServer
from thbridge.ros.messages.goal_owners import GoalOwner
from thbridge.ros.messages.records import CancelRequest, GoalRequest, InitialPose, SimpleGoal, VelocityCommand

MANUAL_DRIVE_TICKS = TICKS_PER_SECOND // 2
"""Number of ticks for which a command of manual driving is valid. Then the base stops, like real bases."""


@dataclass(frozen=True, slots=True)
class _ManualDrive:
    """Manual driving of a robot: number of remaining ticks, and name of the driving researcher or None."""

    ticks: int
    researcher: str | None


class RobotControls:
    """Queue of requests between two ticks of a team. They become the team's inputs in the next tick.

    Args:
        robots: the team. The caller runs the team's steps.

    Attributes:
        researchers: by robot, the researcher who has set its goal or drives it by hand, or None.
    """

    def __init__(self, robots: RobotTeam) -> None:
        self._robots = robots
        self._servers = tuple(MoveBaseServer(robot) for robot in range(robots.size))
        self._actions: list[ActionRequest] = []
        self._inputs: list[TeamInput] = []
        self._by_hand: dict[int, _ManualDrive] = {}
        # Researchers, by the goals that they have set (robot, owner, number of the goal).
        self._goals: dict[tuple[int, str, int], str] = {}
        self._no_researchers = (None,) * robots.size
        self.researchers: tuple[str | None, ...] = self._no_researchers

    def ask(self, request: RobotRequest, researcher: str | None = None) -> None:
        """Queue a request for the next tick. Drop a request to a robot that does not exist.

        Args:
            request: the request.
            researcher: name of the intervening researcher. None if the request is not an intervention.
        """
        if not (isinstance(request, PutThing | RemoveThing) or 0 <= request.robot < self._robots.size):
            return
        if researcher is not None:
            match request:
                case GoalRequest(robot=robot, number=number):
                    self._goals[robot, GoalOwner.ROS_CLIENT, number] = researcher
                case SimpleGoal(robot=robot, number=number, owner=owner):
                    self._goals[robot, owner, number] = researcher
                case SendGoal(robot, goal):
                    self._goals[robot, goal.owner, goal.id] = researcher
        match request:
            case GoalRequest() | SimpleGoal() | CancelRequest():
                self._actions.append(request)
            case VelocityCommand(robot, twist):
                self._take(DriveManually(robot, twist, MANUAL_DRIVE_TICKS), researcher)
            case InitialPose(robot, base_in_map, covariance):
                self._take(SetPoseEstimate(robot, base_in_map, covariance))
            case SetParameters(robot, values):
                self._tune(robot, values)
            case _:
                self._take(request, researcher)

    def take_inputs(self, tick: int) -> list[TeamInput]:
        """Return the team's inputs for this tick: requests in order of arrival, then goals of action clients."""
        if self._actions:
            actions, self._actions = self._actions, []
            for robot, server in enumerate(self._servers):
                for decided in server.take(tick, [action for action in actions if action.robot == robot]):
                    self._take(decided)
        inputs, self._inputs = self._inputs, []
        return inputs

    def follow(self, snapshot: TeamSnapshot) -> None:
        """Update action servers and researchers after a step of the team."""
        self._follow_researchers(snapshot)
        renewed = snapshot.renewed
        for robot, server in enumerate(self._servers):
            if robot in snapshot.dead:
                server.follow(snapshot.tick, None)
            elif robot in renewed:
                server.follow(snapshot.tick, renewed[robot].navigation)
            else:
                server.pass_to(snapshot.tick)

    def _follow_researchers(self, snapshot: TeamSnapshot) -> None:
        if not self._by_hand and not self._goals:
            self.researchers = self._no_researchers
            return
        self._by_hand = {
            robot: replace(hand, ticks=hand.ticks - 1) for robot, hand in self._by_hand.items() if hand.ticks > 1
        }
        goals = [output.navigation.goal for output in snapshot.robots]
        current = {(robot, goal.owner, goal.id) for robot, goal in enumerate(goals) if goal is not None}
        self._goals = {key: name for key, name in self._goals.items() if key in current}
        set_by = {robot: name for (robot, *_), name in self._goals.items()}
        driven_by = {robot: hand.researcher for robot, hand in self._by_hand.items()}
        self.researchers = tuple(driven_by.get(robot, set_by.get(robot)) for robot in range(self._robots.size))

    def is_driven(self, robot: int) -> bool:
        """Return True if a robot is driven by hand."""
        return robot in self._by_hand

    def _take(self, item: TeamInput, researcher: str | None = None) -> None:
        match item:
            case DriveManually(robot, _, ticks):
                self._by_hand[robot] = _ManualDrive(ticks, researcher)
            case SendGoal(robot) | CancelGoal(robot):
                self._by_hand.pop(robot, None)
        self._inputs.append(item)

    def tuning(self, robot: int) -> Tuning | None:
        """Return a robot's parameters after all queued requests.

        Return None for real robots, because their parameters cannot be changed here.
        """
        if robot >= len(self._robots.parameters):
            return None
        software, world = self._robots.parameters[robot], self._robots.worlds[robot]
        for item in self._inputs:
            match item:
                case SetSoftwareParameters(number, parameters) if number == robot:
                    software = parameters
                case SetWorldParameters(number, true) if number == robot:
                    world = true
        return Tuning(software, world)

    def _tune(self, robot: int, values: Sequence[tuple[str, ParameterValue]]) -> None:
        before = self.tuning(robot)
        if before is None:
            return
        after = before.changed(values)
        if isinstance(after, ParameterRejection):
            return
        if after.software != before.software:
            self._take(SetSoftwareParameters(robot, after.software))
        if after.world != before.world:
            self._take(SetWorldParameters(robot, after.world))
