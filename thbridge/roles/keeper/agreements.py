"""Agreements between the participant and robots, and the last sentences of their dialogues."""

from collections.abc import Sequence
from typing import Literal

from thbridge.dialogue.moves import (
    CloseQuestions,
    Conclude,
    Dialogue,
    DialogueUtterance,
    Move,
    OpenQuestions,
    Scenario,
)
from thbridge.hunt import rules
from thbridge.hunt.game import GameState
from thbridge.hunt.rooms import Room
from thbridge.roles.shared.view import Consent, DialogueMatter, LastWords

MATTERS: dict[Scenario, DialogueMatter] = {
    Scenario.SPECIFIC_ROOM: "select-room",
    Scenario.DONT_KNOW: "select-room",
    Scenario.TAKE_PICTURE: "take-picture",
    Scenario.TAKE_TREASURE: "take-treasure",
    Scenario.UNSURE_NAME: "take-treasure",
}


class Agreements:
    """Agreements that are not carried out yet.

    Attributes:
        all: the agreements, oldest first.
    """

    def __init__(self) -> None:
        self.all: tuple[Consent, ...] = ()

    def add(self, consent: Consent) -> None:
        """Add an agreement."""
        self.all += (consent,)

    def is_agreed(self, robot: int, matter: DialogueMatter, room: Room, name: str = "") -> bool:
        """Return True if there is an agreement on this act. An agreement with a name is valid only for this name."""
        return any(
            (consent.robot, consent.matter, consent.room) == (robot, matter, room.people) and consent.name in {"", name}
            for consent in self.all
        )

    def has(self, robot: int, matter: DialogueMatter) -> bool:
        """Return True if there is an agreement with a robot on a matter."""
        return any((consent.robot, consent.matter) == (robot, matter) for consent in self.all)

    def covers(self, scenario: Scenario, robot: int, room: Room, name: str) -> bool:
        """Return True if a dialogue about this would only repeat an agreement."""
        if scenario is Scenario.UNSURE_NAME:
            return any(
                (consent.robot, consent.matter, consent.room) == (robot, MATTERS[scenario], room.people)
                for consent in self.all
            )
        return self.is_agreed(robot, MATTERS[scenario], room, name)

    def withdraw(self, robot: int, matter: DialogueMatter) -> None:
        """Remove an agreement, because it was carried out or its matter is open again."""
        self.all = tuple(consent for consent in self.all if (consent.robot, consent.matter) != (robot, matter))

    def withdraw_name(self, room: Room, name: str) -> None:
        """Remove an agreement on the name of the treasure in a room, or on any name of it."""
        self.all = tuple(
            consent
            for consent in self.all
            if (consent.matter, consent.room) != ("take-treasure", room.people) or consent.name not in {"", name}
        )

    def drop_stale(self, state: GameState) -> None:
        """Remove agreements that can no longer be carried out."""
        self.all = tuple(
            consent for consent in self.all if still_open(state, consent.robot, consent.matter, Room(consent.room))
        )


class LastSentences:
    """Last sentences of ended dialogues, for at most one dialogue per robot.

    Attributes:
        all: the last sentences, oldest dialogue first.
    """

    def __init__(self) -> None:
        self.all: tuple[LastWords, ...] = ()

    def keep(self, dialogue: Dialogue, utterances: tuple[DialogueUtterance, ...], *, agreed: bool) -> None:
        """Store the last sentences of a dialogue, unless the robot agreed without a sentence."""
        if agreed and not dialogue.turns:
            return
        said_truly = true_utterances(utterances, agreed=agreed)
        topic, (said, speakers) = dialogue.topic, sentences(said_truly)
        # If the agreement is carried out, the robot's last sentence states this. Otherwise only a conclusion states it.
        is_told = agreed or any(isinstance(each.move, Conclude) for each in said_truly[-1:])
        matter = MATTERS[topic.scenario]
        words = LastWords(dialogue.number, topic.robot, matter, topic.room.people, said, speakers, agreed, is_told)
        self.forget(topic.robot)
        self.all += (words,)

    def forget(self, robot: int) -> None:
        """Remove the last sentences of a robot's dialogue."""
        self.all = tuple(words for words in self.all if words.robot != robot)

    def drop_stale(self, state: GameState, agreements: Agreements) -> None:
        """Remove last sentences that are no longer relevant."""
        agreed = {(consent.robot, consent.matter, consent.room) for consent in agreements.all}
        self.all = tuple(
            words
            for words in self.all
            if _still_matters(state, words) or (words.robot, words.matter, words.room) in agreed
        )


def sentences(
    utterances: Sequence[DialogueUtterance],
) -> tuple[tuple[str, ...], tuple[Literal["robot", "person"], ...]]:
    """Return the sentences and their speakers. Ignore turns that only open or close the list of questions."""
    said = [each for each in utterances if not isinstance(each.move, OpenQuestions | CloseQuestions)]
    return tuple(each.text for each in said), tuple(each.speaker.value for each in said)


def true_utterances(utterances: tuple[DialogueUtterance, ...], *, agreed: bool) -> tuple[DialogueUtterance, ...]:
    """Return the utterances without conclusions about acts that are not carried out."""

    def is_true(move: Move) -> bool:
        return agreed or not isinstance(move, Conclude) or move.about is None

    return tuple(each for each in utterances if is_true(each.move))


def still_open(state: GameState, robot: int, matter: DialogueMatter, room: Room) -> bool:
    """Return True if a robot can carry out the matter of a dialogue or agreement."""
    if state.ended is not None:
        return False
    if matter == "select-room":
        return isinstance(rules.move(state, robot, room), tuple)
    worker = state.decider(room) if matter == "take-treasure" else state.standing_in(room)
    return worker == robot and not state.robots[robot].is_silent and not state.room(room).is_decided


def _still_matters(state: GameState, words: LastWords) -> bool:
    """Return True if the last sentences of a dialogue are still relevant.

    After an agreement, they are relevant until the agreement is carried out. Otherwise, they are relevant until the
    robot moves or there is a decision on the treasure.
    """
    if state.ended is not None:
        return False
    robot, room = state.robots[words.robot], Room(words.room)
    if words.matter == "select-room":
        return robot.bound_for == (room if words.agreed else None)
    return not words.agreed and still_open(state, words.robot, words.matter, room)
