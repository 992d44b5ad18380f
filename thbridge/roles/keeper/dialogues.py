"""Open dialogues between robots and the participant, and agreements that are not carried out yet."""

import math
from dataclasses import dataclass, replace

from thbridge.dialogue.engine import DialogueEngine, DialogueStep
from thbridge.dialogue.moves import (
    Author,
    DecideAlone,
    Dialogue,
    DialogueOutcome,
    DialogueTopic,
    DialogueUtterance,
    Echo,
    Scenario,
    Speaker,
    Turn,
    move_text,
    word_of,
)
from thbridge.dialogue.robot_arguments import WhatFacts, WhereFacts
from thbridge.hunt.events import DialogueSaid
from thbridge.hunt.game import GameState
from thbridge.hunt.rooms import Room, RoomNames
from thbridge.roles.keeper.agreements import (
    MATTERS,
    Agreements,
    LastSentences,
    sentences,
    still_open,
    true_utterances,
)
from thbridge.roles.keeper.open_dialogues import OpenDialogues, RobotMemories
from thbridge.roles.shared.participant_rules import Discussed
from thbridge.roles.shared.view import Consent, DialogueMatter, DialogueView


@dataclass(frozen=True, slots=True)
class HeldTurn:
    """A turn of a puppet, a robot for which a person speaks. The turn waits for this person.

    Attributes:
        dialogue: number of the dialogue.
        turn: index of the move in the dialogue, from 0.
        robot: index of the robot, from 0.
        scenario: matter of the dialogue.
        room: number of the room in the dialogue.
        sentences: sentences of the legal moves, in order.
    """

    dialogue: int
    turn: int
    robot: int
    scenario: DialogueMatter
    room: int
    sentences: tuple[str, ...]


class GameDialogues:
    """The open dialogues of a game, at most one per robot, and their agreements.

    Args:
        engine: engine of the dialogues.
        puppets: robots for which a person speaks (Wizard-of-Oz).
        room_names: names of the map's rooms.

    Attributes:
        puppets: robots for which a person speaks at present.
        argues: True if dialogues need the facts of robots.
        asked_for_advice: puppets that the participant has asked for advice, in order. Their dialogues are not open yet.
        under_way: the open dialogues.
        agreements: agreements that are not carried out yet.
        last_words: last sentences of ended dialogues.
        last_words_without_energy: the same for participants who do not see energy.
        memories: memories of the robots.
        not_restored: numbers of dialogues that could not be resumed after an interruption of the game.
    """

    def __init__(
        self,
        engine: DialogueEngine,
        puppets: frozenset[int] = frozenset(),
        room_names: RoomNames | None = None,
    ) -> None:
        self.puppets = puppets
        self._room_names = room_names or RoomNames()
        self.asked_for_advice: tuple[int, ...] = ()
        self._engine = engine
        self._without_energy = engine.without_energy()
        self.argues = engine.argues
        self.memories = RobotMemories()
        self.under_way = OpenDialogues()
        self._opened = 0
        self.agreements = Agreements()
        self.last_words = LastSentences()
        self.last_words_without_energy = LastSentences()
        self.not_restored: tuple[int, ...] = ()
        self._utterances: list[DialogueUtterance] = []

    def take_utterances(self) -> list[DialogueUtterance]:
        """Return the utterances since the last call, in order."""
        utterances, self._utterances = self._utterances, []
        return utterances

    @property
    def said(self) -> int:
        """Number of utterances since the last call of `take_utterances`."""
        return len(self._utterances)

    @property
    def next_number(self) -> int:
        """Number of the next dialogue."""
        return self._opened + 1

    def open(
        self,
        state: GameState,
        scenario: Scenario,
        robot: int,
        room: Room,
        reason: str = "",
        confidence: float | None = None,
        *,
        facts: WhereFacts | WhatFacts | None = None,
        opener: Speaker = Speaker.PERSON,
        name: str = "",
        restored: int | None = None,
    ) -> None:
        """Open a dialogue. Close an earlier dialogue with this robot, and remove an agreement on the same matter.

        Args:
            state: state of the game.
            scenario: the decision.
            robot: index of the robot.
            room: the room in the dialogue.
            reason: reason for a suggestion, as part of a sentence.
            confidence: confidence that the robot states in a suggestion, 0 to 1, or None.
            facts: facts of an arguing robot.
            opener: the side that opens the dialogue.
            name: proposed name of the treasure.
            restored: number of the dialogue before an interruption of the game; then `retake` repeats its turns. None
                for a new dialogue.
        """
        self._forget(robot, MATTERS[scenario])
        room_name = self._room_names.name(room.people)
        topic = replace(_topic(state, scenario, robot, room, room_name), reason=reason, confidence=confidence)
        topic = replace(topic, facts=facts, opener=opener, name=name)
        former = None if facts is None else self.memories.former(robot, facts)
        self._opened = self.next_number if restored is None else restored
        held = restored is not None or robot in self.puppets
        self._follow(state, self._engine.open(self._opened, topic, held=held, former=former))

    def retake(self, state: GameState, said: DialogueSaid) -> None:
        """Repeat a turn from a journal. If the turn is no longer legal, close the dialogue."""
        self._opened = max(self._opened, said.dialogue)
        dialogue = self.under_way.numbered(said.dialogue)
        if dialogue is None:
            return
        if said.turn < len(dialogue.turns):
            # `open` has already made the opening move, which must be equal to this move.
            if move_text(dialogue.turns[said.turn].move) == said.move:
                return
        elif said.turn == len(dialogue.turns):
            speaker = Speaker(said.speaker)
            legal = [choice.move for choice in self._engine.choices(dialogue, speaker)]
            move = next((move for move in (*legal, Echo(said.text)) if move_text(move) == said.move), None)
            if move is not None:
                self._follow(state, self._engine.retake(dialogue, Turn(speaker, move, Author(said.author), said.text)))
                return
        self.under_way.drop(dialogue.topic.robot)
        self.not_restored += (dialogue.number,)

    def go_on(self, state: GameState) -> None:
        """Let robots make the turns that were due when the game was interrupted. Do not repeat restored turns."""
        self._utterances.clear()
        for dialogue in self.under_way:
            self._follow(state, self._engine.release(dialogue))

    def await_advice(self, robot: int) -> None:
        """Record that the participant asked a puppet for advice. Remove its dialogue and its agreement on a room."""
        self._forget(robot, "select-room")
        self.asked_for_advice += (robot,)

    def has_advised(self, robot: int) -> bool:
        """Return True if an earlier request for this robot's advice is pending or discussed, or led to an agreement."""
        waits = robot in self.asked_for_advice or self.under_way.suggestion_stands(robot)
        return waits or self.agreements.has(robot, "select-room")

    def is_discussed(self, scenario: Scenario, robot: int, room: Room, name: str = "") -> bool:
        """Return True if this robot and the participant talk about exactly this decision or have agreed on it."""
        dialogue = self.under_way.of(robot)
        topic = None if dialogue is None else dialogue.topic
        is_open = topic is not None and (topic.scenario, topic.room, topic.name) == (scenario, room, name)
        return is_open or self.agreements.covers(scenario, robot, room, name)

    def answer(self, state: GameState, number: int, turn: int, choice: int) -> None:
        """Make the move that the participant chose. Ignore a choice for an earlier turn."""
        dialogue = self.under_way.at_turn(number, turn)
        choices = () if dialogue is None else self._engine.choices(dialogue)
        if dialogue is not None and 0 <= choice < len(choices):
            held = dialogue.topic.robot in self.puppets
            self._follow(state, self._engine.move(dialogue, choices[choice].move, held=held))

    def decided_alone(self, state: GameState, robot: int, room: Room, waited: float) -> None:
        """Let a robot announce its own decision for a room, after it has waited `waited` seconds."""
        self._forget(robot, "select-room")
        topic = _topic(state, Scenario.DONT_KNOW, robot, room, self._room_names.name(room.people))
        self._opened += 1
        step = self._engine.announce(self._opened, topic, DecideAlone(waited))
        self._follow(state, step)
        self._keep_last_words(step.dialogue, agreed=True)

    # In a robot's place

    def hold(self, robot: int) -> None:
        """Let a person speak for this robot from now on."""
        self.puppets |= {robot}

    def release(self, state: GameState | None, robot: int) -> None:
        """Let the robot speak for itself again; at its turn, it speaks at once. Drop a pending request for advice."""
        self.puppets -= {robot}
        self.asked_for_advice = _without(self.asked_for_advice, robot)
        dialogue = self.under_way.of(robot)
        if dialogue is not None and state is not None:
            self._follow(state, self._engine.release(dialogue))

    def speak_for(self, state: GameState, number: int, turn: int, move: int, text: str) -> None:
        """Make a puppet's move. Ignore a move for an earlier turn."""
        dialogue = self.under_way.at_turn(number, turn)
        choices = () if dialogue is None else self._engine.choices(dialogue, Speaker.ROBOT)
        if dialogue is not None and 0 <= move < len(choices):
            self._follow(state, self._engine.speak(dialogue, choices[move].move, text))

    def held_turns(self) -> tuple[HeldTurn, ...]:
        """Return the turns of puppets that wait for a person."""
        return tuple(
            HeldTurn(
                dialogue=dialogue.number,
                turn=len(dialogue.turns),
                robot=dialogue.topic.robot,
                scenario=MATTERS[dialogue.topic.scenario],
                room=dialogue.topic.room.people,
                sentences=tuple(choice.text for choice in choices),
            )
            for dialogue in self.under_way
            if (choices := self._engine.choices(dialogue, Speaker.ROBOT))
        )

    @property
    def discussed(self) -> tuple[Discussed, ...]:
        """Matters of open dialogues, followed by matters of agreements."""
        topics = (dialogue.topic for dialogue in self.under_way)
        return (
            *(Discussed(topic.robot, MATTERS[topic.scenario], topic.room.people) for topic in topics),
            *(Discussed(consent.robot, consent.matter, consent.room) for consent in self.agreements.all),
        )

    def drop_stale(self, state: GameState) -> None:
        """Close dialogues that have become useless: the robot left, or the room or treasure is no longer available."""
        for dialogue in self.under_way:
            topic = dialogue.topic
            if not still_open(state, topic.robot, MATTERS[topic.scenario], topic.room):
                self.under_way.drop(topic.robot)
                self._keep_last_words(dialogue, agreed=False)
        self.agreements.drop_stale(state)
        self.last_words.drop_stale(state, self.agreements)
        self.last_words_without_energy.drop_stale(state, self.agreements)
        self.asked_for_advice = tuple(
            robot
            for robot in self.asked_for_advice
            if any(still_open(state, robot, "select-room", room) for room in state.free_rooms)
        )

    def sentence_count(self, dialogue: Dialogue) -> int:
        """Return the number of sentences that participants have read in a dialogue."""
        return len(sentences(self._engine.utterances(dialogue))[0])

    def views(self, *, names_energy: bool = True) -> tuple[DialogueView, ...]:
        """Return the open dialogues in the form for a participant, with or without amounts of energy."""
        views, engine = [], self._engine if names_energy else self._without_energy
        for dialogue in self.under_way:
            topic, choices = dialogue.topic, engine.choices(dialogue)
            said, speakers = sentences(engine.utterances(dialogue))
            views.append(
                DialogueView(
                    dialogue=dialogue.number,
                    turn=len(dialogue.turns),
                    robot=topic.robot,
                    matter=MATTERS[topic.scenario],
                    room=topic.room.people,
                    said=said,
                    choices=tuple(choice.text for choice in choices),
                    acts=tuple(word_of(choice.move) for choice in choices),
                    speakers=speakers,
                    suggested=self.under_way.suggestion_stands(topic.robot),
                )
            )
        return tuple(views)

    def _follow(self, state: GameState, step: DialogueStep) -> None:
        topic = step.dialogue.topic
        matter = MATTERS[topic.scenario]
        self.memories.note(step.dialogue)
        if step.outcome is None:
            self._utterances += step.utterances
            self.under_way.put(step.dialogue)
            return
        # During the dialogue, another robot may have carried out the same decision.
        can_be_done = still_open(state, topic.robot, matter, topic.room)
        agreed = step.outcome is DialogueOutcome.CONSENSUS and can_be_done
        self.under_way.drop(topic.robot)
        self._utterances += true_utterances(step.utterances, agreed=agreed)
        self._keep_last_words(step.dialogue, agreed=agreed)
        if agreed:
            self.agreements.add(Consent(topic.robot, matter, topic.room.people, topic.name))

    def _keep_last_words(self, dialogue: Dialogue, *, agreed: bool) -> None:
        """Store the last sentences of a dialogue in which a robot argues."""
        if self.argues:
            self.last_words.keep(dialogue, self._engine.utterances(dialogue), agreed=agreed)
            unnamed = self._without_energy.utterances(dialogue)
            self.last_words_without_energy.keep(dialogue, unnamed, agreed=agreed)

    def _forget(self, robot: int, matter: DialogueMatter) -> None:
        """Remove a robot's dialogue, its request for advice, and its agreement on this matter."""
        self.agreements.withdraw(robot, matter)
        self.asked_for_advice = _without(self.asked_for_advice, robot)
        self.under_way.drop(robot)
        self.last_words.forget(robot)
        self.last_words_without_energy.forget(robot)


def _without(robots: tuple[int, ...], robot: int) -> tuple[int, ...]:
    return tuple(each for each in robots if each != robot)


def _topic(state: GameState, scenario: Scenario, robot: int, room: Room, room_name: str) -> DialogueTopic:
    here = state.robots[robot]
    match scenario:
        case Scenario.TAKE_PICTURE:
            cost = state.started.picture_cost
        case Scenario.TAKE_TREASURE | Scenario.UNSURE_NAME:
            cost = state.started.identify_cost
        case _:
            cost = state.cost(robot, room)
    return DialogueTopic(
        scenario,
        robot,
        room,
        cost,
        here.energy,
        room_name=room_name,
        other_robot=_nearest_other(state, robot, room),
        properties=state.room(room).known,
    )


def _nearest_other(state: GameState, robot: int, room: Room) -> int | None:
    """Return the other robot that needs the least energy to drive to a room, or None."""
    costs = {
        other: state.cost(other, room)
        for other, mover in enumerate(state.robots)
        if other != robot and mover.bound_for is None and not (mover.is_silent or mover.is_blocked)
    }
    return min((other for other, cost in costs.items() if math.isfinite(cost)), key=costs.__getitem__, default=None)
