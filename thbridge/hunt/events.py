"""Events of a game. A game is fully described by its events, in order."""

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
    """Commander of a robot: the participant, unless somebody else has taken it over.

    A ground station keeps a robot until it gives it back. A researcher, or a program beside the game, has it while a
    goal or manual driving of theirs lasts, whoever had it before.
    """

    PARTICIPANT = "participant"
    GROUND_STATION = "ground station"
    RESEARCHER = "researcher"


class _Event(msgspec.Struct, frozen=True, forbid_unknown_fields=True, tag_field="event"):
    """Base of the events; the tag of each is its kind in journals and recordings."""


class GameStarted(_Event, frozen=True, tag="started"):
    """A new game: its rules and its numbers. Every robot stands in the corridor.

    Attributes:
        seed: of all random numbers of this game.
        game: number of the game, from 1, unique within a journal folder.
        robots: size of the team; in events a robot is its index, from 0, as on the wire.
        energy: of each robot at the start.
        picture_cost: energy of the first picture in a room.
        identify_cost: energy of identifying.
        wrong_share: share of a treasure's points that a wrong name costs; 1 is the rule of 2016.
        costs: energy of every move; its size determines the number of rooms.
        properties: of its treasures.

    Raises:
        ValueError: a team without robots, or a negative number.
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
        # Written as a negation so that NaN is refused too.
        if not min(self.energy, self.picture_cost, self.identify_cost, self.wrong_share) >= 0.0:
            raise ValueError("energy, costs and the share of a wrong answer are numbers that are not negative")


class TreasuresHidden(_Event, frozen=True, tag="hidden"):
    """The treasures were hidden, one per room, room 1 first. Never shown to the participant."""

    treasures: tuple[TreasureKind, ...]


class ConsentGiven(_Event, frozen=True, omit_defaults=True, tag="agreed"):
    """The participant agreed to take part in the study. Recorded again in each later game of the same keeper.

    Attributes:
        at: time of day of the agreement, as `GiveConsent.at`.
    """

    at: str = ""


class RoomAdvised(_Event, frozen=True, tag="advised"):
    """A robot suggested a room to a participant who did not know, or a wizard did in its place.

    The participant is told the room and what the robot says about it, never whether the advice errs.

    Attributes:
        robot: index in the team, from 0.
        room: the room suggested.
        advice: number of the robot's advice in this game, from 1. Older releases recorded a repeated one again.
        planned: the room that the robot's planner chose. A wizard may have suggested another one.
        erred: True when the robot suggested another room than planned because the study has it err.
        confidence: stated by the robot, 0 to 1; None when it stated none.
    """

    robot: int
    room: Room
    advice: int
    planned: Room
    erred: bool
    confidence: Number | None


class RobotDeparted(_Event, frozen=True, tag="departed"):
    """A robot set out for a room, which is reserved from now on; its energy is paid in advance."""

    robot: int
    room: Room
    cost: Number


class RobotArrived(_Event, frozen=True, tag="arrived"):
    """A robot stands in a room, which counts as visited from now on."""

    robot: int
    room: Room


class MoveFailed(_Event, frozen=True, tag="failed"):
    """A robot did not reach the room it drove to, or was stopped; the room is free again.

    Attributes:
        robot: index in the team, from 0.
        room: destination of the move.
        reason: sentence of the navigator or for a stop, for people.
        refund: energy given back.
        at: its place now, from which the cost of its next move counts.
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
    """The costs of a robot's moves were estimated anew from where it stands, which is none of the game's places.

    Attributes:
        robot: index in the team, from 0.
        costs: energy to each place, by the number people use; None where there is no move.
    """

    robot: int
    costs: tuple[Number | None, ...]


class CommanderChanged(_Event, frozen=True, tag="commanded"):
    """The commander of a robot has changed.

    Attributes:
        robot: index in the team, from 0.
        by: commander from now on.
        name: of the commander, for example "ground station 255" or a ROS node's name; empty for the participant.
    """

    robot: int
    by: Commander
    name: str


class HandbackRequested(_Event, frozen=True, tag="asked-back"):
    """The participant asks the commander of a robot to give it back; the commander decides."""

    robot: int


class TreasureSensed(_Event, frozen=True, tag="sensed"):
    """Properties of the treasure in a room that the robot there senses as it finds it."""

    room: Room
    properties: Properties


class PropertyMeasured(_Event, frozen=True, tag="measured"):
    """A robot sensed one more property of the treasure in a room, for energy."""

    room: Room
    robot: int
    property: str
    value: str
    cost: Number


class PropertyTold(_Event, frozen=True, tag="told"):
    """The participant told a property of the treasure in a room, as it appears to a person."""

    room: Room
    property: str
    value: str


class TreasurePictured(_Event, frozen=True, tag="pictured"):
    """A picture was taken; `image` is a file name without directory. Cost 0 when it was shown again."""

    room: Room
    robot: int
    image: str
    cost: Number


class TreasureIdentified(_Event, frozen=True, tag="identified"):
    """The treasure in a room was named; points are negative when the name was wrong.

    Attributes:
        room: None if a program of 2016 sent only the points.
        robot: the robot that stood there; None if the game knows of none.
        name: the participant's name for it; None if a program of 2016 sent only the points.
        points: added to the score.
        cost: energy paid by the robot.
    """

    room: Room | None
    robot: int | None
    name: str | None
    points: int
    cost: Number


class TreasureLeft(_Event, frozen=True, tag="left"):
    """The participant gave up the treasure in a room."""

    room: Room


class TreasureTakenUp(_Event, frozen=True, tag="taken-up"):
    """The participant took back that the treasure in a room was given up."""

    room: Room


class GameEnded(_Event, frozen=True, tag="ended"):
    """The game is over, with this score."""

    reason: EndReason
    score: int


class DialogueOpened(_Event, frozen=True, omit_defaults=True, tag="talk"):
    """A robot and the participant have begun to talk about a decision. Only journals have it: no game depends on it.

    Attributes:
        dialogue: its number in this game, from 1.
        scenario: the decision.
        robot: index in the team, from 0.
        room: the room that it is about.
        at: simulated time, s.
        opener: the side that brings it up.
        advised: the room that the robot's planner chose; None where it had none.
        reason: of a suggestion, as part of a sentence.
        confidence: stated in a suggestion, 0 to 1; None where none was.
        name: that the treasure there is to be given; empty where none was said.
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
    """A robot or the participant has said something in a dialogue. Only journals have it.

    Attributes:
        dialogue: number of the dialogue; one that was not opened is an announcement.
        turn: place of the move in it, from 0.
        speaker: the side that said it.
        author: who decided on it: robot, person or wizard.
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
    """A key was used: a program joined by it, or whoever has it asked for something. Only journals have it.

    Attributes:
        key: its name.
        did: what was done by it, for people.
        run: name of this game, unlike all others: the game that a participant's key is good for.
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
"""What a journal holds: the events of a game, what was said between them, and by which keys."""
