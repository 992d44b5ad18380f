"""Memory of the participant's view model, from which the screen is computed."""

import math
from collections.abc import Callable
from dataclasses import dataclass, field

from sim.common.observations import TICKS_PER_SECOND
from thbridge.dialogue.wording.texts import Texts
from thbridge.hunt.rooms import Room
from thbridge.roles.shared.notices import FloorPlan, RobotMotion
from thbridge.roles.shared.participant_rules import Situation, revealed
from thbridge.roles.shared.view import DialogueView, LastWords, RequestSuggestion, SelectRoom, View
from thbridge.timing.wall_clock import utc_now
from ui.model.playing.memory.connection import ConnectionStatus
from ui.model.playing.memory.history import GameHistory
from ui.model.playing.memory.name_choice import NameChoice
from ui.model.playing.memory.pending import PendingRequests
from ui.model.playing.memory.pictures import Pictures
from ui.model.playing.memory.popup_queue import DestinationItem, PopupItem, PopupQueue, TreasureItem
from ui.model.playing.memory.talk import TalkMemory
from ui.model.playing.screen import GameSound


@dataclass(frozen=True, slots=True)
class Reroute:
    """Step that needs confirmation: a driving robot goes to another room."""

    robot: int
    room: int


@dataclass(frozen=True, slots=True)
class DepartUndecided:
    """Step that needs confirmation: a robot departs although the treasure in its room is undecided."""

    request: SelectRoom | RequestSuggestion
    room: int


@dataclass(frozen=True, slots=True)
class EndGameEarly:
    """Step that needs confirmation: the game ends although robots can still act."""


@dataclass(frozen=True, slots=True)
class LeaveLastTreasure:
    """Step that needs confirmation: the last undecided treasure is left unnamed, which ends the game."""

    room: int


@dataclass(frozen=True, slots=True)
class LeaveWindow:
    """Step that needs confirmation: the window closes during the game; `ends` is True if this ends the game."""

    ends: bool


@dataclass(frozen=True, slots=True)
class HandOverStep:
    """Step that needs a choice: the participant hands over a robot to a teammate."""

    robot: int


@dataclass(frozen=True, slots=True)
class ObjectionStep:
    """Step that needs a reason: the participant objects in a dialogue of a teammate, given by its number.

    The participant's own words may be empty.
    """

    dialogue: int
    text: str


@dataclass(frozen=True, slots=True)
class Note:
    """Sentence that is shown for a limited time.

    Attributes:
        sentence: the sentence.
        until: time at which the sentence disappears.
        about: the pop-up that the sentence is about; if the pop-up closes, the sentence disappears.
    """

    sentence: str
    until: float
    about: PopupItem | None = None


PendingStep = Reroute | DepartUndecided | EndGameEarly | LeaveLastTreasure | LeaveWindow | HandOverStep | ObjectionStep
"""Step that waits for the participant's confirmation."""


@dataclass(slots=True)
class HuntMemory:
    """Memory of one game; each game gets a new memory.

    Attributes:
        texts: texts of the game's language.
        view: the newest view.
        known: the facts in the view, for the rules.
        pending: requests that have no result yet.
        opening_sentences: sentences by which the participant opened the current dialogues, by robot.
        reroutes: next rooms of robots that were stopped, by robot.
        choice: name that is selected in the pop-up shown, but not confirmed yet.
        submitted_names: names that the participant wants to submit and that are being discussed, by room.
        enlarged: pop-up whose picture is shown enlarged.
        ticks: simulation ticks at the beginning of the game and in the newest telemetry.
        named: rooms for which the participant has submitted a name in this window.
        verdicts: robots in the rooms whose verdict is still shown, by room.
        popups: the pop-up shown, and the waiting pop-ups.
        picture_times: times at which a view first showed that a picture was taken, by room.
        most_energy: greatest energy that any robot has had.
        pending_step: step that waits for confirmation.
        read: numbers of ended dialogues whose last sentences the participant has read.
        reading: number of the ended dialogue in the pop-up shown; None if there is no ended dialogue.
        verdict_read: room of the verdict in the pop-up shown; None if there is no verdict.
        is_continued: True if an earlier program showed the beginning of the game.
    """

    texts: Texts
    view: View
    known: Situation = field(init=False)
    pending: PendingRequests = field(default_factory=PendingRequests)
    opening_sentences: dict[int, str] = field(default_factory=dict)
    reroutes: dict[int, int] = field(default_factory=dict)
    choice: NameChoice | None = None
    submitted_names: dict[int, str] = field(default_factory=dict)
    enlarged: PopupItem | None = None
    ticks: tuple[int, int] | None = None
    named: set[int] = field(default_factory=set)
    verdicts: dict[int, int] = field(default_factory=dict)
    popups: PopupQueue = field(default_factory=PopupQueue)
    picture_times: dict[int, float] = field(default_factory=dict)
    most_energy: float = 0.0
    pending_step: PendingStep | None = None
    read: set[int] = field(default_factory=set)
    reading: int | None = None
    verdict_read: int | None = None
    is_continued: bool = False

    def __post_init__(self) -> None:
        self.receive(self.view)

    def receive(self, view: View) -> None:
        """Process a new view of this game."""
        self.view, self.known = view, revealed(view)

    @property
    def seconds(self) -> int:
        """Simulated time since the beginning of the game, in whole seconds."""
        return 0 if self.ticks is None else (self.ticks[1] - self.ticks[0]) // TICKS_PER_SECOND

    def seconds_of(self, at: float) -> int:
        """Return the time of the game at a simulated time, in whole seconds."""
        began = 0.0 if self.ticks is None else self.ticks[0] / TICKS_PER_SECOND
        return max(0, int(at - began))

    @property
    def picked(self) -> str | None:
        """Name selected in the pop-up shown."""
        return None if self.choice is None else self.choice.name

    def robot_in_room(self, room: int) -> int | None:
        """Return the robot that is at rest in a room; None if there is none."""
        return self.known.state.standing_in(Room(room))

    def ask_to_go(self, request: SelectRoom | RequestSuggestion) -> str:
        """Ask a robot to go to a room or to suggest a room, and show the dialogue at once.

        Return the participant's sentence to the robot.
        """
        sentence = (
            self.texts.text("popups.say_go", room=request.room)
            if isinstance(request, SelectRoom)
            else self.texts.text("popups.say_advise")
        )
        self.pending.ask(request, self.view)
        self.opening_sentences[request.robot] = sentence
        self.popups.show(DestinationItem(request.robot))
        return sentence

    def destination_dialogue(self, robot: int) -> DialogueView | None:
        """Return the open dialogue with a robot about its next room; None if there is none."""
        return next((d for d in self.view.dialogues if d.robot == robot and d.matter == "select-room"), None)

    def treasure_dialogue(self, item: TreasureItem) -> DialogueView | None:
        """Return the open dialogue with a robot about the treasure in its room; None if there is none."""
        return next(
            (
                dialogue
                for dialogue in self.view.dialogues
                if dialogue.matter != "select-room" and (dialogue.robot, dialogue.room) == (item.robot, item.room)
            ),
            None,
        )

    def last_words(self, robot: int) -> LastWords | None:
        """Return the end of the last dialogue with a robot; None if it is no longer relevant."""
        return next((words for words in self.view.last_words if words.robot == robot), None)

    def unread_words(self, robot: int) -> LastWords | None:
        """Return the unread end of a dialogue about a robot's next room; None while a dialogue about it is open."""
        words = self.last_words(robot)
        if words is None or words.matter != "select-room" or words.dialogue in self.read:
            return None
        is_open = self.destination_dialogue(robot) or self.pending.destination_request(robot)
        return None if is_open else words

    def note_reading(self) -> None:
        """Record the ended dialogue or the verdict in the pop-up shown.

        A dialogue or verdict that was shown before counts as read.
        """
        shown = self.popups.shown
        words = self.unread_words(shown.robot) if isinstance(shown, DestinationItem) else None
        number = None if words is None else words.dialogue
        if self.reading not in (None, number):
            self.read.add(self.reading)
        self.reading = number
        room = None
        if isinstance(shown, TreasureItem) and self.verdicts.get(shown.room) == shown.robot:
            room = shown.room
        if self.verdict_read not in (None, room):
            self.verdicts.pop(self.verdict_read, None)
        self.verdict_read = room

    def destination_considered(self, robot: int) -> int | None:
        """Return the room of a pending request to a robot, or of the open dialogue with the robot."""
        match self.pending_step:
            case Reroute(rerouted, room) if rerouted == robot:
                return room
            case DepartUndecided(SelectRoom() as request, _) if request.robot == robot:
                return request.room
        asked = self.pending.destination_request(robot)
        if isinstance(asked, SelectRoom):
            return asked.room
        dialogue = self.destination_dialogue(robot)
        agreed = (consent for consent in self.view.consents if consent.robot == robot)
        consent = next((consent.room for consent in agreed if consent.matter == "select-room"), None)
        return consent if dialogue is None else dialogue.room


@dataclass(frozen=True, slots=True)
class DrawnState:
    """State on which the last screen was based.

    The next act refers to this state, because the participant has not seen later changes.

    Attributes:
        item: the pop-up shown.
        dialogue: number and turn of the dialogue in the pop-up.
        pending_step: the step that needs confirmation.
        game: number of the game.
        picked: name selected in the pop-up.
    """

    item: PopupItem | None = None
    dialogue: tuple[int, int] | None = None
    pending_step: PendingStep | None = None
    game: int = 0
    picked: str | None = None

    @property
    def subject(self) -> tuple[PopupItem | None, int | None]:
        """The pop-up, and the number of the dialogue if the pop-up shows a dialogue in place of a treasure."""
        return self.item, self.dialogue[0] if self.dialogue and isinstance(self.item, TreasureItem) else None


@dataclass(slots=True)
class ParticipantMemory:
    """Memory of the participant's view model.

    Attributes:
        texts: texts of the window's language.
        hunt: memory of the game; None before the first view with robots.
        floor_plan: floor plan of the game.
        motions: progress of the robots on their paths, one entry per robot; may be empty.
        selected: index of the robot that the participant commands.
        turned: True if the participant has selected this robot, and no pop-up has been shown since then.
        hovered: room under the pointer.
        typed: typed digits of a room's number.
        typed_until: time at which these digits are discarded.
        followed: index of the robot that the map follows; None if the map follows no robot.
        help_open: True while the help sheet is open.
        note: a sentence shown for a limited time.
        connection: state of the connection to the game.
        history: lines of this game.
        pictures: pictures taken in this game.
        last_refusal: number of the last refusal.
        last_drawn: state on which the last screen was based.
        leaving: True after the participant has agreed to close the window.
        time_of_day: function that returns the time of day.
        sound_on: True while the participant wants sounds.
        can_sound: True if the computer can play sounds.
        sounds: sounds to play with the next screen.
        once: True if only one game is played, and another part of a study follows.
        talk: texts between the participants of the game.
    """

    texts: Texts
    hunt: HuntMemory | None = None
    floor_plan: FloorPlan | None = None
    motions: tuple[RobotMotion, ...] = ()
    selected: int = 0
    turned: bool = False
    hovered: int | None = None
    typed: str = ""
    typed_until: float = math.inf
    followed: int | None = None
    help_open: bool = False
    note: Note | None = None
    connection: ConnectionStatus = field(default_factory=ConnectionStatus)
    history: GameHistory = field(default_factory=GameHistory)
    pictures: Pictures = field(default_factory=Pictures)
    last_refusal: int = 0
    time_of_day: Callable[[], str] = utc_now
    last_drawn: DrawnState = field(default_factory=DrawnState)
    leaving: bool = False
    sound_on: bool = True
    can_sound: bool = True
    sounds: list[GameSound] = field(default_factory=list)
    once: bool = False
    talk: TalkMemory = field(default_factory=TalkMemory)

    def motion(self, robot: int) -> RobotMotion:
        """Return the progress of a robot on its path, from the last telemetry.

        Older robot programs do not send the progress; the robot then counts as driving.
        """
        return self.motions[robot] if robot < len(self.motions) else RobotMotion("driving")

    def considered(self) -> int | None:
        """Return the room under the pointer, or the room of the digits typed so far."""
        rooms = len(self.hunt.view.rooms) if self.hunt is not None else 0
        number = int(self.typed) if self.typed else self.hovered
        return number if number is not None and 0 < number <= rooms else None
