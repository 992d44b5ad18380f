"""Open dialogues of robots and participant, and agreements that were not acted upon yet."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Literal

from thbridge.dialogue.arguing import decision_of
from thbridge.dialogue.engine import DialogueEngine, DialogueStep
from thbridge.dialogue.evidence import WhatFacts, WhereFacts, is_decision, situation_of
from thbridge.dialogue.games.control import Conversation
from thbridge.dialogue.moves import (
    Author,
    CloseQuestions,
    Conclude,
    DecideAlone,
    Dialogue,
    DialogueOutcome,
    DialogueTopic,
    DialogueUtterance,
    Echo,
    Move,
    OpenQuestions,
    Scenario,
    Speaker,
    Turn,
    move_text,
    word_of,
)
from thbridge.dialogue.propositions import NextRoom
from thbridge.hunt import rules
from thbridge.hunt.events import DialogueSaid
from thbridge.hunt.game import GameState
from thbridge.hunt.rooms import Room, RoomNames
from thbridge.roles.shared.participant_rules import Discussed
from thbridge.roles.shared.view import Consent, DialogueMatter, DialogueView, LastWords

MATTERS: dict[Scenario, DialogueMatter] = {
    Scenario.SPECIFIC_ROOM: "select-room",
    Scenario.DONT_KNOW: "select-room",
    Scenario.TAKE_PICTURE: "take-picture",
    Scenario.TAKE_TREASURE: "take-treasure",
    Scenario.UNSURE_NAME: "take-treasure",
}


@dataclass(frozen=True, slots=True)
class HeldTurn:
    """A puppet's turn in a dialogue, which waits for the person who speaks in its place.

    Attributes:
        dialogue: its number.
        turn: place of the move in it, from 0.
        robot: index in the team, from 0.
        scenario: matter of the dialogue.
        room: the room it is about, as people count.
        sentences: for the legal moves, in their order.
    """

    dialogue: int
    turn: int
    robot: int
    scenario: DialogueMatter
    room: int
    sentences: tuple[str, ...]


class GameDialogues:
    """The open dialogues of one game, at most one per robot, and the consents they led to.

    Args:
        engine: runs the dialogues.
        puppets: robots that a person speaks for (Wizard-of-Oz).
        room_names: names of the map's rooms.

    Attributes:
        puppets: the current ones.
        asked_for_advice: puppets that the participant has asked where to go, in the order of asking; no dialogue yet.
        consents: agreements not yet acted upon, oldest first.
        last_words: of dialogues that have ended, at most one per robot, the newest last.
        not_restored: numbers of dialogues that were open when the game was cut off, and could not be taken up again.
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
        # By robot: the situation it was in when it last talked, and all that was said and believed.
        self._memories: dict[int, tuple[WhereFacts | WhatFacts, Conversation]] = {}
        # By robot, in the order of opening.
        self._open: dict[int, Dialogue] = {}
        self._opened = 0
        self.consents: tuple[Consent, ...] = ()
        self.last_words: tuple[LastWords, ...] = ()
        self.not_restored: tuple[int, ...] = ()
        self._utterances: list[DialogueUtterance] = []

    def take_utterances(self) -> list[DialogueUtterance]:
        """Return the utterances since the last call, in order."""
        utterances, self._utterances = self._utterances, []
        return utterances

    @property
    def next_number(self) -> int:
        """Number of the next dialogue."""
        return self._opened + 1

    @property
    def argues(self) -> bool:
        """True when dialogues need the facts of robots."""
        return self._engine.argues

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
        """Open a dialogue; an earlier one with this robot is withdrawn, and an agreement on the same matter too.

        Args:
            state: of the game.
            scenario: the decision.
            robot: index in the team.
            room: the room that it is about.
            reason: of a suggestion, as part of a sentence.
            confidence: to be stated in a suggestion, 0 to 1, or None.
            facts: of a robot that argues.
            opener: the side that brings it up.
            name: that the treasure is to be given.
            restored: the number that it had before the game was cut off; what was said follows by `retake`.
        """
        self._forget(robot, MATTERS[scenario])
        room_name = self._room_names.name(room.people)
        topic = replace(_topic(state, scenario, robot, room, room_name), reason=reason, confidence=confidence)
        topic = replace(topic, facts=facts, opener=opener, name=name)
        former = None if facts is None else self._remembered(robot, facts)
        self._opened = self.next_number if restored is None else restored
        held = restored is not None or robot in self.puppets
        self._follow(state, self._engine.open(self._opened, topic, held=held, former=former))

    def retake(self, state: GameState, said: DialogueSaid) -> None:
        """Take a turn again, as a journal has it; a dialogue in which it is not legal any more is withdrawn."""
        self._opened = max(self._opened, said.dialogue)
        dialogue = next((dialogue for dialogue in self._open.values() if dialogue.number == said.dialogue), None)
        if dialogue is None:
            return
        if said.turn < len(dialogue.turns):
            # With the move that opens it.
            is_same = move_text(dialogue.turns[said.turn].move) == said.move
        else:
            is_same = said.turn == len(dialogue.turns) and self._retaken(state, dialogue, said)
        if not is_same:
            del self._open[dialogue.topic.robot]
            self.not_restored += (dialogue.number,)

    def _retaken(self, state: GameState, dialogue: Dialogue, said: DialogueSaid) -> bool:
        speaker = Speaker(said.speaker)
        legal = [choice.move for choice in self._engine.choices(dialogue, speaker)]
        echo = Echo(said.text)
        move = next((move for move in (*legal, echo) if move_text(move) == said.move), None)
        if move is None:
            return False
        self._follow(state, self._engine.retake(dialogue, Turn(speaker, move, Author(said.author), said.text)))
        return True

    def go_on(self, state: GameState) -> None:
        """Let robots speak whose turn it was when the game was cut off; what was restored is not said again."""
        self._utterances.clear()
        for dialogue in tuple(self._open.values()):
            self._follow(state, self._engine.release(dialogue))

    def decision(self, facts: WhereFacts) -> Room | None:
        """Return the room that a robot would go to by itself, in the light of what it was told; None: none."""
        decision = decision_of(facts, self._remembered(facts.robot, facts))
        goes = None if decision is None else decision.proposition
        return goes.room if isinstance(goes, NextRoom) else None

    def _remembered(self, robot: int, facts: WhereFacts | WhatFacts) -> Conversation | None:
        """Return what was said before; where the situation is another one, without what was decided in the last."""
        if robot not in self._memories:
            return None
        situation, conversation = self._memories[robot]
        return conversation if situation == situation_of(facts) else conversation.begun_anew(is_decision)

    def await_advice(self, robot: int) -> None:
        """Note that the participant asked a puppet where to go; earlier dialogue and agreement are withdrawn."""
        self._forget(robot, "select-room")
        self.asked_for_advice += (robot,)

    def suggestion_stands(self, robot: int) -> bool:
        """Return True while participant and robot talk about a room that the robot suggested."""
        given = self._open.get(robot)
        return given is not None and given.topic.scenario is Scenario.DONT_KNOW

    def has_advised(self, robot: int) -> bool:
        """Return True while a request for this robot's advice has its effect: advice, or its agreement, or a wait."""
        agreed = any((consent.robot, consent.matter) == (robot, "select-room") for consent in self.consents)
        return robot in self.asked_for_advice or self.suggestion_stands(robot) or agreed

    def is_discussed(self, scenario: Scenario, robot: int, room: Room, name: str = "") -> bool:
        """Return True while this robot and the participant talk about just this, or have agreed on it."""
        topic = self._open[robot].topic if robot in self._open else None
        is_open = topic is not None and (topic.scenario, topic.room, topic.name) == (scenario, room, name)
        is_agreed = any(
            (consent.robot, consent.matter, consent.room) == (robot, MATTERS[scenario], room.people)
            and (scenario is Scenario.UNSURE_NAME or consent.name in {"", name})
            for consent in self.consents
        )
        return is_open or is_agreed

    def answer(self, state: GameState, number: int, turn: int, choice: int) -> None:
        """Make the participant's choice; one for an earlier turn changes nothing."""
        dialogue = self._at_turn(number, turn)
        choices = () if dialogue is None else self._engine.choices(dialogue)
        if dialogue is not None and 0 <= choice < len(choices):
            held = dialogue.topic.robot in self.puppets
            self._follow(state, self._engine.move(dialogue, choices[choice].move, held=held))

    def decided_alone(self, state: GameState, robot: int, room: Room, waited: float) -> None:
        """Let a robot say that it goes to a room by itself, after it has waited for so many seconds."""
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
        """Let the robot speak for itself again, at once if it is its turn; a waiting request for advice is dropped."""
        self.puppets -= {robot}
        self._forget_advice(robot)
        dialogue = self._open.get(robot)
        if dialogue is not None and state is not None:
            self._follow(state, self._engine.release(dialogue))

    def speak_for(self, state: GameState, number: int, turn: int, move: int, text: str) -> None:
        """Make a puppet's move; one for an earlier turn changes nothing."""
        dialogue = self._at_turn(number, turn)
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
            for dialogue in self._open.values()
            if (choices := self._engine.choices(dialogue, Speaker.ROBOT))
        )

    # Agreements

    def is_agreed(self, robot: int, matter: DialogueMatter, room: Room, name: str = "") -> bool:
        """Return True when the participant may act on this now; of an agreement on a name, by this name."""
        return any(
            (consent.robot, consent.matter, consent.room) == (robot, matter, room.people) and consent.name in {"", name}
            for consent in self.consents
        )

    def withdraw_consent(self, robot: int, matter: DialogueMatter) -> None:
        """Withdraw an agreement, because it was acted upon or the matter is open again."""
        self.consents = tuple(
            consent for consent in self.consents if (consent.robot, consent.matter) != (robot, matter)
        )

    @property
    def discussed(self) -> tuple[Discussed, ...]:
        """Matters of open dialogues, then those of agreements not yet acted upon."""
        topics = (dialogue.topic for dialogue in self._open.values())
        return (
            *(Discussed(topic.robot, MATTERS[topic.scenario], topic.room.people) for topic in topics),
            *(Discussed(consent.robot, consent.matter, consent.room) for consent in self.consents),
        )

    def drop_stale(self, state: GameState) -> None:
        """Withdraw dialogues without purpose: the robot left, the room is taken, or the treasure is decided."""
        for robot, dialogue in list(self._open.items()):
            if not _still_open(state, robot, MATTERS[dialogue.topic.scenario], dialogue.topic.room):
                del self._open[robot]
                self._keep_last_words(dialogue, agreed=False)
        self.consents = tuple(
            consent
            for consent in self.consents
            if _still_open(state, consent.robot, consent.matter, Room(consent.room))
        )
        agreed = {(consent.robot, consent.matter, consent.room) for consent in self.consents}
        self.last_words = tuple(
            words
            for words in self.last_words
            if _still_matters(state, words) or (words.robot, words.matter, words.room) in agreed
        )
        self.asked_for_advice = tuple(
            robot
            for robot in self.asked_for_advice
            if any(_still_open(state, robot, "select-room", room) for room in state.free_rooms)
        )

    def views(self) -> tuple[DialogueView, ...]:
        """Return the open dialogues as the participant sees them."""
        return tuple(map(self._view, self._open.values()))

    def _view(self, dialogue: Dialogue) -> DialogueView:
        choices, utterances = self._engine.choices(dialogue), self._engine.utterances(dialogue)
        said, speakers = _sentences(utterances)
        return DialogueView(
            dialogue=dialogue.number,
            turn=len(dialogue.turns),
            robot=dialogue.topic.robot,
            matter=MATTERS[dialogue.topic.scenario],
            room=dialogue.topic.room.people,
            said=said,
            choices=tuple(choice.text for choice in choices),
            acts=tuple(word_of(choice.move) for choice in choices),
            speakers=speakers,
            suggested=self.suggestion_stands(dialogue.topic.robot),
        )

    def is_talking(self, robot: int) -> bool:
        """Return True while a dialogue with this robot is open."""
        return robot in self._open

    def robot_of(self, number: int) -> int | None:
        """Return the robot of the open dialogue with this number, or None."""
        return next((robot for robot, dialogue in self._open.items() if dialogue.number == number), None)

    def _at_turn(self, number: int, turn: int) -> Dialogue | None:
        """Return the open dialogue of this number if it is at this turn."""
        dialogue = next((dialogue for dialogue in self._open.values() if dialogue.number == number), None)
        return dialogue if dialogue is not None and len(dialogue.turns) == turn else None

    def _follow(self, state: GameState, step: DialogueStep) -> None:
        topic = step.dialogue.topic
        matter = MATTERS[topic.scenario]
        if step.dialogue.conversation is not None and topic.facts is not None:
            self._memories[topic.robot] = (situation_of(topic.facts), step.dialogue.conversation)
        if step.outcome is None:
            self._utterances += step.utterances
            self._open[topic.robot] = step.dialogue
            return
        # What both agreed upon in the end may have been done by another robot while they talked.
        can_be_done = _still_open(state, topic.robot, matter, topic.room)
        agreed = step.outcome is DialogueOutcome.CONSENSUS and can_be_done
        self._open.pop(topic.robot, None)
        self._utterances += _true(step.utterances, agreed=agreed)
        self._keep_last_words(step.dialogue, agreed=agreed)
        if agreed:
            self.consents += (Consent(topic.robot, matter, topic.room.people, topic.name),)

    def _keep_last_words(self, dialogue: Dialogue, *, agreed: bool) -> None:
        """Keep how a dialogue has ended; where robots do as they are told without a word, there is nothing to keep."""
        if not self.argues or (agreed and not dialogue.turns):
            return
        utterances = _true(self._engine.utterances(dialogue), agreed=agreed)
        topic, (said, speakers) = dialogue.topic, _sentences(utterances)
        matter = MATTERS[topic.scenario]
        # Of what is done the robot's last sentence tells, of what is not only its conclusion.
        is_told = agreed or any(isinstance(each.move, Conclude) for each in utterances[-1:])
        words = LastWords(dialogue.number, topic.robot, matter, topic.room.people, said, speakers, agreed, is_told)
        self.last_words = (*(each for each in self.last_words if each.robot != topic.robot), words)

    def _forget(self, robot: int, matter: DialogueMatter) -> None:
        """Withdraw a robot's dialogue, its request for advice, and its agreement on this matter."""
        self.withdraw_consent(robot, matter)
        self._forget_advice(robot)
        self._open.pop(robot, None)
        self.last_words = tuple(words for words in self.last_words if words.robot != robot)

    def _forget_advice(self, robot: int) -> None:
        self.asked_for_advice = tuple(asked for asked in self.asked_for_advice if asked != robot)


def _sentences(
    utterances: Sequence[DialogueUtterance],
) -> tuple[tuple[str, ...], tuple[Literal["robot", "person"], ...]]:
    """Return what was said and by whom; to look for a question, and to ask none after all, says nothing."""
    said = [each for each in utterances if not isinstance(each.move, OpenQuestions | CloseQuestions)]
    return tuple(each.text for each in said), tuple(each.speaker.value for each in said)


def _true(utterances: tuple[DialogueUtterance, ...], *, agreed: bool) -> tuple[DialogueUtterance, ...]:
    """Return what was said, without a conclusion that tells of something that is not done."""

    def is_true(move: Move) -> bool:
        return agreed or not isinstance(move, Conclude) or move.about is None

    return tuple(each for each in utterances if is_true(each.move))


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
    """Return the robot besides this one that could get to a room for the least energy, or None."""
    costs = {
        other: state.cost(other, room)
        for other, mover in enumerate(state.robots)
        if other != robot and mover.bound_for is None and not (mover.is_silent or mover.is_blocked)
    }
    return min((other for other, cost in costs.items() if math.isfinite(cost)), key=costs.__getitem__, default=None)


def _still_open(state: GameState, robot: int, matter: DialogueMatter, room: Room) -> bool:
    if state.ended is not None:
        return False
    if matter == "select-room":
        return isinstance(rules.move(state, robot, room), tuple)
    worker = state.decider(room) if matter == "take-treasure" else state.standing_in(room)
    return worker == robot and not state.robots[robot].is_silent and not state.room(room).is_decided


def _still_matters(state: GameState, words: LastWords) -> bool:
    """Return True until what was agreed is done; without an agreement, until the robot or its treasure moves on."""
    if state.ended is not None:
        return False
    robot, room = state.robots[words.robot], Room(words.room)
    if words.matter == "select-room":
        return robot.bound_for == (room if words.agreed else None)
    return not words.agreed and _still_open(state, words.robot, words.matter, room)
