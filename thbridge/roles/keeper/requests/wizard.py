"""Wizard-of-Oz: a person speaks and advises for robots, and the participant does not know this.

The list of turns that wait for the wizard is recorded at each change. A released robot makes its
pending turns at once, by its own strategy.
"""

from dataclasses import dataclass

import msgspec

from thbridge.hunt.game import GameState
from thbridge.hunt.rooms import Room
from thbridge.roles.keeper.advice.adviser import Advice, possible_rooms
from thbridge.roles.keeper.dialogues import HeldTurn
from thbridge.roles.keeper.initiative import suggest
from thbridge.roles.keeper.open_game import OpenGame
from thbridge.roles.keeper.requests.participant_requests import suggest_or_await
from thbridge.roles.shared.robot_requests import WizardAdvice, WizardMode, WizardMove, WizardRequest


@dataclass(frozen=True, slots=True)
class HeldAdvice:
    """A participant's "don't know", which waits for the person who speaks for the robot.

    Attributes:
        robot: index of the asked robot, from 0.
        costs: number and energy of each possible room.
        suggestion: room that the robot's own strategy would suggest, or None.
    """

    robot: int
    costs: tuple[tuple[int, float], ...]
    suggestion: int | None


@dataclass(frozen=True, slots=True)
class WizardState:
    """Robots for which a person speaks, and the turns and advice that wait for this person."""

    puppets: tuple[int, ...] = ()
    turns: tuple[HeldTurn, ...] = ()
    advice: tuple[HeldAdvice, ...] = ()

    def json(self) -> str:
        """Return the state as a JSON object."""
        return msgspec.json.encode(self).decode()


def wizard_state(game: OpenGame, state: GameState | None) -> WizardState:
    """Return the present state for the wizard of a game."""
    dialogues = game.dialogues
    advice = () if state is None else tuple(_advice(game, state, robot) for robot in dialogues.asked_for_advice)
    return WizardState(tuple(sorted(dialogues.puppets)), dialogues.held_turns(), advice)


def handle_wizard_request(game: OpenGame, state: GameState | None, request: WizardRequest) -> None:
    """Carry out a wizard's request. Ignore a request for an earlier turn."""
    match request:
        case WizardMode(robot, True):
            game.dialogues.hold(robot)
        case WizardMode(robot):
            asked = robot in game.dialogues.asked_for_advice
            game.dialogues.release(state, robot)
            if asked and state is not None:
                suggest_or_await(game, state, robot)
        case WizardMove(dialogue, turn, move, text):
            if state is not None:
                game.dialogues.speak_for(state, dialogue, turn, move, text)
        case WizardAdvice(robot, number):
            if state is not None and robot in game.dialogues.asked_for_advice:
                own, room = game.advice(state, robot), Room(max(number, 0))
                if isinstance(own, Advice) and room in possible_rooms(state, game.dialogues.discussed, robot):
                    reason = game.knowledge.adviser.reason_by_cost(state.cost(robot, room))
                    suggest(game, state, robot, own.instead(room, reason))


def _advice(game: OpenGame, state: GameState, robot: int) -> HeldAdvice:
    rooms = possible_rooms(state, game.dialogues.discussed, robot)
    own = game.advice(state, robot)
    costs = tuple((room.people, state.cost(robot, room)) for room in rooms)
    return HeldAdvice(robot, costs, own.room.people if isinstance(own, Advice) else None)
