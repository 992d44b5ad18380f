"""Reasons why an act is impossible at the moment, in words for a hint.

The rules are in `thbridge.roles.shared.participant_rules`; the keeper uses the same rules. This module converts
refusals into hints. Functions called `why_not_...` return the reason, or None if the act is possible.
"""

from dataclasses import replace
from typing import Literal

from thbridge.dialogue.wording.texts import Texts
from thbridge.hunt import rules
from thbridge.hunt.events import Commander, CostsEstimated, Event, RobotArrived
from thbridge.hunt.game import GameState, apply
from thbridge.hunt.properties import property_named
from thbridge.hunt.refusals import RequestRefused
from thbridge.hunt.rooms import CORRIDOR, Room
from thbridge.hunt.rules import RuleReason
from thbridge.roles.shared.participant_rules import JudgedRequest, KeeperReason, Situation, judge, other_candidate
from thbridge.roles.shared.view import (
    EndGame,
    MeasureProperty,
    OpenDialogue,
    ParticipantRequest,
    RefusalView,
    RequestSuggestion,
    SelectRoom,
    StopRobot,
    TakeUpTreasure,
    TellProperty,
)
from ui.model.playing.seat_view import only_others
from ui.model.playing.words import commanded_words

_NOT_ABOUT_ROOMS = {
    RuleReason.GAME_OVER,
    RuleReason.COMMANDED,
    RuleReason.SILENT,
    RuleReason.BLOCKED,
    RuleReason.NOT_ALLOWED,
}
"""Reasons why a robot cannot be asked for advice that do not depend on the rooms left."""


def is_allowed(known: Situation, request: JudgedRequest) -> bool:
    """Return True if the rules allow a request."""
    return isinstance(judge(known, request), tuple)


def undecided_beside(known: Situation, robot: int) -> int | None:
    """Return the room where this robot is if the treasure there is undecided, that is, neither named nor left."""
    state, place = known.state, known.state.robots[robot].at
    if state.standing_in(place) != robot or not state.has_room(place):
        return None
    room = state.room(place)
    return place.people if room.visited and not room.is_decided else None


def left_beside(known: Situation, robot: int) -> int | None:
    """Return the room where this robot is if the treasure there was left, and the participant can return to it."""
    state = known.state
    if not state.has_robot(robot) or not state.has_room(state.robots[robot].at):
        return None
    place = state.robots[robot].at
    again = rules.take_up(state, place)
    return place.people if state.standing_in(place) == robot and isinstance(again, tuple) and again else None


def ends_game(known: Situation, event: Event) -> bool:
    """Return True if the game ends automatically after an event, because nothing is left to do."""
    return bool(rules.ending(apply(known.state, event)))


def why_not_work(texts: Texts, known: Situation, robot: int) -> str | None:
    """Return the reason why a robot cannot act at all at the moment, or None."""
    return _hint(texts, known, robot, rules.unable(known.state, robot))


def why_not_command(texts: Texts, known: Situation, robot: int) -> str | None:
    """Return the reason why the participant may not send or stop a robot at the moment, or None."""
    return _hint(texts, known, robot, rules.commanded_by_other(known.state, robot, Commander.PARTICIPANT))


def why_not_go(texts: Texts, known: Situation, robot: int, room: int) -> str | None:
    """Return the reason why a robot cannot go to a room, or None. A driving robot would be stopped first."""
    goes_there = known.state.robots[robot].bound_for == Room(room)
    then = known if goes_there else _stopped(known, robot)
    refused = judge(then, SelectRoom(robot, room))
    if isinstance(refused, tuple):
        return None
    mover = then.state.robots[robot]
    match refused.reason:
        case RuleReason.ALREADY_VISITED:
            return texts.text("hints.refused_already_visited")
        case RuleReason.UNDER_WAY:
            return texts.text("hints.on_its_way_there", robot=robot)
        case RuleReason.RESERVED:
            going = then.state.reserved_by(Room(room))
            return texts.text("hints.on_its_way_there", robot=robot if going is None else going)
        case KeeperReason.UNDER_DISCUSSION:
            other = other_candidate(then.discussed, Room(room), robot)
            command = None if other is None else then.state.robots[other].command
            if command is not None and command.by is Commander.TEAMMATE:
                return texts.text("seats.talks_about", seat=command.name, robot=robot if other is None else other)
            return texts.text("hints.asks_about_room", robot=robot if other is None else other)
        case RuleReason.NOT_A_MOVE:
            return texts.text("hints.no_path", room=mover.at)
        case RuleReason.NOT_ENOUGH_ENERGY:
            cost = then.state.cost(robot, Room(room))
            return texts.text("hints.too_dear", cost=cost, robot=robot, energy=mover.energy)
    return _hint(texts, known, robot, refused, SelectRoom(robot, room))


def why_not_ask(texts: Texts, known: Situation, robot: int) -> str | None:
    """Return the reason why a robot cannot be asked for advice, or None."""
    refused = judge(known, RequestSuggestion(robot))
    if isinstance(refused, tuple):
        return None
    bound_for = known.state.robots[robot].bound_for
    if refused.reason == RuleReason.UNDER_WAY and bound_for is not None:
        return texts.text("hints.on_its_way", robot=robot, room=bound_for)
    if refused.reason in _NOT_ABOUT_ROOMS:
        return _hint(texts, known, robot, refused, RequestSuggestion(robot))
    return texts.text("hints.no_room_left", robot=robot)


def why_not_picture(texts: Texts, known: Situation, robot: int, room: int) -> str | None:
    """Return the reason why a robot cannot take a picture in its room, or None."""
    return _why_not_discuss(texts, known, OpenDialogue(robot, "take-picture", room))


def why_not_name(texts: Texts, known: Situation, robot: int, room: int) -> str | None:
    """Return the reason why the treasure in a robot's room cannot be named, or None."""
    if known.state.room(Room(room)).is_decided:
        return texts.text("hints.refused_already_decided")
    return _why_not_discuss(texts, known, OpenDialogue(robot, "take-treasure", room))


def why_not_find_out(
    texts: Texts, known: Situation, request: MeasureProperty | TellProperty | TakeUpTreasure
) -> str | None:
    """Return the reason why a request about a treasure is impossible, or None.

    The request is to sense a property, to report a property, or to return to a treasure that was left.
    """
    refused = judge(known, request)
    if isinstance(refused, tuple):
        return None
    robot = known.state.standing_in(Room(request.room))
    if robot is None:
        return refusal_words(texts, refused)
    measured = property_named(known.state.started.properties, getattr(request, "property", ""))
    if refused.reason == RuleReason.NOT_ENOUGH_ENERGY and measured is not None:
        energy = known.state.robots[robot].energy
        return texts.text("hints.too_dear", cost=measured.cost, robot=robot, energy=energy)
    return _hint(texts, known, robot, refused, request)


def why_not_stop(texts: Texts, known: Situation, robot: int) -> str | None:
    """Return the reason why a robot cannot be stopped, or None."""
    refused = judge(known, StopRobot(robot))
    if isinstance(refused, tuple):
        return None
    if refused.reason == RuleReason.NOT_UNDER_WAY:
        return why_not_work(texts, known, robot) or refusal_words(texts, refused)
    return _hint(texts, known, robot, refused, StopRobot(robot))


def why_not_end(texts: Texts, known: Situation) -> str | None:
    """Return the reason why the game cannot be ended at the moment, or None."""
    refused = judge(known, EndGame(known.state.started.game))
    if isinstance(refused, tuple):
        return None
    if refused.reason == RuleReason.NOT_ALLOWED:
        return only_others(texts, known, EndGame(known.state.started.game)) or refusal_words(texts, refused)
    moving = (number for number, robot in enumerate(known.state.robots) if robot.bound_for is not None)
    if refused.reason == RuleReason.UNDER_WAY and (mover := next(moving, None)) is not None:
        theirs = why_not_command(texts, known, mover)
        still = texts.text("hints.still_driving", robot=mover)
        return f"{still} {theirs or texts.text('hints.stop_or_wait')}"
    return refusal_words(texts, refused)


def energy_warning(texts: Texts, known: Situation, robot: int, room: int) -> str:
    """Return a warning that a robot would have too little energy in a room to take a picture or name a treasure.

    The warning is empty if the energy would be enough.
    """
    departure = rules.move(known.state, robot, Room(room))
    if isinstance(departure, RequestRefused):
        return ""
    there = known.state
    for event in (*departure, RobotArrived(robot, Room(room))):
        there = apply(there, event)
    lacking = _too_little_for(there, Room(room))
    return "" if lacking is None else texts.text(f"tiles.warn_{lacking}")


def arrival_warning(texts: Texts, known: Situation, robot: int) -> str:
    """Return a warning that a driving robot will have too little energy to take a picture or name a treasure.

    The warning is empty if the energy will be enough.
    """
    room = known.state.robots[robot].bound_for
    if room is None:
        return ""
    lacking = _too_little_for(apply(known.state, RobotArrived(robot, room)), room)
    return "" if lacking is None else texts.text(f"cards.warn_{lacking}")


def _too_little_for(state: GameState, room: Room) -> Literal["name", "picture", "both"] | None:
    """Return the act for which the robot in a room has too little energy; None if the energy is enough for all acts."""
    if not _is_nameable(state, room):
        return "name"
    pictured = rules.picture(state, room, "")
    if isinstance(pictured, RequestRefused):
        return "picture"
    return None if _is_nameable(apply(state, pictured[0]), room) else "both"


def _is_nameable(state: GameState, room: Room) -> bool:
    """Return True if the robot in a room can name its treasure."""
    return isinstance(rules.identify(state, room, "", 0), tuple)


def _stopped(known: Situation, robot: int) -> Situation:
    """Return the situation after a driving robot is stopped now; the robot is then in the corridor.

    If the cost of a move depends on the robot's position, the costs of moves from there are unknown, and count as 0.
    """
    events = rules.fail(known.state, robot, "", 0.0, CORRIDOR)
    if isinstance(events, RequestRefused):
        return known
    state = apply(known.state, events[0])
    if state.by_position:
        state = apply(state, CostsEstimated(robot, (None, *(0.0 for _ in state.rooms))))
    return replace(known, state=state)


def _why_not_discuss(texts: Texts, known: Situation, request: OpenDialogue) -> str | None:
    robot, started = request.robot, known.state.started
    refused = judge(known, request)
    if isinstance(refused, tuple):
        return None
    match refused.reason:
        case RuleReason.NOBODY_THERE:
            unable = why_not_work(texts, known, robot)
            return unable or texts.text("hints.not_there", robot=robot, room=request.room)
        case RuleReason.NOT_ENOUGH_ENERGY:
            energy = known.state.robots[robot].energy
            if request.matter == "take-picture":
                return texts.text("hints.picture_too_dear", cost=started.picture_cost, robot=robot, energy=energy)
            return texts.text("hints.naming_too_dear", cost=started.identify_cost, robot=robot, energy=energy)
    return _hint(texts, known, robot, refused, request)


def _hint(
    texts: Texts,
    known: Situation,
    robot: int,
    refused: RequestRefused | None,
    request: ParticipantRequest | None = None,
) -> str | None:
    """Return the hint for a refusal; None if there is no refusal. `request` is the refused request, if there is one."""
    if refused is None:
        return None
    match refused.reason:
        case RuleReason.SILENT:
            return texts.text("hints.silent", robot=robot)
        case RuleReason.BLOCKED:
            return texts.text("hints.blocked", robot=robot)
        case RuleReason.COMMANDED:
            command = known.state.robots[robot].command
            return commanded_words(texts, robot, command.by, command.name, known.seat)
        case RuleReason.NOT_ALLOWED if request is not None:
            return only_others(texts, known, request) or refusal_words(texts, refused)
        case _:
            return refusal_words(texts, refused)


def why_refused(
    texts: Texts, known: Situation, refusal: RequestRefused | RefusalView, request: ParticipantRequest | None
) -> str:
    """Return a sentence about the game's refusal of a request, with the reasons as far as they are known.

    If `request` is None, it is unknown which request was refused.
    """
    unknown = refusal.reason in {RuleReason.UNKNOWN_ROBOT, RuleReason.UNKNOWN_ROOM}
    explains = not unknown and texts.has(_refusal_key(refusal))
    others = refusal.reason == KeeperReason.UNDER_DISCUSSION and known.seat is not None
    general = texts.text("seats.other_talk") if others else refusal_words(texts, refusal)
    return (_why_not(texts, known, request) if explains else None) or general


def _why_not(texts: Texts, known: Situation, request: ParticipantRequest | None) -> str | None:
    if request is not None and (others := only_others(texts, known, request)) is not None:
        return others
    match request:
        case SelectRoom(robot, room):
            return why_not_go(texts, known, robot, room)
        case RequestSuggestion(robot):
            return why_not_ask(texts, known, robot)
        case OpenDialogue(robot, "take-picture", room):
            return why_not_picture(texts, known, robot, room)
        case OpenDialogue(robot, "take-treasure", room):
            return why_not_name(texts, known, robot, room)
        case MeasureProperty() | TellProperty() | TakeUpTreasure():
            return why_not_find_out(texts, known, request)
        case StopRobot(robot):
            return why_not_stop(texts, known, robot)
        case EndGame():
            return why_not_end(texts, known)
        case _:
            return None


def refusal_words(texts: Texts, refused: RequestRefused | RefusalView) -> str:
    """Return a refusal in the language of the texts.

    If the reason is unknown because a later release sent it, return the received sentence.
    """
    key = _refusal_key(refused)
    return texts.text(key) if texts.has(key) else refused.sentence


def _refusal_key(refused: RequestRefused | RefusalView) -> str:
    return f"hints.refused_{refused.reason.replace('-', '_')}"
