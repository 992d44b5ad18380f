"""The navigator: from a goal to velocity commands (move_base).

The navigator plans to a goal (`global_planning.itinerary_planner`) and follows the plan as far as the right of way
allows (`navigator.follower`). The goal ends as GoalReached, NoPath or Cancelled. If standing robots leave no path, the
robot broadcasts the path that it wants. Robots on this path drive aside if they rest or have younger goals. If the
robot sees an obstacle on its path, it immediately plans around the obstacle. If there is no path, it waits and then
tries the recovery behaviors. In any case, a goal is given up if its remaining path has not become shorter for
PROGRESS_TIMEOUT seconds. So every goal ends in bounded time. `navigator.states` contains the states and the table of
all transitions.

Source: ros-planning/navigation, move_base/src/move_base.cpp.
Differences from ROS: plans and commands are made in the tick when they are due, without threads. Only the search for a
path on a large map takes several ticks, with a part of the map in each. Robots take turns in planning. If the map alone
has no path to a goal, the goal is given up without recovery. While a robot waits for its right of way, it does not
count as oscillating, and the time of controller_patience does not run. A robot that drives in one place for
STAY_TIMEOUT seconds tries a recovery behavior even with `oscillation_timeout: 0`.
"""

from collections.abc import Mapping, Sequence
from operator import attrgetter

import numpy as np

from sim.common.geometry import Pose2
from sim.common.grid import OccupancyGrid
from sim.common.observations import STANDSTILL, TICKS_PER_SECOND, Neighbour, Scan, Twist, next_turn
from sim.numerics import noise
from sim.numerics.float_array import FloatArray
from sim.parameters import GlobalPlannerParameters, NavfnParameters, RobotParameters
from sim.robot.costmap.obstacle import CostmapObservation
from sim.robot.costmap.robot_costmap import RobotCostmap
from sim.robot.costmap.robots import neighbours_reaching
from sim.robot.costmap.view import CostmapName
from sim.robot.global_planning.itinerary_planner import ItineraryPlanner
from sim.robot.global_planning.make_plan import make_plan
from sim.robot.global_planning.path import PlannerFactory, PlanRefusal, RobotPathPlanner
from sim.robot.global_planning.planners import global_planner
from sim.robot.global_planning.wave import Workspace
from sim.robot.navigator.clearing_cycle import ClearingCycle
from sim.robot.navigator.control_cycle import ControlCycle
from sim.robot.navigator.controller import Controller
from sim.robot.navigator.costmaps import Costmaps
from sim.robot.navigator.follower import NO_POSES, NO_TIMES, STANDING
from sim.robot.navigator.goal_execution import GoalExecution
from sim.robot.navigator.goals import Goal, NoPath
from sim.robot.navigator.making_way import MakingWay
from sim.robot.navigator.navigation import Navigation, NavigatorState
from sim.robot.navigator.planning_cycle import PlanningCycle
from sim.robot.navigator.recovery import (
    RecoveryFactory,
    RecoveryProgress,
)
from sim.robot.navigator.rotated_map import RotatedMap
from sim.robot.navigator.stale_neighbours import StaleNeighbours
from sim.robot.navigator.states import (
    Clearing,
    Controlling,
    Idle,
    Lost,
    Planning,
)
from sim.robot.part_failure import PartFailed

_CLAIM = attrgetter("claim")


class Navigator:
    """The navigator of one robot.

    Args:
        parameters: parameters of this robot's software.
        footprint: (n, 2) corners of the robot's body, base frame, meters.
        static: the map.
        robot: index of the robot in the team.
        space: workspace for plans. It may be shared, because nothing is kept in it between plans. If None, the
            navigator makes its own workspace.
        seed: random seed of recovery behaviors.
        recoveries: installed recovery behaviors, by name.
        planners: installed global planners, by name.
    """

    def __init__(
        self,
        parameters: RobotParameters,
        footprint: FloatArray,
        static: OccupancyGrid,
        robot: int = 0,
        space: Workspace | None = None,
        seed: int = 0,
        recoveries: Mapping[str, RecoveryFactory] | None = None,
        planners: Mapping[str, PlannerFactory] | None = None,
    ) -> None:
        self._seed = seed
        self._planners = planners or {}
        self._rotated = RotatedMap(static)
        static = self._rotated.grid
        self._parameters = parameters
        self._robot = robot
        self._tick = -1
        self._costmaps = Costmaps(parameters, footprint, self._rotated, robot)
        self._space = space
        self._itinerary_planner = ItineraryPlanner(
            static,
            self._costmaps.global_costmap,
            parameters.global_costmap.inflation_layer,
            self._planner(parameters, space),
        )
        self._controller = Controller(parameters, static, self._costmaps, robot)
        circumscribed = self._costmaps.global_costmap.circumscribed_radius
        self._execution = GoalExecution(parameters.move_base, circumscribed, self._itinerary_planner)
        self._clearing = ClearingCycle(
            self._execution, self._controller, self._costmaps, self._rotated, recoveries or {}, seed
        )
        self._planning = PlanningCycle(
            self._execution, self._itinerary_planner, self._controller, self._clearing, self._rotated, robot
        )
        self._controlling = ControlCycle(self._execution, self._controller)
        self._stale = StaleNeighbours()
        self._making_way = MakingWay()
        self._seen: CostmapObservation | None = None

    def go(self, goal: Goal) -> None:
        """Accept a goal. The present goal ends as Cancelled."""
        self._execution.go(goal, self._tick)

    def cancel(self) -> None:
        """Cancel the present goal, if any. It ends as Cancelled, and the robot stops."""
        self._execution.cancel()

    def replan(self) -> None:
        """Plan again to the present goal, because the robot's pose was set."""
        self._execution.replan(self._tick)

    def clear_costmaps(self) -> None:
        """Forget what the laser has seen."""
        self._costmaps.clear()

    def clear_region(self, name: CostmapName, middle: Pose2, side: float | None, *, outside: bool) -> None:
        """Let one costmap forget what the laser has seen in a region; see `Costmaps.clear_region`."""
        place = self._rotated.pose_in_grid(middle)
        self._costmaps.clear_region(name, place.x, place.y, side, outside=outside)

    def configure(self, parameters: RobotParameters) -> None:
        """Continue with these parameters (ROS: dynamic_reconfigure). Keep goal, plan and seen obstacles."""
        before = self._parameters
        if parameters == before:
            return
        self._parameters = parameters
        self._costmaps.configure(parameters)
        self._planning.forget_free_path()
        if parameters.global_costmap != before.global_costmap or _plans_by(parameters) != _plans_by(before):
            self._itinerary_planner.configure(
                parameters.global_costmap.inflation_layer, self._planner(parameters, self._space)
            )
        self._controller.configure(parameters)
        self._execution.configure(parameters.move_base, self._costmaps.global_costmap.circumscribed_radius)

    def costmap(self, name: CostmapName, base_in_map: Pose2) -> RobotCostmap:
        """Return a costmap with the present observations. The robot does not change.

        Args:
            name: name of the costmap.
            base_in_map: pose estimate of the robot.
        """
        pose = self._rotated.pose_in_grid(base_in_map)
        return self._costmaps.at(name, self._tick, pose, self._stale, self._controller.pending)

    def make_plan(self, base_in_map: Pose2, start: Pose2, goal: Pose2, tolerance: float) -> FloatArray | PlanRefusal:
        """Make a plan on request (ROS: move_base/make_plan). The robot does not change.

        Args:
            base_in_map: pose estimate of the robot.
            start: pose at the beginning.
            goal: pose at the end.
            tolerance: meters along x and along y by which the plan may miss a goal that is unreachable.

        Returns:
            (m, 3) poses in the map, or the reason why no plan exists.
        """
        turned = self._rotated
        place = turned.pose_in_grid(base_in_map)
        costs, frame = self._costmaps.global_costmap.as_updated(place.x, place.y, self._stale.known(self._tick))
        adds = self._parameters.move_base.make_plan_add_unreachable_goal
        # Use another workspace, because a search may be running in the usual workspace.
        start, goal = turned.pose_in_grid(start), turned.pose_in_grid(goal)
        try:
            poses = make_plan(self._planner(self._parameters), costs, frame, start, goal, tolerance, adds)
        except PartFailed as failed:
            return PlanRefusal("no_way", str(failed))
        return poses if isinstance(poses, PlanRefusal) else turned.poses_in_map(poses)

    def _planner(self, parameters: RobotParameters, space: Workspace | None = None) -> RobotPathPlanner:
        """Return the global planner for these parameters. See `Navigator` for `space`."""
        if (factory := self._planners.get(parameters.move_base.base_global_planner)) is not None:
            return factory(parameters, int(noise.key(self._seed, "global planner")))
        return global_planner(*_plans_by(parameters), space)

    def step(
        self,
        tick: int,
        base_in_map: Pose2,
        twist: Twist,
        scan: Scan | None,
        neighbours: Sequence[Neighbour],
        lost: bool = False,
    ) -> Navigation:
        """Run one tick.

        Args:
            tick: the present tick.
            base_in_map: pose estimate of the robot.
            twist: velocity of the robot, by odometry.
            scan: scan of the laser, if it was due.
            neighbours: broadcasts of the other robots in the last tick.
            lost: True if the pose is not reliable. A robot with a goal then looks around until the pose is reliable.
        """
        execution = self._execution
        self._costmaps.expire()
        # Ticks are missing after the robot was dead.
        if tick != self._tick + 1:
            execution.restart(tick)
        self._tick = tick
        pose, neighbours = self._rotated.pose_in_grid(base_in_map), self._rotated.neighbours_in_grid(neighbours)
        self._stale.update(tick, neighbours)
        if lost:
            self._look_around(tick, twist, scan)
            return self._report(tick, pose)
        if isinstance(execution.state, Lost):
            execution.command = STANDSTILL  # Stop looking around now, not only when the next command is due.
            execution.enter("located", execution.standing())
        if scan is not None:
            self._stale.forget_seen_through(pose.compose(scan.mount.laser_in_base), scan)
            if execution.goal is not None or not self._parameters.move_base.shutdown_costmaps:
                self._observe(pose, scan, self._stale.known(tick))
        self._itinerary_planner.search_on()
        clearing = isinstance(execution.state, Clearing)
        # Robots plan in turns, so that each robot knows the plans of all others.
        if (tick - self._robot) % self._team == 0 and tick >= execution.next_plan and not clearing:
            self._planning.run(tick, pose, self._stale.known(tick))
        if self._controller.command_due(tick):
            bodies = [*neighbours, *self._stale.bodies()]
            self._choose_command(tick, pose, twist, bodies)
        return self._report(tick, pose)

    @property
    def rests(self) -> bool:
        """True if the robot stands without a goal, and knows only robots that broadcast.

        Until `next_due`, a step with a scan then does the same as `take_in`.
        """
        execution = self._execution
        return isinstance(execution.state, Idle) and execution.state.wanted is None and not self._stale.any

    @property
    def explained_range(self) -> float:
        """Robots farther from the laser than this are not needed to explain readings, meters."""
        return self._costmaps.explained_range

    def take_in(self, base_in_map: Pose2, scan: Scan, neighbours: Sequence[Neighbour]) -> None:
        """Mark and clear obstacles with a scan of a resting robot; see `step` for the arguments."""
        if not self._parameters.move_base.shutdown_costmaps:
            self._costmaps.expire()
            neighbours = self._rotated.neighbours_in_grid(neighbours)
            self._observe(self._rotated.pose_in_grid(base_in_map), scan, neighbours)

    def _observe(self, pose: Pose2, scan: Scan, neighbours: Sequence[Neighbour]) -> None:
        discs = _discs(neighbours, pose.compose(scan.mount.laser_in_base), self._costmaps.explained_range)
        self._seen = seen = CostmapObservation(pose, scan, discs, self._seen)
        self._costmaps.global_costmap.observe(seen)
        self._planning.forget_free_path()
        self._controller.keep_scan(seen)

    def next_due(self, tick: int, neighbours: Sequence[Neighbour]) -> int:
        """Return the next tick in which a step is needed even without a scan. Before it, the output would not change.

        If this tick cannot be determined, return the next tick. Requests, and changes of the team, make a step
        necessary immediately.

        Args:
            tick: tick of the last step.
            neighbours: broadcasts of the other robots in that tick.
        """
        execution = self._execution
        state = execution.state
        waits = self._making_way.pauses or execution.progress.yields_to(tick) is not None
        if (
            waits
            or execution.results
            or self._itinerary_planner.searching
            or not isinstance(state, Idle | Planning | Controlling)
        ):
            return tick + 1
        due = [self._costmaps.next_due(tick)]
        before_plan = max(tick, execution.next_plan - 1)
        if isinstance(state, Controlling):
            due.append(self._controller.next_command(tick))
            if self._planning.drives_on(state, tick + TICKS_PER_SECOND):
                before_plan = max(before_plan, tick + TICKS_PER_SECOND)
        # A resting robot plans only if another robot asks it to clear a path.
        rests = isinstance(state, Idle) and state.wanted is None
        if not rests or any(map(_CLAIM, neighbours)):
            due.append(next_turn(before_plan, self._robot, self._team))
        return min((one for one in due if one is not None), default=tick + TICKS_PER_SECOND)

    def skip(self, tick: int) -> None:
        """Record a tick without a step."""
        self._tick = tick
        self._making_way.go_on(tick)

    def rejoin(self, neighbours: Sequence[Neighbour]) -> None:
        """Process the broadcasts of the last tick, which had no step. For some robots, it may be the last broadcast."""
        self._stale.update(self._tick, self._rotated.neighbours_in_grid(neighbours))

    @property
    def recovery(self) -> RecoveryProgress:
        """The recovery behaviors, and the number of behaviors that were tried."""
        return self._execution.recovery.progress

    @property
    def _team(self) -> int:
        """Ticks between two turns to plan.

        They are equal for all robots that broadcast, so no two robots plan simultaneously.
        """
        return 1 + max(self._robot, self._stale.highest_robot)

    def _report(self, tick: int, pose: Pose2) -> Navigation:
        execution = self._execution
        name: NavigatorState = "idle" if execution.goal is None else "planning"
        plan, times, remaining, claim = NO_POSES, NO_TIMES, 0.0, None
        fault, execution.fault = execution.fault or self._itinerary_planner.fault, ""
        self._itinerary_planner.fault = ""
        output, waits_for = STANDING, None if execution.goal is None else execution.progress.yields_to(tick)
        state = execution.going_on
        match state:
            case Controlling(follower, _, output):
                name, (plan, times, remaining), waits_for = "controlling", follower.ahead, output.waits_for
            case Planning(waits_for=first) if waits_for is None:
                waits_for = first
        if isinstance(state, Idle | Planning) and state.wanted is not None:
            plan, claim = state.wanted.poses, state.wanted.claim
        return Navigation(
            execution.command,
            execution.goal,
            "clearing" if isinstance(execution.state, Clearing) else name,
            self._rotated.poses_in_map(plan),
            times,
            self._rotated.poses_in_map(output.local_plan),
            execution.results.popleft() if execution.results else None,
            remaining,
            claim,
            *self._costmaps.shown(tick, pose, self._stale, self._controller.pending),
            waits_for,
            self._making_way.now(tick, execution.makes_way_for(tick), has_goal=execution.goal is not None),
            fault,
        )

    def _look_around(self, tick: int, twist: Twist, scan: Scan | None) -> None:
        """Look around. The goal waits until the robot is localized again, but only for a limited time."""
        execution = self._execution
        if not isinstance(execution.state, Lost):
            # Obstacles seen from a wrong pose were marked in wrong places.
            self._costmaps.clear_outside(0.0, 0.0, 0.0)
            execution.stop("lost", Lost())
        execution.next_plan = tick + 2
        if execution.goal is None:
            return
        if scan is not None:
            execution.command = self._controller.look_around(twist, scan)
        if execution.progress.timed_out(tick):
            execution.end(NoPath(execution.goal, "lost", "the robot does not know where it is"))

    def _choose_command(self, tick: int, pose: Pose2, twist: Twist, bodies: Sequence[Neighbour]) -> None:
        match self._execution.state:
            case Controlling() as state:
                self._controlling.run(state, tick, pose, twist, bodies)
            case Clearing() as state:
                self._clearing.run(state, tick, pose, twist, bodies)
            case _:
                self._execution.command = STANDSTILL


def _plans_by(parameters: RobotParameters) -> tuple[str, NavfnParameters, GlobalPlannerParameters]:
    """Return all parameters on which a global planner depends."""
    return parameters.move_base.base_global_planner, parameters.NavfnROS, parameters.GlobalPlanner


def _discs(neighbours: Sequence[Neighbour], laser: Pose2, reach: float) -> FloatArray:
    """Return (k, 3) x, y and circumscribed radius of the neighbors within `reach` meters of the laser."""
    near = neighbours_reaching(neighbours, laser.x - reach, laser.y - reach, laser.x + reach, laser.y + reach)
    return np.array([(other.base_in_map.x, other.base_in_map.y, radius) for other, radius in near]).reshape(-1, 3)
