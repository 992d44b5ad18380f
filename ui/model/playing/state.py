"""All that the participant's view model remembers; what is shown is worked out from it."""

import math
from dataclasses import dataclass, field

from thbridge.roles.notices import FloorPlan, RobotMotion
from thbridge.roles.view import DialogueView, Select, Unsure, View
from ui.model.playing.connection import ConnectionStatus
from ui.model.playing.history import GameHistory
from ui.model.playing.pending import PendingRequests
from ui.model.playing.pictures import Pictures
from ui.model.playing.popup_queue import DestinationItem, PopupItem, PopupQueue, TreasureItem


@dataclass(frozen=True, slots=True)
class Reroute:
    """A robot that is under way shall go to this room instead."""

    robot: int
    room: int


@dataclass(frozen=True, slots=True)
class LeaveUndecided:
    """A robot shall go on although what it found in this room is not decided."""

    wish: Select | Unsure
    room: int


@dataclass(frozen=True, slots=True)
class EndGameEarly:
    """The game shall end although robots could still do something."""


PendingStep = Reroute | LeaveUndecided | EndGameEarly
"""What the participant is asked about: is that meant?"""


@dataclass(slots=True)
class HuntMemory:
    """One game: what is forgotten when another begins.

    Attributes:
        view: as last heard.
        asked: wishes without an answer yet.
        requests: what the participant said to a robot to open the talk under way.
        reroutes: robots that are called back, and where they shall go then.
        picked: the name picked for what is in a room.
        named: the name that the participant means to be held to, while it is talked over.
        verdicts: rooms whose verdict is not closed yet, and the robot that stands there.
        popups: what is to be looked at.
        pictured: when the picture of a room was heard of.
        richest: the most energy that any robot had.
        gained: points of the last verdict.
        doubt: what the participant is asked about.
    """

    view: View
    pending: PendingRequests = field(default_factory=PendingRequests)
    opening_sentences: dict[int, str] = field(default_factory=dict)
    reroutes: dict[int, int] = field(default_factory=dict)
    picked_names: dict[int, str] = field(default_factory=dict)
    submitted_names: dict[int, str] = field(default_factory=dict)
    verdicts: dict[int, int] = field(default_factory=dict)
    popups: PopupQueue = field(default_factory=PopupQueue)
    picture_times: dict[int, float] = field(default_factory=dict)
    most_energy: float = 0.0
    last_points: int | None = None
    pending_step: PendingStep | None = None

    def ask_to_go(self, wish: Select | Unsure) -> str:
        """Ask a robot to go somewhere, and show the talk at once; what was said to it."""
        said = f"Go to room {wish.room}." if isinstance(wish, Select) else "I don't know where to go."
        self.pending.ask(wish, self.view)
        self.opening_sentences[wish.robot] = said
        self.popups.show(DestinationItem(wish.robot))
        return said

    def destination_dialogue(self, robot: int) -> DialogueView | None:
        """What a robot and the participant talk about, if it is where to go."""
        return next((d for d in self.view.dialogues if d.robot == robot and d.matter == "select-room"), None)

    def treasure_dialogue(self, find: TreasureItem) -> DialogueView | None:
        """What is talked about the treasure beside a robot."""
        return next(
            (
                dialogue
                for dialogue in self.view.dialogues
                if dialogue.matter != "select-room" and (dialogue.robot, dialogue.room) == (find.robot, find.room)
            ),
            None,
        )

    def destination_considered(self, robot: int) -> int | None:
        """The room that a robot is asked to go to, or talks about."""
        match self.pending_step:
            case Reroute(rerouted, room) if rerouted == robot:
                return room
            case LeaveUndecided(Select() as wish, _) if wish.robot == robot:
                return wish.room
        asked = self.pending.destination_request(robot)
        if isinstance(asked, Select):
            return asked.room
        talk = self.destination_dialogue(robot)
        agreed = (consent for consent in self.view.consents if consent.robot == robot)
        consent = next((consent.room for consent in agreed if consent.matter == "select-room"), None)
        return consent if talk is None else talk.room


@dataclass(frozen=True, slots=True)
class DrawnState:
    """What the last screen showed, by which the next act is judged: what came since was not meant by it.

    Attributes:
        item: the pop-up.
        dialogue: number and turn of the dialogue in it.
        doubt: what was asked.
        game: the game's number.
    """

    item: PopupItem | None = None
    dialogue: tuple[int, int] | None = None
    pending_step: PendingStep | None = None
    game: int = 0


@dataclass(slots=True)
class ParticipantMemory:
    """Everything.

    Attributes:
        hunt: the game, None before the first view that has robots.
        house: where it is played.
        motions: how the robots are on their way, one entry a robot; may be empty.
        selected: the robot commanded.
        hovered: the room looked at.
        typed: digits of a room's number.
        typed_until: when they are forgotten.
        followed: the robot kept in the middle of the map.
        helping: the sheet of keys is open.
        note: a sentence shown for a while, and until when.
        connection: to the game.
        history: what happened in this game.
        pictures: taken in it.
        refusals: number of the last refusal heard of.
        drawn: what the last screen showed.
    """

    hunt: HuntMemory | None = None
    floor_plan: FloorPlan | None = None
    motions: tuple[RobotMotion, ...] = ()
    selected: int = 0
    hovered: int | None = None
    typed: str = ""
    typed_until: float = math.inf
    followed: int | None = None
    help_open: bool = False
    note: tuple[str, float] | None = None
    connection: ConnectionStatus = field(default_factory=ConnectionStatus)
    history: GameHistory = field(default_factory=GameHistory)
    pictures: Pictures = field(default_factory=Pictures)
    last_refusal: int = 0
    last_drawn: DrawnState = field(default_factory=DrawnState)

    def motion(self, robot: int) -> RobotMotion:
        """How a robot is on its way, as last told; nothing is told where robots are moved by an older program."""
        return self.motions[robot] if robot < len(self.motions) else RobotMotion("driving")

    def considered(self) -> int | None:
        """The room looked at, by mouse or by the digits typed so far."""
        rooms = len(self.hunt.view.rooms) if self.hunt is not None else 0
        number = int(self.typed) if self.typed else self.hovered
        return number if number is not None and 0 < number <= rooms else None
