"""The participant's requests beyond the lines of 2016: dialogues, leaving treasures, calling a robot back."""

from typing import get_args

from thbridge.dialogue.moves import Scenario
from thbridge.hunt import rules
from thbridge.hunt.game import GameState
from thbridge.hunt.refusals import RequestRefused
from thbridge.hunt.rooms import Room
from thbridge.roles.keeper.dialogues import MATTERS
from thbridge.roles.keeper.open_game import OpenGame
from thbridge.roles.shared.participant_rules import Situation, judge, place
from thbridge.roles.shared.view import (
    AnswerDialogue,
    CallBack,
    GiveUp,
    GiveUpTreasure,
    MeasureProperty,
    OpenDialogue,
    ParticipantRequest,
    RequestHandback,
    RequestSuggestion,
    SelectRoom,
    TakeUpTreasure,
    TellProperty,
)
from thbridge.text_protocol.wire.notice import Notice, decode_notice, kind_of


def handle_participant_request(game: OpenGame, state: GameState, notice: Notice, *, awaits_treasures: bool) -> None:
    """Grant a request, or keep its refusal; another notice changes nothing.

    Args:
        game: the game in progress.
        state: of the game.
        notice: the request.
        awaits_treasures: Hider is about to hide them; until then no robot is sent.
    """
    now = Situation(state, game.dialogues.discussed, awaits_treasures)
    asked = _decode_request(notice)
    robot = _robot_of(game, state, asked)
    if robot is not None:
        game.attend(robot)
    match asked:
        case GiveUpTreasure() | TakeUpTreasure() | MeasureProperty() | TellProperty() as request:
            game.apply_ruling(notice.kind, judge(now, request))
        case GiveUp() as request if request.game == state.started.game:
            game.apply_ruling(notice.kind, judge(now, request))
        case RequestHandback() as request:
            ruling = judge(now, request)
            # Who asked a moment ago is refused what has become impossible, and else waits for the answer.
            if isinstance(ruling, RequestRefused) or request.robot not in game.asked_back:
                game.apply_ruling(notice.kind, ruling)
        case CallBack() as request:
            if game.apply_ruling(notice.kind, judge(now, request)):
                game.recall(request.robot)
        case RequestSuggestion() as request:
            ruling = judge(now, request)
            if isinstance(ruling, RequestRefused):
                game.refuse(notice.kind, ruling)
            elif not game.dialogues.has_advised(request.robot):
                suggest_or_await(game, state, request.robot)
        case SelectRoom() as request:
            _open(game, state, judge(now, request), Scenario.SPECIFIC_ROOM, request.robot, place(request.room))
        case OpenDialogue() as request:
            scenario = Scenario.TAKE_PICTURE if request.matter == "take-picture" else Scenario.TAKE_TREASURE
            name = request.name if scenario is Scenario.TAKE_TREASURE else None
            _open(game, state, judge(now, request), scenario, request.robot, place(request.room), name)
        case AnswerDialogue() as request:
            game.dialogues.answer(state, request.dialogue, request.turn, request.choice)


def _robot_of(game: OpenGame, state: GameState, request: ParticipantRequest | None) -> int | None:
    """Return the robot that a request attends to, or None."""
    if isinstance(request, AnswerDialogue):
        return game.dialogues.robot_of(request.dialogue)
    room: int | None = getattr(request, "room", None)
    robot: int | None = getattr(request, "robot", None)
    return state.decider(place(room)) if robot is None and room is not None else robot


def suggest_or_await(game: OpenGame, state: GameState, number: int) -> None:
    """Let a robot suggest a room, or wait for the person who speaks in its place."""
    advice = game.advice(state, number)
    if isinstance(advice, RequestRefused):
        game.refuse(kind_of(RequestSuggestion), advice)
    elif number in game.dialogues.puppets:
        game.dialogues.await_advice(number)
    else:
        game.suggest(state, number, advice)


def _open(
    game: OpenGame,
    state: GameState,
    ruling: rules.Ruling,
    scenario: Scenario,
    robot: int,
    room: Room,
    name: str | None = None,
) -> None:
    """Open a dialogue about something that the rules allow, or keep the refusal."""
    if isinstance(ruling, RequestRefused):
        game.refuse(MATTERS[scenario], ruling)
    else:
        game.discuss(state, scenario, robot, room, name)


def _decode_request(notice: Notice) -> ParticipantRequest | None:
    decoded = (decode_notice(notice, kind) for kind in get_args(ParticipantRequest))
    return next((request for request in decoded if request is not None), None)
