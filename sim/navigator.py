"""move_base: from a goal to commands, with its goal states and recovery behaviours.

A goal is planned for (`sim.planning.router`), followed by trajectory rollout as far as the right of way reaches
(`sim.planning.itinerary`), and ends Arrived, NoPath or Cancelled. Where robots that stand leave no way, the robot tells
the path it wishes for; those of them that rest or have a higher number move aside. Recovery is move_base's: forget the
obstacles seen, turn once, again both, give up. Whatever the cause, a goal whose way left has not become shorter for
STALEMATE seconds is given up: every goal ends in bounded time.

Source: ros-planning/navigation, move_base/src/move_base.cpp.
Differs: plans and commands are made in the tick that is due, without threads; robots take turns in planning.
"""

import math
from collections import deque
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numba import njit

from sim.control.braking import LATENCY, Surroundings, surroundings
from sim.control.trajectory_rollout import Drive, TrajectoryRollout
from sim.costmap.costmap_2d import Costmap2D
from sim.costmap.costs import INSCRIBED, CostFrame, Costs
from sim.costmap.footprint import circumscribed_radius
from sim.geometry import FloatArray, Pose2, wrap_angle
from sim.grid import OccupancyGrid, distance_field
from sim.observations import STANDSTILL, TICK, TICKS_PER_SECOND, Neighbour, Scan, Twist
from sim.parameters import RobotParameters
from sim.planning.itinerary import Itinerary, Others, heard, reached, resting_left_out, right_of_way, start_time
from sim.planning.path import Refused, headings
from sim.planning.router import Blocked, Router

NavigatorState = Literal["idle", "planning", "controlling", "clearing"]


@dataclass(frozen=True, slots=True)
class Goal:
    """A pose to drive to.

    Attributes:
        id: the caller's number; comes back with the result.
        base_in_map: where the base shall end.
    """

    id: int
    base_in_map: Pose2


@dataclass(frozen=True, slots=True)
class Arrived:
    """The base stands at the goal, within the goal tolerances."""

    goal: Goal


@dataclass(frozen=True, slots=True)
class NoPath:
    """The goal was given up.

    Attributes:
        reason: the cause as a code, stable for programs.
        sentence: the cause for people.
    """

    goal: Goal
    reason: str
    sentence: str


@dataclass(frozen=True, slots=True)
class Cancelled:
    """The goal was withdrawn, or another took its place."""

    goal: Goal


@dataclass(frozen=True, slots=True)
class Navigation:
    """What a robot does about its goal in one tick.

    Attributes:
        command: the velocity it asks for.
        goal: the one under way.
        state: move_base's: "planning" waits for a plan, "controlling" follows it, "clearing" tries to get free.
        plan: (m, 3) map poses still to be driven, the robot's own place first; empty without a goal. The path that
            its neighbours hear.
        times: (m,) the times that its neighbours hear with it; empty beside a plan that is only wished for.
        local_plan: (k, 3) map poses the command would lead through.
        result: how a goal ended in this very tick.
        remaining: metres of the plan left.
    """

    command: Twist
    goal: Goal | None
    state: NavigatorState
    plan: FloatArray
    times: FloatArray
    local_plan: FloatArray
    result: Arrived | NoPath | Cancelled | None
    remaining: float


LOOK_AHEAD = 1.75
"""Metres of path given to the local planner at most."""
RIM = 0.25
"""Metres from it to the local costmap's rim, toward which the robot drives until the next update."""
HALT = 0.12
"""Metres before a point that may not be passed at which a robot waits."""
TURNS_BACK = 0.06
"""Metres that a way comes nearer again before it counts as turning back."""
YIELD_TIME = 0.5
"""Seconds from such a point, at least, from which a robot slows down."""
ESCAPE = 0.12
"""Metres that a robot backs up where no command leads on."""
RETRY = 0.5
"""Seconds between attempts to plan."""
STUCK = 2.0
"""Seconds that a robot may be held up, other than by right of way, before it plans anew."""
QUEUE = 20.0
"""Seconds that it may be held up by right of way before it plans anew."""
RECOVERIES = 4
"""Recoveries in vain after which a goal is given up."""
WISHING = 60.0
"""Seconds that a robot waits for others to clear its way."""
STALEMATE = 120.0
"""Seconds in which the way left must become shorter than ever, or the goal is given up: so every goal ends."""
NEARER = 0.5
"""Metres by which it must become so."""
MAKING_WAY = 5.0
"""Seconds that a robot that made way lets the other one plan first."""

NOWHERE: FloatArray = np.empty((0, 3))
NO_TIMES: FloatArray = np.empty(0)


class Navigator:
    """The navigator of one robot.

    Args:
        parameters: of this robot's software.
        footprint: (n, 2) corners of its body, base frame, metres.
        static: the map; its origin must not be turned.
        robot: its index in the team: the lower, the more the others make way.

    Raises:
        ValueError: the map's origin is turned.
    """

    def __init__(
        self, parameters: RobotParameters, footprint: FloatArray, static: OccupancyGrid, robot: int = 0
    ) -> None:
        if static.origin.theta != 0.0:
            raise ValueError("a robot cannot plan on a map whose origin is turned: set the yaw in `origin` to 0")
        self._parameters = parameters
        self._robot = robot
        resolution = static.resolution
        self._global = Costmap2D(parameters.global_costmap, footprint, static)
        self._local = Costmap2D(parameters.local_costmap, footprint, static)
        self._footprint = self._local.footprint
        self._frame = CostFrame(static.origin.x, static.origin.y, resolution)
        # Half a cell less: from an occupied cell's centre to its side.
        self._clearance = np.maximum(distance_field(static, 2.0) - np.float32(0.5 * resolution), np.float32(0))
        self._router = Router(
            static,
            self._clearance.astype(np.float64),
            self._global,
            parameters.global_costmap.inflation_layer,
            parameters.NavfnROS.allow_unknown,
        )
        costmap = parameters.local_costmap
        cells = min(self._local.costs.shape)
        self._reach = min(LOOK_AHEAD, cells / 2 * resolution - RIM)
        self._control_ticks = max(1, round(TICKS_PER_SECOND / parameters.move_base.controller_frequency))
        self._costmap_ticks = max(1, round(TICKS_PER_SECOND / costmap.update_frequency))
        self._hold = self._control_ticks * TICK + LATENCY
        self._rollout = TrajectoryRollout(
            parameters.TrajectoryPlannerROS,
            self._footprint,
            self._local.costs.shape,
            self._hold,
            costmap.inflation_layer.cost_scaling_factor,
            costmap.inflation_layer.inflation_radius,
        )
        self._results: deque[Arrived | NoPath | Cancelled] = deque()
        self._goal: Goal | None = None
        self._wish = NOWHERE
        self._drop()
        self._restart_clocks(0)

    def _drop(self) -> None:
        """Stand, and follow nothing."""
        self._itinerary: Itinerary | None = None
        self._poses = NOWHERE
        self._left = NO_TIMES
        self._index = 0
        self._ahead = (NOWHERE, NO_TIMES, 0.0)
        self._at_goal = False
        self._others_bar = False
        self._making_way = False
        self._escaping_from: Pose2 | None = None
        self._command = STANDSTILL
        self._local_plan = NOWHERE

    def _restart_clocks(self, tick: int) -> None:
        self._fresh = True
        # In its first tick a robot has not heard the others yet, and would plan out of turn.
        self._next_plan = tick + 1
        self._planning_since = tick
        self._progress = tick
        self._free = tick
        self._recoveries = 0
        self._turn_left = 0.0
        self._heading = 0.0
        self._mark: Pose2 | None = None
        self._mark_tick = tick
        self._yielded = -math.inf
        self._shortest = math.inf
        self._shortest_tick = tick

    @property
    def global_costmap(self) -> Costmap2D:
        """Costs over the whole map, for plans."""
        return self._global

    @property
    def local_costmap(self) -> Costmap2D:
        """Costs around the robot, for commands."""
        return self._local

    def go(self, goal: Goal) -> None:
        """Take up a goal; the one under way ends Cancelled."""
        self.cancel()
        self._goal = goal
        self._fresh = True

    def cancel(self) -> None:
        """Give up the goal under way, if any: it ends Cancelled, and the robot stops."""
        if self._goal is not None:
            self._end(Cancelled(self._goal))

    def _end(self, result: Arrived | NoPath | Cancelled) -> None:
        self._results.append(result)
        self._goal = None
        self._wish = NOWHERE
        self._drop()

    def step(
        self, tick: int, base_in_map: Pose2, twist: Twist, scan: Scan | None, neighbours: Sequence[Neighbour]
    ) -> Navigation:
        """One tick.

        Args:
            tick: which one.
            base_in_map: where the robot believes it is.
            twist: how it moves, by odometry.
            scan: the laser's, where it was due.
            neighbours: what the other robots said in the last tick.
        """
        if self._fresh:
            self._restart_clocks(tick)
            self._fresh = False
        if scan is not None:
            discs = _discs(neighbours)
            for costmap in (self._global, self._local):
                costmap.observe(base_in_map, scan, discs)
        team = len(neighbours) + 1
        if (tick - self._robot) % team == 0 and tick >= self._next_plan:
            self._choose_way(tick, base_in_map, neighbours)
        if (tick - self._robot) % self._control_ticks == 0:
            self._choose_command(tick, base_in_map, twist, neighbours)
        return self._told()

    def _told(self) -> Navigation:
        result = self._results.popleft() if self._results else None
        if self._itinerary is None:
            state: NavigatorState = "idle" if self._goal is None else "planning"
            return Navigation(
                self._command, self._goal, state, self._wish, NO_TIMES, self._local_plan, result, remaining=0.0
            )
        state = "clearing" if self._turn_left > 0.0 else "controlling"
        plan, times, remaining = self._ahead
        return Navigation(self._command, self._goal, state, plan, times, self._local_plan, result, remaining)

    def _pass(self, way: Itinerary, index: int) -> None:
        """Have reached this point of the way."""
        self._index = index
        self._ahead = (self._poses[index:], way.times[index:], float(self._left[index]))

    # Which way

    def _choose_way(self, tick: int, pose: Pose2, neighbours: Sequence[Neighbour]) -> None:
        """Plan if there is something to plan for; it is this robot's turn."""
        if self._goal is not None and tick - self._shortest_tick > STALEMATE * TICKS_PER_SECOND:
            self._end(self._given_up(self._goal))
        if self._itinerary is not None:
            if not self._held_up(tick):
                return
            self._recover(tick)
        if self._goal is not None and tick - self._yielded >= MAKING_WAY * TICKS_PER_SECOND:
            self._plan(tick, pose, self._goal, neighbours)
        if self._itinerary is None:
            asking = self._asked_to_clear(pose, neighbours)
            if asking is not None:
                self._make_way(tick, pose, asking, neighbours)
            elif self._goal is None:
                self._wish = NOWHERE

    def _held_up(self, tick: int) -> bool:
        """Whether the way under way leads on no more."""
        patience = STUCK if self._progress <= self._free else QUEUE
        return tick - self._progress > patience * TICKS_PER_SECOND or self._oscillates(tick)

    def _recover(self, tick: int) -> None:
        """Before planning anew: forget what was seen, and every other time look around for it again."""
        self._next_plan = tick + round(STUCK * TICKS_PER_SECOND)
        if not self._oscillates(tick):
            return
        self._mark_tick = tick
        self._recoveries += 1
        if self._recoveries > RECOVERIES and self._goal is not None:
            self._end(self._given_up(self._goal))
        elif self._parameters.move_base.recovery_behavior_enabled:
            self._forget_obstacles()
            self._turn_left = math.tau if self._recoveries % 2 == 0 else 0.0

    def _forget_obstacles(self) -> None:
        for costmap in (self._global, self._local):
            costmap.clear()

    def _given_up(self, goal: Goal) -> NoPath:
        if len(self._wish) > 0 or self._others_bar:
            return NoPath(goal, "robots_in_the_way", "other robots stand in the way and do not clear it")
        return NoPath(goal, "stuck", "the robot is stuck and cannot get free")

    def _oscillates(self, tick: int) -> bool:
        """Whether the robot has long been moving, or trying to, and come nowhere."""
        timeout = self._parameters.move_base.oscillation_timeout
        return timeout > 0.0 and tick - self._mark_tick > timeout * TICKS_PER_SECOND

    def _plan(self, tick: int, pose: Pose2, goal: Goal, neighbours: Sequence[Neighbour]) -> None:
        others = heard(neighbours)
        self._router.see(neighbours)
        way = self._router.way(pose, goal.base_in_map, self._time(tick, pose, others), others)
        match way:
            case Itinerary():
                self._follow(tick, way, goal.base_in_map.theta)
            case Blocked(wish):
                self._drop()
                self._wish = headings(wish, goal.base_in_map.theta)
                self._next_plan = tick + round(RETRY * TICKS_PER_SECOND)
                if tick - self._planning_since > WISHING * TICKS_PER_SECOND:
                    self._end(self._given_up(goal))
            case Refused(code, sentence):
                self._drop()
                self._forget_obstacles()
                self._next_plan = tick + round(RETRY * TICKS_PER_SECOND)
                waited = tick - self._planning_since > self._parameters.move_base.planner_patience * TICKS_PER_SECOND
                if code in ("goal_outside", "goal_occupied") or waited:
                    self._end(NoPath(goal, code, sentence))

    def _asked_to_clear(self, pose: Pose2, neighbours: Sequence[Neighbour]) -> Neighbour | None:
        """The robot that wishes for a way in which this one stands, and whose wish counts more."""
        for other in neighbours:
            if len(other.path) == 0 or len(other.times) > 0:
                continue
            if (self._goal is None or other.robot < self._robot) and self._router.in_the_way(pose, other.path):
                return other
        return None

    def _make_way(self, tick: int, pose: Pose2, asking: Neighbour, neighbours: Sequence[Neighbour]) -> None:
        others = heard(neighbours)
        self._router.see(neighbours)
        away = self._router.refuge(pose, asking.path, self._time(tick, pose, others), others)
        self._next_plan = tick + round(RETRY * TICKS_PER_SECOND)
        if away is None:
            # Those that rest around it are asked in their turn.
            movers = resting_left_out(neighbours)
            away = self._router.refuge(pose, asking.path, self._time(tick, pose, movers), movers)
            self._wish = NOWHERE if away is None else headings(away.points, pose.theta)
            return
        self._yielded = tick
        self._follow(tick, away, pose.theta)
        self._making_way = True

    def _time(self, tick: int, pose: Pose2, others: Others) -> float:
        if self._itinerary is not None:
            return float(self._itinerary.times[self._index])
        return float(start_time(tick * TICK, pose.x, pose.y, others, self._router.separation))

    def _follow(self, tick: int, way: Itinerary, heading: float) -> None:
        self._drop()
        self._wish = NOWHERE
        self._itinerary = way
        self._poses = headings(way.points, heading)
        steps = np.hypot(*np.diff(way.points, axis=0).T)
        self._left = np.append(np.cumsum(steps[::-1])[::-1], 0.0)
        self._pass(way, 0)
        self._planning_since = tick
        self._progress, self._free = tick, tick - 1
        self._rollout.reset()

    # Which command

    def _choose_command(self, tick: int, pose: Pose2, twist: Twist, neighbours: Sequence[Neighbour]) -> None:
        self._command, self._local_plan = STANDSTILL, NOWHERE
        way = self._itinerary
        if way is None:
            return
        if self._mark is None or self._mark.distance(pose) >= self._parameters.move_base.oscillation_distance:
            self._mark, self._mark_tick, self._recoveries = pose, tick, 0
        if (tick - self._robot) % self._costmap_ticks < self._control_ticks or self._progress == tick:
            reach = max(self._parameters.local_costmap.width, self._parameters.local_costmap.height)
            self._local.see(
                [
                    other
                    for other in neighbours
                    if abs(other.base_in_map.x - pose.x) < reach and abs(other.base_in_map.y - pose.y) < reach
                ]
            )
            self._local.update(pose.x, pose.y)
        index = int(reached(way.points, self._index, pose.x, pose.y))
        if index > self._index:
            self._pass(way, index)
            self._progress = tick
        if not self._making_way and self._left[self._index] < self._shortest - NEARER:
            self._shortest, self._shortest_tick = float(self._left[self._index]), tick
        around = surroundings(
            self._clearance,
            self._frame,
            self._footprint,
            pose,
            neighbours,
            self._parameters.TrajectoryPlannerROS.acc_lim_x,
            self._hold,
        )
        drive = self._drive(tick, pose, twist, way, around, neighbours)
        if drive is not None:
            self._command, self._local_plan = drive.command, drive.local_plan

    def _drive(
        self,
        tick: int,
        pose: Pose2,
        twist: Twist,
        way: Itinerary,
        around: Surroundings,
        neighbours: Sequence[Neighbour],
    ) -> Drive | None:
        planner = self._parameters.TrajectoryPlannerROS
        end_x, end_y, end_heading = self._poses[-1]
        off = math.hypot(end_x - pose.x, end_y - pose.y)
        if self._left[self._index] < 3 * planner.xy_goal_tolerance and off <= planner.xy_goal_tolerance:
            self._at_goal = True
        elif not planner.latch_xy_goal_tolerance:
            self._at_goal = False
        if self._turn_left > 0.0:
            return self._look_around(pose, twist, around)
        if self._escaping_from is not None:
            return self._escape(self._escaping_from, pose, twist, around)
        if self._at_goal:
            return self._finish(tick, pose, twist, float(end_heading), around)
        last = int(np.searchsorted(-self._left, self._reach - self._left[self._index], side="right")) - 1
        last = max(self._index, last)
        allowed, barred = right_of_way(
            way.points, way.times, self._index, last, pose.x, pose.y, heard(neighbours), self._router.separation_driven
        )
        self._others_bar = allowed < last
        path, slow_down = self._stretch(pose, way, int(allowed), allowed < last)
        if path is None:
            if allowed == last or barred:
                self._free = tick
            else:
                self._mark_tick += self._control_ticks
            return None
        drive = self._rollout.follow(pose, twist, self._local.costs, self._local.frame, path, slow_down, around)
        if drive.stuck:
            self._free = tick
            self._escaping_from = pose
            return self._escape(pose, pose, twist, around)
        if drive.command.linear == 0.0 and drive.command.angular != 0.0:
            # Turning to the way is progress that no point of the way shows.
            self._progress = tick
        return drive

    def _escape(self, begun: Pose2, pose: Pose2, twist: Twist, around: Surroundings) -> Drive:
        """Back up a little from where no command led on, then turn to the way."""
        drive = self._rollout.back_up(pose, twist, around)
        if drive.stuck or begun.distance(pose) > ESCAPE:
            self._escaping_from = None
            self._rollout.turn_first()
        return drive

    def _look_around(self, pose: Pose2, twist: Twist, around: Surroundings) -> Drive:
        """One turn in place (rotate_recovery)."""
        drive = self._rollout.turn(pose, twist, pose.theta + 0.5 * math.pi, around)
        turned = abs(drive.command.angular) * self._control_ticks * TICK
        self._turn_left = 0.0 if drive.stuck else self._turn_left - turned
        return drive

    def _finish(self, tick: int, pose: Pose2, twist: Twist, heading: float, around: Surroundings) -> Drive | None:
        """At the goal: stop, turn to its heading, be there."""
        off = abs(wrap_angle(heading - pose.theta))
        standing = abs(twist.linear) < 0.05 and abs(twist.angular) < 0.1
        if self._goal is None or self._making_way:
            if standing:
                self._drop()
            return None
        if off <= self._parameters.TrajectoryPlannerROS.yaw_goal_tolerance:
            if standing:
                self._end(Arrived(self._goal))
            return None
        self._progress = tick
        return self._rollout.turn(pose, twist, heading, around)

    def _stretch(self, pose: Pose2, way: Itinerary, allowed: int, yields: bool) -> tuple[FloatArray | None, float]:
        """The part of the way to drive along now, and how early to slow down; None where the robot has to wait."""
        points = way.points[self._index : allowed + 1]
        count, stopped, turns = _drivable(points, self._local.costs, self._local.frame, pose.x, pose.y)
        points = points[:count]
        yields = stopped or (yields and not turns)
        if len(points) == 0 or (yields and math.hypot(points[-1, 0] - pose.x, points[-1, 1] - pose.y) < HALT):
            return None, 0.0
        ends = not yields and self._index + len(points) == len(way.points)
        slow_down = self._parameters.TrajectoryPlannerROS.sim_time if ends else YIELD_TIME if yields else 0.1
        return points, slow_down


@njit(cache=True)
def _drivable(points: FloatArray, costs: Costs, frame: CostFrame, x: float, y: float) -> tuple[int, bool, bool]:
    """How many of (m, 2) points a robot at (x, y) may be led along at once.

    Where the way turns back, to a place to wait and on again, it first leads to the turning point; and it ends before
    the first point, HALT away or more, that lies in an obstacle's inscribed radius or off the costmap.

    Returns:
        How many; whether an obstacle ends them; whether a turning point does.
    """
    farthest = 0.0
    end, turns = points.shape[0], False
    top = 0
    for i in range(points.shape[0]):
        away = math.hypot(points[i, 0] - x, points[i, 1] - y)
        if away > farthest or i == 0:
            farthest, top = away, i
        if away < farthest - TURNS_BACK:
            end, turns = top + 1, True
            break
    for i in range(end):
        row = math.floor((points[i, 1] - frame.y) / frame.resolution)
        col = math.floor((points[i, 0] - frame.x) / frame.resolution)
        inside = row >= 0 and col >= 0 and row < costs.shape[0] and col < costs.shape[1]
        if inside and costs[row, col] < INSCRIBED:
            continue
        if math.hypot(points[i, 0] - x, points[i, 1] - y) > HALT:
            return i, True, turns
    return end, False, turns


def _discs(neighbours: Sequence[Neighbour]) -> FloatArray:
    """(k, 3) x, y and circumscribed radius of the neighbours."""
    return np.array(
        [(other.base_in_map.x, other.base_in_map.y, circumscribed_radius(other.footprint)) for other in neighbours]
    ).reshape(-1, 3)
