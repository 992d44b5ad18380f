"""The participant's view of the game, and the participant's requests to the keeper.

A view is an allow-list: each field is a copy of data that the game has revealed. A treasure's kind, picture or room is
included only after the rules reveal it. A view contains the complete state instead of changes. So a program that missed
some views has the present state after the next view.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Annotated, Literal

import msgspec
from msgspec import UNSET, UnsetType

from thbridge.hunt.events import Commander, Condition
from thbridge.hunt.properties import OF_2016, Properties, TreasureProperty
from thbridge.hunt.seats import Seat
from thbridge.hunt.treasures import name_in_words
from thbridge.roles.shared.team_notices import (
    DecisionView,
    MarkRead,
    ObjectionView,
    RaiseObjection,
    SayToPeople,
    SettledView,
    Vote,
)
from thbridge.text_protocol.wire.notice_format import COUNTED, Notice, NoticeValue, decode_notice, kind_of


@dataclass(frozen=True, slots=True)
class RobotView:
    """A robot in the game.

    Attributes:
        robot: index of the robot, from 0. For people, robots have numbers from 1.
        place: number of the robot's room, or 0 for the corridor. During a move, the start of the move.
        moving_to: destination of the move, or None at rest.
        energy: remaining energy.
        blocked: True if the robot has no energy and cannot act any more.
        condition: well, lost or silent. A silent robot cannot act until it responds again.
        commander: commander of the robot. If this is not the participant, they can neither send nor stop the robot.
        commander_name: name of the commanding ground station or seat, for people; otherwise empty.
        asked_back: True if the participant has recently asked the commander to give the robot back. Then they cannot
            ask again.
        costs: energy to each place from the robot's position, like a row of the view's costs. If empty, use the row of
            `place`.
    """

    robot: int
    place: int
    moving_to: int | None
    energy: float
    blocked: bool
    condition: Condition
    commander: Commander = Commander.PARTICIPANT
    commander_name: str = ""
    asked_back: bool = False
    costs: tuple[float | None, ...] = ()

    @property
    def has_other_commander(self) -> bool:
        """True if the participant does not command the robot."""
        return self.commander is not Commander.PARTICIPANT


@dataclass(frozen=True, slots=True)
class IdentificationVerdict:
    """Result of naming a treasure: the name and the points."""

    name: str
    points: int


@dataclass(frozen=True, slots=True)
class RoomView:
    """A room, with the team's knowledge about it.

    Attributes:
        room: number of the room, from 1.
        state: state of the room. "reserved" means that a robot is driving to it.
        robot: the robot that is driving to the room, is in the room, or found the undecided treasure there.
        sensed: properties of the treasure that robots sensed, by name. None before the first sensing.
        `told`: properties of the treasure that the participant entered.
        picture: file name of the picture, or None before it was taken.
        verdict: result of naming the treasure, or None before it is named.
        left: True if the participant has left the treasure undecided.
    """

    room: int
    state: Literal["unvisited", "reserved", "visited"]
    robot: int | None
    sensed: Properties | None
    picture: str | None
    verdict: IdentificationVerdict | None
    left: bool
    told: Properties = field(default_factory=dict)

    @property
    def found(self) -> bool:
        """True if a robot has sensed the treasure."""
        return self.sensed is not None

    @property
    def known(self) -> Properties:
        """Known properties of the treasure, sensed and entered."""
        return {**(self.sensed or {}), **self.told}

    @property
    def undecided(self) -> bool:
        """True if the room is visited and its treasure is neither named nor left."""
        return self.state == "visited" and self.verdict is None and not self.left


@dataclass(frozen=True, slots=True)
class RoomDebrief:
    """Treasure of a room, shown after the game: its name, and the points for the right name."""

    room: int
    name: str
    points: int


@dataclass(frozen=True, slots=True)
class Debrief:
    """Debrief of participants after the game.

    Attributes:
        rooms: the treasure of each room. Empty if the study does not show the treasures or the keeper does not know
            them.
        best: best possible score with the same energy, or None if it is unknown or not shown.
        farewell: thanks, and the next steps. If empty, the window uses its own text.
    """

    rooms: tuple[RoomDebrief, ...] = ()
    best: int | None = None
    farewell: str = ""


DialogueMatter = Literal["select-room", "take-picture", "take-treasure"]
"""Matter of a dialogue, as in the three scenarios of the 2016 study."""


@dataclass(frozen=True, slots=True)
class DialogueView:
    """An open dialogue.

    Attributes:
        dialogue: number of the dialogue.
        turn: number of previous moves. An answer must contain this number, so that no answer counts twice.
        robot: index of the robot, from 0.
        matter: matter of the dialogue.
        room: number of the room in the dialogue.
        said: all previous sentences, oldest first.
        choices: possible answers of the participant, most agreeable first. Empty during the robot's turn.
        acts: move of each choice, by its name in recordings, for programs. Empty from servers that do not send acts.
        speakers: speaker of each sentence. Empty from servers that do not send speakers.
        suggested: True if the robot suggested the room. Then a request for its advice has no effect.
    """

    dialogue: int
    turn: int
    robot: int
    matter: DialogueMatter
    room: int
    said: tuple[str, ...]
    choices: tuple[str, ...]
    acts: tuple[str, ...] = ()
    speakers: tuple[Literal["robot", "person"], ...] = ()
    suggested: bool = False


@dataclass(frozen=True, slots=True)
class LastWords:
    """An ended dialogue.

    It is shown until the next dialogue with this robot, or until the agreement is carried out.

    Attributes:
        dialogue: number of the dialogue.
        robot: index of the robot, from 0.
        matter: matter of the dialogue.
        room: number of the agreed room. Without an agreement, number of the room in the dialogue.
        said: all sentences, oldest first. Empty if there were no new sentences.
        speakers: speaker of each sentence.
        agreed: True if the decision is carried out, as the side with the last word has decided.
        is_told: True if a sentence of the robot states the next event.
    """

    dialogue: int
    robot: int
    matter: DialogueMatter
    room: int
    said: tuple[str, ...]
    speakers: tuple[Literal["robot", "person"], ...]
    agreed: bool
    is_told: bool = False


@dataclass(frozen=True, slots=True)
class Consent:
    """Agreement between the participant and a robot. The participant may now carry out the agreement.

    Attributes:
        robot: index of the robot, from 0.
        matter: matter of the agreement.
        room: number of the room in the agreement.
        name: agreed name of the treasure. Empty if any name is possible.
    """

    robot: int
    matter: DialogueMatter
    room: int
    name: str = ""


@dataclass(frozen=True, slots=True)
class RefusalView:
    """The participant's last refused request.

    Attributes:
        number: number of the refusal, from 1. It distinguishes equal refusals.
        wish: kind of the request.
        reason: code of the reason, for programs.
        sentence: reason for people.
    """

    number: int
    wish: str
    reason: str
    sentence: str


@dataclass(frozen=True, slots=True)
class Teammate:
    """Another seat of the game.

    Attributes:
        seat: the seat, with its rights.
        present: True if its participant is connected, and not away from their front end.
    """

    seat: Seat
    present: bool


@dataclass(frozen=True, slots=True)
class TeamView:
    """Seats of a game, as a participant sees them.

    Attributes:
        own: the participant's own seat.
        teammates: the other seats.
        asked_for: robots of this seat that another seat asks for: index of the robot, and the name of that seat.
        partners: dialogues of other seats: number of the dialogue, and the name of that seat.
        decisions: open votes.
        talk_is_open: True if participants may send texts to each other now.
        read: number of the last text that a program of this seat has shown; 0 before the first.
        settled: the last votes that have ended, oldest first.
        room_names: names of the rooms, in order, for a seat that does not see the map; otherwise empty.
        objections: objections in the dialogues of the view, and in those with last words, oldest first; unset if there
            are none.
    """

    own: Seat
    teammates: tuple[Teammate, ...]
    asked_for: tuple[tuple[int, str], ...] = ()
    partners: tuple[tuple[int, str], ...] = ()
    decisions: tuple[DecisionView, ...] = ()
    talk_is_open: bool = False
    read: int = 0
    settled: tuple[SettledView, ...] = ()
    room_names: tuple[str, ...] = ()
    objections: tuple[ObjectionView, ...] | UnsetType = UNSET


class View(NoticeValue, frozen=True, tag="View"):
    """All game data that the participant may see.

    Attributes:
        game: number of the game, from 1; 0 before the first game.
        ready: True if the robots are connected. If False, every request is refused.
        costs: energy of each move, [from][to], by room number, with 0 for the corridor. None if there is no move.
        robots: robots in the order of the team.
        rooms: rooms in order.
        dialogues: open dialogues.
        consents: agreements that are not carried out yet.
        score: present score.
        over: reason for the end of the game, or None during the game.
        picture_cost: energy of taking a picture.
        identify_cost: energy of naming a treasure.
        refusal: the last refused request, or None.
        names: possible names of treasures, in alphabetical order. Empty before the first treasure was sensed.
        called: words for these names in the participant's language; see `word_for`.
        consent: text that the participant must agree to first. None if they have agreed, or if no consent is needed.
        thinking: robots that were asked for advice and have not answered yet.
        debrief: data that are shown after the game, or None.
        worth: points for each name in `names`, or None if treasures with this name have different points. Empty if the
            study does not show points.
        wrong_share: points that a wrong name costs, as a share of the treasure's points. None if the study does not
            show this share.
        sound: True if the window may play sounds.
        properties: properties of treasures, with words for their values in the participant's language.
        last_words: last sentences of dialogues with arguing robots.
        has_last_word: the side with the last word in dialogues with arguing robots, otherwise None.
        by_position: True if the price of a move from outside the rooms depends on the robot's position. Then the row of
            the corridor is not used.
        team: the seats of the game; None if there is only one participant. In the view of a seat, the robots of other
            seats have the commander `TEAMMATE`. For a seat that does not see the energy, each energy is 1, or 0 if it
            is used up, and each cost is 0. For a seat that does not see the score, all points are 0.
    """

    OMITTED = frozenset({"team"})

    game: int
    ready: bool
    costs: tuple[tuple[float | None, ...], ...]
    robots: tuple[RobotView, ...]
    rooms: tuple[RoomView, ...]
    dialogues: tuple[DialogueView, ...]
    consents: tuple[Consent, ...]
    score: int
    over: str | None
    picture_cost: float
    identify_cost: float
    refusal: RefusalView | None
    names: tuple[str, ...] = ()
    consent: str | None = None
    thinking: tuple[int, ...] = ()
    by_position: bool = False
    debrief: Debrief | None = None
    worth: tuple[int | None, ...] = ()
    wrong_share: float | None = None
    sound: bool = True
    properties: tuple[TreasureProperty, ...] = OF_2016
    last_words: tuple[LastWords, ...] = ()
    has_last_word: Literal["both", "participant", "robot"] | None = None
    called: Mapping[str, str] = msgspec.field(default_factory=dict)
    team: TeamView | None = None

    def word_for(self, name: str) -> str:
        """Return the words for a treasure's name that the participant sees."""
        return self.called.get(name) or name_in_words(name)

    def room(self, number: int) -> RoomView:
        """Return the room with this number, from 1."""
        return self.rooms[number - 1]

    def costs_from(self, robot: RobotView) -> tuple[float | None, ...]:
        """Return the energy of a robot's moves, by room number. During a move, return the energy from its start."""
        return robot.costs or self.costs[robot.place]

    def costs_when_stopped(self) -> tuple[float | None, ...] | None:
        """Return the energy of a robot's next moves if the robot is stopped during its present move.

        Return None if this energy depends on the robot's position.
        """
        return None if self.by_position else self.costs[0]

    @classmethod
    def of_notice(cls, notice: Notice) -> "View | None":
        """Return the view in a notice. Return None if there is no valid view, for example from another release."""
        view = decode_notice(notice, cls)
        return view if view is not None and view.is_consistent() else None

    def is_consistent(self) -> bool:
        """Return True if the view has all robots and rooms that it mentions, and no cost is negative."""
        places, robots = range(len(self.rooms) + 1), range(len(self.robots))
        rooms = places[1:]
        matters: list[DialogueView | Consent | LastWords] = [*self.dialogues, *self.consents, *self.last_words]
        return (
            len(rooms) > 0
            and [room.room for room in self.rooms] == list(rooms)
            and [robot.robot for robot in self.robots] == list(robots)
            and len(self.costs) == len(places)
            and all(len(row) == len(places) for row in self.costs)
            and all(len(robot.costs) in (0, len(places)) for robot in self.robots)
            and all(
                cost is None or cost >= 0.0
                for row in (*self.costs, *(robot.costs for robot in self.robots))
                for cost in row
            )
            and min(self.picture_cost, self.identify_cost) >= 0.0
            and all(robot.place in places for robot in self.robots)
            and all(robot.moving_to is None or robot.moving_to in rooms for robot in self.robots)
            and all(room.robot is None or room.robot in robots for room in self.rooms)
            and all(robot in robots for robot in self.thinking)
            and all(item.robot in robots and item.room in rooms for item in matters)
            and all(dialogue.dialogue in COUNTED for dialogue in self.dialogues)
            and all(dialogue.said or not dialogue.choices for dialogue in self.dialogues)
            and all(len(dialogue.acts) in (0, len(dialogue.choices)) for dialogue in self.dialogues)
            and all(len(dialogue.speakers) in (0, len(dialogue.said)) for dialogue in self.dialogues)
            and all(len(words.speakers) == len(words.said) for words in self.last_words)
        )


def objections_of(view: View) -> tuple[ObjectionView, ...]:
    """Return the objections in the dialogues of a view, oldest first."""
    return (None if view.team is None else view.team.objections) or ()


class SelectRoom(NoticeValue, frozen=True, tag="Select"):
    """Ask a robot to drive to this room. This opens a dialogue."""

    robot: int
    room: int


class RequestSuggestion(NoticeValue, frozen=True, tag="Unsure"):
    """Ask a robot to suggest a room ("don't know")."""

    robot: int


class AnswerDialogue(NoticeValue, frozen=True, tag="Answer"):
    """Choose an answer (number from 0) at this turn of a dialogue."""

    dialogue: int
    turn: int
    choice: int


class SendRobot(NoticeValue, frozen=True, tag="SendRobot"):
    """Send a robot to the agreed room."""

    robot: int
    room: int


class StopRobot(NoticeValue, frozen=True, tag="CallBack"):
    """Stop a robot that is driving to a room."""

    robot: int


class RequestHandback(NoticeValue, frozen=True, tag="AskBack"):
    """Ask the commander of a robot to give the robot back. The commander may be another seat."""

    robot: int


class HandOver(NoticeValue, frozen=True, tag="HandOver"):
    """Hand over the command of a robot to another seat, whose name is given."""

    robot: int
    seat: str


class SenseTreasure(NoticeValue, frozen=True, tag="Sense"):
    """Sense the treasure in a room that a robot reached."""

    room: int


class MeasureProperty(NoticeValue, frozen=True, tag="Measure"):
    """Let the robot in a room sense a further property of the treasure. This costs energy."""

    room: int
    property: str


class TellProperty(NoticeValue, frozen=True, tag="Tell"):
    """Enter a property of the treasure in a room. Only people can recognize this property."""

    room: int
    property: str
    value: str


class OpenDialogue(NoticeValue, frozen=True, tag="Discuss"):
    """Open a dialogue about taking a picture or about the name of a treasure.

    Attributes:
        robot: index of the robot, from 0.
        matter: matter of the dialogue.
        room: room of the treasure.
        name: proposed name of the treasure. If empty, the participant asks the robot for the name. If None, the
            participant proposes no name.
    """

    robot: int
    matter: Literal["take-picture", "take-treasure"]
    room: int
    name: str | None = None


class TakePicture(NoticeValue, frozen=True, tag="TakePicture"):
    """Take a picture of the treasure in a room."""

    room: int


class IdentifyTreasure(NoticeValue, frozen=True, tag="Identify"):
    """Name the treasure in a room."""

    room: int
    name: str


class LeaveTreasure(NoticeValue, frozen=True, tag="Leave"):
    """Leave the treasure in a room undecided."""

    room: int


class TakeUpTreasure(NoticeValue, frozen=True, tag="TakeUp"):
    """Return to a treasure that was left. A robot must be in the room."""

    room: int


class EndGame(NoticeValue, frozen=True, tag="GiveUp"):
    """End this game early."""

    game: int


class PlayAgain(NoticeValue, frozen=True, tag="PlayAgain"):
    """Begin a new game after the end of this game."""

    game: int


class GiveConsent(NoticeValue, frozen=True, omit_defaults=True, tag="Agree"):
    """Agree to take part in the study, after the text in `View.consent`.

    Attributes:
        at: time at which the participant agreed, ISO 8601 in UTC; empty if the program has no clock.
    """

    at: Annotated[str, msgspec.Meta(max_length=40)] = ""


class DeclineConsent(NoticeValue, frozen=True, tag="Decline"):
    """Decline to take part in the study. The participant's program then leaves."""


ParticipantRequest = (
    GiveConsent
    | SelectRoom
    | RequestSuggestion
    | AnswerDialogue
    | SendRobot
    | StopRobot
    | RequestHandback
    | HandOver
    | SenseTreasure
    | OpenDialogue
    | TakePicture
    | IdentifyTreasure
    | LeaveTreasure
    | TakeUpTreasure
    | EndGame
    | PlayAgain
    | MeasureProperty
    | TellProperty
    | SayToPeople
    | MarkRead
    | Vote
    | RaiseObjection
)


def refusal_wishes(request: ParticipantRequest) -> tuple[str, ...]:
    """Return the possible values of `RefusalView.wish` for this request. For a dialogue, this may be its matter."""
    match request:
        case SelectRoom() | RequestSuggestion():
            return ("select-room", kind_of(type(request)))
        case OpenDialogue(matter=matter):
            return (matter, kind_of(OpenDialogue))
        case _:
            return (kind_of(type(request)),)
