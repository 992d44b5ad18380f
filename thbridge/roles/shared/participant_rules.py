"""Rules for the participant's requests: the rules of the game, and rules about dialogues and agreements.

`judge` decides whether the keeper grants a request. The keeper calls `judge` with the state of the game. A window calls
it with the situation that its view reveals (`revealed`), so that it offers only requests that the keeper will grant. A
view contains all data for these rules, with two exceptions: in the first ticks, Hider may not have hidden the treasures
yet, and a Hider of 2016 does not reveal them.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from enum import StrEnum
from typing import NamedTuple, TypeAlias

from sim.common.robot_numbers import robot_name
from thbridge.hunt import rules
from thbridge.hunt.costs import CostMatrix
from thbridge.hunt.events import Commander, EndReason, GameEnded, GameStarted
from thbridge.hunt.game import CommandHolder, GameState, RobotState, RoomState
from thbridge.hunt.refusals import RequestRefused
from thbridge.hunt.rooms import Room
from thbridge.hunt.seats import Seat
from thbridge.hunt.tour import why_no_tour
from thbridge.hunt.treasures import TreasureKind
from thbridge.roles.shared.seat_rights import why_not_allowed
from thbridge.roles.shared.view import (
    Consent,
    DialogueMatter,
    DialogueView,
    EndGame,
    HandOver,
    LeaveTreasure,
    MeasureProperty,
    OpenDialogue,
    RequestHandback,
    RequestSuggestion,
    RobotView,
    RoomView,
    SelectRoom,
    StopRobot,
    TakeUpTreasure,
    TellProperty,
    View,
)

JudgedRequest: TypeAlias = (
    SelectRoom
    | RequestSuggestion
    | OpenDialogue
    | LeaveTreasure
    | TakeUpTreasure
    | MeasureProperty
    | TellProperty
    | EndGame
    | StopRobot
    | RequestHandback
    | HandOver
)


class KeeperReason(StrEnum):
    """Reason why the keeper refuses a request that the rules of the game allow."""

    NO_CONSENSUS = "no-consensus"
    NOT_READY = "not-ready"
    UNDER_DISCUSSION = "under-discussion"
    NO_PATH = "no-path"
    NOT_AGREED = "not-agreed"
    STOPPED = "stopped"
    HAS_SEATS = "has-seats"
    TALK_IS_OFF = "talk-is-off"
    TOO_LONG = "too-long"
    TOO_MANY = "too-many"
    NOT_AGREED_ON = "not-agreed-on"
    HAS_OBJECTED = "has-objected"
    DIALOGUE_ENDED = "dialogue-ended"


class Discussed(NamedTuple):
    """Matter of an open dialogue, or of an agreement that is not carried out yet."""

    robot: int
    matter: DialogueMatter
    room: int


@dataclass(frozen=True, slots=True)
class Situation:
    """All facts that the decision about a request depends on.

    Attributes:
        state: state of the game.
        discussed: matters of open dialogues, followed by matters of agreements.
        awaits_treasures: True if Hider has not hidden the treasures yet. Then no robot is sent.
        seat: seat of the participant who asks; None in a game with one participant.
    """

    state: GameState
    discussed: tuple[Discussed, ...]
    awaits_treasures: bool = False
    seat: Seat | None = None


def judge(now: Situation, request: JudgedRequest) -> rules.Ruling:
    """Return the events of a request, or a refusal. For a new dialogue, return the events after an agreement."""
    state = now.state
    refused = None if now.seat is None else why_not_allowed(state, now.seat, request)
    if refused is not None:
        return refused
    match request:
        case SelectRoom(robot, room):
            return _select(now, robot, place(room))
        case RequestSuggestion(robot):
            return _immovable(now, robot) or _no_advice(now, robot) or ()
        case OpenDialogue(robot, matter, room):
            return _discuss(state, robot, matter, place(room))
        case LeaveTreasure(room):
            return rules.leave(state, place(room))
        case TakeUpTreasure(room):
            return rules.take_up(state, place(room))
        case MeasureProperty(room, name):
            return rules.measure(state, place(room), name)
        case TellProperty(room, name, value):
            return rules.tell(state, place(room), name, value)
        case EndGame():
            return rules.end_game(state)
        case StopRobot(robot):
            return _stop_robot(state, robot)
        case RequestHandback(robot):
            return rules.request_handback(state, robot, "" if now.seat is None else now.seat.name)
        case HandOver(robot, seat):
            return rules.hand_over(state, robot, seat)


def other_candidate(discussed: Sequence[Discussed], room: Room, robot: int) -> int | None:
    """Return another robot with a dialogue or agreement about a move to this room, or None."""
    others = (about.robot for about in discussed if (about.matter, about.room) == ("select-room", room.people))
    return next((other for other in others if other != robot), None)


def free_to_discuss(now: Situation, robot: int) -> list[Room]:
    """Return the rooms that are neither visited, nor reserved, nor discussed with other robots."""
    return [room for room in now.state.free_rooms if other_candidate(now.discussed, room, robot) is None]


def place(number: int) -> Room:
    """Return the place with this number. A negative number becomes the corridor, which every rule refuses."""
    return Room(max(number, 0))


def revealed(view: View) -> Situation:
    """Return the situation that a view reveals.

    Data that the view does not contain are empty. The rules in this module do not use them.
    """
    matters: list[DialogueView | Consent] = [*view.dialogues, *view.consents]
    team = view.team
    started = GameStarted(
        seed=0,
        game=view.game,
        robots=len(view.robots),
        energy=0.0,
        picture_cost=view.picture_cost,
        identify_cost=view.identify_cost,
        wrong_share=0.0,
        costs=CostMatrix.of_plain(view.costs),
        properties=view.properties,
        seats=() if team is None else (team.own, *(mate.seat for mate in team.teammates)),
    )
    state = GameState(
        started=started,
        treasures=tuple(
            TreasureKind({each.name: "" for each in view.properties}, 0, "", room.picture or "") for room in view.rooms
        ),
        robots=tuple(_robot(view, robot) for robot in view.robots),
        rooms=tuple(_room(room) for room in view.rooms),
        score=view.score,
        # Rules do not use the reason. A later release may have unknown reasons.
        ended=None if view.over is None else GameEnded(EndReason.GIVEN_UP, view.score),
        agreed=view.consent is None,
        by_position=view.by_position,
    )
    discussed = tuple(Discussed(about.robot, about.matter, about.room) for about in matters)
    return Situation(state, discussed, seat=None if team is None else team.own)


def _select(now: Situation, robot: int, room: Room) -> rules.Ruling:
    ruling = _immovable(now, robot) or rules.move(now.state, robot, room)
    other = other_candidate(now.discussed, room, robot)
    if isinstance(ruling, RequestRefused) or other is None:
        return ruling
    return RequestRefused(KeeperReason.UNDER_DISCUSSION, f"You are talking with {robot_name(other)} about {room}.")


def _immovable(now: Situation, robot: int) -> RequestRefused | None:
    """Return the reason why a robot cannot make any move, or None."""
    if now.awaits_treasures:
        return RequestRefused(KeeperReason.NOT_READY, "The treasures are not hidden yet.")
    ruling = rules.move(now.state, robot, next(iter(now.state.free_rooms), Room(1)))
    about_the_room = {rules.RuleReason.NOT_ENOUGH_ENERGY, rules.RuleReason.ALREADY_VISITED, rules.RuleReason.NOT_A_MOVE}
    return ruling if isinstance(ruling, RequestRefused) and ruling.reason not in about_the_room else None


def _no_advice(now: Situation, robot: int) -> RequestRefused | None:
    """Return the reason why a robot cannot suggest any room, or None."""
    adviser = now.state.robots[robot]
    return why_no_tour(now.state.costs_from(robot), adviser.at, free_to_discuss(now, robot), adviser.energy)


def _discuss(state: GameState, robot: int, matter: str, room: Room) -> rules.Ruling:
    if not state.has_room(room) or state.decider(room) != robot:
        return RequestRefused(rules.RuleReason.NOBODY_THERE, f"This robot does not stand in {room}.")
    if matter == "take-picture":
        return rules.picture(state, room)
    # This only checks whether naming is allowed and the robot has enough energy, so any name will do.
    return rules.identify(state, room, "", 0)


def _stop_robot(state: GameState, robot: int) -> rules.Ruling:
    if not state.has_robot(robot) or state.robots[robot].bound_for is None:
        return rules.fail(state, robot, "", 0.0)
    # The seats' rights to stop each other's robots come before.
    if state.robots[robot].command.by is Commander.TEAMMATE:
        return ()
    return rules.commanded_by_other(state, robot, Commander.PARTICIPANT) or ()


def _robot(view: View, robot: RobotView) -> RobotState:
    going = robot.moving_to
    is_own = robot.commander is Commander.PARTICIPANT and view.team is not None
    command = CommandHolder(robot.commander, view.team.own.name if is_own and view.team else robot.commander_name)
    intervenes = robot.commander is Commander.RESEARCHER
    return RobotState(
        at=Room(robot.place),
        energy=robot.energy,
        bound_for=None if going is None else Room(going),
        paid=0.0 if going is None else view.costs_from(robot)[going] or 0.0,
        costs=tuple(math.inf if cost is None else cost for cost in robot.costs) or None,
        condition=robot.condition,
        holder=CommandHolder() if intervenes else command,
        intervention=command if intervenes else None,
    )


def _room(room: RoomView) -> RoomState:
    visited = room.state == "visited"
    return RoomState(
        visited=visited,
        sensed=room.sensed,
        told=room.told,
        image=room.picture,
        points=None if room.verdict is None else room.verdict.points,
        name=None if room.verdict is None else room.verdict.name,
        left=room.left,
        finder=room.robot if visited else None,
    )
