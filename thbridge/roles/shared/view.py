"""The participant's view of the game, and the participant's requests: everything that keeper and participant exchange.

A view is an allow-list. Each field is copied explicitly from what the game has revealed. A treasure's kind, picture or
room is included only once the rules reveal it. A view contains the state and not a change, so a program that missed
some views is up to date with the next one.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Annotated, Literal

import msgspec

from thbridge.hunt.events import Commander, Condition
from thbridge.hunt.properties import OF_2016, Properties, TreasureProperty
from thbridge.hunt.treasures import name_in_words
from thbridge.text_protocol.wire.notice import COUNTED, Notice, NoticeValue, decode_notice, kind_of


@dataclass(frozen=True, slots=True)
class RobotView:
    """One robot in the game.

    Attributes:
        robot: index in the team, from 0; people count from 1.
        place: room in which it stands, from 1, or 0 for the corridor; while it moves, the room where it started.
        moving_to: room to which it drives; None at rest.
        energy: energy left.
        blocked: True if it has no energy left and can do nothing more.
        condition: well, lost or silent; a silent robot cannot do anything until it responds again.
        commander: commander of the robot. Unless it is the participant, they can neither send nor stop the robot.
        commander_name: name of the ground station that commands it, for people; otherwise empty.
        asked_back: True if the participant has recently asked for it back; until it is False they cannot ask again.
        costs: energy to each place from where it stands, like a row of the view's costs; if empty, the row of `place`.
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
        """True when it is not commanded by the participant."""
        return self.commander is not Commander.PARTICIPANT


@dataclass(frozen=True, slots=True)
class IdentificationVerdict:
    """Result of an identification."""

    name: str
    points: int


@dataclass(frozen=True, slots=True)
class RoomView:
    """One room, with the team's knowledge about it.

    Attributes:
        room: its number, from 1.
        state: "reserved" while a robot drives to it.
        robot: the robot that drives to it, stands there, or found the undecided treasure there.
        sensed: properties of its treasure that robots sensed, by name; None before that.
        told: properties that the participant entered.
        picture: file name of its picture, once taken.
        verdict: result of its identification, once identified.
        left: True when the treasure was left and not taken up again.
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
        """True when a robot has sensed its treasure."""
        return self.sensed is not None

    @property
    def known(self) -> Properties:
        """Known properties of its treasure, both sensed and entered."""
        return {**(self.sensed or {}), **self.told}

    @property
    def undecided(self) -> bool:
        """True when the room is visited and its treasure is neither identified nor left."""
        return self.state == "visited" and self.verdict is None and not self.left


@dataclass(frozen=True, slots=True)
class RoomDebrief:
    """Treasure of a room, shown after the game: its name, and the points for naming it."""

    room: int
    name: str
    points: int


@dataclass(frozen=True, slots=True)
class Debrief:
    """Debrief of participants after the game.

    Attributes:
        rooms: the treasure of each room; empty if the study does not show it, or the keeper does not know it.
        best: most points that could have been won with the same energy; None if not shown or unknown.
        farewell: thanks, and the next steps; if empty, the window's own words are used.
    """

    rooms: tuple[RoomDebrief, ...] = ()
    best: int | None = None
    farewell: str = ""


DialogueMatter = Literal["select-room", "take-picture", "take-treasure"]
"""Matter of a dialogue: one of the three scenarios of the 2016 study."""


@dataclass(frozen=True, slots=True)
class DialogueView:
    """A dialogue that waits for the participant.

    Attributes:
        dialogue: its number.
        turn: number of moves so far. An answer must contain this number, so that no answer counts twice.
        robot: index of the robot, from 0.
        matter: matter of the dialogue.
        room: number of the room it is about.
        said: all sentences so far, oldest first; the robot waits for an answer to the last.
        choices: possible answers of the participant, most agreeable first; empty while it is the robot's turn.
        acts: move of each choice, by its name in recordings, for programs; empty from servers that do not send it.
        speakers: speaker of each sentence; empty from servers that do not send it.
        suggested: True if the robot has suggested the room. Asking for its advice again then changes nothing.
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
    """A dialogue that has ended.

    It is shown until the participant talks with its robot again, or the agreement is carried out.

    Attributes:
        dialogue: its number.
        robot: index of the robot, from 0.
        matter: matter of the dialogue.
        room: number of the room that was agreed upon; without an agreement, of the room it was about.
        said: all sentences, oldest first; empty if everything had been said before.
        speakers: speaker of each sentence.
        agreed: True when the matter is carried out, by decision of the side that has the last word.
        is_told: True when the robot itself has said what happens next.
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
    """Agreement of participant and robot, on which the participant may now act.

    Attributes:
        robot: index of the robot, from 0.
        matter: matter that they agreed on.
        room: number of the room it is about.
        name: name of the treasure, if they agreed on one; empty for any name.
    """

    robot: int
    matter: DialogueMatter
    room: int
    name: str = ""


@dataclass(frozen=True, slots=True)
class RefusalView:
    """The participant's last request that was refused.

    Attributes:
        number: count of refusals; it distinguishes two equal refusals.
        wish: kind of the request.
        reason: a code for programs.
        sentence: the reason, for people.
    """

    number: int
    wish: str
    reason: str
    sentence: str


class View(NoticeValue, frozen=True, tag="View"):
    """The game as the participant may see it.

    Attributes:
        game: number of the game, from 1; 0 before the first begins.
        ready: True when the robots are connected; until then every request is refused.
        costs: energy of a move, [from][to], by room numbers, 0 for the corridor; None where there is no move.
        robots: in the team's order.
        rooms: room 1 first.
        dialogues: open dialogues.
        consents: agreements on which the participant has not acted yet.
        score: points so far.
        over: reason for the game's end; None while it continues.
        picture_cost: energy of taking a picture.
        identify_cost: energy of naming a treasure.
        refusal: the last refused request.
        names: possible names of treasures, in alphabetical order; empty until the first treasure was sensed.
        called: words for the shown names, in the participant's language; see `word_for`.
        consent: text to which the participant has to agree first; None when they have agreed, or need not agree.
        thinking: robots that were asked where to go and have not answered yet.
        debrief: shown once the game is over.
        worth: points of the treasure of each name in `names`, None if treasures of that name differ; empty if the study
            does not show points.
        wrong_share: share of a treasure's points that a wrong name costs; None if the study does not show it.
        sound: True if the window may play sounds.
        properties: properties of treasures, with words for their values in the participant's language.
        last_words: last words of robots that argue.
        has_last_word: the side that decides in the end, if robots argue; otherwise None.
        by_position: True if the robot's position determines the price of moves that start outside rooms. Then the row
            of the corridor applies nowhere.
    """

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

    def word_for(self, name: str) -> str:
        """Return a treasure's name in the words that are shown to the participant."""
        return self.called.get(name) or name_in_words(name)

    def room(self, number: int) -> RoomView:
        """Return the room with this number, from 1."""
        return self.rooms[number - 1]

    def costs_from(self, robot: RobotView) -> tuple[float | None, ...]:
        """Return the energy of a robot's moves, by room number; while it moves, from where it started."""
        return robot.costs or self.costs[robot.place]

    def costs_when_stopped(self) -> tuple[float | None, ...] | None:
        """Return the energy of moves of a robot that is stopped while moving; None if it depends on the robot's
        position."""
        return None if self.by_position else self.costs[0]

    @classmethod
    def of_notice(cls, notice: Notice) -> "View | None":
        """Return the view in a notice; None if there is no view, or a malformed one, for example from another
        release."""
        view = decode_notice(notice, cls)
        return view if view is not None and view.is_consistent() else None

    def is_consistent(self) -> bool:
        """Return True when every robot and room named in the view is also part of it, and no cost is negative."""
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


class SelectRoom(NoticeValue, frozen=True, tag="Select"):
    """Ask a robot to go to this room; this opens a dialogue."""

    robot: int
    room: int


class RequestSuggestion(NoticeValue, frozen=True, tag="Unsure"):
    """Ask a robot to suggest a room ("don't know")."""

    robot: int


class AnswerDialogue(NoticeValue, frozen=True, tag="Answer"):
    """Make a choice, counted from 0, at this turn of a dialogue."""

    dialogue: int
    turn: int
    choice: int


class SendRobot(NoticeValue, frozen=True, tag="SendRobot"):
    """Send a robot to the agreed room."""

    robot: int
    room: int


class StopRobot(NoticeValue, frozen=True, tag="CallBack"):
    """Stop a robot that drives to a room."""

    robot: int


class RequestHandback(NoticeValue, frozen=True, tag="AskBack"):
    """Ask the commander of a robot to give it back."""

    robot: int


class SenseTreasure(NoticeValue, frozen=True, tag="Sense"):
    """Sense the treasure in a room that a robot reached."""

    room: int


class MeasureProperty(NoticeValue, frozen=True, tag="Measure"):
    """Let the robot in a room sense another property of the treasure there, at a cost in energy."""

    room: int
    property: str


class TellProperty(NoticeValue, frozen=True, tag="Tell"):
    """Enter a property of the treasure in a room that only people can recognize."""

    room: int
    property: str
    value: str


class OpenDialogue(NoticeValue, frozen=True, tag="Discuss"):
    """Open a dialogue about taking a picture, or the treasure.

    Attributes:
        robot: index of the robot, from 0.
        matter: matter of the dialogue.
        room: where the treasure is.
        name: proposed name of the treasure. If empty, the participant asks the robot what it is. If None, the
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
    """Take up a treasure that was left, while its robot still stands there."""

    room: int


class EndGame(NoticeValue, frozen=True, tag="GiveUp"):
    """End this game although robots could still do something."""

    game: int


class PlayAgain(NoticeValue, frozen=True, tag="PlayAgain"):
    """Begin a new game once this one is over."""

    game: int


class GiveConsent(NoticeValue, frozen=True, omit_defaults=True, tag="Agree"):
    """Agree to take part in the study, as `View.consent` asks.

    Attributes:
        at: time at which the participant agreed, ISO 8601 in UTC; empty if the program has no clock.
    """

    at: Annotated[str, msgspec.Meta(max_length=40)] = ""


class DeclineConsent(NoticeValue, frozen=True, tag="Decline"):
    """Do not agree to take part in the study. The participant's program then leaves."""


ParticipantRequest = (
    GiveConsent
    | SelectRoom
    | RequestSuggestion
    | AnswerDialogue
    | SendRobot
    | StopRobot
    | RequestHandback
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
)


def refusal_wishes(request: ParticipantRequest) -> tuple[str, ...]:
    """Return the values of `RefusalView.wish` for this request; the refusal of a dialogue may have its matter there."""
    match request:
        case SelectRoom() | RequestSuggestion():
            return ("select-room", kind_of(type(request)))
        case OpenDialogue(matter=matter):
            return (matter, kind_of(OpenDialogue))
        case _:
            return (kind_of(type(request)),)
