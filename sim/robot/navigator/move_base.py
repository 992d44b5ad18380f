"""The states of move_base, from a goal to commands.

A goal is planned for (`planning.itinerary_planner`), followed as far as the right of way reaches
(`navigator.follower`), and ends GoalReached, NoPath or Cancelled. Where robots that stand leave no path, the robot
broadcasts the path it wants; those of them that rest, or whose goals are younger, move aside. An obstacle seen on the
path is planned around at once; where that leaves no path, the robot waits, then tries the recovery behaviours. Whatever
the cause, a goal whose remaining path has not become shorter for PROGRESS_TIMEOUT seconds is given up: every goal ends
in bounded time.

Source: ros-planning/navigation, move_base/src/move_base.cpp.
Differs: plans and commands are made in the tick that is due, without threads; robots take turns in planning. A goal
that the map alone makes impossible is given up without recovery. A robot that waits for its right of way neither
oscillates nor is out of valid commands.
"""

import math
from collections import deque
from collections.abc import Callable, Sequence

import numpy as np

from sim.common.geometry import IDENTITY, FloatArray, Pose2
from sim.common.grid import OccupancyGrid, clearance_field
from sim.common.observations import STANDSTILL, TICK, TICKS_PER_SECOND, Claim, Neighbour, Scan, Twist
from sim.parameters import GlobalPlannerParameters, NavfnParameters, RobotParameters
from sim.robot.costmap.robots import neighbours_reaching
from sim.robot.navigator.costmaps import Costmaps
from sim.robot.navigator.follower import NO_POSES, NO_TIMES, Follower
from sim.robot.navigator.goals import Cancelled, Goal, GoalReached, GoalResult, NoPath
from sim.robot.navigator.navigation import Navigation, NavigatorState
from sim.robot.navigator.recovery import OscillationDetector, RecoveryBehaviours
from sim.robot.navigator.rotated_map import RotatedMap
from sim.robot.navigator.stale_neighbours import StaleNeighbours
from sim.robot.planning.itinerary import (
    ITINERARY_SPEED,
    Itinerary,
    OtherItineraries,
    itineraries_of,
    itineraries_of_moving,
    start_time,
)
from sim.robot.planning.itinerary_planner import BlockedByRobots, ItineraryPlanner
from sim.robot.planning.make_plan import make_plan
from sim.robot.planning.path import PlanRefusal, headings
from sim.robot.planning.planners import global_planner
from sim.robot.planning.potential_planner import PotentialPlanner
from sim.robot.planning.wave import Workspace

PLAN_RETRY = 0.5
"""Seconds between attempts to plan."""
HELD_UP_RETRY = 2.0
"""The same for a robot that is held up."""
CLEARING_TIMEOUT = 60.0
"""Seconds that a robot waits for others to clear its path."""
PROGRESS_TIMEOUT = 120.0
"""Seconds, beside those that its longest path takes, in which the remaining path must become shorter than ever before,
or the goal is given up: so every goal ends."""
PROGRESS_DISTANCE = 0.5
"""Metres by which it must become shorter."""
GIVE_WAY_TIME = 5.0
"""Seconds for which a robot that gave way lets the other one plan first."""


class Navigator:
    """The navigator of one robot.

    Args:
        parameters: this robot's software's.
        footprint: (n, 2) corners of its body, base frame, metres.
        static: the map.
        robot: its index in the team.
        space: room to plan in, which it may share with others: nothing is kept there between plans. None: of its own.
    """

    def __init__(
        self,
        parameters: RobotParameters,
        footprint: FloatArray,
        static: OccupancyGrid,
        robot: int = 0,
        space: Workspace | None = None,
    ) -> None:
        self._rotated = RotatedMap(static)
        static = self._rotated.grid
        self._software = parameters
        self._parameters = parameters.move_base
        self._robot = robot
        self._costmaps = Costmaps(parameters, footprint, self._rotated, robot)
        self._space = space
        self._itinerary_planner = ItineraryPlanner(
            static, self._costmaps.global_costmap, parameters.global_costmap.inflation_layer, self._planner(parameters)
        )
        self._follower = Follower(
            parameters,
            static,
            clearance_field(static),
            self._costmaps.local_costmap,
            self._costmaps.global_costmap,
            self._itinerary_planner.separation_driven,
            robot,
        )
        self._recovery = RecoveryBehaviours(self._parameters, self._costmaps.global_costmap.circumscribed_radius)
        self._oscillation = OscillationDetector(
            self._parameters.oscillation_timeout, self._parameters.oscillation_distance
        )
        self._stale = StaleNeighbours()
        self._results: deque[GoalResult] = deque()
        self._goal: Goal | None = None
        self._target = IDENTITY
        self._wanted_path = NO_POSES
        self._claim: Claim | None = None
        self._waits_for: int | None = None
        self._tick = -1
        self._command = STANDSTILL
        self._giving_way = False
        self._lost = False
        self._restart_clocks(0)

    def _restart_clocks(self, tick: int) -> None:
        self._fresh = True
        # In its first tick a robot has received no broadcasts yet, and would plan out of turn.
        self._next_plan = tick + 1
        self._began = tick
        self._planned = tick
        self._planning_since = tick
        self._retries = 0
        self._turn_left = 0.0
        self._yielded = -math.inf
        self._yielded_to: int | None = None
        self._shortest = math.inf
        self._shortest_tick = tick
        self._longest = 0.0
        self._recovery.restart()
        self._oscillation.restart(tick)
        self._follower.restart(tick)

    def go(self, goal: Goal) -> None:
        """Take up a goal; the present one ends Cancelled."""
        self.cancel()
        self._goal = goal
        self._target = self._rotated.pose_in_grid(goal.base_in_map)
        self._fresh = True

    def cancel(self) -> None:
        """Give up the present goal, if any: it ends Cancelled, and the robot stops."""
        if self._goal is not None:
            self._end(Cancelled(self._goal))

    def replan(self) -> None:
        """Plan anew to the present goal: the robot was told that it is somewhere else."""
        self._drop()
        self._next_plan = self._tick + 1
        self._shortest, self._shortest_tick = math.inf, self._tick

    def clear_costmaps(self) -> None:
        """Forget what the laser has seen."""
        self._costmaps.clear()

    def configure(self, parameters: RobotParameters) -> None:
        """Go on with these parameters (ROS: dynamic_reconfigure): with the same goal, plan and obstacles seen."""
        before = self._software
        if parameters == before:
            return
        self._software, self._parameters = parameters, parameters.move_base
        self._costmaps.configure(parameters)
        if parameters.global_costmap != before.global_costmap or _plans_by(parameters) != _plans_by(before):
            self._itinerary_planner.configure(parameters.global_costmap.inflation_layer, self._planner(parameters))
        self._follower.configure(parameters, self._itinerary_planner.separation_driven)
        self._recovery.configure(self._parameters, self._costmaps.global_costmap.circumscribed_radius)
        self._oscillation.configure(self._parameters.oscillation_timeout, self._parameters.oscillation_distance)

    def make_plan(self, base_in_map: Pose2, start: Pose2, goal: Pose2, tolerance: float) -> FloatArray | PlanRefusal:
        """Make a plan on request (ROS: move_base/make_plan); it changes nothing for the robot.

        Args:
            base_in_map: believed pose of the robot.
            start: pose at the beginning.
            goal: pose at the end.
            tolerance: metres by which it may miss the goal, along x and along y, where that cannot be reached.

        Returns:
            (m, 3) poses in the map, or why there are none.
        """
        turned = self._rotated
        place = turned.pose_in_grid(base_in_map)
        costs, frame = self._costmaps.global_costmap.as_updated(place.x, place.y, self._stale.known(self._tick))
        adds = self._parameters.make_plan_add_unreachable_goal
        planner = self._planner(self._software)
        poses = make_plan(planner, costs, frame, turned.pose_in_grid(start), turned.pose_in_grid(goal), tolerance, adds)
        return poses if isinstance(poses, PlanRefusal) else turned.poses_in_map(poses)

    def _planner(self, parameters: RobotParameters) -> PotentialPlanner:
        """The global planner that these parameters name."""
        return global_planner(*_plans_by(parameters), self._space)

    def _end(self, result: GoalResult) -> None:
        self._results.append(result)
        self._goal = None
        self._drop()

    def _drop(self) -> None:
        """Stand, and follow nothing."""
        self._wanted_path, self._claim, self._waits_for = NO_POSES, None, None
        self._giving_way = False
        self._command = STANDSTILL
        self._follower.drop()

    def step(
        self,
        tick: int,
        base_in_map: Pose2,
        twist: Twist,
        scan: Scan | None,
        neighbours: Sequence[Neighbour],
        lost: bool = False,
    ) -> Navigation:
        """One tick.

        Args:
            tick: the present one.
            base_in_map: believed pose of the robot.
            twist: its velocity, by odometry.
            scan: the laser's, where it was due.
            neighbours: broadcasts of the other robots in the last tick.
            lost: True when that pose cannot be relied on: with a goal the robot looks around until it can.
        """
        if self._fresh or tick != self._tick + 1:
            self._restart_clocks(tick)
            self._fresh = False
        self._tick = tick
        pose, neighbours = self._rotated.pose_in_grid(base_in_map), self._rotated.neighbours_in_grid(neighbours)
        self._stale.update(tick, neighbours)
        if lost:
            self._look_around(tick, twist, scan)
            return self._report(tick, pose)
        self._lost = False
        if scan is not None:
            laser = pose.compose(scan.mount.laser_in_base)
            self._stale.forget_seen_through(laser, scan)
            if self._goal is not None or not self._parameters.shutdown_costmaps:
                discs = _discs(self._stale.known(tick), laser, self._costmaps.explained_range)
                self._costmaps.global_costmap.observe(pose, scan, discs)
                self._follower.keep_scan(pose, scan, discs)
        # The same number for all robots that broadcast, so that no two of them have their turn at once.
        team = 1 + max(self._robot, self._stale.highest_robot)
        if (tick - self._robot) % team == 0 and tick >= self._next_plan and self._turn_left == 0.0:
            self._choose_plan(tick, pose, self._stale.known(tick))
        if (tick - self._robot) % self._follower.control_ticks == 0:
            bodies = [*neighbours, *self._stale.bodies()]
            self._choose_command(tick, pose, twist, bodies)
        return self._report(tick, pose)

    def _report(self, tick: int, pose: Pose2) -> Navigation:
        result = self._results.popleft() if self._results else None
        follower = self._follower
        state: NavigatorState = "planning"
        if self._turn_left > 0.0:
            state = "clearing"
        elif follower.itinerary is not None:
            state = "controlling"
        elif self._goal is None:
            state = "idle"
        plan, times, remaining = (self._wanted_path, NO_TIMES, 0.0) if follower.itinerary is None else follower.ahead
        plan, local_plan = self._rotated.poses_in_map(plan), self._rotated.poses_in_map(follower.local_plan)
        return Navigation(
            self._command,
            self._goal,
            state,
            plan,
            times,
            local_plan,
            result,
            remaining,
            self._claim,
            *self._costmaps.shown(tick, pose, self._stale, follower.pending),
            self._waited_for(tick),
        )

    def _waited_for(self, tick: int) -> int | None:
        """Return the robot that this one lets go first, if it stands because of one."""
        if self._follower.itinerary is not None:
            return self._follower.waits_for
        return self._yielded_to if self._goal is not None and self._yields(tick) else self._waits_for

    def _look_around(self, tick: int, twist: Twist, scan: Scan | None) -> None:
        """Look around; a goal waits for the robot to know its place again, but not for ever."""
        command = self._command
        self._drop()
        if not self._lost:
            # Obstacles that were seen from a wrong pose were marked at wrong places.
            self._costmaps.clear_outside(0.0, 0.0, 0.0)
            self._lost, command = True, STANDSTILL
        self._turn_left = 0.0
        self._next_plan = tick + 2
        if self._goal is None:
            return
        if scan is not None:
            command = self._follower.look_around(twist, scan)
        self._command = command
        if self._progress_timed_out(tick):
            self._end(NoPath(self._goal, "lost", "the robot does not know where it is"))

    # Plans

    def _choose_plan(self, tick: int, pose: Pose2, neighbours: Sequence[Neighbour]) -> None:
        """Plan if there is something to plan for; it is this robot's turn."""
        if self._goal is not None and self._progress_timed_out(tick):
            self._end(self._given_up(self._goal))
        keeps = False
        if self._follower.itinerary is not None:
            if self._follower.obstructed(self._itinerary_planner):
                self._next_plan = tick + round(PLAN_RETRY * TICKS_PER_SECOND)
            elif self._oscillation.due(tick) or self._out_of_control(tick):
                self._recover(tick, pose, self._given_up)
            elif self._follower.held_up(tick):
                self._next_plan = tick + round(HELD_UP_RETRY * TICKS_PER_SECOND)
            elif self._replans(tick):
                keeps = True
            else:
                return
        if self._turn_left > 0.0:
            return
        if self._goal is not None and not self._yields(tick):
            self._plan(tick, pose, self._goal, neighbours, keeps)
        if self._follower.itinerary is None:
            asking = self._asked_to_clear(pose, neighbours)
            if asking is not None:
                self._give_way(tick, pose, asking, neighbours)
            elif self._goal is None:
                self._wanted_path, self._claim = NO_POSES, None

    def _progress_timed_out(self, tick: int) -> bool:
        return tick - self._shortest_tick > (PROGRESS_TIMEOUT + self._longest / ITINERARY_SPEED) * TICKS_PER_SECOND

    def _out_of_control(self, tick: int) -> bool:
        return tick - self._follower.last_valid > self._parameters.controller_patience * TICKS_PER_SECOND

    def _yields(self, tick: int) -> bool:
        """Return True when it has just given way to another one, which is to plan first."""
        return tick - self._yielded < GIVE_WAY_TIME * TICKS_PER_SECOND

    def _replans(self, tick: int) -> bool:
        """Return True when a plan is due although the present one is good."""
        rate = self._parameters.planner_frequency
        return rate > 0.0 and not self._giving_way and tick - self._planned >= TICKS_PER_SECOND / rate

    def _recover(self, tick: int, pose: Pose2, why: Callable[[Goal], NoPath]) -> None:
        """Try the next recovery behaviour; when there is none left, the goal is given up."""
        self._oscillation.restart(tick)
        self._follower.restart(tick)
        self._planning_since, self._retries = tick, 0
        behaviour = self._recovery.next()
        if behaviour is None:
            if self._goal is not None:
                self._end(why(self._goal))
            else:
                self._drop()
        elif behaviour == "rotate_recovery":
            self._drop()
            self._turn_left = math.tau
        else:
            self._costmaps.clear_outside(pose.x, pose.y, self._recovery.reset_side(behaviour))

    def _given_up(self, goal: Goal) -> NoPath:
        if len(self._wanted_path) > 0 or self._follower.blocked_by_others:
            return NoPath(goal, "robots_in_the_way", "other robots stand in the way and do not clear it")
        return NoPath(goal, "stuck", "the robot is stuck and cannot get free")

    def _plan(self, tick: int, pose: Pose2, goal: Goal, neighbours: Sequence[Neighbour], keeps: bool) -> None:
        self._planned = tick
        first = self._defers_to(neighbours)
        if first is not None:
            if not keeps:
                self._waits_for = first
                self._next_plan = tick + round(PLAN_RETRY * TICKS_PER_SECOND)
            return
        others = itineraries_of(neighbours)
        self._itinerary_planner.update_neighbours(neighbours)
        planned = self._itinerary_planner.plan(pose, self._target, self._time(tick, pose, others), others)
        if keeps and not isinstance(planned, Itinerary):
            return
        match planned:
            case Itinerary():
                self._follow(tick, planned, self._target.theta, turns_at_end=True)
            case BlockedByRobots(wanted_path):
                self._drop()
                self._wanted_path = headings(wanted_path, self._target.theta)
                self._claim = Claim(self._began, self._robot)
                self._waits_for = self._itinerary_planner.first_obstructing(neighbours, wanted_path)
                self._longest = max(self._longest, float(np.hypot(*np.diff(wanted_path, axis=0).T).sum()))
                self._next_plan = tick + round(PLAN_RETRY * TICKS_PER_SECOND)
                if any(
                    len(other.times) and self._itinerary_planner.obstructs(other.path[-1], wanted_path)
                    for other in neighbours
                ):
                    # These robots are still to arrive there, and can be asked to move aside only then.
                    self._planning_since = tick
                if tick - self._planning_since > CLEARING_TIMEOUT * TICKS_PER_SECOND:
                    self._end(self._given_up(goal))
            case PlanRefusal():
                self._drop()
                self._next_plan = tick + round(PLAN_RETRY * TICKS_PER_SECOND)
                self._refuse(tick, pose, goal, planned)

    def _defers_to(self, neighbours: Sequence[Neighbour]) -> int | None:
        """Return a robot with an older goal on whose wanted path this goal lies: that robot is to go first."""
        own = Claim(self._began, self._robot)
        older = (other for other in neighbours if other.claim is not None and other.claim < own)
        place = self._target.array()[:2]
        return next((other.robot for other in older if self._itinerary_planner.obstructs(place, other.path)), None)

    def _refuse(self, tick: int, pose: Pose2, goal: Goal, refused: PlanRefusal) -> None:
        """Wait for a path to open, then recover, then give up."""
        self._retries += 1
        timeout = self._parameters.planner_patience
        waited = tick - self._planning_since > timeout * TICKS_PER_SECOND
        waited = waited or 0 <= self._parameters.max_planning_retries < self._retries
        if refused.code in ("goal_outside", "goal_occupied") or (waited and refused.code != "blocked_by_obstacle"):
            self._end(NoPath(goal, refused.code, refused.sentence))
        elif waited:
            self._recover(tick, pose, lambda goal: NoPath(goal, refused.code, refused.sentence))

    def _asked_to_clear(self, pose: Pose2, neighbours: Sequence[Neighbour]) -> Neighbour | None:
        """Return the robot of highest priority, above this one's, on whose wanted path this robot stands."""
        own = None if self._goal is None else Claim(self._began, self._robot)
        strongest: Neighbour | None = None
        for other in neighbours:
            if other.claim is None or (own is not None and other.claim > own):
                continue
            if strongest is not None and strongest.claim is not None and strongest.claim <= other.claim:
                continue
            if self._itinerary_planner.obstructs(pose.array()[:2], other.path):
                strongest = other
        return strongest

    def _give_way(self, tick: int, pose: Pose2, asking: Neighbour, neighbours: Sequence[Neighbour]) -> None:
        others = itineraries_of(neighbours)
        self._itinerary_planner.update_neighbours(neighbours)
        away = self._itinerary_planner.refuge(pose, asking.path, self._time(tick, pose, others), others)
        self._next_plan = tick + round(PLAN_RETRY * TICKS_PER_SECOND)
        if away is None:
            # Robots that rest around it are in its path: they are asked in their turn, with the same priority.
            movers = itineraries_of_moving(neighbours)
            away = self._itinerary_planner.refuge(pose, asking.path, self._time(tick, pose, movers), movers)
            if away is not None:
                self._wanted_path, self._claim = headings(away.points, pose.theta), asking.claim
            elif self._goal is None:
                self._wanted_path, self._claim = NO_POSES, None
            return
        self._yielded, self._yielded_to = tick, asking.robot
        self._follow(tick, away, pose.theta, turns_at_end=False)
        self._giving_way = True

    def _time(self, tick: int, pose: Pose2, others: OtherItineraries) -> float:
        if self._follower.itinerary is not None:
            return self._follower.time
        return float(start_time(tick * TICK, pose.x, pose.y, others, self._itinerary_planner.separation))

    def _follow(self, tick: int, itinerary: Itinerary, heading: float, turns_at_end: bool) -> None:
        self._drop()
        self._follower.follow(tick, itinerary, heading, turns_at_end)
        self._planning_since, self._retries = tick, 0
        self._longest = max(self._longest, self._follower.remaining)

    # Commands

    def _choose_command(self, tick: int, pose: Pose2, twist: Twist, bodies: Sequence[Neighbour]) -> None:
        follower = self._follower
        if self._turn_left > 0.0:
            self._turn(pose, twist, bodies)
            return
        if follower.itinerary is None:
            self._command = STANDSTILL
            return
        self._oscillation.watch(tick, pose)
        self._command = follower.step(tick, pose, twist, bodies)
        if follower.waiting:
            self._oscillation.pause(follower.control_ticks)
        if not self._giving_way and follower.remaining < self._shortest - PROGRESS_DISTANCE:
            self._shortest, self._shortest_tick = follower.remaining, tick
            self._recovery.restart()
        if follower.arrived:
            if self._goal is None or self._giving_way:
                self._drop()
            else:
                self._end(GoalReached(self._goal))

    def _turn(self, pose: Pose2, twist: Twist, bodies: Sequence[Neighbour]) -> None:
        """Choose a command of one full turn in place, as far as that is safe."""
        drive = self._follower.rotate_recovery(pose, twist, bodies)
        turned = abs(drive.command.angular) * self._follower.control_ticks * TICK
        self._turn_left = 0.0 if drive.stuck else max(0.0, self._turn_left - turned)
        self._command = drive.command if self._turn_left > 0.0 else STANDSTILL


def _plans_by(parameters: RobotParameters) -> tuple[str, NavfnParameters, GlobalPlannerParameters]:
    """All parameters that a global planner is made from."""
    return parameters.move_base.base_global_planner, parameters.NavfnROS, parameters.GlobalPlanner


def _discs(neighbours: Sequence[Neighbour], laser: Pose2, reach: float) -> FloatArray:
    """(k, 3) x, y and circumscribed radius of those neighbours that come within `reach` metres of the laser."""
    near = neighbours_reaching(neighbours, laser.x - reach, laser.y - reach, laser.x + reach, laser.y + reach)
    return np.array([(other.base_in_map.x, other.base_in_map.y, radius) for other, radius in near]).reshape(-1, 3)
