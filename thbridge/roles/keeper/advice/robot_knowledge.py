"""Knowledge of robots in the open game: their advice, and the facts for their arguments."""

from dataclasses import replace

from thbridge.dialogue.evidence import WhatFacts, WhereFacts
from thbridge.dialogue.moves import Scenario
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
    """Knowledge of the robots of a game, on which their advice and arguments are based.

    Args:
        adviser: suggests rooms in the place of robots.
        kinds: all treasures, known to robots and participants.

    Attributes:
        adviser: see `Args`.
        unreached: rooms that robots have recently failed to reach.
    """

    def __init__(self, adviser: Adviser, kinds: tuple[TreasureKind, ...]) -> None:
        self.adviser = adviser
        self.unreached = UnreachedRooms()
        self._kinds = kinds

    def begin(self) -> None:
        """Begin another game: forget facts about the game before."""
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
        """Return an arguing robot's facts about where to go.

        Args:
            state: state of the game.
            dialogues: dialogues of the game.
            robot: index in the team.
            tick: present tick.
            advised: the room that its planner has chosen; None if there is none.
            rival: room to which the participant wants to send it.
        """
        facts = where_facts(state, dialogues.discussed, robot, self.unreached.of(robot), tick, rival)
        facts = replace(facts, compares=self.adviser.error_rate <= 0.0)
        return facts if advised is None else replace(facts, advised=advised)

    def what(self, state: GameState, robot: int, room: Room, tick: int, name: str = "") -> WhatFacts:
        """Return a robot's facts about the treasure in a room, for which the participant proposes `name`."""
        return what_facts(state, robot, room, self._kinds, tick, name)

    def about(
        self, state: GameState, dialogues: GameDialogues, opened: DialogueOpened, tick: int
    ) -> WhereFacts | WhatFacts | None:
        """Return the facts of a robot for a new dialogue; None if robots do not argue."""
        scenario, robot, room = Scenario(opened.scenario), opened.robot, opened.room
        if not dialogues.argues:
            return None
        if MATTERS[scenario] == "select-room":
            rival = room if scenario is Scenario.SPECIFIC_ROOM else None
            return self.where(state, dialogues, robot, tick, opened.advised, rival)
        return replace(self.what(state, robot, room, tick, opened.name), unsure=scenario is Scenario.UNSURE_NAME)
