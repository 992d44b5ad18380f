"""All that the participant's view model remembers; what is shown is worked out from it."""

import math
from dataclasses import dataclass, field

from thbridge.roles.notices import House, Motion
from thbridge.roles.view import DialogueView, Select, Unsure, View
from ui.model.playing.asked import Asked
from ui.model.playing.connection import Connection
from ui.model.playing.history import History
from ui.model.playing.pictures import Pictures
from ui.model.playing.queue import Find, Item, Popups, Talk


@dataclass(frozen=True, slots=True)
class Reroute:
    """A robot that is under way shall go to this room instead."""

    robot: int
    room: int


@dataclass(frozen=True, slots=True)
class MoveOn:
    """A robot shall go on although what it found in this room is not decided."""

    wish: Select | Unsure
    room: int


@dataclass(frozen=True, slots=True)
class End:
    """The game shall end although robots could still do something."""


Doubt = Reroute | MoveOn | End
"""What the participant is asked about: is that meant?"""


@dataclass(slots=True)
class Hunt:
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
    asked: Asked = field(default_factory=Asked)
    requests: dict[int, str] = field(default_factory=dict)
    reroutes: dict[int, int] = field(default_factory=dict)
    picked: dict[int, str] = field(default_factory=dict)
    named: dict[int, str] = field(default_factory=dict)
    verdicts: dict[int, int] = field(default_factory=dict)
    popups: Popups = field(default_factory=Popups)
    pictured: dict[int, float] = field(default_factory=dict)
    richest: float = 0.0
    gained: int | None = None
    doubt: Doubt | None = None

    def ask_to_go(self, wish: Select | Unsure) -> str:
        """Ask a robot to go somewhere, and show the talk at once; what was said to it."""
        said = f"Go to room {wish.room}." if isinstance(wish, Select) else "I don't know where to go."
        self.asked.ask(wish, self.view)
        self.requests[wish.robot] = said
        self.popups.show(Talk(wish.robot))
        return said

    def talk(self, robot: int) -> DialogueView | None:
        """What a robot and the participant talk about, if it is where to go."""
        return next((d for d in self.view.dialogues if d.robot == robot and d.matter == "select-room"), None)

    def talk_about(self, find: Find) -> DialogueView | None:
        """What is talked about the treasure beside a robot."""
        return next(
            (
                dialogue
                for dialogue in self.view.dialogues
                if dialogue.matter != "select-room" and (dialogue.robot, dialogue.room) == (find.robot, find.room)
            ),
            None,
        )

    def goal_considered(self, robot: int) -> int | None:
        """The room that a robot is asked to go to, or talks about."""
        match self.doubt:
            case Reroute(rerouted, room) if rerouted == robot:
                return room
            case MoveOn(Select() as wish, _) if wish.robot == robot:
                return wish.room
        asked = self.asked.going(robot)
        if isinstance(asked, Select):
            return asked.room
        talk = self.talk(robot)
        agreed = (consent for consent in self.view.consents if consent.robot == robot)
        consent = next((consent.room for consent in agreed if consent.matter == "select-room"), None)
        return consent if talk is None else talk.room


@dataclass(frozen=True, slots=True)
class Drawn:
    """What the last screen showed, by which the next act is judged: what came since was not meant by it.

    Attributes:
        item: the pop-up.
        dialogue: number and turn of the dialogue in it.
        doubt: what was asked.
        game: the game's number.
    """

    item: Item | None = None
    dialogue: tuple[int, int] | None = None
    doubt: Doubt | None = None
    game: int = 0


@dataclass(slots=True)
class Memory:
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

    hunt: Hunt | None = None
    house: House | None = None
    motions: tuple[Motion, ...] = ()
    selected: int = 0
    hovered: int | None = None
    typed: str = ""
    typed_until: float = math.inf
    followed: int | None = None
    helping: bool = False
    note: tuple[str, float] | None = None
    connection: Connection = field(default_factory=Connection)
    history: History = field(default_factory=History)
    pictures: Pictures = field(default_factory=Pictures)
    refusals: int = 0
    drawn: Drawn = field(default_factory=Drawn)

    def motion(self, robot: int) -> Motion:
        """How a robot is on its way, as last told; nothing is told where robots are moved by an older program."""
        return self.motions[robot] if robot < len(self.motions) else Motion("driving")

    def considered(self) -> int | None:
        """The room looked at, by mouse or by the digits typed so far."""
        rooms = len(self.hunt.view.rooms) if self.hunt is not None else 0
        number = int(self.typed) if self.typed else self.hovered
        return number if number is not None and 0 < number <= rooms else None
