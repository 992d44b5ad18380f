"""A team of robots in one world, and the order of events within a tick.

In each tick, the world moves according to the commands of the previous tick. Then all sensors read this world, and each
robot estimates, plans and chooses a command. Robots receive broadcasts of others one tick later, so the order in which
robots are stepped has no effect.
"""

from bisect import bisect_left
from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import cached_property, partial

import numpy as np

from sim.common.frozen import frozen
from sim.common.geometry import Pose2
from sim.common.grid import OccupancyGrid
from sim.common.observations import Neighbour
from sim.common.robot_numbers import namespace_of
from sim.inputs import (
    CancelGoal,
    ClearCostmapRegion,
    ClearCostmaps,
    DriveManually,
    GlobalLocalization,
    KidnapRobot,
    KillRobot,
    NomotionUpdate,
    PlaceRobot,
    PutThing,
    RemoveThing,
    ReviveRobot,
    ScheduledInput,
    SendGoal,
    SetCharge,
    SetPoseEstimate,
    SetSoftwareParameters,
    SetWorldParameters,
    TeamInput,
)
from sim.numerics import noise
from sim.numerics.float_array import FloatArray
from sim.parameters import RobotParameters, WorldParameters
from sim.parameters.reconfiguration import P, fixed_differences
from sim.robot.costmap.robot_costmap import RobotCostmap
from sim.robot.costmap.view import CostmapName
from sim.robot.global_planning.path import PlanRefusal
from sim.robot.global_planning.wave import Workspace
from sim.robot.installed_parts import InstalledParts
from sim.robot.localization.amcl import Amcl
from sim.robot.localization.estimate import Localizer, propagated
from sim.robot.localization.fake_localization import FakeLocalization
from sim.robot.navigator.move_base import Navigator
from sim.robot.navigator.navigation import Navigation
from sim.robot.navigator.recovery import RecoveryProgress
from sim.robot.software import Robot, RobotOutput
from sim.world.physics import Misplaced, World, WorldState, with_charge, with_noise, with_thing, without_thing
from sim.world.sensors import Sensors, mount_of


@frozen()
class TeamSnapshot:
    """State of a team in one tick: truth, observations, beliefs and commands.

    Attributes:
        tick: the present tick.
        world: the truth. Robots never get it, and people get it only if the study permits this. None for real robots,
            because their truth is unknown.
        robots: outputs of the robots, in the team's order.
        commands: (n, 2) m/s and rad/s given to the motors in this tick, by navigators or by hand.
        dead: indices of dead robots. They perceive nothing, broadcast nothing and do nothing. Their entries are
            from the last tick before their death.
    """

    tick: int
    world: WorldState | None
    robots: tuple[RobotOutput, ...]
    commands: FloatArray
    dead: frozenset[int] = frozenset()

    @property
    def truth(self) -> WorldState:
        """The truth about simulated robots.

        Raises:
            ValueError: these are real robots.
        """
        if self.world is None:
            raise ValueError("the true state of real robots is unknown")
        return self.world


START_COVARIANCE: FloatArray = np.diag([0.05 * 0.05, 0.05 * 0.05, 0.05 * 0.05])
"""Covariance of the start pose that a robot gets. People place robots on a mark with 5 cm and 3 degrees of error."""


class _Broadcasts:
    """Broadcasts of robots in one tick.

    Args:
        outputs: outputs of the robots that broadcast, by index, in the team's order.

    Attributes:
        claims: claim of each robot, by index.
    """

    def __init__(self, outputs: Mapping[int, RobotOutput]) -> None:
        self.claims = {robot: output.navigation.claim for robot, output in outputs.items()}
        self._robots = list(outputs)
        self._outputs = outputs

    @cached_property
    def _all(self) -> tuple[Neighbour, ...]:
        return tuple(output.neighbour for output in self._outputs.values())

    def others(self, robot: int) -> tuple[Neighbour, ...]:
        """Return the broadcasts of the other robots. This is fast, because many robots call it in each tick."""
        heard = self._all
        own = bisect_left(self._robots, robot)
        return heard[:own] + heard[own + 1 :] if robot in self.claims else heard


class Team:
    """The simulation: a team of robots in one world.

    Args:
        grid: the map that every robot knows.
        world: the truth about bodies, motors and sensors.
        robots: software parameters of each robot.
        starts: start pose of each robot, map frame.
        seed: seed of all noise in the simulation.
        charge: initial energy of each robot.
        schedule: inputs known beforehand. They are applied before other inputs of the same tick.
        true_grid: the true map, if it differs from the map that robots know.
        parts: installed parts that the parameters may name. If None, they may name no installed part.

    Raises:
        ValueError: the number of starts differs from that of the robots, a start is not free, or parameters name a part
            that is not in `parts`.
    """

    def __init__(
        self,
        grid: OccupancyGrid,
        world: WorldParameters,
        robots: Sequence[RobotParameters],
        starts: Sequence[Pose2],
        seed: int,
        charge: float,
        schedule: Sequence[ScheduledInput] = (),
        true_grid: OccupancyGrid | None = None,
        parts: InstalledParts | None = None,
    ) -> None:
        parts = parts or InstalledParts()
        for parameters in robots:
            parts.check(parameters)
        if len(robots) != len(starts):
            raise ValueError(f"{len(robots)} robots need {len(robots)} start poses, not {len(starts)}")
        self._world = World(true_grid or grid, world, seed, charge)
        self._sensors = Sensors(true_grid or grid, world, seed, charge)
        self._parameters = list(robots)
        self._worlds = [world] * len(robots)
        state = self._world.start(starts)
        if isinstance(state, Misplaced):
            raise ValueError(state.sentence)
        self._state = state
        self._commands = np.zeros((len(robots), 2))
        self._driven_by_hand: dict[int, DriveManually] = {}
        self._schedule = sorted(schedule, key=lambda timed: timed.tick)
        self._carried: dict[int, KidnapRobot] = {}
        self._dead: set[int] = set()
        self._outputs: list[RobotOutput | None] = [None] * len(robots)
        # Broadcasts of the last tick, and of the tick before.
        self._heard = self._heard_before = _Broadcasts({})
        self._corrections = np.zeros((len(robots), 3))
        footprint = np.array(world.footprint, dtype=np.float64)
        # Robots plan one after another. So one workspace is enough, and it stays in the processor's cache.
        space = Workspace(*grid.cells.shape)
        self._robots: list[Robot] = []
        for index, parameters in enumerate(robots):
            localizer = self._localizer(index, parameters, grid, world, seed, parts)
            localizer.start(starts[index], START_COVARIANCE)
            navigator = Navigator(
                parameters,
                footprint,
                grid,
                index,
                space,
                int(noise.key(seed, namespace_of(index))),
                parts.recoveries,
                parts.planners,
            )
            self._robots.append(Robot(index, localizer, navigator, footprint))

    def _localizer(
        self,
        index: int,
        parameters: RobotParameters,
        grid: OccupancyGrid,
        world: WorldParameters,
        seed: int,
        parts: InstalledParts,
    ) -> Localizer:
        if parameters.localization in {"truth", "fake_localization"}:
            truth = parameters.fake_localization
            return FakeLocalization(truth, lambda: Pose2(*(float(value) for value in self._state.poses[index])))
        if parameters.localization in {"ekf", "ukf"}:
            # Imported here, because filterpy loads slowly and most teams do not need it.
            from sim.robot.localization.ekf import KalmanLocalizer  # noqa: PLC0415

            return KalmanLocalizer(parameters, grid, mount_of(world.laser))
        if (factory := parts.localizers.get(parameters.localization)) is not None:
            own = int(noise.key(seed, namespace_of(index), "localizer"))
            return factory(parameters, grid, mount_of(world.laser), own)
        return Amcl(parameters.amcl, grid, mount_of(world.laser), seed, namespace_of(index))

    @property
    def size(self) -> int:
        """Number of robots."""
        return len(self._robots)

    @property
    def parameters(self) -> tuple[RobotParameters, ...]:
        """Current parameters of each robot's software."""
        return tuple(self._parameters)

    @property
    def recoveries(self) -> tuple[RecoveryProgress, ...]:
        """Progress of each robot's recovery."""
        return tuple(robot.navigator.recovery for robot in self._robots)

    def navigation(self, robot: int) -> Navigation | None:
        """Return what a robot's navigator did in the present tick; None before the first tick, and for a dead robot."""
        output = self._outputs[robot]
        return None if output is None or robot in self._dead else output.navigation

    @property
    def worlds(self) -> tuple[WorldParameters, ...]:
        """Current true parameters of each robot's body, motors and sensors."""
        return tuple(self._worlds)

    def believed_pose(self, robot: int) -> Pose2:
        """Return a robot's estimate of its pose in the map. Before its first tick, it is the true start pose."""
        output = self._outputs[robot]
        return Pose2(*self._state.poses[robot].tolist()) if output is None else output.estimate.base_in_map

    def make_plan(self, robot: int, start: Pose2 | None, goal: Pose2, tolerance: float) -> FloatArray | PlanRefusal:
        """Make a plan for a robot on request (ROS: move_base/make_plan). The simulation does not change.

        Args:
            robot: index of the robot.
            start: pose at the beginning. If None, the robot's present pose estimate.
            goal: pose at the end.
            tolerance: meters along x and along y by which the plan may miss a goal that is unreachable.

        Returns:
            (m, 3) poses in the map, or the reason why no plan exists.
        """
        base_in_map = self.believed_pose(robot)
        return self._robots[robot].navigator.make_plan(base_in_map, start or base_in_map, goal, tolerance)

    def costmap(self, robot: int, name: CostmapName) -> RobotCostmap:
        """Return a costmap of a robot, with the robot's footprint. The simulation does not change.

        Args:
            robot: index of the robot.
            name: name of the costmap.
        """
        return self._robots[robot].navigator.costmap(name, self.believed_pose(robot))

    def step(self, inputs: Sequence[TeamInput] = ()) -> TeamSnapshot:
        """Step by one tick. Inputs received since the last tick are applied first, in their order.

        Raises:
            ValueError: an input changes parameters that cannot change while a robot runs.
        """
        tick = self._state.tick + 1
        requested = bool(inputs or self._carried)
        while self._schedule and self._schedule[0].tick <= tick:
            self._take(self._schedule.pop(0).input)
            requested = True
        for item in inputs:
            self._take(item)
        for robot in list(self._carried):
            self._set_down(self._carried[robot])
        self._state = self._world.step(self._state, self._commands)
        outputs = self._step_robots(tick, requested)
        self._commands = np.array([self._command(robot, output) for robot, output in enumerate(outputs)])
        return TeamSnapshot(tick, self._state, outputs, self._commands, frozenset(self._dead))

    def _step_robots(self, tick: int, requested: bool) -> tuple[RobotOutput, ...]:
        """Step the robots that have work in this tick, and propagate the outputs of the other robots.

        After a request, all robots are stepped. They are also stepped if the set of robots that broadcast, or that ask
        others to clear a path, has changed.
        """
        heard, before, state = self._heard, self._heard_before, self._state
        all_due = requested or heard.claims != before.claims
        regroup = heard.claims.keys() != before.claims.keys()
        believed: list[list[float]] = []
        twists: list[list[float]] = []
        for robot in self._robots:
            index = robot.index
            if index in self._dead and self._outputs[index] is not None:
                continue
            if regroup:
                robot.rejoin(before.others(index))
            if all_due or tick >= robot.next_due or self._sensors.scan_due(tick, index):
                output = robot.step(self._sensors.sense(state, index), heard.others(index))
                correction = output.estimate.odom_in_map
                self._corrections[index] = correction.x, correction.y, correction.theta
            else:
                if not believed:
                    believed = propagated(self._corrections, state.odom_poses).tolist()
                    twists = state.odom_twists.tolist()
                sense = partial(self._sensors.sense, state, index)
                output = robot.skip(tick, believed[index], twists[index], sense)
            self._outputs[index] = output
        outputs = [output for output in self._outputs if output is not None]
        # Neither dead nor lost robots broadcast.
        broadcasting = [robot for robot in self._robots if robot.index not in self._dead and not robot.lost]
        self._heard_before = heard
        self._heard = _Broadcasts({robot.index: outputs[robot.index] for robot in broadcasting})
        return tuple(outputs)

    def _command(self, robot: int, output: RobotOutput) -> tuple[float, float]:
        if robot in self._dead:
            return 0.0, 0.0
        by_hand = self._driven_by_hand.get(robot)
        if by_hand is None:
            return output.navigation.command.linear, output.navigation.command.angular
        if by_hand.ticks <= 1:
            del self._driven_by_hand[by_hand.robot]
        else:
            self._driven_by_hand[by_hand.robot] = DriveManually(by_hand.robot, by_hand.command, by_hand.ticks - 1)
        return by_hand.command.linear, by_hand.command.angular

    def _set_down(self, carry: KidnapRobot) -> None:
        placed = self._world.place(self._state, carry.robot, carry.base_in_map)
        if isinstance(placed, WorldState):
            self._state = placed
        elif placed.reason in {"robot", "thing"}:
            # They may move away, so the next tick tries again. A wall stays, so the attempt ends.
            return
        del self._carried[carry.robot]

    def _disturb(self, robot: int, parameters: WorldParameters) -> None:
        _check_live(robot, self._worlds[robot], parameters)
        self._worlds[robot] = parameters
        self._state = with_noise(self._state, self._worlds)

    def _configure(self, robot: int, parameters: RobotParameters) -> None:
        _check_live(robot, self._parameters[robot], parameters)
        self._robots[robot].configure(parameters)
        self._parameters[robot] = parameters

    def _take(self, item: TeamInput) -> None:
        match item:
            case (
                SendGoal(robot)
                | CancelGoal(robot)
                | DriveManually(robot)
                | SetPoseEstimate(robot)
                | GlobalLocalization(robot)
                | NomotionUpdate(robot)
                | ClearCostmaps(robot)
                | ClearCostmapRegion(robot)
                | SetSoftwareParameters(robot)
            ) if robot in self._dead:
                pass  # The software of a dead robot ignores requests.
            case SendGoal(robot, goal):
                self._driven_by_hand.pop(robot, None)
                self._robots[robot].navigator.go(goal)
            case CancelGoal(robot):
                self._driven_by_hand.pop(robot, None)
                self._robots[robot].navigator.cancel()
            case DriveManually(robot):
                self._robots[robot].navigator.cancel()
                self._driven_by_hand[robot] = item
            case SetPoseEstimate(robot, pose, covariance):
                self._robots[robot].localizer.start(pose, covariance)
                self._robots[robot].navigator.replan()
            case GlobalLocalization(robot):
                self._robots[robot].localizer.globalize()
            case NomotionUpdate(robot):
                self._robots[robot].localizer.request_update()
            case ClearCostmaps(robot):
                self._robots[robot].navigator.clear_costmaps()
            case ClearCostmapRegion(robot, name, side, middle, outside):
                middle = middle or self.believed_pose(robot)
                self._robots[robot].navigator.clear_region(name, middle, side, outside=outside)
            case SetSoftwareParameters(robot, software):
                self._configure(robot, software)
            case SetWorldParameters(robot, true):
                self._disturb(robot, true)
            case SetCharge(robot, charge):
                self._state = with_charge(self._state, robot, charge)
            case PlaceRobot(robot, pose):
                placed = self._world.place(self._state, robot, pose)
                if isinstance(placed, WorldState):
                    self._state = placed
                    self._robots[robot].localizer.start(pose, START_COVARIANCE)
            case PutThing(thing):
                self._state = with_thing(self._state, thing)
            case RemoveThing(name):
                self._state = without_thing(self._state, name)
            case KidnapRobot(robot):
                self._carried[robot] = item
            case KillRobot(robot):
                self._driven_by_hand.pop(robot, None)
                self._robots[robot].navigator.cancel()
                self._dead.add(robot)
                if (output := self._outputs[robot]) is not None:
                    # From now on, the last output is repeated for the dead robot. So it must not end a goal again.
                    last = replace(output.navigation, result=None, global_costmap=None, local_costmap=None, fault="")
                    self._outputs[robot] = RobotOutput(output.observations, output.estimate, last, output.neighbour)
                # The last snapshot still uses the old array, so it must not change.
                self._commands = self._commands.copy()
                self._commands[robot] = 0.0
            case ReviveRobot(robot):
                self._dead.discard(robot)


def _check_live(robot: int, before: P, after: P) -> None:
    """Raise ValueError if parameters of a robot differ that must not change while the robot runs."""
    fixed = fixed_differences(before, after)
    if fixed:
        raise ValueError(f"robot {robot}: these parameters cannot change while it runs: {', '.join(fixed)}")
