"""The participant's requests beyond the lines of 2016, for example about dialogues, treasures or stopping a robot."""

from typing import TypeAlias, assert_never

from thbridge.dialogue.moves import Scenario
from thbridge.hunt import rules
from thbridge.hunt.game import GameState
from thbridge.hunt.refusals import RequestRefused
from thbridge.hunt.rooms import Room
from thbridge.hunt.seats import Seat
from thbridge.roles.keeper.agreements import MATTERS
from thbridge.roles.keeper.initiative import discuss, suggest
from thbridge.roles.keeper.open_game import OpenGame
from thbridge.roles.shared.participant_rules import Situation, judge, place
from thbridge.roles.shared.seat_rights import why_not_allowed
from thbridge.roles.shared.view import (
    AnswerDialogue,
    EndGame,
    HandOver,
    LeaveTreasure,
    MeasureProperty,
    OpenDialogue,
    RequestHandback,
    RequestSuggestion,
    SelectRoom,
    StopRobot,
    TakeUpTreasure,
    TellProperty,
)
from thbridge.text_protocol.wire.notice_format import kind_of

NoticeRequest: TypeAlias = (
    SelectRoom
    | RequestSuggestion
    | AnswerDialogue
    | StopRobot
    | RequestHandback
    | HandOver
    | OpenDialogue
    | LeaveTreasure
    | TakeUpTreasure
    | EndGame
    | MeasureProperty
    | TellProperty
)
"""A request of the participant in a notice."""


def handle_participant_request(
    game: OpenGame, state: GameState, request: NoticeRequest, seat: Seat | None = None, *, awaits_treasures: bool
) -> None:
    """Carry out a request, or store its refusal. Requests with their own lines of 2016 have no effect here.

    Args:
        game: the game in progress.
        state: state of the game.
        request: the request.
        seat: seat of the participant; None in a game with one participant.
        awaits_treasures: True if Hider has not hidden the treasures yet. Then no robot is sent.
    """
    now, kind = Situation(state, game.dialogues.discussed, awaits_treasures, seat), kind_of(type(request))
    robot = _robot_of(game, state, request)
    if robot is not None:
        game.attend(robot)
    match request:
        case LeaveTreasure() | TakeUpTreasure() | MeasureProperty() | TellProperty() | HandOver():
            game.apply_ruling(kind, judge(now, request))
        case EndGame():
            if request.game == state.started.game:
                game.apply_ruling(kind, judge(now, request))
        case RequestHandback():
            ruling = judge(now, request)
            # A quick repetition has no effect, unless the request has become impossible.
            asker = "" if seat is None else seat.name
            if isinstance(ruling, RequestRefused) or not (
                request.robot in game.handbacks.robots and state.robots[request.robot].asked_by == asker
            ):
                game.apply_ruling(kind, ruling)
        case StopRobot():
            if game.apply_ruling(kind, judge(now, request)):
                game.stop(request.robot)
        case RequestSuggestion():
            ruling = judge(now, request)
            if isinstance(ruling, RequestRefused):
                game.refuse(kind, ruling)
            elif not game.dialogues.has_advised(request.robot):
                suggest_or_await(game, state, request.robot)
        case SelectRoom():
            _open(game, state, judge(now, request), Scenario.SPECIFIC_ROOM, request.robot, place(request.room))
        case OpenDialogue():
            scenario = Scenario.TAKE_PICTURE if request.matter == "take-picture" else Scenario.TAKE_TREASURE
            name = request.name if scenario is Scenario.TAKE_TREASURE else None
            _open(game, state, judge(now, request), scenario, request.robot, place(request.room), name)
        case AnswerDialogue(dialogue, turn, choice):
            about = game.dialogues.under_way.matter_of(dialogue)
            refused = None if seat is None else why_not_allowed(state, seat, request, about)
            if refused is None:
                game.dialogues.answer(state, dialogue, turn, choice)
            else:
                game.refuse(kind, refused)
        case _:
            assert_never(request)


def _robot_of(game: OpenGame, state: GameState, request: NoticeRequest) -> int | None:
    """Return the robot that a request is about, or None."""
    if isinstance(request, AnswerDialogue):
        return game.dialogues.under_way.robot_of(request.dialogue)
    room: int | None = getattr(request, "room", None)
    robot: int | None = getattr(request, "robot", None)
    return state.decider(place(room)) if robot is None and room is not None else robot


def suggest_or_await(game: OpenGame, state: GameState, number: int) -> None:
    """Let a robot suggest a room, or wait for the person who speaks for the robot."""
    advice = game.advice(state, number)
    if isinstance(advice, RequestRefused):
        game.refuse(kind_of(RequestSuggestion), advice)
    elif number in game.dialogues.puppets:
        game.dialogues.await_advice(number)
    else:
        suggest(game, state, number, advice)


def _open(
    game: OpenGame,
    state: GameState,
    ruling: rules.Ruling,
    scenario: Scenario,
    robot: int,
    room: Room,
    name: str | None = None,
) -> None:
    """Open a dialogue about a matter if the rules allow it, otherwise store the refusal."""
    if isinstance(ruling, RequestRefused):
        game.refuse(MATTERS[scenario], ruling)
    else:
        discuss(game, state, scenario, robot, room, name)
