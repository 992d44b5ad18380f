"""The participant's requests beyond the lines of 2016: dialogues, giving up a treasure, calling a robot back."""

from thbridge.dialogue.moves import Scenario
from thbridge.hunt import rules
from thbridge.hunt.events import Commander
from thbridge.hunt.game import GameState
from thbridge.hunt.refusals import RequestRefused
from thbridge.hunt.rooms import Room
from thbridge.hunt.tour import suggest
from thbridge.roles.keeper.dialogues import MATTERS
from thbridge.roles.keeper.open_game import KeeperReason, OpenGame
from thbridge.roles.notices import decode_notice
from thbridge.roles.view import Agree, Answer, AskBack, CallBack, Discuss, GiveUp, Leave, Select, Unsure
from thbridge.wire.notice import Notice


def handle_participant_request(game: OpenGame, state: GameState, notice: Notice, *, awaits_treasures: bool) -> None:
    """Grant a request, or keep its refusal; another notice changes nothing.

    Args:
        game: the game in progress.
        state: of the game.
        notice: the request.
        awaits_treasures: Hider is about to hide them; until then no robot is sent.
    """
    if decode_notice(notice, Agree) is not None:
        game.apply_ruling(Agree.__name__, rules.agree(state))
    elif (asked := decode_notice(notice, Select)) is not None:
        _select(game, state, asked, awaits_treasures)
    elif (unsure := decode_notice(notice, Unsure)) is not None:
        _suggest(game, state, unsure.robot, awaits_treasures)
    elif (discuss := decode_notice(notice, Discuss)) is not None:
        _discuss(game, state, discuss)
    elif (answer := decode_notice(notice, Answer)) is not None:
        refused = game.dialogues.answer(answer.dialogue, answer.turn, answer.choice)
        if refused is not None:
            game.refuse(Answer.__name__, refused)
    elif (leave := decode_notice(notice, Leave)) is not None:
        game.apply_ruling(Leave.__name__, rules.leave(state, _room(leave.room)))
    elif (end := decode_notice(notice, GiveUp)) is not None:
        if end.game == state.started.game:
            game.apply_ruling(GiveUp.__name__, rules.give_up(state))
    elif (back := decode_notice(notice, CallBack)) is not None:
        _call_back(game, state, back.robot)
    elif (ask := decode_notice(notice, AskBack)) is not None and ask.robot not in game.handback_requests.recent:
        game.apply_ruling(AskBack.__name__, rules.ask_back(state, ask.robot))


def _call_back(game: OpenGame, state: GameState, robot: int) -> None:
    is_under_way = state.has_robot(robot) and state.robots[robot].bound_for is not None
    refused = rules.commanded_by_other(state, robot, Commander.PARTICIPANT) if is_under_way else None
    if refused is not None:
        game.refuse(CallBack.__name__, refused)
    elif is_under_way:
        game.recall(robot)
    else:
        game.apply_ruling(CallBack.__name__, rules.fail(state, robot, "", 0.0))


def _select(game: OpenGame, state: GameState, asked: Select, awaits_treasures: bool) -> None:
    room = _room(asked.room)
    ruling = _immovable(state, asked.robot, awaits_treasures) or rules.move(state, asked.robot, room)
    other = game.dialogues.other_candidate(room, asked.robot)
    if isinstance(ruling, tuple) and other is not None:
        name = rules.robot_name(other)
        ruling = RequestRefused(KeeperReason.UNDER_DISCUSSION, f"You are talking with {name} about {room}.")
    _open(game, state, ruling, Scenario.SPECIFIC_ROOM, asked.robot, room)


def _suggest(game: OpenGame, state: GameState, number: int, awaits_treasures: bool) -> None:
    refused = _immovable(state, number, awaits_treasures)
    if refused is not None:
        game.refuse(Unsure.__name__, refused)
        return
    suggest_or_await(game, state, number)


def suggest_or_await(game: OpenGame, state: GameState, number: int) -> None:
    """Let a robot suggest a room, or wait for the person who speaks in its place."""
    room = suggested_room(game, state, number)
    if isinstance(room, RequestRefused):
        game.refuse(Unsure.__name__, room)
    elif number in game.dialogues.puppets:
        game.dialogues.await_advice(number)
    else:
        open_suggestion(game, state, number, room)


def open_suggestion(game: OpenGame, state: GameState, number: int, room: Room) -> None:
    """Open the dialogue in which a robot suggests a room."""
    _open(game, state, (), Scenario.DONT_KNOW, number, room)


def suggested_room(game: OpenGame, state: GameState, number: int) -> Room | RequestRefused:
    """Return the room that a robot itself suggests; rooms that other robots have dialogues about are left out."""
    robot = state.robots[number]
    free = [room for room in state.free_rooms if game.dialogues.other_candidate(room, number) is None]
    return suggest(state.started.costs, robot.at, free, robot.energy, state.started.identify_cost)


def _discuss(game: OpenGame, state: GameState, discuss: Discuss) -> None:
    room = _room(discuss.room)
    scenario = Scenario.TAKE_PICTURE if discuss.matter == "take-picture" else Scenario.TAKE_TREASURE
    ruling: rules.Ruling
    if not state.has_room(room) or state.decider(room) != discuss.robot:
        ruling = RequestRefused(rules.RuleReason.NOBODY_THERE, f"This robot does not stand in {room}.")
    elif scenario is Scenario.TAKE_PICTURE:
        ruling = rules.picture(state, room)
    else:
        # The name is still open; whether naming is allowed and can be paid is not.
        ruling = rules.identify(state, room, "", 0)
    _open(game, state, ruling, scenario, discuss.robot, room)


def _open(game: OpenGame, state: GameState, ruling: rules.Ruling, scenario: Scenario, robot: int, room: Room) -> None:
    """Open a dialogue about something that the rules allow, or keep the refusal."""
    refused = ruling if isinstance(ruling, RequestRefused) else game.dialogues.open(state, scenario, robot, room)
    if refused is not None:
        game.refuse(MATTERS[scenario], refused)


def _immovable(state: GameState, robot: int, awaits_treasures: bool) -> RequestRefused | None:
    """Return the reason why this robot cannot make any move, or None."""
    if awaits_treasures:
        return RequestRefused(KeeperReason.NOT_READY, "The treasures are not hidden yet.")
    ruling = rules.move(state, robot, next(iter(state.free_rooms), Room(1)))
    about_the_room = {rules.RuleReason.NOT_ENOUGH_ENERGY, rules.RuleReason.ALREADY_VISITED, rules.RuleReason.NOT_A_MOVE}
    return ruling if isinstance(ruling, RequestRefused) and ruling.reason not in about_the_room else None


def _room(number: int) -> Room:
    """Return the room of a number as people count. A negative one becomes the corridor, which every rule refuses."""
    return Room(max(number, 0))
