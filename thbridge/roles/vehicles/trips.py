"""Where a robot was told to go from its helm, and how that ends: a move of the game, or a goal of its navigator."""

from dataclasses import dataclass, replace
from enum import Enum

from sim.common.geometry import Pose2
from sim.common.observations import TICKS_PER_SECOND
from sim.robot.navigator import Cancelled, GoalReached, NoPath
from sim.robot.software import RobotOutput
from sim.team import TeamSnapshot
from thbridge.hunt.game import GameState
from thbridge.hunt.rooms import Room
from thbridge.roles import failure_reasons as reasons
from thbridge.wire.mavlink.vehicle_interface import HelmLeg, LegState

FIRST_GOAL = 3_000_000_000
"""Number of the first goal that is set from a helm; those of the game and of researchers are below."""

RESPONSE_TIMEOUT = TICKS_PER_SECOND
"""Ticks after which a robot that is not heard does not answer, and one that says nothing of a goal has forgotten it."""


class TripStage(Enum):
    """How far a trip is on: the move of the game before it has to end; it is asked for; the robot is on its way."""

    WAITING = 0
    ASKED = 1
    GOING = 2


@dataclass(frozen=True, slots=True)
class VehicleTrip:
    """A leg and what it takes.

    Attributes:
        leg: as it stands.
        target: where the base shall end, map frame.
        room: the move of the game that it is; None: a goal beside the game.
        stage: how far it is on.
        silence: ticks for which the navigator has said nothing of the goal.
        trouble: what the navigator said when it gave up a move, for people; the game says only that it has failed.
    """

    leg: HelmLeg
    target: Pose2
    room: Room | None
    stage: TripStage = TripStage.WAITING
    unanswered_ticks: int = 0
    failure: str = ""

    @property
    def goal(self) -> int:
        """The number of the navigator's goal beside the game."""
        return FIRST_GOAL + self.leg.number

    @property
    def under_way(self) -> bool:
        """Whether it has not ended."""
        return self.leg.state is LegState.UNDER_WAY

    def ended(self, state: LegState, reason: str = "") -> "VehicleTrip":
        """The same, at its end."""
        return replace(self, leg=HelmLeg(self.leg.number, state, 0.0, reason))

    def failed(self, reason: str) -> "VehicleTrip":
        """The same, given up for this reason."""
        return self.ended(LegState.FAILED, reason)


def is_responding(snapshot: TeamSnapshot, robot: int) -> bool:
    """Whether a robot's software was heard within the last second."""
    return snapshot.tick - snapshot.robots[robot].observations.tick < RESPONSE_TIMEOUT


def advanced(trip: VehicleTrip, snapshot: TeamSnapshot, game: GameState, robot: int) -> VehicleTrip:
    """A trip of a robot that is asked for or under way, as this tick has left it."""
    trip = _with_remaining(trip, snapshot.robots[robot])
    if trip.stage is TripStage.WAITING:
        return trip
    return _by_navigator(trip, snapshot, robot) if trip.room is None else _by_game(trip, snapshot, game, robot)


def _by_game(trip: VehicleTrip, snapshot: TeamSnapshot, game: GameState, robot: int) -> VehicleTrip:
    """A move of the game, as the game sees it."""
    result, mover = snapshot.robots[robot].navigation.result, game.robots[robot]
    if isinstance(result, NoPath):
        trip = replace(trip, failure=reasons.failure_sentence(robot, result.reason))
    if mover.bound_for is not None and mover.bound_for == trip.room:
        return replace(trip, stage=TripStage.GOING)
    if mover.bound_for is None and mover.at == trip.room:
        return trip.ended(LegState.ARRIVED)
    if trip.stage is TripStage.ASKED:
        return trip.failed(reasons.NOT_READY)
    silent = reasons.unresponsive_sentence(robot) if mover.is_silent else ""
    return trip.failed(trip.failure or silent or reasons.CALLED_BACK)


def _by_navigator(trip: VehicleTrip, snapshot: TeamSnapshot, robot: int) -> VehicleTrip:
    """A goal beside the game, as the navigator sees it."""
    navigation = snapshot.robots[robot].navigation
    # What a dead robot said last is no news.
    if robot not in snapshot.dead:
        match navigation.result:
            case GoalReached(goal) if goal.id == trip.goal:
                return trip.ended(LegState.ARRIVED)
            case NoPath(goal, reason) if goal.id == trip.goal:
                return trip.failed(reasons.failure_sentence(robot, reason))
            case Cancelled(goal) if goal.id == trip.goal:
                return trip.failed(reasons.ELSEWHERE)
        if navigation.goal is not None and navigation.goal.id == trip.goal:
            return replace(trip, unanswered_ticks=0)
    if trip.unanswered_ticks < RESPONSE_TIMEOUT:
        return replace(trip, unanswered_ticks=trip.unanswered_ticks + 1)
    return trip.failed(reasons.unresponsive_sentence(robot))


def _with_remaining(trip: VehicleTrip, output: RobotOutput) -> VehicleTrip:
    """The same, with what is left of the way: of the navigator's plan, or as the crow flies while there is none."""
    navigation = output.navigation
    planned = trip.stage is TripStage.GOING and navigation.state == "controlling"
    left = navigation.remaining if planned else output.estimate.base_in_map.distance(trip.target)
    return replace(trip, leg=replace(trip.leg, remaining=left))
