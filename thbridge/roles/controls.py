"""The robots' controls: what is asked of them beside the game, and what becomes of it."""

from sim.observations import TICKS_PER_SECOND
from sim.parameters import RobotParameters
from sim.parameters.reconfiguration import Rejected
from sim.team import Configure, Drive, Go, Halt, Localize, PutThing, RemoveThing, TeamInput, TeamSnapshot
from thbridge.roles.requests import RobotRequest, SetParameters, with_values
from thbridge.roles.robots import Robots
from thbridge.ros.actionlib import ActionRequest, MoveBaseServer
from thbridge.ros.records import CancelRequest, GoalRequest, InitialPose, SimpleGoal, VelocityCommand

HAND_TICKS = TICKS_PER_SECOND // 2
"""Ticks that one command of somebody who drives by hand lasts; then the base stops, as real ones do."""


class Controls:
    """Takes requests between two ticks of a team, and turns them into its inputs for the next.

    Args:
        robots: somebody else steps them.
    """

    def __init__(self, robots: Robots) -> None:
        self._robots = robots
        self._servers = tuple(MoveBaseServer(robot) for robot in range(robots.size))
        self._actions: list[ActionRequest] = []
        self._inputs: list[TeamInput] = []
        self._by_hand: dict[int, int] = {}

    def ask(self, request: RobotRequest) -> None:
        """Do this in the next tick; requests to robots that there are not are forgotten."""
        if not (isinstance(request, PutThing | RemoveThing) or 0 <= request.robot < self._robots.size):
            return
        match request:
            case GoalRequest() | SimpleGoal() | CancelRequest():
                self._actions.append(request)
            case VelocityCommand(robot, twist):
                self._take(Drive(robot, twist, HAND_TICKS))
            case InitialPose(robot, base_in_map, covariance):
                self._take(Localize(robot, base_in_map, covariance))
            case SetParameters(robot, values) if robot < len(self._robots.parameters):
                changed = with_values(self._software(robot), values)
                if not isinstance(changed, Rejected):
                    self._take(Configure(robot, changed))
            case SetParameters():
                pass  # Robots of others have their own.
            case _:
                self._take(request)

    def take_inputs(self, tick: int) -> list[TeamInput]:
        """What the team shall do in its next step, that of this tick: as asked; then what clients' goals come to."""
        actions, self._actions = self._actions, []
        for robot, server in enumerate(self._servers):
            for decided in server.take(tick, [action for action in actions if action.robot == robot]):
                self._take(decided)
        inputs, self._inputs = self._inputs, []
        return inputs

    def follow(self, snapshot: TeamSnapshot) -> None:
        """See what became of it."""
        self._by_hand = {robot: left - 1 for robot, left in self._by_hand.items() if left > 1}
        for robot, (server, output) in enumerate(zip(self._servers, snapshot.robots, strict=True)):
            navigation = None if robot in snapshot.dead else output.navigation
            server.follow(snapshot.tick, navigation, output.estimate.base_in_map)

    def is_driven(self, robot: int) -> bool:
        """Whether somebody drives a robot by hand just now."""
        return robot in self._by_hand

    def _take(self, item: TeamInput) -> None:
        match item:
            case Drive(robot, _, ticks):
                self._by_hand[robot] = ticks
            case Go(robot) | Halt(robot):
                self._by_hand.pop(robot, None)
        self._inputs.append(item)

    def _software(self, robot: int) -> RobotParameters:
        """A robot's parameters as they will be when what has been asked so far is done."""
        asked = [item.parameters for item in self._inputs if isinstance(item, Configure) and item.robot == robot]
        return asked[-1] if asked else self._robots.parameters[robot]
