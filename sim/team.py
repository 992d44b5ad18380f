"""A team of robots in one world, and the order of events within a tick.

In each tick, the world moves according to the commands of the previous tick. Then all sensors read this world, and each
robot estimates, plans and chooses a command. Robots receive broadcasts of others one tick later, so the order in which
robots are stepped has no effect.
"""

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from sim.broadcasts import Broadcasts
from sim.common.geometry import Pose2
from sim.common.grid import OccupancyGrid
from sim.common.observations import Claim, Scan
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
from sim.robot.localization.estimate import Localizer
from sim.robot.localization.fake_localization import FakeLocalization
from sim.robot.navigator.move_base import Navigator
from sim.robot.navigator.navigation import Navigation
from sim.robot.navigator.recovery import RecoveryProgress
from sim.robot.software import Robot, RobotOutput
from sim.snapshot import TeamOutputs, TeamSnapshot
from sim.world.physics import Misplaced, World, WorldState, with_charge, with_noise, with_thing, without_thing
from sim.world.sensors import Sensors, mount_of

START_COVARIANCE: FloatArray = np.diag([0.05 * 0.05, 0.05 * 0.05, 0.05 * 0.05])
"""Covariance of the start pose that a robot gets. People place robots on a mark with 5 cm and 3 degrees of error."""


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
        self._dead: frozenset[int] = frozenset()
        # Dead robots, and robots revived since the last tick. The clocks of their software stand still.
        self._paused: set[int] = set()
        self._outputs: Sequence[RobotOutput] = ()
        # Last outputs, without data that are valid only in the tick of their step. Empty before the first tick.
        self._lasting: list[RobotOutput] = []
        self._claims: Mapping[int, Claim | None] = {}
        # Broadcasts of the last tick, and of the tick before.
        self._heard = self._heard_before = Broadcasts(None, {})
        # True for robots that are stepped; dead robots are not.
        self._running = np.ones(len(robots), dtype=np.bool_)
        # Next tick in which each robot has work, apart from scans.
        self._next_due = np.zeros(len(robots), dtype=np.int64)
        # Robots whose commands came from a person in the last tick.
        self._were_driven: set[int] = set()
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
        return None if not self._outputs or robot in self._dead else self._outputs[robot].navigation

    @property
    def worlds(self) -> tuple[WorldParameters, ...]:
        """Current true parameters of each robot's body, motors and sensors."""
        return tuple(self._worlds)

    def believed_pose(self, robot: int) -> Pose2:
        """Return a robot's estimate of its pose in the map. Before its first tick, it is the true start pose."""
        if not self._outputs:
            return Pose2(*self._state.poses[robot].tolist())
        return self._outputs[robot].estimate.base_in_map

    def _awake(self, robot: int, tick: int | None = None) -> Robot:
        """Return the software of a robot, after its clock has been set to a tick; by default, the present tick."""
        if robot not in self._paused:
            self._robots[robot].pass_to(self._state.tick if tick is None else tick)
        return self._robots[robot]

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
        return self._awake(robot).navigator.make_plan(base_in_map, start or base_in_map, goal, tolerance)

    def costmap(self, robot: int, name: CostmapName) -> RobotCostmap:
        """Return a costmap of a robot, with the robot's footprint. The simulation does not change.

        Args:
            robot: index of the robot.
            name: name of the costmap.
        """
        return self._awake(robot).navigator.costmap(name, self.believed_pose(robot))

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
        return TeamSnapshot(tick, self._state, outputs, self._commands, self._dead)

    def _step_robots(self, tick: int, requested: bool) -> TeamOutputs:
        """Step the robots that have work in this tick.

        After a request, all robots are stepped. They are also stepped if the set of robots that broadcast, or that ask
        others to clear a path, has changed.
        """
        heard, before, state = self._heard, self._heard_before, self._state
        if heard.claims.keys() != before.claims.keys():
            for index in np.flatnonzero(self._running).tolist():
                self._awake(index, tick - 1).rejoin(before.others(index))
        due, all_due = self._running, requested or heard.claims != before.claims
        if not all_due:
            due = due & ((self._next_due <= tick) | self._sensors.scanning(tick, self.size))
        stepped: dict[int, RobotOutput] = {}
        scans: dict[int, Scan] = {}
        for index in np.flatnonzero(due).tolist():
            robot = self._awake(index, tick - 1)
            if not all_due and robot.is_at_rest(tick, state.odom_poses[index].tolist()):
                scans[index] = scan = self._sensors.scan(state, index)
                robot.take_in(scan, heard.near)
            else:
                stepped[index] = robot.step(self._sensors.sense(state, index), heard.others(index))
        self._keep(stepped, requested)
        outputs = TeamOutputs(stepped, self._lasting, self._dead, scans, state, self._corrections, self._sensors.sense)
        self._heard_before, self._heard = heard, Broadcasts(outputs, self._claims)
        self._paused = set(self._dead)
        self._outputs = outputs
        return outputs

    def _keep(self, stepped: Mapping[int, RobotOutput], requested: bool) -> None:
        """Record what lasts after the steps of this tick. Arrays and lists of previous ticks do not change."""
        if stepped:
            self._lasting = list(self._lasting) or list(stepped.values())
        corrections, regroup = self._corrections, requested
        for index, output in stepped.items():
            robot = self._robots[index]
            is_dead = index in self._dead
            self._lasting[index] = output if is_dead or robot.lasting is None else robot.lasting
            self._running[index] = not is_dead
            self._next_due[index] = robot.next_due
            correction = output.estimate.odom_in_map
            pose = [correction.x, correction.y, correction.theta]
            if pose != corrections[index].tolist():
                if corrections is self._corrections:
                    corrections = corrections.copy()
                corrections[index] = pose
            heard = not is_dead and not robot.lost
            was = self._claims.get(index)
            regroup = regroup or heard != (index in self._claims) or (heard and output.navigation.claim != was)
        self._corrections = corrections
        if regroup:
            # Neither dead nor lost robots broadcast.
            self._claims = {
                robot.index: self._lasting[robot.index].navigation.claim
                for robot in self._robots
                if robot.index not in self._dead and not robot.lost
            }
        driven, self._were_driven = self._driven_by_hand.keys() | self._were_driven, set(self._driven_by_hand)
        if stepped or driven:
            self._commands = self._commands.copy()
        for index in stepped.keys() | driven:
            self._commands[index] = self._command(index)

    def _command(self, robot: int) -> tuple[float, float]:
        if robot in self._dead:
            return 0.0, 0.0
        by_hand = self._driven_by_hand.get(robot)
        if by_hand is None:
            command = self._lasting[robot].navigation.command
            return command.linear, command.angular
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
        self._awake(robot).configure(parameters)
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
                self._awake(robot).navigator.go(goal)
            case CancelGoal(robot):
                self._driven_by_hand.pop(robot, None)
                self._awake(robot).navigator.cancel()
            case DriveManually(robot):
                self._awake(robot).navigator.cancel()
                self._driven_by_hand[robot] = item
            case SetPoseEstimate(robot, pose, covariance):
                self._awake(robot).localizer.start(pose, covariance)
                self._awake(robot).navigator.replan()
            case GlobalLocalization(robot):
                self._awake(robot).localizer.globalize()
            case NomotionUpdate(robot):
                self._awake(robot).localizer.request_update()
            case ClearCostmaps(robot):
                self._awake(robot).navigator.clear_costmaps()
            case ClearCostmapRegion(robot, name, side, middle, outside):
                middle = middle or self.believed_pose(robot)
                self._awake(robot).navigator.clear_region(name, middle, side, outside=outside)
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
                    self._awake(robot).localizer.start(pose, START_COVARIANCE)
            case PutThing(thing):
                self._state = with_thing(self._state, thing)
            case RemoveThing(name):
                self._state = without_thing(self._state, name)
            case KidnapRobot(robot):
                self._carried[robot] = item
            case KillRobot(robot):
                self._driven_by_hand.pop(robot, None)
                self._awake(robot).navigator.cancel()
                self._dead |= {robot}
                self._paused.add(robot)
                if self._outputs:
                    # From now on, the last output is repeated for the dead robot. So it must not end a goal again.
                    output = self._outputs[robot]
                    last = replace(output.navigation, result=None, global_costmap=None, local_costmap=None, fault="")
                    self._lasting = list(self._lasting)
                    self._lasting[robot] = RobotOutput(output.observations, output.estimate, last, output.neighbour)
                    self._running[robot] = False
                # The last snapshot still uses the old array, so it must not change.
                self._commands = self._commands.copy()
                self._commands[robot] = 0.0
            case ReviveRobot(robot):
                self._dead -= {robot}
                self._running[robot] = True


def _check_live(robot: int, before: P, after: P) -> None:
    """Raise ValueError if parameters of a robot differ that must not change while the robot runs."""
    fixed = fixed_differences(before, after)
    if fixed:
        raise ValueError(f"robot {robot}: these parameters cannot change while it runs: {', '.join(fixed)}")
