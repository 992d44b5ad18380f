"""Trips that ground stations send a robot on: a move of the game, or a goal of its navigator beside it."""

from dataclasses import dataclass, replace
from enum import Enum

from sim.common.geometry import Pose2
from sim.common.observations import TICKS_PER_SECOND
from sim.robot.navigator.goals import Cancelled, Goal, GoalReached, NoPath
from sim.robot.software import RobotOutput
from sim.team import TeamSnapshot
from thbridge.hunt.game import GameState
from thbridge.hunt.rooms import Room
from thbridge.mavlink.values.vehicle_interface import HelmLeg, LegState
from thbridge.roles.shared import failure_reasons as reasons
from thbridge.ros.messages.goal_owners import GoalOwner

RESPONSE_TIMEOUT = TICKS_PER_SECOND
"""Ticks without observations after which a robot counts as silent, and without news of a goal after which it fails."""


class TripStage(Enum):
    """Stage of a trip: an earlier move of the game has to end; the trip is requested; the robot drives."""

    WAITING = 0
    ASKED = 1
    GOING = 2


@dataclass(frozen=True, slots=True)
class VehicleTrip:
    """A leg and its execution.

    Attributes:
        leg: its state as ground stations see it.
        target: goal pose of the base, map frame.
        room: destination of a move of the game; None: a goal beside the game.
        stage: of the execution.
        unanswered_ticks: ticks without news of the goal from the navigator.
    """

    leg: HelmLeg
    target: Pose2
    room: Room | None
    stage: TripStage = TripStage.WAITING
    unanswered_ticks: int = 0

    @property
    def goal(self) -> Goal:
        """The navigator's goal beside the game."""
        return Goal(self.leg.number, self.target, GoalOwner.GROUND_STATION)

    @property
    def under_way(self) -> bool:
        """True until it has ended."""
        return self.leg.state is LegState.UNDER_WAY

    def ended(self, state: LegState, reason: str = "") -> "VehicleTrip":
        """Return the trip at its end."""
        return replace(self, leg=HelmLeg(self.leg.number, state, 0.0, reason))

    def failed(self, reason: str) -> "VehicleTrip":
        """Return the trip, given up for this reason."""
        return self.ended(LegState.FAILED, reason)


def is_responding(snapshot: TeamSnapshot, robot: int) -> bool:
    """Return True when a robot's observations are less than a second old."""
    return snapshot.tick - snapshot.robots[robot].tick < RESPONSE_TIMEOUT


def advanced(trip: VehicleTrip, snapshot: TeamSnapshot, game: GameState, robot: int) -> VehicleTrip:
    """Return a trip as it stands after this tick."""
    trip = _with_remaining(trip, snapshot.robots[robot])
    if trip.stage is TripStage.WAITING:
        return trip
    return _by_navigator(trip, snapshot, robot) if trip.room is None else _by_game(trip, game, robot)


def _by_game(trip: VehicleTrip, game: GameState, robot: int) -> VehicleTrip:
    """Return the trip of a move of the game, by the state of the game."""
    mover = game.robots[robot]
    if mover.bound_for is not None and mover.bound_for == trip.room:
        return replace(trip, stage=TripStage.GOING)
    if mover.bound_for is None and mover.at == trip.room:
        return trip.ended(LegState.ARRIVED)
    if trip.stage is TripStage.ASKED:
        return trip.failed(reasons.NOT_READY)
    # A game that begins anew ends moves without a reason.
    return trip.failed(mover.failure or reasons.CALLED_BACK)


def _by_navigator(trip: VehicleTrip, snapshot: TeamSnapshot, robot: int) -> VehicleTrip:
    """Return the trip of a goal beside the game, by the state of the navigator."""
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
    """Return the trip with its remaining distance: of the navigator's plan, or straight while there is none."""
    navigation = output.navigation
    planned = trip.stage is TripStage.GOING and navigation.state == "controlling"
    left = navigation.remaining if planned else output.estimate.base_in_map.distance(trip.target)
    return replace(trip, leg=replace(trip.leg, remaining=left))
