"""What a participant may know, and may wish for: all that passes between the keeper and a participant's program.

A view is an allow-list. Each field is copied on purpose from what the game has revealed; a treasure's kind, picture or
room is in here only from the moment the rules give it away. A view says how things are, never what changed, so a
program that missed some is up to date with the next.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal

import msgspec

from thbridge.hunt.events import Commander, Condition
from thbridge.hunt.rules import commander_name
from thbridge.wire.notice import JsonValue


@dataclass(frozen=True, slots=True)
class RobotView:
    """One robot, as the game sees it.

    Attributes:
        robot: its index in the team; people say one more.
        place: the room it stands in as people count, 0 the corridor; where it set out from while it moves.
        moving_to: the room it is under way to.
        energy: what it has left.
        blocked: it has no energy left and does nothing any more.
        condition: whether it answers, and knows where it is; a silent one does nothing until it answers again.
        commander: who commands it; while it is not the participant, it can be neither sent nor called back.
        commander_name: which ground station, for people; else empty.
        asked_back: the participant has asked for it back just now, and can ask again once this is false.
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

    @property
    def other_commander(self) -> str:
        """Who else than the participant commands it, within a sentence; empty when nobody does."""
        if self.commander is Commander.PARTICIPANT:
            return ""
        return commander_name(self.commander, self.commander_name)


@dataclass(frozen=True, slots=True)
class IdentificationVerdict:
    """How an identification ended."""

    name: str
    points: int


@dataclass(frozen=True, slots=True)
class RoomView:
    """One room and what the team has found out about it.

    Attributes:
        room: its number as people count, from 1.
        state: "reserved" while a robot is under way to it.
        robot: the robot that is under way to it, stands there, or found what is undecided there.
        colour: of the treasure, once sensed.
        footprint: of the treasure, once sensed.
        picture: the file name of its picture, once taken.
        verdict: once identified.
        left: this treasure was given up.
    """

    room: int
    state: Literal["unvisited", "reserved", "visited"]
    robot: int | None
    colour: str | None
    footprint: str | None
    picture: str | None
    verdict: IdentificationVerdict | None
    left: bool

    @property
    def sensed(self) -> bool:
        """Whether colour and footprint are known."""
        return self.colour is not None

    @property
    def undecided(self) -> bool:
        """Whether a treasure waits here for the participant: visited, and neither identified nor given up."""
        return self.state == "visited" and self.verdict is None and not self.left


DialogueMatter = Literal["select-room", "take-picture", "take-treasure"]
"""What participant and robot talk about: the three scenarios of the 2016 study."""


@dataclass(frozen=True, slots=True)
class DialogueView:
    """A dialogue that waits for the participant.

    Attributes:
        dialogue: its number.
        turn: how many moves were made in it; an answer must name it, so that none is counted twice.
        robot: who talks.
        matter: what about.
        room: the room it is about, as people count.
        said: everything said so far, oldest first; the last is what the robot waits to have answered.
        choices: what the participant may answer, most agreeable first; none while the robot thinks.
    """

    dialogue: int
    turn: int
    robot: int
    matter: DialogueMatter
    room: int
    said: tuple[str, ...]
    choices: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class Consent:
    """What participant and robot agreed on and the participant may now order."""

    robot: int
    matter: DialogueMatter
    room: int


@dataclass(frozen=True, slots=True)
class RefusalView:
    """The last wish of the participant that was not granted, and why.

    Attributes:
        number: counts the refusals, so that the same one twice can be told from one that lasts.
        wish: its kind.
        reason: a code for programs.
        sentence: for people.
    """

    number: int
    wish: str
    reason: str
    sentence: str


@dataclass(frozen=True, slots=True)
class View:
    """The game as the participant may see it.

    Attributes:
        game: counts the games of this keeper, from 1; 0 before the first begins.
        ready: the robots are there; before, there is nothing to do but wait.
        costs: energy of a move, [from][to], as people count rooms; None where there is no move.
        robots: in the team's order.
        rooms: room 1 first.
        dialogues: those that wait for an answer.
        consents: agreements that are not yet acted upon.
        score: so far.
        over: why the game ended; None while it goes on.
        picture_cost: energy of taking a picture.
        identify_cost: energy of naming a treasure.
        refusal: the last wish refused.
        names: what a treasure may be called, in alphabetical order; empty until one was sensed.
        consent: what the participant has to agree to before anything else; None when that is done, or not asked.
        thinking: robots that were asked where to go and have not answered yet.
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

    def room(self, number: int) -> RoomView:
        """The room people call `number`, from 1."""
        return self.rooms[number - 1]

    def to_json(self) -> Mapping[str, JsonValue]:
        """Plain values for a notice."""
        fields: Mapping[str, JsonValue] = msgspec.to_builtins(self)
        return fields

    @classmethod
    def from_json(cls, fields: Mapping[str, JsonValue]) -> "View | None":
        """The view in a notice, or None when it is not one (a peer of another version, or noise)."""
        try:
            view = msgspec.convert(fields, cls)
        except msgspec.ValidationError:
            return None
        return view if view._is_consistent() else None

    def _is_consistent(self) -> bool:
        """Whether every number in it names something that is in it."""
        places, robots = range(len(self.rooms) + 1), range(len(self.robots))
        rooms = places[1:]
        talks: list[DialogueView | Consent] = [*self.dialogues, *self.consents]
        return (
            [room.room for room in self.rooms] == list(rooms)
            and [robot.robot for robot in self.robots] == list(robots)
            and len(self.costs) == len(places)
            and all(len(row) == len(places) for row in self.costs)
            and all(robot.place in places for robot in self.robots)
            and all(robot.moving_to is None or robot.moving_to in rooms for robot in self.robots)
            and all(room.robot is None or room.robot in robots for room in self.rooms)
            and all(robot in robots for robot in self.thinking)
            and all(talk.robot in robots and talk.room in rooms for talk in talks)
            and all(dialogue.said or not dialogue.choices for dialogue in self.dialogues)
        )


@dataclass(frozen=True, slots=True)
class Select:
    """Ask a robot to go to this room."""

    robot: int
    room: int


@dataclass(frozen=True, slots=True)
class Unsure:
    """Don't know: ask a robot for its suggestion."""

    robot: int


@dataclass(frozen=True, slots=True)
class Answer:
    """Make a choice in a dialogue, counted from 0, as things stood at this turn of it."""

    dialogue: int
    turn: int
    choice: int


@dataclass(frozen=True, slots=True)
class SendRobot:
    """Send a robot where it was agreed to go."""

    robot: int
    room: int


@dataclass(frozen=True, slots=True)
class CallBack:
    """Stop a robot that is under way."""

    robot: int


@dataclass(frozen=True, slots=True)
class AskBack:
    """Ask whoever commands a robot to give it back."""

    robot: int


@dataclass(frozen=True, slots=True)
class Sense:
    """Ask what is in a room that a robot reached."""

    room: int


@dataclass(frozen=True, slots=True)
class Discuss:
    """Talk about taking a picture, or the treasure, before it is done."""

    robot: int
    matter: Literal["take-picture", "take-treasure"]
    room: int


@dataclass(frozen=True, slots=True)
class TakePicture:
    """Take a picture of what is in a room."""

    room: int


@dataclass(frozen=True, slots=True)
class Identify:
    """Say what the treasure in a room is."""

    room: int
    name: str


@dataclass(frozen=True, slots=True)
class Leave:
    """Give up the treasure in a room."""

    room: int


@dataclass(frozen=True, slots=True)
class GiveUp:
    """End this game although robots could still do something."""

    game: int


@dataclass(frozen=True, slots=True)
class PlayAgain:
    """Begin a new game once this one is over."""

    game: int


@dataclass(frozen=True, slots=True)
class Agree:
    """Agree to take part in the study, as `View.consent` asks."""


ParticipantRequest = (
    Agree
    | Select
    | Unsure
    | Answer
    | SendRobot
    | CallBack
    | AskBack
    | Sense
    | Discuss
    | TakePicture
    | Identify
    | Leave
    | GiveUp
    | PlayAgain
)
