"""The navigator: from a goal to commands (move_base).

A goal is planned for (`planning.itinerary_planner`), followed as far as the right of way reaches
(`navigator.follower`), and ends GoalReached, NoPath or Cancelled. Where robots that stand leave no path, the robot
broadcasts the path it wants; those of them that rest, or whose goals are younger, move aside. An obstacle seen on the
path is planned around at once; where that leaves no path, the robot waits, then tries the recovery behaviours. Whatever
the cause, a goal whose remaining path has not become shorter for PROGRESS_TIMEOUT seconds is given up: every goal ends
in bounded time. `navigator.states` has the states, and the table of all transitions between them.

Source: ros-planning/navigation, move_base/src/move_base.cpp.
Differs: plans and commands are made in the tick that is due, without threads, but the search for a path on a large map
takes several ticks, a portion of the map in each; robots take turns in planning. A goal that the map alone makes
impossible is given up without recovery. A robot that waits for its right of way neither
oscillates nor is out of valid commands. One that drives in one place for STAY_TIMEOUT seconds tries a recovery behavior
even with `oscillation_timeout: 0`.
"""

import math
from collections import deque
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from operator import attrgetter

import numpy as np

from sim.common.geometry import Pose2
from sim.common.grid import OccupancyGrid
from sim.common.observations import STANDSTILL, TICK, TICKS_PER_SECOND, Claim, Neighbour, Scan, Twist, next_turn
from sim.numerics import elementary_arrays, noise
from sim.numerics.float_array import FloatArray
from sim.parameters import GlobalPlannerParameters, NavfnParameters, RobotParameters
from sim.robot.costmap.obstacle import CostmapObservation
from sim.robot.costmap.robots import neighbours_reaching
from sim.robot.global_planning.itinerary import (
    Itinerary,
    OtherItineraries,
    itineraries_of,
    itineraries_of_moving,
    start_time,
)
from sim.robot.global_planning.itinerary_planner import BlockedByRobots, ItineraryPlanner
from sim.robot.global_planning.make_plan import make_plan
from sim.robot.global_planning.path import PlannerFactory, PlanRefusal, RobotPathPlanner, headings
from sim.robot.global_planning.planners import global_planner
from sim.robot.global_planning.wave import Workspace
from sim.robot.navigator.controller import Controller
from sim.robot.navigator.costmaps import Costmaps
from sim.robot.navigator.follower import NO_POSES, NO_TIMES, STANDING, Follower, FollowerOutput
from sim.robot.navigator.goals import Cancelled, Goal, GoalReached, GoalResult, NoPath
from sim.robot.navigator.making_way import MakingWay
from sim.robot.navigator.navigation import Navigation, NavigatorState
from sim.robot.navigator.progress import GoalProgress
from sim.robot.navigator.recovery import (
    LONGEST_RECOVERY,
    OscillationDetector,
    RecoveryBehaviours,
    RecoveryFactory,
    RecoveryProgress,
    RecoverySituation,
    RunningRecovery,
)
from sim.robot.navigator.rotated_map import RotatedMap
from sim.robot.navigator.stale_neighbours import StaleNeighbours
from sim.robot.navigator.states import (
    TRANSITIONS,
    Clearing,
    Controlling,
    Event,
    Idle,
    Lost,
    Planning,
    State,
    WantedPath,
)
from sim.robot.navigator.transitions import check_transition
from sim.robot.part_failure import PartFailed

_CLAIM = attrgetter("claim")

PLAN_RETRY = 0.5
"""Seconds between attempts to plan."""
HELD_UP_RETRY = 2.0
"""The same for a robot that is held up."""
CLEARING_TIMEOUT = 60.0
"""Seconds that a robot waits for others to clear its path."""


class Navigator:
    """The navigator of one robot.

    Args:
        parameters: this robot's software's.
        footprint: (n, 2) corners of its body, base frame, metres.
        static: the map.
        robot: its index in the team.
        space: room to plan in, which it may share with others: nothing is kept there between plans. None: of its own.
        seed: random seed of recovery behaviors.
        recoveries: recovery behaviors of others, by name.
        planners: global planners of others, by name.
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
        self._recoveries = recoveries or {}
        self._planners = planners or {}
        self._fault = ""
        self._rotated = RotatedMap(static)
        static = self._rotated.grid
        self._parameters = parameters
        self._robot = robot
        self._costmaps = Costmaps(parameters, footprint, self._rotated, robot)
        self._space = space
        self._itinerary_planner = ItineraryPlanner(
            static,
            self._costmaps.global_costmap,
            parameters.global_costmap.inflation_layer,
            self._planner(parameters, space),
        )
        self._controller = Controller(parameters, static, self._costmaps, robot)
        move_base = parameters.move_base
        self._recovery = RecoveryBehaviours(move_base, self._costmaps.global_costmap.circumscribed_radius)
        self._oscillation = OscillationDetector(move_base.oscillation_timeout, move_base.oscillation_distance)
        self._stale = StaleNeighbours()
        self._making_way = MakingWay()
        self._results: deque[GoalResult] = deque()
        self._state: State = Idle()
        self._goal: Goal | None = None
        self._tick = -1
        self._command = STANDSTILL
        # True when the robot follows its present itinerary should the plan under way find none.
        self._keeps = False
        self._restart(0)

    def _restart(self, tick: int) -> None:
        """Start all clocks, those of a new goal or of a robot that comes back to life."""
        # In its first tick a robot has received no broadcasts yet, and would plan out of turn.
        self._next_plan = tick + 1
        self._progress = GoalProgress(tick)
        self._recovery.restart()
        self._oscillation.restart(tick)
        if isinstance(self._state, Clearing):
            self._enter("recovery ended", self._state.then)

    def go(self, goal: Goal) -> None:
        """Take up a goal; the present one ends Cancelled."""
        self.cancel()
        self._goal = goal
        self._restart(self._tick + 1)
        if isinstance(self._state, Idle):
            self._enter("goal received", Planning(self._state.wanted))

    def cancel(self) -> None:
        """Give up the present goal, if any: it ends Cancelled, and the robot stops."""
        if self._goal is not None:
            self._end(Cancelled(self._goal))

    def replan(self) -> None:
        """Plan anew to the present goal: the robot was told that it is somewhere else."""
        self._stop("told to replan")
        now = max(self._tick, self._progress.began)
        self._next_plan = now + 1
        self._progress.restart_distance(now)

    def clear_costmaps(self) -> None:
        """Forget what the laser has seen."""
        self._costmaps.clear()

    def configure(self, parameters: RobotParameters) -> None:
        """Go on with these parameters (ROS: dynamic_reconfigure): with the same goal, plan and obstacles seen."""
        before, move_base = self._parameters, parameters.move_base
        if parameters == before:
            return
        self._parameters = parameters
        self._costmaps.configure(parameters)
        if parameters.global_costmap != before.global_costmap or _plans_by(parameters) != _plans_by(before):
            self._itinerary_planner.configure(
                parameters.global_costmap.inflation_layer, self._planner(parameters, self._space)
            )
        self._controller.configure(parameters)
        self._recovery.configure(move_base, self._costmaps.global_costmap.circumscribed_radius)
        self._oscillation.configure(move_base.oscillation_timeout, move_base.oscillation_distance)

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
        adds = self._parameters.move_base.make_plan_add_unreachable_goal
        # In room of its own: a search may be under way in the other.
        start, goal = turned.pose_in_grid(start), turned.pose_in_grid(goal)
        try:
            poses = make_plan(self._planner(self._parameters), costs, frame, start, goal, tolerance, adds)
        except PartFailed as failed:
            return PlanRefusal("no_way", str(failed))
        return poses if isinstance(poses, PlanRefusal) else turned.poses_in_map(poses)

    def _planner(self, parameters: RobotParameters, space: Workspace | None = None) -> RobotPathPlanner:
        """The global planner that these parameters name; `space` as for `Navigator`."""
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
        """One tick.

        Args:
            tick: the present one.
            base_in_map: believed pose of the robot.
            twist: its velocity, by odometry.
            scan: the laser's, where it was due.
            neighbours: broadcasts of the other robots in the last tick.
            lost: True when that pose cannot be relied on: with a goal the robot looks around until it can.
        """
        if tick != self._tick + 1:
            self._restart(tick)
        self._tick = tick
        pose, neighbours = self._rotated.pose_in_grid(base_in_map), self._rotated.neighbours_in_grid(neighbours)
        self._stale.update(tick, neighbours)
        if lost:
            self._look_around(tick, twist, scan)
            return self._report(tick, pose)
        if isinstance(self._state, Lost):
            self._command = STANDSTILL  # It looks around no longer, whenever the next command is due.
            self._enter("located", self._standing())
        if scan is not None:
            laser = pose.compose(scan.mount.laser_in_base)
            self._stale.forget_seen_through(laser, scan)
            if self._goal is not None or not self._parameters.move_base.shutdown_costmaps:
                discs = _discs(self._stale.known(tick), laser, self._costmaps.explained_range)
                seen = CostmapObservation(pose, scan, discs)
                self._costmaps.global_costmap.observe(seen)
                self._controller.keep_scan(seen)
        self._itinerary_planner.search_on()
        if (tick - self._robot) % self._team == 0 and tick >= self._next_plan and not isinstance(self._state, Clearing):
            self._choose_plan(tick, pose, self._stale.known(tick))
        if self._controller.command_due(tick):
            bodies = [*neighbours, *self._stale.bodies()]
            self._choose_command(tick, pose, twist, bodies)
        return self._report(tick, pose)

    def next_due(self, tick: int, neighbours: Sequence[Neighbour]) -> int:
        """Return the first tick after a step's in which another would do more than repeat its output, without a scan.

        Where that cannot be told it is the very next one. A request, and another team, make one due at once.

        Args:
            tick: that of the last step.
            neighbours: broadcasts of the other robots in that tick.
        """
        state = self._state
        waits = self._making_way.pauses or self._progress.yields_to(tick) is not None
        if (
            waits
            or self._results
            or self._itinerary_planner.searching
            or not isinstance(state, Idle | Planning | Controlling)
        ):
            return tick + 1
        due = [self._costmaps.next_due(tick)]
        if isinstance(state, Controlling):
            due.append(self._controller.next_command(tick))
        rests = isinstance(state, Idle) and state.wanted is None
        if not rests or any(map(_CLAIM, neighbours)):
            due.append(next_turn(max(tick, self._next_plan - 1), self._robot, self._team))
        return min((one for one in due if one is not None), default=tick + TICKS_PER_SECOND)

    def skip(self, tick: int) -> None:
        """Take note of a tick in which no step was due."""
        self._tick = tick
        self._making_way.go_on(tick)

    def rejoin(self, neighbours: Sequence[Neighbour]) -> None:
        """Take in broadcasts of the last tick, in which no step was due: some of them are the last of their robots."""
        self._stale.update(self._tick, self._rotated.neighbours_in_grid(neighbours))

    @property
    def recovery(self) -> RecoveryProgress:
        """The recovery behaviours, and how many of them have been tried."""
        return self._recovery.progress

    @property
    def _team(self) -> int:
        """Ticks between two turns to plan, the same for all that broadcast: so no two robots have theirs at once."""
        return 1 + max(self._robot, self._stale.highest_robot)

    def _report(self, tick: int, pose: Pose2) -> Navigation:
        name: NavigatorState = "idle" if self._goal is None else "planning"
        plan, times, remaining, claim = NO_POSES, NO_TIMES, 0.0, None
        fault, self._fault = self._fault or self._itinerary_planner.fault, ""
        self._itinerary_planner.fault = ""
        output, waits_for = STANDING, None if self._goal is None else self._progress.yields_to(tick)
        state = self._state.then if isinstance(self._state, Clearing) else self._state
        match state:
            case Controlling(follower, _, output):
                name, (plan, times, remaining), waits_for = "controlling", follower.ahead, output.waits_for
            case Planning(waits_for=first) if waits_for is None:
                waits_for = first
        if isinstance(state, Idle | Planning) and state.wanted is not None:
            plan, claim = state.wanted.poses, state.wanted.claim
        return Navigation(
            self._command,
            self._goal,
            "clearing" if isinstance(self._state, Clearing) else name,
            self._rotated.poses_in_map(plan),
            times,
            self._rotated.poses_in_map(output.local_plan),
            self._results.popleft() if self._results else None,
            remaining,
            claim,
            *self._costmaps.shown(tick, pose, self._stale, self._controller.pending),
            waits_for,
            self._making_way.now(tick, self._makes_way_for(tick), has_goal=self._goal is not None),
            fault,
        )

    def _makes_way_for(self, tick: int) -> int | None:
        """Return the robot that has the right of way over what this one does in this very tick."""
        match self._state.then if isinstance(self._state, Clearing) else self._state:
            case Controlling(output=FollowerOutput(waiting=True, waits_for=first)):
                return first
            case Controlling(follower, gives_way, makes_way_for=first) if gives_way or follower.hindered:
                return first
            case Planning(wanted=None, waits_for=first):
                yields_to = self._progress.yields_to(tick)
                return first if yields_to is None else yields_to
        return None

    # States

    def _enter(self, event: Event, state: State) -> None:
        """Change the state as TRANSITIONS says; in a recovery rotation, the state that follows it."""
        now = self._state
        if isinstance(now, Clearing) and event != "recovery ended" and isinstance(state, Idle | Planning | Controlling):
            state = replace(now, then=state)
        check_transition(TRANSITIONS, now, event, state)
        self._state = state

    def _standing(self, wanted: WantedPath | None = None, waits_for: int | None = None) -> Idle | Planning:
        """Return the state of a robot that stands, with or without a goal."""
        return Idle(wanted) if self._goal is None else Planning(wanted, waits_for)

    def _stop(self, event: Event, state: State | None = None) -> None:
        """Stand, and follow the present itinerary no longer; give up the search for another."""
        self._command = STANDSTILL
        self._itinerary_planner.give_up()
        if not isinstance(self._state, Lost):
            self._enter(event, state or self._standing())

    def _end(self, result: GoalResult) -> None:
        self._results.append(result)
        self._goal = None
        self._stop("goal ended")

    def _look_around(self, tick: int, twist: Twist, scan: Scan | None) -> None:
        """Look around; a goal waits for the robot to know its place again, but not for ever."""
        if not isinstance(self._state, Lost):
            # Obstacles that were seen from a wrong pose were marked at wrong places.
            self._costmaps.clear_outside(0.0, 0.0, 0.0)
            self._stop("lost", Lost())
        self._next_plan = tick + 2
        if self._goal is None:
            return
        if scan is not None:
            self._command = self._controller.look_around(twist, scan)
        if self._progress.timed_out(tick):
            self._end(NoPath(self._goal, "lost", "the robot does not know where it is"))

    # Plans

    def _choose_plan(self, tick: int, pose: Pose2, neighbours: Sequence[Neighbour]) -> None:
        """Plan if there is something to plan for; it is this robot's turn."""
        if self._goal is not None and self._progress.timed_out(tick):
            self._end(self._given_up(self._goal))
        # A search that takes several ticks ends as what it was begun for.
        keeps = self._itinerary_planner.searching and self._keeps
        if isinstance(self._state, Controlling) and not self._itinerary_planner.searching:
            if self._progress.stays:
                self._recover(tick, pose, self._given_up)
            elif self._state.follower.obstructed():
                self._plan_after(tick, PLAN_RETRY)
            elif self._oscillation.due(tick) or self._out_of_control(tick):
                self._recover(tick, pose, self._given_up)
            elif self._state.follower.held_up(tick):
                self._plan_after(tick, HELD_UP_RETRY)
            elif not self._state.gives_way and self._replans(tick):
                keeps = True
            else:
                return
        if isinstance(self._state, Clearing):
            return
        if self._goal is not None and self._progress.yields_to(tick) is None:
            self._plan(tick, pose, self._goal, neighbours, keeps)
        if not isinstance(self._state, Controlling):
            asking = self._asked_to_clear(pose, neighbours)
            if asking is not None:
                self._give_way(tick, pose, asking, neighbours)
            elif isinstance(self._state, Idle) and self._state.wanted is not None:
                self._enter("no longer asked", Idle())

    def _plan_after(self, tick: int, seconds: float) -> None:
        self._next_plan = tick + round(seconds * TICKS_PER_SECOND)

    def _out_of_control(self, tick: int) -> bool:
        patience = self._parameters.move_base.controller_patience
        return tick - self._progress.last_valid > patience * TICKS_PER_SECOND

    def _replans(self, tick: int) -> bool:
        """Return True when a plan is due although the present one is good."""
        rate = self._parameters.move_base.planner_frequency
        return rate > 0.0 and tick - self._progress.planned >= TICKS_PER_SECOND / rate

    def _recover(self, tick: int, pose: Pose2, why: Callable[[Goal], NoPath]) -> None:
        """Try the next recovery behaviour; when there is none left, the goal is given up."""
        self._oscillation.restart(tick)
        self._progress.restart_stay()
        self._progress.restart_patience(tick)
        self._progress.last_valid = tick
        behaviour = self._recovery.next()
        if behaviour is None:
            if self._goal is not None:
                self._end(why(self._goal))
            else:
                self._stop("way given")
        elif behaviour == "rotate_recovery":
            self._stop("recovery", Clearing(math.tau, self._standing()))
        elif behaviour in self._recoveries:
            self._begin(behaviour, tick)
        else:
            self._costmaps.clear_outside(pose.x, pose.y, self._recovery.reset_side(behaviour))

    def _begin(self, name: str, tick: int) -> None:
        """Begin a recovery behavior of others."""
        try:
            behavior = self._recoveries[name](int(noise.key(self._seed, "recovery", name, str(tick))))
        except PartFailed as failed:
            self._fault = str(failed)
        else:
            self._stop("recovery", Clearing(0.0, self._standing(), behavior, tick))

    def _given_up(self, goal: Goal) -> NoPath:
        match self._state:
            case Planning(wanted=WantedPath()) | Controlling(output=FollowerOutput(blocked_by_others=True)):
                return NoPath(goal, "robots_in_the_way", "other robots stand in the way and do not clear it")
        return NoPath(goal, "stuck", "the robot is stuck and cannot get free")

    def _plan(self, tick: int, pose: Pose2, goal: Goal, neighbours: Sequence[Neighbour], keeps: bool) -> None:
        self._progress.planned = tick
        target = self._rotated.pose_in_grid(goal.base_in_map)
        first = self._defers_to(target, neighbours)
        if first is not None:
            if not keeps:
                self._plan_after(tick, PLAN_RETRY)
                if isinstance(self._state, Planning):
                    self._enter("deferred", replace(self._state, waits_for=first))
            return
        others = itineraries_of(neighbours)
        self._itinerary_planner.update_neighbours(neighbours)
        planned = self._itinerary_planner.plan(pose, target, self._time(tick, pose, others), others)
        if planned is None:
            self._next_plan, self._keeps = tick + 1, keeps
            return
        if keeps and not isinstance(planned, Itinerary):
            return
        match planned:
            case Itinerary():
                met = self._itinerary_planner.made_way_for(planned, others)
                first = None if met is None else neighbours[met].robot
                self._follow("plan made", tick, planned, target.theta, first, gives_way=False)
            case BlockedByRobots(wanted_path):
                self._ask(tick, goal, wanted_path, target.theta, neighbours)
            case PlanRefusal():
                self._stop("plan refused")
                self._plan_after(tick, PLAN_RETRY)
                self._refuse(tick, pose, goal, planned)

    def _defers_to(self, target: Pose2, neighbours: Sequence[Neighbour]) -> int | None:
        """Return a robot with an older goal on whose wanted path this goal lies: that robot is to go first."""
        own = Claim(self._progress.began, self._robot)
        older = (other for other in neighbours if other.claim is not None and other.claim < own)
        place = target.array()[:2]
        return next((other.robot for other in older if self._itinerary_planner.obstructs(place, other.path)), None)

    def _ask(self, tick: int, goal: Goal, path: FloatArray, heading: float, neighbours: Sequence[Neighbour]) -> None:
        """Ask the robots that stand in a path to clear it; after CLEARING_TIMEOUT give up."""
        planner, progress = self._itinerary_planner, self._progress
        wanted = WantedPath(headings(path, heading), Claim(progress.began, self._robot))
        self._stop("blocked by robots", Planning(wanted, planner.first_obstructing(neighbours, path)))
        self._plan_after(tick, PLAN_RETRY)
        progress.note_path(float(elementary_arrays.hypot(*np.diff(path, axis=0).T).sum()))
        if any(len(other.times) and planner.obstructs(other.path[-1], path) for other in neighbours):
            progress.note_others_arriving(tick)
        if progress.patience_over(tick, CLEARING_TIMEOUT):
            self._end(self._given_up(goal))

    def _refuse(self, tick: int, pose: Pose2, goal: Goal, refused: PlanRefusal) -> None:
        """Wait for a path to open, then recover, then give up."""
        move_base, retries = self._parameters.move_base, self._progress.count_retry()
        waited = self._progress.patience_over(tick, move_base.planner_patience)
        waited = waited or 0 <= move_base.max_planning_retries < retries
        if refused.code in ("goal_outside", "goal_occupied") or (waited and refused.code != "blocked_by_obstacle"):
            self._end(NoPath(goal, refused.code, refused.sentence))
        elif waited:
            self._recover(tick, pose, lambda goal: NoPath(goal, refused.code, refused.sentence))

    def _asked_to_clear(self, pose: Pose2, neighbours: Sequence[Neighbour]) -> Neighbour | None:
        """Return the robot of highest priority, above this one's, on whose wanted path this robot stands."""
        own = None if self._goal is None else Claim(self._progress.began, self._robot)
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
        self._plan_after(tick, PLAN_RETRY)
        if away is not None:
            self._progress.note_way_given(tick, asking.robot)
            self._follow("asked to clear", tick, away, pose.theta, asking.robot, gives_way=True)
            return
        # Robots that rest around it are in its path: they are asked in their turn, with the same priority.
        movers = itineraries_of_moving(neighbours)
        away = self._itinerary_planner.refuge(pose, asking.path, self._time(tick, pose, movers), movers)
        if away is not None or self._goal is None:
            wanted = None if away is None else WantedPath(headings(away.points, pose.theta), asking.claim)
            waits_for = self._state.waits_for if isinstance(self._state, Planning) else None
            self._enter("asked to clear", self._standing(wanted, waits_for))

    def _time(self, tick: int, pose: Pose2, others: OtherItineraries) -> float:
        if isinstance(self._state, Controlling):
            return self._state.follower.time
        return float(start_time(tick * TICK, pose.x, pose.y, others, self._itinerary_planner.separation))

    @property
    def _driven_on(self) -> Controlling | None:
        """The present state, if the robot drives on while its plan is replaced: where plans are made all the time."""
        state = self._state
        often = self._parameters.move_base.planner_frequency > 0.0
        return state if often and isinstance(state, Controlling) and not state.gives_way else None

    def _follow(
        self,
        event: Event,
        tick: int,
        itinerary: Itinerary,
        heading: float,
        makes_way_for: int | None,
        *,
        gives_way: bool,
    ) -> None:
        replaced = None if gives_way else self._driven_on
        follower = Follower(
            self._controller,
            self._itinerary_planner,
            tick,
            itinerary,
            heading,
            not gives_way,
            None if replaced is None else replaced.follower,
        )
        if replaced is None:
            self._stop(event, Controlling(follower, gives_way, makes_way_for=makes_way_for))
        else:
            self._enter(event, replace(replaced, follower=follower, makes_way_for=makes_way_for))
        self._progress.restart_patience(tick)
        self._progress.note_path(follower.remaining)

    # Commands

    def _choose_command(self, tick: int, pose: Pose2, twist: Twist, bodies: Sequence[Neighbour]) -> None:
        match self._state:
            case Controlling():
                self._control(self._state, tick, pose, twist, bodies)
            case Clearing() as state:
                if state.behavior is None:
                    self._turn(state, pose, twist, bodies)
                else:
                    self._behave(state, state.behavior, tick, pose, twist, bodies)
            case _:
                self._command = STANDSTILL

    def _control(self, state: Controlling, tick: int, pose: Pose2, twist: Twist, bodies: Sequence[Neighbour]) -> None:
        """Choose a command along the itinerary."""
        self._oscillation.watch(tick, pose)
        output = state.follower.step(tick, pose, twist, bodies)
        self._command = output.command
        self._enter("command due", replace(state, output=output))
        if output.waiting:
            self._oscillation.pause(self._controller.control_ticks)
        else:
            self._progress.note_driving(self._controller.control_ticks, pose)
        if output.valid:
            self._progress.last_valid = tick
        if not state.gives_way and self._progress.watch(tick, state.follower.remaining):
            self._recovery.restart()
        if output.arrived:
            if self._goal is None or state.gives_way:
                self._stop("way given")
            else:
                self._end(GoalReached(self._goal))

    def _turn(self, state: Clearing, pose: Pose2, twist: Twist, bodies: Sequence[Neighbour]) -> None:
        """Choose a command of one full turn in place, as far as that is safe."""
        drive = self._controller.rotate_recovery(pose, twist, bodies)
        left = state.turn_left - abs(drive.command.angular) * self._controller.control_ticks * TICK
        if left > 0.0 and not drive.stuck:
            self._command = drive.command
            self._enter("command due", replace(state, turn_left=left))
        else:
            self._stop("recovery ended", state.then)

    def _behave(
        self,
        state: Clearing,
        behavior: RunningRecovery,
        tick: int,
        pose: Pose2,
        twist: Twist,
        bodies: Sequence[Neighbour],
    ) -> None:
        """Choose the command of a recovery behavior of others, as far as that is safe."""
        controller, seconds = self._controller, (tick - state.began) * TICK
        scan = None if controller.pending is None else controller.pending.scan
        controller.update_costmap(pose, bodies)
        goal = None if self._goal is None else self._rotated.pose_in_grid(self._goal.base_in_map)
        costs, footprint = controller.costmap.costs.copy(), controller.costmap.footprint.copy()
        for array in (costs, footprint):
            array.setflags(write=False)
        now = RecoverySituation(seconds, pose, twist, goal, scan, costs, controller.costmap.frame, footprint)
        try:
            command = None if seconds > LONGEST_RECOVERY else behavior.command(now)
        except PartFailed as failed:
            command, self._fault = None, str(failed)
        if command is None:
            self._stop("recovery ended", state.then)
            return
        safe = controller.planner.safe(pose, twist, command, controller.surroundings(pose, bodies))
        self._command = command if safe else STANDSTILL
        self._enter("command due", state)


def _plans_by(parameters: RobotParameters) -> tuple[str, NavfnParameters, GlobalPlannerParameters]:
    """All parameters that a global planner is made from."""
    return parameters.move_base.base_global_planner, parameters.NavfnROS, parameters.GlobalPlanner


def _discs(neighbours: Sequence[Neighbour], laser: Pose2, reach: float) -> FloatArray:
    """(k, 3) x, y and circumscribed radius of those neighbours that come within `reach` metres of the laser."""
    near = neighbours_reaching(neighbours, laser.x - reach, laser.y - reach, laser.x + reach, laser.y + reach)
    return np.array([(other.base_in_map.x, other.base_in_map.y, radius) for other, radius in near]).reshape(-1, 3)
