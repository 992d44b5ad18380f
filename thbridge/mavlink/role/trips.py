"""Trips that ground stations request: moves of the game, or goals of the navigator outside the game."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from enum import Enum

from sim.common.geometry import Pose2
from sim.common.observations import TICKS_PER_SECOND
from sim.inputs import SendGoal
from sim.robot.navigator.goals import Cancelled, Goal, GoalReached, NoPath
from sim.robot.software import RobotOutput
from sim.snapshot import TeamSnapshot
from thbridge.hunt import rules
from thbridge.hunt.events import Commander
from thbridge.hunt.game import GameState, apply
from thbridge.hunt.refusals import RequestRefused
from thbridge.hunt.rooms import Room
from thbridge.mavlink.values.vehicle_interface import Denied, HelmLeg, LegState
from thbridge.roles.shared import failure_reasons as reasons
from thbridge.roles.shared.robot_requests import Request, StationSend, StationStop
from thbridge.ros.messages.goal_owners import GoalOwner

RESPONSE_TIMEOUT = TICKS_PER_SECOND
"""After this many ticks without observations, a robot counts as silent. After this many ticks without a goal status, a
goal fails."""


class TripStage(Enum):
    """Stage of a trip: it waits for the end of an earlier move of the game, it is requested, or the robot drives."""

    WAITING = 0
    ASKED = 1
    GOING = 2


@dataclass(frozen=True, slots=True)
class VehicleTrip:
    """Leg of a robot and its execution.

    Attributes:
        leg: state of the leg for ground stations.
        target: goal pose of the base, map frame.
        room: destination of a move of the game. If None, the goal is outside the game.
        stage: stage of the execution.
        unanswered_ticks: ticks without a status of the goal from the navigator.
    """

    leg: HelmLeg
    target: Pose2
    room: Room | None
    stage: TripStage = TripStage.WAITING
    unanswered_ticks: int = 0

    @property
    def goal(self) -> Goal:
        """The navigator's goal, for a trip outside the game."""
        return Goal(self.leg.number, self.target, GoalOwner.GROUND_STATION)

    @property
    def under_way(self) -> bool:
        """True until the trip has ended."""
        return self.leg.state is LegState.UNDER_WAY

    def ended(self, state: LegState, reason: str = "") -> "VehicleTrip":
        """Return the trip after its end."""
        return replace(self, leg=HelmLeg(self.leg.number, state, 0.0, reason))

    def failed(self, reason: str) -> "VehicleTrip":
        """Return the trip after its failure for this reason."""
        return self.ended(LegState.FAILED, reason)


class TripDispatcher:
    """Dispatcher of one robot's trips, one at a time.

    It requests a trip from the game or the navigator when the trip can start.

    Args:
        robot: its index in the team, from 0.
        ask: queues requests to the robots and the game for the next tick.
    """

    def __init__(self, robot: int, ask: Callable[[Request], None]) -> None:
        self._robot = robot
        self._ask = ask
        self._legs = 0
        self._trip: VehicleTrip | None = None
        self._game: GameState | None = None
        # `_sent`: a move was requested since the last tick. `_stopping`: the current move of the game has to end.
        self._sent = False
        self._stopping = False

    @property
    def leg(self) -> HelmLeg | None:
        """Progress of the last trip. None before the first trip."""
        return None if self._trip is None else self._trip.leg

    def begin(self, target: Pose2, room: Room | None, here: Pose2, state: GameState) -> int | Denied:
        """Start a trip. It replaces the last trip.

        Args:
            target: goal pose of the base, map frame.
            room: destination of a move of the game. If None, the goal is outside the game.
            here: current pose of the base, map frame.
            state: state of the game after all requests so far.

        Returns:
            The number of the leg, or the refusal by the game.
        """
        trip = VehicleTrip(HelmLeg(self._legs + 1, LegState.UNDER_WAY, here.distance(target)), target, room)
        # The robot is already on its way to this room, so no new move is requested.
        if room is not None and state.robots[self._robot].bound_for == room and not self._stopping:
            trip = replace(trip, stage=TripStage.GOING)
        elif room is not None and isinstance(ruling := _judge(state, self._robot, room), RequestRefused):
            return Denied(ruling.sentence, is_done=ruling.reason == rules.RuleReason.ALREADY_VISITED)
        self._legs += 1
        self._trip = self._set_out(trip, state) if trip.stage is TripStage.WAITING else trip
        return trip.leg.number

    def abort(self, reason: str) -> None:
        """Abort the current trip for this reason. Also abort the current move of the game of any commander."""
        if self._trip is not None and self._trip.under_way:
            self._trip = self._trip.failed(reason)
        self._stop_move()

    def follow(self, snapshot: TeamSnapshot, game: GameState | None) -> None:
        """Update the trip after a tick."""
        self._game, self._sent = game, False
        if game is None:
            return
        self._stopping = self._stopping and game.robots[self._robot].bound_for is not None
        if self._stopping:
            self._ask(StationStop(self._robot))
        if self._trip is not None and self._trip.under_way:
            trip = advanced(self._trip, snapshot, game, self._robot)
            self._trip = self._set_out(trip, game) if trip.stage is TripStage.WAITING else trip

    def _set_out(self, trip: VehicleTrip, state: GameState) -> VehicleTrip:
        """Request a trip. If a move of the game has to end first, request it later.

        After a failsafe, the participant commands the robot again. The drive home continues until a commander sends the
        robot to another goal.
        """
        mover = state.robots[self._robot]
        if self._sent or mover.bound_for is not None:
            if not self._stopping:
                if mover.holder.by is not Commander.GROUND_STATION:
                    return trip.failed(reasons.ELSEWHERE)
                self._stop_move()
            return trip
        if trip.room is None:
            if mover.intervention is not None:
                return trip.failed(reasons.ELSEWHERE)
            self._ask(SendGoal(self._robot, trip.goal))
            return replace(trip, stage=TripStage.GOING)
        ruling = rules.move(state, self._robot, trip.room, Commander.GROUND_STATION)
        if isinstance(ruling, RequestRefused):
            return trip.failed(ruling.sentence)
        self._ask(StationSend(self._robot, trip.room.people))
        self._sent = True
        return replace(trip, stage=TripStage.ASKED)

    def _stop_move(self) -> None:
        """Stop the current move of the game, or a move that was just requested.

        This takes some ticks. Until then, each tick repeats the request.
        """
        under_way = self._game is not None and self._game.robots[self._robot].bound_for is not None
        if under_way:
            self._ask(StationStop(self._robot))
        self._stopping = under_way or self._sent


def is_responding(snapshot: TeamSnapshot, robot: int) -> bool:
    """Return True if a robot's observations are less than a second old."""
    return snapshot.tick - snapshot.robots[robot].tick < RESPONSE_TIMEOUT


def advanced(trip: VehicleTrip, snapshot: TeamSnapshot, game: GameState, robot: int) -> VehicleTrip:
    """Return the state of a trip after this tick."""
    trip = _with_remaining(trip, snapshot.robots[robot])
    if trip.stage is TripStage.WAITING:
        return trip
    return _by_navigator(trip, snapshot, robot) if trip.room is None else _by_game(trip, game, robot)


def _by_game(trip: VehicleTrip, game: GameState, robot: int) -> VehicleTrip:
    """Return the state of a trip that is a move of the game."""
    mover = game.robots[robot]
    if mover.bound_for is not None and mover.bound_for == trip.room:
        return replace(trip, stage=TripStage.GOING)
    if mover.bound_for is None and mover.at == trip.room:
        return trip.ended(LegState.ARRIVED)
    if trip.stage is TripStage.ASKED:
        return trip.failed(reasons.NOT_READY)
    # When a game restarts, moves end without a reason.
    return trip.failed(mover.failure or reasons.CALLED_BACK)


def _by_navigator(trip: VehicleTrip, snapshot: TeamSnapshot, robot: int) -> VehicleTrip:
    """Return the state of a trip to a goal outside the game."""
    navigation = snapshot.robots[robot].navigation
    # The last result of a dead robot is outdated.
    if robot not in snapshot.dead:
        match navigation.result:
            case GoalReached(goal) if goal == trip.goal:
                return trip.ended(LegState.ARRIVED)
            case NoPath(goal, reason) if goal == trip.goal:
                return trip.failed(reasons.failure_sentence(robot, reason))
            case Cancelled(goal) if goal == trip.goal:
                return trip.failed(reasons.ELSEWHERE)
        if navigation.goal == trip.goal:
            return replace(trip, unanswered_ticks=0)
    if trip.unanswered_ticks < RESPONSE_TIMEOUT:
        return replace(trip, unanswered_ticks=trip.unanswered_ticks + 1)
    return trip.failed(reasons.unresponsive_sentence(robot))


def _with_remaining(trip: VehicleTrip, output: RobotOutput) -> VehicleTrip:
    """Return the trip with its remaining distance: along the navigator's plan, or straight if there is no plan."""
    navigation = output.navigation
    planned = trip.stage is TripStage.GOING and navigation.state == "controlling"
    left = navigation.remaining if planned else output.estimate.base_in_map.distance(trip.target)
    return replace(trip, leg=replace(trip.leg, remaining=left))


def _judge(state: GameState, robot: int, room: Room) -> rules.Ruling:
    """Return the rules' decision on a move.

    A moving robot is judged as if it stood still, because it will be stopped first.
    """
    back = rules.fail(state, robot, "", 0.0)
    for event in () if isinstance(back, RequestRefused) else back:
        state = apply(state, event)
    return rules.move(state, robot, room, Commander.GROUND_STATION)
