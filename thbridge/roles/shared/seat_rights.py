"""Rights of seats: which requests the participant of a seat may send, in a game with several seats.

The rules of the game (`hunt/rules.py`) do not depend on who asks. These functions come before them.
"""

from collections.abc import Callable
from typing import TypeAlias

from sim.common.robot_numbers import robot_name
from thbridge.hunt.game import GameState
from thbridge.hunt.refusals import RequestRefused
from thbridge.hunt.rooms import Room
from thbridge.hunt.rules import RuleReason, commanded_by_other_seat
from thbridge.hunt.seats import Seat, StopRight, labels_of
from thbridge.roles.shared.team_notices import MarkRead, RaiseObjection, SayToPeople, Vote
from thbridge.roles.shared.view import (
    AnswerDialogue,
    DialogueMatter,
    EndGame,
    GiveConsent,
    HandOver,
    IdentifyTreasure,
    LeaveTreasure,
    MeasureProperty,
    OpenDialogue,
    ParticipantRequest,
    PlayAgain,
    RequestHandback,
    RequestSuggestion,
    SelectRoom,
    SendRobot,
    SenseTreasure,
    StopRobot,
    TakePicture,
    TakeUpTreasure,
    TellProperty,
)

TalkedAbout: TypeAlias = tuple[int, DialogueMatter]
"""Robot of a dialogue, and its matter."""


def why_not_allowed(
    state: GameState, seat: Seat, request: ParticipantRequest, dialogue: TalkedAbout | None = None
) -> RequestRefused | None:
    """Return the reason why the participant of a seat may not send a request, or None.

    The sentence names the seats that may.

    Args:
        state: state of the game.
        seat: the seat.
        request: the request.
        dialogue: for an answer or an objection, the robot and the matter of the dialogue; None if there is no such
            dialogue.
    """
    match request:
        case SelectRoom(robot) | RequestSuggestion(robot):
            return commanded_by_other_seat(state, robot, seat.name) or _may_talk(state, seat)
        case SendRobot(robot) | HandOver(robot):
            return commanded_by_other_seat(state, robot, seat.name)
        case StopRobot(robot):
            return _may_stop(state, seat, robot)
        case SenseTreasure(room) | TakePicture(room) | MeasureProperty(room):
            return _commands_in(state, seat, room)
        case IdentifyTreasure() | LeaveTreasure() | TakeUpTreasure() | TellProperty():
            return _may_name(state, seat)
        case OpenDialogue(robot, matter):
            return may_discuss(state, seat, robot, matter)
        case AnswerDialogue():
            return None if dialogue is None else may_discuss(state, seat, *dialogue)
        case RaiseObjection():
            return _may_object(state, seat, dialogue)
        case EndGame():
            return None if seat.ends_game else _refusal(state, "end the game early", lambda each: each.ends_game)
        case GiveConsent() | RequestHandback() | PlayAgain() | SayToPeople() | MarkRead() | Vote():
            return None


def may_discuss(state: GameState, seat: Seat, robot: int, matter: DialogueMatter) -> RequestRefused | None:
    """Return the reason why a seat may not talk with a robot about a matter, or None.

    The commander of a robot talks with it about its moves and pictures. Who names treasures talks with robots about
    the names.
    """
    by_right = _may_name(state, seat) if matter == "take-treasure" else commanded_by_other_seat(state, robot, seat.name)
    return by_right or _may_talk(state, seat)


def _may_object(state: GameState, seat: Seat, dialogue: TalkedAbout | None) -> RequestRefused | None:
    if not seat.may_object:
        return _refusal(state, "object in dialogues of others", lambda each: each.may_object)
    if dialogue is None or may_discuss(state, seat, *dialogue) is not None:
        return None
    return RequestRefused(RuleReason.NOT_ALLOWED, "You can answer in this dialogue yourself.")


def _may_talk(state: GameState, seat: Seat) -> RequestRefused | None:
    return None if seat.talks else _refusal(state, "talk with robots", lambda each: each.talks)


def _may_name(state: GameState, seat: Seat) -> RequestRefused | None:
    if seat.names_treasures:
        return None
    return _refusal(state, "decide about treasures", lambda each: each.names_treasures)


def _may_stop(state: GameState, seat: Seat, robot: int) -> RequestRefused | None:
    if seat.stops is StopRight.ALL:
        return None
    other = commanded_by_other_seat(state, robot, seat.name)
    if other is not None:
        return other
    if seat.stops is StopRight.OWN:
        return None
    return _refusal(state, f"stop {robot_name(robot)}", lambda each: each.stops is StopRight.ALL)


def _commands_in(state: GameState, seat: Seat, room: int) -> RequestRefused | None:
    """Return the reason why a seat does not command the robot in a room, or None. Rules decide about empty rooms."""
    robot = state.standing_in(Room(max(room, 0)))
    return None if robot is None else commanded_by_other_seat(state, robot, seat.name)


def _refusal(state: GameState, deed: str, may: Callable[[Seat], bool]) -> RequestRefused:
    able = labels_of([seat for seat in state.started.seats if may(seat)])
    return RequestRefused(RuleReason.NOT_ALLOWED, f"Only {able} can {deed}.")
