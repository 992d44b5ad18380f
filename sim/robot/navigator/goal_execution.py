"""Execution of goals: the state of move_base, the goal and its clocks, and their changes."""

from collections import deque
from dataclasses import replace

from sim.common.observations import STANDSTILL, TICKS_PER_SECOND
from sim.parameters import MoveBaseParameters
from sim.robot.global_planning.itinerary_planner import ItineraryPlanner
from sim.robot.navigator.follower import FollowerOutput
from sim.robot.navigator.goals import Cancelled, Goal, GoalResult, NoPath
from sim.robot.navigator.progress import GoalProgress
from sim.robot.navigator.recovery import OscillationDetector, RecoveryBehaviours
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


class GoalExecution:
    """State machine of one robot's move_base. The states and transitions are in `states`.

    Args:
        move_base: parameters.
        circumscribed: circumscribed radius of the robot, meters.
        planner: planner of itineraries. Its search stops when the robot stops.

    Attributes:
        move_base: parameters.
        state: the present state.
        goal: the present goal, or None.
        results: results of ended goals that are not reported yet.
        command: the present command.
        next_plan: first tick in which a plan may be made.
        progress: clocks of the goal.
        recovery: remaining recovery behaviors.
        oscillation: detector of oscillations.
        fault: failure of an installed planner or recovery behavior that is not reported yet. Empty if nothing failed.
    """

    def __init__(self, move_base: MoveBaseParameters, circumscribed: float, planner: ItineraryPlanner) -> None:
        self._planner = planner
        self.move_base = move_base
        self.recovery = RecoveryBehaviours(move_base, circumscribed)
        self.oscillation = OscillationDetector(move_base.oscillation_timeout, move_base.oscillation_distance)
        self.results: deque[GoalResult] = deque()
        self.state: State = Idle()
        self.goal: Goal | None = None
        self.command = STANDSTILL
        self.fault = ""
        self.restart(0)

    def configure(self, move_base: MoveBaseParameters, circumscribed: float) -> None:
        """Continue with these parameters."""
        self.move_base = move_base
        self.recovery.configure(move_base, circumscribed)
        self.oscillation.configure(move_base.oscillation_timeout, move_base.oscillation_distance)

    def restart(self, tick: int) -> None:
        """Start all clocks, for a new goal or for a robot that is revived."""
        # In its first tick, a robot has not received any broadcasts. So it would plan out of turn.
        self.next_plan = tick + 1
        self.progress = GoalProgress(tick)
        self.recovery.restart()
        self.oscillation.restart(tick)
        if isinstance(self.state, Clearing):
            self.enter("recovery ended", self.state.then)

    def go(self, goal: Goal, tick: int) -> None:
        """Accept a goal after this tick. The present goal ends as Cancelled."""
        self.cancel()
        self.goal = goal
        self.restart(tick + 1)
        if isinstance(self.state, Idle):
            self.enter("goal received", Planning(self.state.wanted))

    def cancel(self) -> None:
        """Cancel the present goal, if any. It ends as Cancelled, and the robot stops."""
        if self.goal is not None:
            self.end(Cancelled(self.goal))

    def replan(self, tick: int) -> None:
        """Plan again to the present goal after this tick, because the robot's pose was set."""
        self.stop("replan requested")
        now = max(tick, self.progress.began)
        self.next_plan = now + 1
        self.progress.restart_distance(now)

    def enter(self, event: Event, state: State) -> None:
        """Change the state according to TRANSITIONS. During a recovery rotation, change the state that follows it."""
        now = self.state
        if isinstance(now, Clearing) and event != "recovery ended" and isinstance(state, Idle | Planning | Controlling):
            state = replace(now, then=state)
        check_transition(TRANSITIONS, now, event, state)
        self.state = state

    def standing(self, wanted: WantedPath | None = None, waits_for: int | None = None) -> Idle | Planning:
        """Return the state of a robot that stands, with or without a goal."""
        return Idle(wanted) if self.goal is None else Planning(wanted, waits_for)

    def stop(self, event: Event, state: State | None = None) -> None:
        """Stop the robot, drop its itinerary, and stop the search for another itinerary."""
        self.command = STANDSTILL
        self._planner.give_up()
        if not isinstance(self.state, Lost):
            self.enter(event, state or self.standing())

    def end(self, result: GoalResult) -> None:
        """End the present goal with a result, and stop."""
        self.results.append(result)
        self.goal = None
        self.stop("goal ended")

    def given_up(self, goal: Goal) -> NoPath:
        """Return the result of a goal that is given up now."""
        match self.state:
            case Planning(wanted=WantedPath()) | Controlling(output=FollowerOutput(blocked_by_others=True)):
                return NoPath(goal, "robots_in_the_way", "other robots block the path and do not move away")
        return NoPath(goal, "stuck", "the robot is stuck and cannot get free")

    def plan_after(self, tick: int, seconds: float) -> None:
        """Make no plan for some seconds."""
        self.next_plan = tick + round(seconds * TICKS_PER_SECOND)

    @property
    def going_on(self) -> State:
        """The present state; during a recovery behavior, the state that follows the behavior."""
        return self.state.then if isinstance(self.state, Clearing) else self.state

    def makes_way_for(self, tick: int) -> int | None:
        """Return the robot with the right of way for which this robot makes way in this tick."""
        match self.going_on:
            case Controlling(output=FollowerOutput(waiting=True, waits_for=first)):
                return first
            case Controlling(follower, gives_way, makes_way_for=first) if gives_way or follower.hindered:
                return first
            case Planning(wanted=None, waits_for=first):
                yields_to = self.progress.yields_to(tick)
                return first if yields_to is None else yields_to
        return None
