"""N robots in one world, and the one order of doing things.

A tick: the world moves by the commands latched in the tick before; every sensor reads that one world; each robot
estimates, plans and chooses a command. What robots tell each other is heard a tick later, so the order in which
they are stepped changes nothing.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from sim.geometry import FloatArray, Pose2
from sim.grid import OccupancyGrid
from sim.localization.amcl import Amcl
from sim.localization.ekf import Ekf
from sim.localization.estimate import Localizer
from sim.localization.truth import Truth
from sim.navigator import Goal, Navigator
from sim.observations import Neighbour, Twist
from sim.parameters import RobotParameters, WorldParameters
from sim.robot import Robot, RobotOutput
from sim.sensors import Sensors, mount_of
from sim.world import Misplaced, World, WorldState, with_charge


@dataclass(frozen=True, slots=True)
class TeamSnapshot:
    """Everything that is true, perceived, believed and done in one tick.

    Attributes:
        tick: which one.
        world: the truth; not for robots, and for people only where the study says so.
        robots: one entry a robot, in the team's order.
        commands: (n, 2) m/s and rad/s that the motors were told in this tick, by navigators or by hand.
    """

    tick: int
    world: WorldState
    robots: tuple[RobotOutput, ...]
    commands: FloatArray


@dataclass(frozen=True, slots=True)
class Go:
    """Send a robot somewhere; a goal under way is given up for it."""

    robot: int
    goal: Goal


@dataclass(frozen=True, slots=True)
class Halt:
    """Withdraw a robot's goal."""

    robot: int


@dataclass(frozen=True, slots=True)
class Drive:
    """Drive by hand: this command instead of the navigator's, for so many ticks."""

    robot: int
    command: Twist
    ticks: int


@dataclass(frozen=True, slots=True)
class SetCharge:
    """The energy that a robot has left."""

    robot: int
    charge: float


@dataclass(frozen=True, slots=True)
class Place:
    """Put a robot somewhere, and tell it so (a restart, not a kidnapping)."""

    robot: int
    base_in_map: Pose2


TeamInput = Go | Halt | Drive | SetCharge | Place

START_COVARIANCE: FloatArray = np.diag([0.05**2, 0.05**2, 0.05**2])
"""How well a robot knows where it is put at the start: people place it on a mark, 5 cm and 3 degrees."""


class Team:
    """The simulation environment: N robots, one world.

    Args:
        grid: the map, true and known to every robot.
        world: what is true of bodies, motors and sensors.
        robots: each robot's own software parameters.
        starts: a start pose a robot, map frame.
        seed: of every chance in here.
        charge: the energy each starts with.

    Raises:
        ValueError: robots and starts differ in number, or a start is not free.
    """

    def __init__(
        self,
        grid: OccupancyGrid,
        world: WorldParameters,
        robots: Sequence[RobotParameters],
        starts: Sequence[Pose2],
        seed: int,
        charge: float,
    ) -> None:
        if len(robots) != len(starts):
            raise ValueError(f"{len(robots)} robots but {len(starts)} start poses")
        self._world = World(grid, world, seed, charge)
        self._sensors = Sensors(grid, world, seed, charge)
        state = self._world.start(starts)
        if isinstance(state, Misplaced):
            raise ValueError(state.sentence)
        self._state = state
        self._commands = np.zeros((len(robots), 2))
        self._driven: dict[int, Drive] = {}
        self._neighbours: tuple[Neighbour, ...] = ()
        footprint = np.array(world.footprint, dtype=np.float64)
        self._robots: list[Robot] = []
        for number, parameters in enumerate(robots):
            localizer = self._localizer(number, parameters, grid, world, seed)
            localizer.start(starts[number], START_COVARIANCE)
            self._robots.append(Robot(number, localizer, Navigator(parameters, footprint, grid, number), footprint))

    def _localizer(
        self, number: int, parameters: RobotParameters, grid: OccupancyGrid, world: WorldParameters, seed: int
    ) -> Localizer:
        if parameters.localization in {"truth", "fake_localization"}:
            truth = parameters.fake_localization
            return Truth(truth, lambda: Pose2(*(float(value) for value in self._state.poses[number])))
        if parameters.localization == "ekf":
            return Ekf(parameters.ekf, grid, mount_of(world.laser))
        return Amcl(parameters.amcl, grid, mount_of(world.laser), seed, f"robot{number + 1}")

    @property
    def size(self) -> int:
        """How many robots."""
        return len(self._robots)

    def step(self, inputs: Sequence[TeamInput] = ()) -> TeamSnapshot:
        """One tick, with what came in since the last one; inputs act in their order."""
        for item in inputs:
            self._take(item)
        self._state = self._world.step(self._state, self._commands)
        outputs = tuple(self._step_robot(robot) for robot in self._robots)
        self._neighbours = tuple(output.neighbour for output in outputs)
        self._commands = np.array([self._command(output) for output in outputs])
        return TeamSnapshot(self._state.tick, self._state, outputs, self._commands)

    def _step_robot(self, robot: Robot) -> RobotOutput:
        others = [neighbour for neighbour in self._neighbours if neighbour.robot != robot.number]
        return robot.step(self._sensors.sense(self._state, robot.number), others)

    def _command(self, output: RobotOutput) -> tuple[float, float]:
        by_hand = self._driven.get(output.neighbour.robot)
        if by_hand is None:
            return output.navigation.command.linear, output.navigation.command.angular
        if by_hand.ticks <= 1:
            del self._driven[by_hand.robot]
        else:
            self._driven[by_hand.robot] = Drive(by_hand.robot, by_hand.command, by_hand.ticks - 1)
        return by_hand.command.linear, by_hand.command.angular

    def _take(self, item: TeamInput) -> None:
        match item:
            case Go(robot, goal):
                self._driven.pop(robot, None)
                self._robots[robot].navigator.go(goal)
            case Halt(robot):
                self._driven.pop(robot, None)
                self._robots[robot].navigator.cancel()
            case Drive(robot):
                self._robots[robot].navigator.cancel()
                self._driven[robot] = item
            case SetCharge(robot, charge):
                self._state = with_charge(self._state, robot, charge)
            case Place(robot, pose):
                placed = self._world.place(self._state, robot, pose)
                if isinstance(placed, WorldState):
                    self._state = placed
                    self._robots[robot].localizer.start(pose, START_COVARIANCE)
