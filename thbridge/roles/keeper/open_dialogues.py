"""Open dialogues of a game, and the robots' memories of earlier dialogues."""

from collections.abc import Iterator

from thbridge.dialogue.arguing import decision_of
from thbridge.dialogue.games.control import Conversation
from thbridge.dialogue.moves import Dialogue, Scenario
from thbridge.dialogue.propositions import NextRoom
from thbridge.dialogue.robot_arguments import WhatFacts, WhereFacts, is_decision, situation_of
from thbridge.hunt.rooms import Room
from thbridge.roles.keeper.agreements import MATTERS
from thbridge.roles.shared.view import DialogueMatter


class OpenDialogues:
    """Open dialogues in the order of opening, at most one per robot."""

    def __init__(self) -> None:
        self._by_robot: dict[int, Dialogue] = {}

    def __iter__(self) -> Iterator[Dialogue]:
        return iter(tuple(self._by_robot.values()))

    def __contains__(self, robot: int) -> bool:
        """Return True if a dialogue with a robot is open."""
        return robot in self._by_robot

    def put(self, dialogue: Dialogue) -> None:
        """Replace the dialogue of the same robot, or add the dialogue at the end."""
        self._by_robot[dialogue.topic.robot] = dialogue

    def drop(self, robot: int) -> None:
        """Drop the dialogue with a robot, if there is one."""
        self._by_robot.pop(robot, None)

    def of(self, robot: int) -> Dialogue | None:
        """Return the dialogue with a robot, or None."""
        return self._by_robot.get(robot)

    def numbered(self, number: int) -> Dialogue | None:
        """Return the dialogue with this number, or None."""
        return next((dialogue for dialogue in self._by_robot.values() if dialogue.number == number), None)

    def robot_of(self, number: int) -> int | None:
        """Return the robot of the dialogue with this number, or None."""
        dialogue = self.numbered(number)
        return None if dialogue is None else dialogue.topic.robot

    def matter_of(self, number: int) -> tuple[int, DialogueMatter] | None:
        """Return the robot and the matter of the dialogue with this number, or None."""
        dialogue = self.numbered(number)
        return None if dialogue is None else (dialogue.topic.robot, MATTERS[dialogue.topic.scenario])

    def at_turn(self, number: int, turn: int) -> Dialogue | None:
        """Return the dialogue with this number if this is its next turn, otherwise None."""
        dialogue = self.numbered(number)
        return dialogue if dialogue is not None and len(dialogue.turns) == turn else None

    def suggestion_stands(self, robot: int) -> bool:
        """Return True if the participant and the robot are talking about a room that the robot suggested."""
        given = self.of(robot)
        return given is not None and given.topic.scenario is Scenario.DONT_KNOW


class RobotMemories:
    """Memories of robots: the situation, the sentences and the beliefs of each robot's last dialogue."""

    def __init__(self) -> None:
        self._memories: dict[int, tuple[WhereFacts | WhatFacts, Conversation]] = {}

    def note(self, dialogue: Dialogue) -> None:
        """Store a dialogue of an arguing robot."""
        if dialogue.conversation is not None and dialogue.topic.facts is not None:
            self._memories[dialogue.topic.robot] = (situation_of(dialogue.topic.facts), dialogue.conversation)

    def former(self, robot: int, facts: WhereFacts | WhatFacts) -> Conversation | None:
        """Return the earlier conversation, or None. If the situation has changed, it has no decisions."""
        if robot not in self._memories:
            return None
        situation, conversation = self._memories[robot]
        return conversation if situation == situation_of(facts) else conversation.begun_anew(is_decision)

    def decision(self, facts: WhereFacts) -> Room | None:
        """Return the room that a robot would choose alone after the participant's arguments, or None."""
        decision = decision_of(facts, self.former(facts.robot, facts))
        goes = None if decision is None else decision.proposition
        return goes.room if isinstance(goes, NextRoom) else None
