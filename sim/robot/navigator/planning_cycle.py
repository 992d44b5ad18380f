"""State "planning" of move_base: times of plans, effects of plans, and the order in which robots drive."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from sim.common.geometry import Pose2
from sim.common.observations import TICK, TICKS_PER_SECOND, Claim, Neighbour
from sim.numerics import elementary_arrays
from sim.numerics.float_array import FloatArray
from sim.robot.global_planning.itinerary import (
    Itinerary,
    OtherItineraries,
    itineraries_of,
    itineraries_of_moving,
    start_time,
)
from sim.robot.global_planning.itinerary_planner import BlockedByRobots, ItineraryPlanner
from sim.robot.global_planning.path import PlanRefusal, headings
from sim.robot.navigator.clearing_cycle import ClearingCycle
from sim.robot.navigator.controller import Controller
from sim.robot.navigator.follower import Follower
from sim.robot.navigator.goal_execution import GoalExecution
from sim.robot.navigator.goals import Goal, NoPath
from sim.robot.navigator.rotated_map import RotatedMap
from sim.robot.navigator.states import Clearing, Controlling, Event, Idle, Planning, WantedPath

PLAN_RETRY = 0.5
"""Seconds between planning attempts."""
HELD_UP_RETRY = 2.0
"""Seconds between planning attempts of a robot without progress."""
CLEARING_TIMEOUT = 60.0
"""Seconds for which a robot waits for others to clear its path."""


class PlanningCycle:
    """State "planning" of one robot's move_base.

    Args:
        execution: execution of the robot's goal.
        planner: planner of itineraries.
        controller: controller for the followers of itineraries.
        clearing: recovery behaviors.
        rotated: the map.
        robot: index of the robot in the team.
    """

    def __init__(
        self,
        execution: GoalExecution,
        planner: ItineraryPlanner,
        controller: Controller,
        clearing: ClearingCycle,
        rotated: RotatedMap,
        robot: int,
    ) -> None:
        self._execution = execution
        self._planner = planner
        self._controller = controller
        self._clearing = clearing
        self._rotated = rotated
        self._robot = robot
        # The follower whose path was last found to be free of obstacles seen by the laser.
        self._free: Follower | None = None
        # True if the robot keeps its present itinerary when the present search finds no other itinerary.
        self._keeps = False

    def run(self, tick: int, pose: Pose2, neighbours: Sequence[Neighbour]) -> None:
        """Plan if it is this robot's turn, and if a plan is needed."""
        if self._execution.goal is not None and self._execution.progress.timed_out(tick):
            self._execution.end(self._execution.given_up(self._execution.goal))
        # A search that takes several ticks keeps the purpose for which it began.
        keeps = self._planner.searching and self._keeps
        if isinstance(self._execution.state, Controlling) and not self._planner.searching:
            if self._execution.progress.stays:
                self._clearing.recover(tick, pose, self._execution.given_up)
            elif self._execution.state.follower.obstructed():
                self._execution.plan_after(tick, PLAN_RETRY)
            elif self._execution.oscillation.due(tick) or self._out_of_control(tick):
                self._clearing.recover(tick, pose, self._execution.given_up)
            elif self._execution.state.follower.held_up(tick):
                self._execution.plan_after(tick, HELD_UP_RETRY)
            elif not self._execution.state.gives_way and self._replans(tick):
                keeps = True
            else:
                return
        if isinstance(self._execution.state, Clearing):
            return
        # A robot that has just given way lets the other robot plan first. Otherwise it could block the path again.
        if self._execution.goal is not None and self._execution.progress.yields_to(tick) is None:
            self._plan(tick, pose, self._execution.goal, neighbours, keeps)
        if not isinstance(self._execution.state, Controlling):
            asking = self._asked_to_clear(pose, neighbours)
            if asking is not None:
                self._give_way(tick, pose, asking, neighbours)
            elif isinstance(self._execution.state, Idle) and self._execution.state.wanted is not None:
                self._execution.enter("no longer asked", Idle())

    def forget_free_path(self) -> None:
        """Record a new scan, so that the path may no longer be free."""
        self._free = None

    def drives_on(self, state: Controlling, tick: int) -> bool:
        """Return True if a robot needs no plan until and including a tick, unless a scan or a command comes before."""
        execution, follower = self._execution, state.follower
        progress = execution.progress
        # All these conditions become true with time, and never false again without a scan or a command.
        if (
            (execution.goal is not None and progress.timed_out(tick))
            or self._planner.searching
            or progress.stays
            or execution.oscillation.due(tick)
            or self._out_of_control(tick)
            or follower.held_up(tick)
            or (not state.gives_way and self._replans(tick))
        ):
            return False
        # The rest of a free path is also free.
        if self._free is not follower:
            self._free = None if follower.obstructed() else follower
        return self._free is follower

    def _out_of_control(self, tick: int) -> bool:
        patience = self._execution.move_base.controller_patience
        return tick - self._execution.progress.last_valid > patience * TICKS_PER_SECOND

    def _replans(self, tick: int) -> bool:
        """Return True if a plan is due although the present plan is valid."""
        rate = self._execution.move_base.planner_frequency
        return rate > 0.0 and tick - self._execution.progress.planned >= TICKS_PER_SECOND / rate

    def _plan(self, tick: int, pose: Pose2, goal: Goal, neighbours: Sequence[Neighbour], keeps: bool) -> None:
        self._execution.progress.planned = tick
        target = self._rotated.pose_in_grid(goal.base_in_map)
        first = self._defers_to(target, neighbours)
        if first is not None:
            if not keeps:
                self._execution.plan_after(tick, PLAN_RETRY)
                if isinstance(self._execution.state, Planning):
                    self._execution.enter("deferred", replace(self._execution.state, waits_for=first))
            return
        others = itineraries_of(neighbours)
        self._planner.update_neighbours(neighbours)
        planned = self._planner.plan(pose, target, self._time(tick, pose, others), others)
        if planned is None:
            self._execution.next_plan, self._keeps = tick + 1, keeps
            return
        # The present itinerary is still valid, so the robot continues with it.
        if keeps and not isinstance(planned, Itinerary):
            return
        match planned:
            case Itinerary():
                met = self._planner.made_way_for(planned, others)
                first = None if met is None else neighbours[met].robot
                self._follow("plan made", tick, planned, target.theta, first, gives_way=False)
            case BlockedByRobots(wanted_path):
                self._ask(tick, goal, wanted_path, target.theta, neighbours)
            case PlanRefusal():
                self._execution.stop("plan refused")
                self._execution.plan_after(tick, PLAN_RETRY)
                self._refuse(tick, pose, goal, planned)

    def _defers_to(self, target: Pose2, neighbours: Sequence[Neighbour]) -> int | None:
        """Return a robot that should go first, because its goal is older and its wanted path leads over `target`."""
        own = Claim(self._execution.progress.began, self._robot)
        older = (other for other in neighbours if other.claim is not None and other.claim < own)
        place = target.array()[:2]
        return next((other.robot for other in older if self._planner.obstructs(place, other.path)), None)

    def _ask(self, tick: int, goal: Goal, path: FloatArray, heading: float, neighbours: Sequence[Neighbour]) -> None:
        """Ask the robots that stand on a path to clear it. After CLEARING_TIMEOUT, give up."""
        planner, progress = self._planner, self._execution.progress
        wanted = WantedPath(headings(path, heading), Claim(progress.began, self._robot))
        self._execution.stop("blocked by robots", Planning(wanted, planner.first_obstructing(neighbours, path)))
        self._execution.plan_after(tick, PLAN_RETRY)
        progress.note_path(float(elementary_arrays.hypot(*np.diff(path, axis=0).T).sum()))
        if any(len(other.times) and planner.obstructs(other.path[-1], path) for other in neighbours):
            progress.note_others_arriving(tick)
        if progress.patience_over(tick, CLEARING_TIMEOUT):
            self._execution.end(self._execution.given_up(goal))

    def _refuse(self, tick: int, pose: Pose2, goal: Goal, refused: PlanRefusal) -> None:
        """Wait until a path is free, then try recovery, then give up."""
        move_base, retries = self._execution.move_base, self._execution.progress.count_retry()
        waited = self._execution.progress.patience_over(tick, move_base.planner_patience)
        waited = waited or 0 <= move_base.max_planning_retries < retries
        # Recovery behaviors can only remove obstacles that the laser has seen. All other causes are on the map.
        if refused.code in ("goal_outside", "goal_occupied") or (waited and refused.code != "blocked_by_obstacle"):
            self._execution.end(NoPath(goal, refused.code, refused.sentence))
        elif waited:
            self._clearing.recover(tick, pose, lambda goal: NoPath(goal, refused.code, refused.sentence))

    def _asked_to_clear(self, pose: Pose2, neighbours: Sequence[Neighbour]) -> Neighbour | None:
        """Return the robot with the highest priority, above this robot's, whose path this robot blocks."""
        own = None if self._execution.goal is None else Claim(self._execution.progress.began, self._robot)
        strongest: Neighbour | None = None
        for other in neighbours:
            if other.claim is None or (own is not None and other.claim > own):
                continue
            if strongest is not None and strongest.claim is not None and strongest.claim <= other.claim:
                continue
            if self._planner.obstructs(pose.array()[:2], other.path):
                strongest = other
        return strongest

    def _give_way(self, tick: int, pose: Pose2, asking: Neighbour, neighbours: Sequence[Neighbour]) -> None:
        others = itineraries_of(neighbours)
        self._planner.update_neighbours(neighbours)
        away = self._planner.refuge(pose, asking.path, self._time(tick, pose, others), others)
        self._execution.plan_after(tick, PLAN_RETRY)
        if away is not None:
            self._execution.progress.note_way_given(tick, asking.robot)
            self._follow("asked to clear", tick, away, pose.theta, asking.robot, gives_way=True)
            return
        # Resting robots block this robot's path. It asks them on behalf of the other robot, with that robot's priority.
        movers = itineraries_of_moving(neighbours)
        away = self._planner.refuge(pose, asking.path, self._time(tick, pose, movers), movers)
        if away is not None or self._execution.goal is None:
            wanted = None if away is None else WantedPath(headings(away.points, pose.theta), asking.claim)
            waits_for = self._execution.state.waits_for if isinstance(self._execution.state, Planning) else None
            self._execution.enter("asked to clear", self._execution.standing(wanted, waits_for))

    def _time(self, tick: int, pose: Pose2, others: OtherItineraries) -> float:
        if isinstance(self._execution.state, Controlling):
            return self._execution.state.follower.time
        return float(start_time(tick * TICK, pose.x, pose.y, others, self._planner.separation))

    @property
    def _driven_on(self) -> Controlling | None:
        """The present state if the robot drives on while its plan is replaced; otherwise None.

        This happens, for example, with a planner_frequency above 0.
        """
        state = self._execution.state
        often = self._execution.move_base.planner_frequency > 0.0
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
            self._planner,
            tick,
            itinerary,
            heading,
            not gives_way,
            None if replaced is None else replaced.follower,
        )
        if replaced is None:
            self._execution.stop(event, Controlling(follower, gives_way, makes_way_for=makes_way_for))
        else:
            self._execution.enter(event, replace(replaced, follower=follower, makes_way_for=makes_way_for))
        self._execution.progress.restart_patience(tick)
        self._execution.progress.note_path(follower.remaining)
