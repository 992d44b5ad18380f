"""Reasons why an act is not possible just now, in words for a hint.

`thbridge.roles.participant_rules` decides, as it does for the keeper; here its refusals become hints. Functions called
`why_not_...` return the reason, or None where the act is possible.
"""

from dataclasses import replace
from typing import Literal

from sim.common.robot_numbers import robot_name
from thbridge.hunt import rules
from thbridge.hunt.costs import energy_text
from thbridge.hunt.events import Commander, CostsEstimated, Event, RobotArrived
from thbridge.hunt.game import GameState, apply
from thbridge.hunt.refusals import RequestRefused
from thbridge.hunt.rooms import CORRIDOR, Room
from thbridge.hunt.rules import RuleReason, commander_name
from thbridge.roles.participant_rules import JudgedRequest, KeeperReason, Situation, judge, other_candidate
from thbridge.roles.view import CallBack, GiveUp, OpenDialogue, RequestSuggestion, SelectRoom
from ui.model.playing.words import how_it_comes_back, titled


def is_allowed(known: Situation, request: JudgedRequest) -> bool:
    """Return True when the rules allow a request."""
    return isinstance(judge(known, request), tuple)


def undecided_beside(known: Situation, robot: int) -> int | None:
    """The room in which this robot stands beside a treasure that is neither named nor left."""
    state, place = known.state, known.state.robots[robot].at
    if state.standing_in(place) != robot or not state.has_room(place):
        return None
    room = state.room(place)
    return place.people if room.visited and not room.is_decided else None


def left_beside(known: Situation, robot: int) -> int | None:
    """The room in which this robot stands beside a treasure that was left and can be taken up again."""
    state = known.state
    if not state.has_robot(robot) or not state.has_room(state.robots[robot].at):
        return None
    place = state.robots[robot].at
    again = rules.take_up(state, place)
    return place.people if state.standing_in(place) == robot and isinstance(again, tuple) and again else None


def ends_game(known: Situation, event: Event) -> bool:
    """Return True when nothing is left to do after an event, so that the game ends by itself."""
    return bool(rules.ending(apply(known.state, event)))


def why_not_work(known: Situation, robot: int) -> str | None:
    """Reason why a robot can do nothing at all just now, or None."""
    return _hint(known, robot, rules.unable(known.state, robot))


def why_not_command(known: Situation, robot: int) -> str | None:
    """Reason why the participant may not send or stop a robot just now, or None."""
    return _hint(known, robot, rules.commanded_by_other(known.state, robot, Commander.PARTICIPANT))


def why_not_go(known: Situation, robot: int, room: int) -> str | None:
    """Reason why a robot cannot go to a room, or None; a robot that is driving would be called back first."""
    goes_there = known.state.robots[robot].bound_for == Room(room)
    then = known if goes_there else _called_back(known, robot)
    refused = judge(then, SelectRoom(robot, room))
    if isinstance(refused, tuple):
        return None
    mover = then.state.robots[robot]
    match refused.reason:
        case RuleReason.ALREADY_VISITED:
            return "This room has been visited."
        case RuleReason.UNDER_WAY:
            return f"{titled(robot)} is on its way there."
        case RuleReason.RESERVED:
            going = then.state.reserved_by(Room(room))
            return f"{titled(robot if going is None else going)} is on its way there."
        case KeeperReason.UNDER_DISCUSSION:
            other = other_candidate(then.discussed, Room(room), robot)
            return f"{titled(robot if other is None else other)} is asking you about this room."
        case RuleReason.NOT_A_MOVE:
            return f"There is no way there from {mover.at}."
        case RuleReason.NOT_ENOUGH_ENERGY:
            cost = then.state.cost(robot, Room(room))
            return f"This costs {energy_text(cost)}; {robot_name(robot)} has {energy_text(mover.energy)} energy."
    return _hint(known, robot, refused)


def why_not_ask(known: Situation, robot: int) -> str | None:
    """Reason why a robot cannot be asked for advice, or None."""
    refused = judge(known, RequestSuggestion(robot))
    if isinstance(refused, tuple):
        return None
    bound_for = known.state.robots[robot].bound_for
    if refused.reason == RuleReason.UNDER_WAY and bound_for is not None:
        return f"{titled(robot)} is on its way to {bound_for}."
    if refused.reason in {RuleReason.GAME_OVER, RuleReason.COMMANDED, RuleReason.SILENT, RuleReason.BLOCKED}:
        return _hint(known, robot, refused)
    return f"There is no room left that {titled(robot)} can go to."


def why_not_picture(known: Situation, robot: int, room: int) -> str | None:
    """Reason why a robot cannot take a picture in the room where it stands, or None."""
    return _why_not_discuss(
        known, OpenDialogue(robot, "take-picture", room), "A picture", known.state.started.picture_cost
    )


def why_not_name(known: Situation, robot: int, room: int) -> str | None:
    """Reason why the treasure in the room where a robot stands cannot be named, or None."""
    if known.state.room(Room(room)).is_decided:
        return "This is decided."
    return _why_not_discuss(
        known, OpenDialogue(robot, "take-treasure", room), "Naming it", known.state.started.identify_cost
    )


def why_not_request(known: Situation, robot: int, request: JudgedRequest) -> str | None:
    """Reason why a robot cannot do what a request asks for, or None."""
    refused = judge(known, request)
    return None if isinstance(refused, tuple) else _hint(known, robot, refused)


def why_not_stop(known: Situation, robot: int) -> str | None:
    """Reason why a robot cannot be stopped, or None."""
    refused = judge(known, CallBack(robot))
    if isinstance(refused, tuple):
        return None
    if refused.reason == RuleReason.NOT_UNDER_WAY:
        return why_not_work(known, robot) or "This robot is not on its way."
    return _hint(known, robot, refused)


def why_not_end(known: Situation) -> str | None:
    """Reason why the game cannot be ended just now, or None."""
    refused = judge(known, GiveUp(known.state.started.game))
    if isinstance(refused, tuple):
        return None
    moving = (number for number, robot in enumerate(known.state.robots) if robot.bound_for is not None)
    if refused.reason == RuleReason.UNDER_WAY and (mover := next(moving, None)) is not None:
        theirs = why_not_command(known, mover)
        return f"{titled(mover)} is still on its way. {theirs or 'Stop it, or wait for it.'}"
    return refused.sentence


def energy_warning(known: Situation, robot: int, room: int) -> str:
    """Warning of what a robot's energy does not suffice for once it is in a room: a picture, a name; or empty."""
    departure = rules.move(known.state, robot, Room(room))
    if isinstance(departure, RequestRefused):
        return ""
    there = known.state
    for event in (*departure, RobotArrived(robot, Room(room))):
        there = apply(there, event)
    match _too_little_for(there, Room(room)):
        case "name":
            return "Enough to get there, not to name what is there."
        case "picture":
            return "Enough to name what is there, not to take a picture."
        case "both":
            return "Enough to take a picture there or to name what is there, not for both."
        case None:
            return ""


def arrival_warning(known: Situation, robot: int) -> str:
    """Warning of what the energy of a driving robot will not suffice for where it arrives, for its card; or empty."""
    room = known.state.robots[robot].bound_for
    if room is None:
        return ""
    match _too_little_for(apply(known.state, RobotArrived(robot, room)), room):
        case "name":
            return "too little to name"
        case "picture":
            return "too little for a picture"
        case "both":
            return "picture or name only"
        case None:
            return ""


def _too_little_for(state: GameState, room: Room) -> Literal["name", "picture", "both"] | None:
    """The work that the robot in a room cannot pay for there; None where it can pay for all."""
    if not _is_nameable(state, room):
        return "name"
    pictured = rules.picture(state, room, "")
    if isinstance(pictured, RequestRefused):
        return "picture"
    return None if _is_nameable(apply(state, pictured[0]), room) else "both"


def _is_nameable(state: GameState, room: Room) -> bool:
    """Return True when the robot in a room can name its treasure."""
    return isinstance(rules.identify(state, room, "", 0), tuple)


def _called_back(known: Situation, robot: int) -> Situation:
    """Return the known when a driving robot is stopped at once: to the game, it stands in the corridor then.

    Where moves are priced by position, nobody knows yet what they will cost from there: it may be nothing.
    """
    events = rules.fail(known.state, robot, "", 0.0, CORRIDOR)
    if isinstance(events, RequestRefused):
        return known
    state = apply(known.state, events[0])
    if state.by_position:
        state = apply(state, CostsEstimated(robot, (None, *(0.0 for _ in state.rooms))))
    return replace(known, state=state)


def _why_not_discuss(known: Situation, request: OpenDialogue, what: str, cost: float) -> str | None:
    robot = request.robot
    refused = judge(known, request)
    if isinstance(refused, tuple):
        return None
    match refused.reason:
        case RuleReason.NOBODY_THERE:
            return why_not_work(known, robot) or f"{titled(robot)} is not in room {request.room} any more."
        case RuleReason.NOT_ENOUGH_ENERGY:
            energy = energy_text(known.state.robots[robot].energy)
            return f"{what} costs {energy_text(cost)}; {robot_name(robot)} has {energy} energy."
    return _hint(known, robot, refused)


def _hint(known: Situation, robot: int, refused: RequestRefused | None) -> str | None:
    """The hint for a refusal that is about the robot or the game; None where there is no such refusal."""
    if refused is None:
        return None
    match refused.reason:
        case RuleReason.SILENT:
            return f"{titled(robot)} does not answer."
        case RuleReason.COMMANDED:
            command = known.state.robots[robot].command
            other = commander_name(command.by, command.name)
            return f"{titled(robot)} is commanded by {other}. {how_it_comes_back(command.by)}"
        case _:
            return refused.sentence
