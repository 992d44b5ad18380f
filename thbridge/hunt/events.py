"""Events of a game. All events in order are a complete description of a game."""

import sys
from enum import StrEnum
from typing import Annotated, TypeAlias

import msgspec

from thbridge.hunt.costs import CostMatrix
from thbridge.hunt.properties import OF_2016, Properties, TreasureProperty
from thbridge.hunt.rooms import Room
from thbridge.hunt.seats import PlayedBy, Seat
from thbridge.hunt.treasures import TreasureKind

Number: TypeAlias = Annotated[float, msgspec.Meta(ge=-sys.float_info.max, le=sys.float_info.max)]
"""A finite number."""


class EndReason(StrEnum):
    """Reason for the end of a game."""

    ALL_VISITED = "all-visited"
    NO_MOVE_LEFT = "no-move-left"
    GIVEN_UP = "given-up"


class Condition(StrEnum):
    """Condition of a robot, from SimR's reports.

    A lost robot does not know its pose. A silent robot does not respond, so it may be dead or out of radio range.
    """

    WELL = "well"
    LOST = "lost"
    SILENT = "silent"


class Commander(StrEnum):
    """Commander of a robot: the participant, or another party that has taken command.

    A ground station commands a robot until the station gives the robot back. A researcher or an external program
    commands a robot only while the robot drives to their goal or is driven by hand. Afterwards, the earlier commander
    commands the robot again.

    Events never have the last value: in the view of a seat, it stands for the participants of the other seats.
    """

    PARTICIPANT = "participant"
    GROUND_STATION = "ground station"
    RESEARCHER = "researcher"
    TEAMMATE = "teammate"


class _Event(msgspec.Struct, frozen=True, forbid_unknown_fields=True, tag_field="event"):
    """Base class of events. The tag of an event class is its kind in journals and recordings.

    In a game with seats, the field `seat` of an event names the seat that caused it. It is empty for events that no
    participant caused, and in games without seats.
    """


class GameStarted(_Event, frozen=True, tag="started"):
    """A new game has started, with these rules and numbers. Every robot starts in the corridor.

    Attributes:
        seed: random seed of the game.
        game: number of the game, from 1, unique in a journal folder.
        robots: number of robots. Events refer to a robot by its index from 0, as in the text protocol.
        energy: energy of each robot at the start.
        picture_cost: energy of the first picture in a room.
        identify_cost: energy of naming a treasure.
        wrong_share: points that a wrong name costs, as a share of the treasure's points. In 2016, the share was 1.
        costs: energy of every move. The size of the matrix is the number of rooms plus 1.
        properties: properties of the treasures.
        seats: the seats. Empty if the game has one participant.

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
    seats: tuple[Seat, ...] = ()

    def __post_init__(self) -> None:
        if self.robots < 1:
            raise ValueError("a team must have at least one robot")
        # With `not`, NaN is refused, too.
        if not min(self.energy, self.picture_cost, self.identify_cost, self.wrong_share) >= 0.0:
            raise ValueError("energy, costs and the share for a wrong name must be numbers of 0 or more")


class TreasuresHidden(_Event, frozen=True, tag="hidden"):
    """The treasures were hidden, one per room, in the order of the rooms. The participant never sees this event."""

    treasures: tuple[TreasureKind, ...]


class ConsentGiven(_Event, frozen=True, omit_defaults=True, tag="agreed"):
    """The participant agreed to take part in the study. Each later game of the same keeper has this event, too.

    Attributes:
        at: date and time of the agreement, as in `GiveConsent.at`.
    """

    at: str = ""
    seat: str = ""


class RoomAdvised(_Event, frozen=True, tag="advised"):
    """A robot, or a wizard in its place, suggested a room to the participant.

    The participant sees the room and the robot's reason, but not `erred`.

    Attributes:
        robot: index of the robot, from 0.
        room: the suggested room.
        advice: number of the robot's advice in this game, from 1. Older releases recorded repeated advice again.
        planned: the room that the robot's planner chose. A wizard may suggest another room.
        `erred`: True if the robot suggested a room other than `planned`, because the study includes wrong advice.
        confidence: confidence that the robot stated, 0 to 1, or None if it stated no confidence.
    """

    robot: int
    room: Room
    advice: int
    planned: Room
    erred: bool
    confidence: Number | None


class RobotDeparted(_Event, frozen=True, tag="departed"):
    """A robot started to drive to a room. The room is now reserved. The robot has paid the energy in advance."""

    robot: int
    room: Room
    cost: Number
    seat: str = ""


class RobotArrived(_Event, frozen=True, tag="arrived"):
    """A robot arrived in a room. The room now counts as visited."""

    robot: int
    room: Room


class MoveFailed(_Event, frozen=True, tag="failed"):
    """A robot did not reach its room, or was stopped. The room is no longer reserved.

    Attributes:
        robot: index of the robot, from 0.
        room: destination of the move.
        reason: sentence for people about the failure or the stop.
        refund: refunded energy.
        at: present place of the robot, from which the cost of its next move is computed.
    """

    robot: int
    room: Room
    reason: str
    refund: Number
    at: Room
    seat: str = ""


class ConditionChanged(_Event, frozen=True, tag="reported"):
    """The condition of a robot has changed."""

    robot: int
    condition: Condition


class CostsEstimated(_Event, frozen=True, tag="priced"):
    """The costs of a robot's moves were estimated for a position that is not in the game's cost matrix.

    Attributes:
        robot: index of the robot, from 0.
        costs: energy to each place, by the number for people. None if there is no move.
    """

    robot: int
    costs: tuple[Number | None, ...]


class CommanderChanged(_Event, frozen=True, tag="commanded"):
    """The commander of a robot has changed.

    Attributes:
        robot: index of the robot, from 0.
        by: new commander.
        name: name of the commander, for example "ground station 255" or the name of a ROS node. Empty for the
            participant.
    """

    robot: int
    by: Commander
    name: str
    seat: str = ""


class HandbackRequested(_Event, frozen=True, tag="asked-back"):
    """The participant asked the commander of a robot to give the robot back. The commander decides."""

    robot: int
    seat: str = ""


class TreasureSensed(_Event, frozen=True, tag="sensed"):
    """A robot found the treasure in a room and sensed these properties at once."""

    room: Room
    properties: Properties
    seat: str = ""


class PropertyMeasured(_Event, frozen=True, tag="measured"):
    """A robot sensed a further property of the treasure in a room, and paid this energy."""

    room: Room
    robot: int
    property: str
    value: str
    cost: Number
    seat: str = ""


class PropertyTold(_Event, frozen=True, tag="told"):
    """The participant reported a visible property of the treasure in a room."""

    room: Room
    property: str
    value: str
    seat: str = ""


class TreasurePictured(_Event, frozen=True, tag="pictured"):
    """A picture was taken, or was shown again at a cost of 0. `image` is a file name without a directory."""

    room: Room
    robot: int
    image: str
    cost: Number
    seat: str = ""


class TreasureIdentified(_Event, frozen=True, tag="identified"):
    """The participant named the treasure in a room. The points are negative for a wrong name.

    Attributes:
        room: the room, or None if a program of 2016 sent only the points.
        robot: index of the robot in the room, or None if the game has no robot there.
        name: the participant's name for the treasure, or None if a program of 2016 sent only the points.
        points: points that are added to the score.
        cost: energy that the robot paid.
    """

    room: Room | None
    robot: int | None
    name: str | None
    points: int
    cost: Number
    seat: str = ""


class TreasureLeft(_Event, frozen=True, tag="left"):
    """The participant left the treasure in a room undecided."""

    room: Room
    seat: str = ""


class TreasureTakenUp(_Event, frozen=True, tag="taken-up"):
    """The participant returned to the treasure in a room that they had left undecided."""

    room: Room
    seat: str = ""


class GameEnded(_Event, frozen=True, tag="ended"):
    """The game ended with this score."""

    reason: EndReason
    score: int
    seat: str = ""


class DialogueOpened(_Event, frozen=True, omit_defaults=True, tag="talk"):
    """A robot and the participant started a dialogue about a decision.

    Only journals have this event. It does not change the state of the game.

    Attributes:
        dialogue: number of the dialogue in this game, from 1.
        scenario: kind of the decision.
        robot: index of the robot, from 0.
        room: topic of the dialogue.
        at: simulated time, s.
        opener: the side that opens the dialogue.
        advised: the room that the robot's planner chose, or None.
        reason: reason for a suggestion, as a part of a sentence.
        confidence: stated confidence in a suggestion, 0 to 1, or None.
        name: proposed name of the treasure in the room; empty if there is none.
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
    seat: str = ""


class DialogueSaid(_Event, frozen=True, tag="said"):
    """A robot or the participant made a move in a dialogue. Only journals have this event.

    Attributes:
        dialogue: number of the dialogue. If no dialogue with this number was opened, the sentence is an announcement.
        turn: index of the move in the dialogue, from 0.
        speaker: side of the speaker.
        author: author of the move: robot, person or wizard.
        move: the move, in the notation of `move_text`.
        text: the sentence.
    """

    dialogue: int
    turn: int
    speaker: str
    author: str
    move: str
    text: str
    seat: str = ""


class PersonSaid(_Event, frozen=True, tag="person-said"):
    """A participant sent a text to the other participants. Only journals have this event.

    Attributes:
        line: number of the text in this game, from 1.
        seat: seat of the author.
        to: seat of the addressee; empty if the text is for all.
        text: the text.
        at: simulated time at which it was sent, s.
        typing: time from the first key to sending, s.
        number: number that the author's program gave the text; see `SayToPeople`.
    """

    line: int
    seat: str
    to: str
    text: str
    at: Number
    typing: Number
    number: int = 0


class PersonRead(_Event, frozen=True, tag="person-read"):
    """A participant's program showed texts of other participants. Only journals have this event.

    Attributes:
        line: number of the last text that was shown; all earlier texts for this seat were shown, too.
        seat: seat of the reader.
        at: simulated time, s.
    """

    line: int
    seat: str
    at: Number


class SeatTaken(_Event, frozen=True, tag="seat-taken"):
    """A seat is played from now on: a participant joined or came back, or a researcher took their place.

    Until the next event of this kind for the same seat, or until it is left, all acts of the seat are theirs. Only
    journals have this event.

    Attributes:
        seat: name of the seat.
        at: simulated time, s.
        by: who plays the seat.
    """

    seat: str
    at: Number
    by: PlayedBy = PlayedBy.PERSON


class SeatLeft(_Event, frozen=True, tag="seat-left"):
    """A seat is no longer played: all its programs were disconnected, or report that the participant is away.

    Only journals have this event.
    """

    seat: str
    at: Number


class DecisionKind(StrEnum):
    """Kind of a decision that several participants may have to agree on."""

    SEND = "send"
    NAME = "name"
    END = "end"


class DecisionProposed(_Event, frozen=True, tag="proposed"):
    """A participant proposed a decision on which several participants vote. Only journals have this event.

    Attributes:
        decision: number of the decision in this game, from 1.
        seat: seat of the participant, who thereby agrees.
        kind: kind of the decision.
        robot: index of the robot that is sent; None for other kinds.
        room: destination, or room of the treasure; None for the end of the game.
        name: proposed name of the treasure; empty for other kinds.
        needs: number of participants who must agree.
        at: simulated time, s.
    """

    decision: int
    seat: str
    kind: DecisionKind
    robot: int | None
    room: Room | None
    name: str
    needs: int
    at: Number


class VoteCast(_Event, frozen=True, tag="voted"):
    """A participant voted on a proposed decision. Only journals have this event.

    Attributes:
        decision: number of the decision.
        seat: seat of the participant.
        agrees: True if the participant agrees.
        reason: their reason; empty if they gave none.
        at: simulated time, s.
    """

    decision: int
    seat: str
    agrees: bool
    reason: str
    at: Number


class DecisionOutcome(StrEnum):
    """Outcome of a vote. A decision is void if it became impossible before all votes were cast."""

    CARRIED = "carried"
    REJECTED = "rejected"
    EXPIRED = "expired"
    VOID = "void"


class DecisionSettled(_Event, frozen=True, tag="settled"):
    """The vote on a decision ended. Only journals have this event.

    Attributes:
        decision: number of the decision.
        outcome: outcome of the vote.
        at: simulated time, s.
    """

    decision: int
    outcome: DecisionOutcome
    at: Number


class ObjectionReason(StrEnum):
    """Reason for an objection to a robot's move, to a picture, or to the name of a treasure."""

    TOO_FAR = "too-far"
    OTHER_ROOM = "other-room"
    OTHER_ROBOT = "other-robot"
    NOT_NEEDED = "not-needed"
    SAVE_ENERGY = "save-energy"
    WRONG_NAME = "wrong-name"
    NOT_SURE = "not-sure"


class ObjectionRaised(_Event, frozen=True, tag="objected"):
    """A participant objected in a dialogue of another seat with a robot. Only journals have this event.

    Attributes:
        dialogue: number of the dialogue.
        seat: seat of the participant who objects.
        robot: index of the robot in the dialogue.
        room: room in the dialogue.
        reason: reason of the objection.
        text: the participant's own words about it; may be empty.
        after: number of sentences in the dialogue before the objection.
        at: simulated time, s.
    """

    dialogue: int
    seat: str
    robot: int
    room: Room
    reason: ObjectionReason
    text: str
    after: int
    at: Number


class KeyUsed(_Event, frozen=True, tag="key"):
    """A client used a key to join or to send a request. Only journals have this event.

    Attributes:
        key: name of the key.
        did: description of the use, for people.
        run: unique name of this game. A participant's key is valid for only one game.
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

TeamEntry = (
    SeatTaken | SeatLeft | PersonSaid | PersonRead | DecisionProposed | VoteCast | DecisionSettled | ObjectionRaised
)
"""Entries about the participants of a game with several seats: their presence, texts, votes and objections."""

JournalOnly = DialogueOpened | DialogueSaid | TeamEntry | KeyUsed
"""Entries of journals that do not change the state of a game."""

JournalEntry = Event | JournalOnly
"""Entries of a journal: events of the game, dialogues, texts and votes of participants, and uses of keys."""
