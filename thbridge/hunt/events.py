"""Events of a game. Its events, in order, describe a game completely."""

import sys
from enum import StrEnum
from typing import Annotated, TypeAlias

import msgspec

from thbridge.hunt.costs import CostMatrix
from thbridge.hunt.properties import OF_2016, Properties, TreasureProperty
from thbridge.hunt.rooms import Room
from thbridge.hunt.treasures import TreasureKind

Number: TypeAlias = Annotated[float, msgspec.Meta(ge=-sys.float_info.max, le=sys.float_info.max)]
"""A finite number."""


class EndReason(StrEnum):
    """Reason for the end of a game."""

    ALL_VISITED = "all-visited"
    NO_MOVE_LEFT = "no-move-left"
    GIVEN_UP = "given-up"


class Condition(StrEnum):
    """Condition of a robot, as SimR reports it.

    A lost robot does not know its pose; a silent one does not respond, so it may be dead or out of reach.
    """

    WELL = "well"
    LOST = "lost"
    SILENT = "silent"


class Commander(StrEnum):
    """Commander of a robot: the participant, unless another party has taken command.

    A ground station commands a robot until the station gives it back. A researcher or an outside program commands a
    robot while their goal or manual driving lasts, whichever party commanded it before.
    """

    PARTICIPANT = "participant"
    GROUND_STATION = "ground station"
    RESEARCHER = "researcher"


class _Event(msgspec.Struct, frozen=True, forbid_unknown_fields=True, tag_field="event"):
    """Base of the events; the tag of each is its kind in journals and recordings."""


class GameStarted(_Event, frozen=True, tag="started"):
    """A new game: its rules and its numbers. Every robot starts in the corridor.

    Attributes:
        seed: random seed of this game.
        game: number of the game, from 1, unique in a journal folder.
        robots: size of the team; events refer to a robot by its index, from 0, as the text protocol does.
        energy: energy of each robot at the start.
        picture_cost: energy of the first picture in a room.
        identify_cost: energy of identifying a treasure.
        wrong_share: share of a treasure's points that a wrong name costs; 1 is the rule of 2016.
        costs: energy of every move; its size is the number of rooms plus 1.
        properties: properties of its treasures.

    Raises:
        ValueError: the team has no robots, or a number is negative.
    """

    seed: int
    game: int
    robots: int
    energy: Number
    picture_cost: Number
    identify_cost: Number
    wrong_share: Number
    costs: CostMatrix
    properties: tuple[TreasureProperty, ...] = OF_2016

    def __post_init__(self) -> None:
        if self.robots < 1:
            raise ValueError("a team has at least one robot")
        # `not ... >= 0` also refuses NaN.
        if not min(self.energy, self.picture_cost, self.identify_cost, self.wrong_share) >= 0.0:
            raise ValueError("energy, costs and the share of a wrong answer are numbers that are not negative")


class TreasuresHidden(_Event, frozen=True, tag="hidden"):
    """The treasures were hidden, one per room, room 1 first. The participant never sees this."""

    treasures: tuple[TreasureKind, ...]


class ConsentGiven(_Event, frozen=True, omit_defaults=True, tag="agreed"):
    """The participant agreed to take part in the study. Recorded again in each later game of the same keeper.

    Attributes:
        at: date and time of the agreement, as in `GiveConsent.at`.
    """

    at: str = ""


class RoomAdvised(_Event, frozen=True, tag="advised"):
    """A robot, or a wizard in its place, suggested a room to a participant who did not know where to go.

    The participant receives the room and the robot's reason, but not whether the advice is wrong.

    Attributes:
        robot: index in the team, from 0.
        room: the suggested room.
        advice: number of the robot's advice in this game, from 1. Older releases recorded a repeated advice again.
        planned: the room that the robot's planner chose. A wizard can have suggested another one.
        `erred`: True if the robot suggested another room than planned, because the study makes it give wrong advice.
        confidence: confidence that the robot stated, 0 to 1; None if it stated none.
    """

    robot: int
    room: Room
    advice: int
    planned: Room
    erred: bool
    confidence: Number | None


class RobotDeparted(_Event, frozen=True, tag="departed"):
    """A robot set out for a room, which is reserved from now on; the energy is paid in advance."""

    robot: int
    room: Room
    cost: Number


class RobotArrived(_Event, frozen=True, tag="arrived"):
    """A robot stands in a room, which counts as visited from now on."""

    robot: int
    room: Room


class MoveFailed(_Event, frozen=True, tag="failed"):
    """A robot did not reach its room, or was stopped; the room is free again.

    Attributes:
        robot: index in the team, from 0.
        room: destination of the move.
        reason: sentence for people from the navigator, or about the stop.
        refund: energy given back.
        at: place where it stands now; the cost of its next move is computed from there.
    """

    robot: int
    room: Room
    reason: str
    refund: Number
    at: Room


class ConditionChanged(_Event, frozen=True, tag="reported"):
    """The condition of a robot has changed."""

    robot: int
    condition: Condition


class CostsEstimated(_Event, frozen=True, tag="priced"):
    """The costs of a robot's moves were estimated again, for a place that is not in the game's cost matrix.

    Attributes:
        robot: index in the team, from 0.
        costs: energy to each place, by the number for people; None if there is no move.
    """

    robot: int
    costs: tuple[Number | None, ...]


class CommanderChanged(_Event, frozen=True, tag="commanded"):
    """The commander of a robot has changed.

    Attributes:
        robot: index in the team, from 0.
        by: commander from now on.
        name: name of the commander, for example "ground station 255" or a ROS node's name; empty for the participant.
    """

    robot: int
    by: Commander
    name: str


class HandbackRequested(_Event, frozen=True, tag="asked-back"):
    """The participant asks the commander of a robot to give it back; the commander decides."""

    robot: int


class TreasureSensed(_Event, frozen=True, tag="sensed"):
    """A robot found a treasure in a room, and sensed these properties at once."""

    room: Room
    properties: Properties


class PropertyMeasured(_Event, frozen=True, tag="measured"):
    """A robot sensed one more property of the treasure in a room, which cost energy."""

    room: Room
    robot: int
    property: str
    value: str
    cost: Number


class PropertyTold(_Event, frozen=True, tag="told"):
    """The participant reported a property of the treasure in a room, as a person sees it."""

    room: Room
    property: str
    value: str


class TreasurePictured(_Event, frozen=True, tag="pictured"):
    """A picture was taken; `image` is a file name without directory. The cost is 0 if the picture was shown again."""

    room: Room
    robot: int
    image: str
    cost: Number


class TreasureIdentified(_Event, frozen=True, tag="identified"):
    """The treasure in a room was named; the points are negative if the name was wrong.

    Attributes:
        room: the room; None if a program of 2016 sent only the points.
        robot: the robot that stood there; None if the game knows of none.
        name: the name that the participant gave; None if a program of 2016 sent only the points.
        points: points that are added to the score.
        cost: energy paid by the robot.
    """

    room: Room | None
    robot: int | None
    name: str | None
    points: int
    cost: Number


class TreasureLeft(_Event, frozen=True, tag="left"):
    """The participant left the treasure in a room undecided."""

    room: Room


class TreasureTakenUp(_Event, frozen=True, tag="taken-up"):
    """The participant took up again the treasure that was left in a room."""

    room: Room


class GameEnded(_Event, frozen=True, tag="ended"):
    """The game is over, with this score."""

    reason: EndReason
    score: int


class DialogueOpened(_Event, frozen=True, omit_defaults=True, tag="talk"):
    """A robot and the participant have begun a dialogue about a decision.

    Only journals have this event; it does not change the state of the game.

    Attributes:
        dialogue: number of the dialogue in this game, from 1.
        scenario: the decision.
        robot: index in the team, from 0.
        room: the room that the dialogue is about.
        at: simulated time, s.
        opener: the side that opens the dialogue.
        advised: the room that the robot's planner chose; None if it chose none.
        reason: reason for a suggestion, as part of a sentence.
        confidence: confidence stated in a suggestion, 0 to 1; None if none was stated.
        name: proposed name of the treasure there; empty if there is none.
    """

    dialogue: int
    scenario: str
    robot: int
    room: Room
    at: Number
    opener: str
    advised: Room | None = None
    reason: str = ""
    confidence: Number | None = None
    name: str = ""


class DialogueSaid(_Event, frozen=True, tag="said"):
    """A robot or the participant has said something in a dialogue. Only journals have this event.

    Attributes:
        dialogue: number of the dialogue. If no dialogue of this number was opened, the sentence is an announcement.
        turn: index of the move in the dialogue, from 0.
        speaker: the side that said it.
        author: author of the move: robot, person or wizard.
        move: the move, as `move_text` writes it.
        text: the sentence.
    """

    dialogue: int
    turn: int
    speaker: str
    author: str
    move: str
    text: str


class KeyUsed(_Event, frozen=True, tag="key"):
    """A client joined or sent a request with a key. Only journals have this event.

    Attributes:
        key: name of the key.
        did: description of its use, for people.
        run: unique name of this game; a participant's key is valid for one such game.
    """

    key: str
    did: str
    run: str = ""


Event = (
    GameStarted
    | TreasuresHidden
    | ConsentGiven
    | RoomAdvised
    | RobotDeparted
    | RobotArrived
    | MoveFailed
    | ConditionChanged
    | CostsEstimated
    | CommanderChanged
    | HandbackRequested
    | TreasureSensed
    | PropertyMeasured
    | PropertyTold
    | TreasurePictured
    | TreasureIdentified
    | TreasureLeft
    | TreasureTakenUp
    | GameEnded
)

JournalEntry = Event | DialogueOpened | DialogueSaid | KeyUsed
"""Entries of a journal: the events of a game, the dialogues, and the uses of keys."""
