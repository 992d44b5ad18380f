"""Knowledge of robots in the open game: advice, and facts for arguments."""

from dataclasses import replace

from thbridge.dialogue.moves import Scenario
from thbridge.dialogue.robot_arguments import WhatFacts, WhereFacts
from thbridge.hunt.events import DialogueOpened
from thbridge.hunt.game import GameState
from thbridge.hunt.refusals import RequestRefused
from thbridge.hunt.rooms import Room
from thbridge.hunt.treasures import TreasureKind
from thbridge.roles.keeper.advice.adviser import Advice, Adviser
from thbridge.roles.keeper.advice.robot_facts import what_facts, where_facts
from thbridge.roles.keeper.agreements import MATTERS
from thbridge.roles.keeper.dialogues import GameDialogues
from thbridge.roles.keeper.moves import UnreachedRooms


class RobotKnowledge:
    """Knowledge of the robots in a game, the basis of their advice and arguments.

    Args:
        adviser: adviser that computes the robots' suggestions.
        kinds: all treasures. Robots and participants know this list.

    Attributes:
        adviser: see `Args`.
        unreached: rooms that robots recently failed to reach.
    """

    def __init__(self, adviser: Adviser, kinds: tuple[TreasureKind, ...]) -> None:
        self.adviser = adviser
        self.unreached = UnreachedRooms()
        self._kinds = kinds

    def begin(self) -> None:
        """Begin another game. Remove facts about the previous game."""
        self.unreached = UnreachedRooms()

    def advice(self, state: GameState, dialogues: GameDialogues, robot: int) -> Advice | RequestRefused:
        """Return a robot's present advice; see `Adviser.advise`."""
        stands = dialogues.under_way.suggestion_stands(robot)
        number = state.robots[robot].advice + (0 if stands else 1)
        return self.adviser.advise(state, dialogues.discussed, robot, number)

    def where(
        self,
        state: GameState,
        dialogues: GameDialogues,
        robot: int,
        tick: int,
        advised: Room | None,
        rival: Room | None = None,
    ) -> WhereFacts:
        """Return the facts of a robot that argues about its next room.

        Args:
            state: state of the game.
            dialogues: dialogues of the game.
            robot: index of the robot.
            tick: present tick.
            advised: the room that the robot's planner has chosen, or None.
            rival: room that the participant prefers, or None.
        """
        facts = where_facts(state, dialogues.discussed, robot, self.unreached.of(robot), tick, rival)
        facts = replace(facts, compares=self.adviser.error_rate <= 0.0)
        return facts if advised is None else replace(facts, advised=advised)

    def what(self, state: GameState, robot: int, room: Room, tick: int, name: str = "") -> WhatFacts:
        """Return a robot's facts about the treasure in a room. `name` is the participant's proposal, or empty."""
        return what_facts(state, robot, room, self._kinds, tick, name)

    def about(
        self, state: GameState, dialogues: GameDialogues, opened: DialogueOpened, tick: int
    ) -> WhereFacts | WhatFacts | None:
        """Return the facts of a robot for a new dialogue, or None if robots do not argue."""
        scenario, robot, room = Scenario(opened.scenario), opened.robot, opened.room
        if not dialogues.argues:
            return None
        if MATTERS[scenario] == "select-room":
            rival = room if scenario is Scenario.SPECIFIC_ROOM else None
            return self.where(state, dialogues, robot, tick, opened.advised, rival)
        return replace(self.what(state, robot, room, tick, opened.name), unsure=scenario is Scenario.UNSURE_NAME)
