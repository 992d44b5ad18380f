"""Initiative of robots: their suggestions, dialogues and own decisions."""

from msgspec import structs

from sim.common.observations import TICKS_PER_SECOND
from thbridge.dialogue.moves import Scenario, Speaker
from thbridge.hunt import rules
from thbridge.hunt.events import DialogueOpened
from thbridge.hunt.game import GameState
from thbridge.hunt.refusals import RequestRefused
from thbridge.hunt.rooms import Room
from thbridge.hunt.tour import NoTour
from thbridge.roles.keeper.advice.adviser import Advice
from thbridge.roles.keeper.advice.neglect import decide_about_treasure, decide_to_go, neglected
from thbridge.roles.keeper.agreements import MATTERS
from thbridge.roles.keeper.open_game import OpenGame
from thbridge.roles.shared.view import RequestSuggestion
from thbridge.text_protocol.wire.notice_format import kind_of

_READING = 30 * TICKS_PER_SECOND
"""Minimum number of ticks for which a robot waits while the participant reads its sentences and answers."""


def suggest(game: OpenGame, state: GameState, robot: int, advice: Advice, *, unasked: bool = False) -> None:
    """Record a robot's advice, and let the robot open the dialogue about it.

    If the robot and the participant have said everything about this room without an agreement, refuse the request.
    """
    room = advice.room
    nothing_left = RequestRefused(NoTour.NOTHING_LEFT, "After what you have said, I know of no room to go to.")
    if game.dialogues.argues:
        chosen = game.dialogues.memories.decision(game.where_facts(state, robot, room))
        if chosen is None:
            game.refuse(kind_of(RequestSuggestion), nothing_left)
            return
        room = chosen
    opener = Speaker.ROBOT if unasked else Speaker.PERSON
    opened = _opening(game, Scenario.DONT_KNOW, robot, room, opener, advice.room)
    said = game.dialogues.said
    game.record((advice.event(robot), structs.replace(opened, reason=advice.reason, confidence=advice.confidence)))
    stands = robot in game.dialogues.under_way or game.dialogues.has_advised(robot)
    if game.dialogues.said == said and not (stands or unasked):
        game.refuse(kind_of(RequestSuggestion), nothing_left)


def discuss(
    game: OpenGame, state: GameState, scenario: Scenario, robot: int, room: Room, name: str | None = None
) -> None:
    """Open the dialogue about a participant's request, unless it is already open or has led to an agreement.

    Args:
        game: the open game.
        state: state of the game.
        scenario: the decision.
        robot: index of the robot.
        room: the room in the request.
        name: proposed name of the treasure. If empty, the participant asks for the name. If None, the request is about
            another matter than a name.
    """
    if name == "" and game.dialogues.argues:
        scenario = Scenario.UNSURE_NAME
    said = (name or "") if game.dialogues.argues else ""
    if game.dialogues.is_discussed(scenario, robot, room, said):
        return
    advised = None
    if game.dialogues.argues and MATTERS[scenario] == "select-room":
        advice = game.advice(state, robot)
        advised = None if isinstance(advice, RequestRefused) else advice.room
    opened = _opening(game, scenario, robot, room, Speaker.PERSON, advised)
    game.record((structs.replace(opened, name=said),))


def _opening(
    game: OpenGame, scenario: Scenario, robot: int, room: Room, opener: Speaker, advised: Room | None
) -> DialogueOpened:
    at = game.tick / TICKS_PER_SECOND
    return DialogueOpened(game.dialogues.next_number, scenario, robot, room, at, opener, advised)


def decide_alone(game: OpenGame, timeout: int) -> bool:
    """Let robots decide alone if the participant has ignored them for too long. Return True if any robot decides alone.

    Args:
        game: the open game.
        timeout: a robot decides alone after this number of ticks without the participant's attention.
    """
    state = game.state
    if state is None:
        return False
    waiting = [
        robot
        for robot in neglected(state, game.attended, game.tick, timeout)
        # During a dialogue, the participant may be reading the robot's reasons, so the robot waits longer.
        if robot not in game.dialogues.under_way or game.tick - game.attended.get(robot, 0) >= _READING
    ]
    for robot in waiting:
        game.attend(robot)
        if game.state is not None:
            _decide_alone(game, game.state, robot, timeout)
    return bool(waiting)


def _decide_alone(game: OpenGame, state: GameState, robot: int, timeout: int) -> None:
    here = state.robots[robot].at
    names = game.knowledge.what(state, robot, here, game.tick).names if state.has_room(here) else ()
    decision = decide_about_treasure(state, robot, names)
    if decision is None:
        advice = game.advice(state, robot)
        room = None if isinstance(advice, RequestRefused) else advice.room
        if room is not None and game.dialogues.argues and not isinstance(advice, RequestRefused):
            room = game.dialogues.memories.decision(game.where_facts(state, robot, advice.room))
        decision = None if room is None else decide_to_go(state, robot, room)
    if decision is not None:
        game.record(decision.events)
        if decision.departs and game.state is not None:
            game.dialogues.decided_alone(game.state, robot, decision.room, timeout / TICKS_PER_SECOND)


def report_failures(game: OpenGame) -> None:
    """Let arguing robots suggest another room after they failed to reach a room."""
    unreached = game.knowledge.unreached
    if not unreached.to_report:
        return
    for robot in unreached.to_report:
        state = game.state
        if state is None or not game.dialogues.argues or robot in game.dialogues.puppets:
            continue
        advice = game.advice(state, robot)
        if isinstance(advice, RequestRefused) or rules.unable(state, robot):
            continue
        if game.dialogues.memories.decision(game.where_facts(state, robot, advice.room)) is not None:
            suggest(game, state, robot, advice, unasked=True)
    unreached.reported()
