"""What the participant's window shows at one moment, and what may be done in it, as values.

The window draws a `Screen` and gives back `Act`s; it decides nothing. Whatever can be done carries its label, its key
and, when it cannot be done just now, the reason in words.
"""

from dataclasses import dataclass
from enum import StrEnum
from typing import Literal


class Phase(StrEnum):
    """Which page is shown."""

    CONNECTING = "connecting"
    """There was never a view: the game's server is not reached yet, or its robots are not ready."""
    CONSENT = "consent"
    """The participant is asked to take part."""
    PLAYING = "playing"
    OVER = "over"


# What may be done -----------------------------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class AgreeToTakePart:
    """Take part in the study."""


@dataclass(frozen=True, slots=True)
class ChooseRobot:
    """Command this robot from now on."""

    robot: int


@dataclass(frozen=True, slots=True)
class NextRobot:
    """Command the next robot (`step` 1) or the one before (-1)."""

    step: int


@dataclass(frozen=True, slots=True)
class ConsiderRoom:
    """Look at a room without choosing it; None looks away."""

    room: int | None


@dataclass(frozen=True, slots=True)
class ChooseRoom:
    """Ask the selected robot to go there; one that is under way is called back first."""

    room: int


@dataclass(frozen=True, slots=True)
class TypeDigit:
    """A digit key: with ten rooms or more the number is complete after two digits, or by `FinishNumber`."""

    digit: int


@dataclass(frozen=True, slots=True)
class FinishNumber:
    """The number typed so far is meant as it is (Enter)."""


@dataclass(frozen=True, slots=True)
class AskAdvice:
    """Ask the selected robot for its advice."""


@dataclass(frozen=True, slots=True)
class StopRobot:
    """Call back a robot that is under way; None: the selected one."""

    robot: int | None = None


@dataclass(frozen=True, slots=True)
class AskForRobot:
    """Ask for a robot that somebody else commands to be given back; None: the selected one."""

    robot: int | None = None


@dataclass(frozen=True, slots=True)
class GiveAnswer:
    """Make a choice in the dialogue shown."""

    choice: int


@dataclass(frozen=True, slots=True)
class TakeThePicture:
    """Take a picture of the treasure shown."""


@dataclass(frozen=True, slots=True)
class PickName:
    """Say what the treasure shown may be, without being held to it; None takes that back."""

    name: str | None


@dataclass(frozen=True, slots=True)
class SubmitName:
    """Be held to the name picked."""


@dataclass(frozen=True, slots=True)
class LeaveTreasure:
    """Leave the treasure shown where it is, for good."""


@dataclass(frozen=True, slots=True)
class ShowNext:
    """Put the pop-up aside and show what waits behind it, if anything does; what was put aside waits.

    Without a pop-up it shows what waits longest.
    """


@dataclass(frozen=True, slots=True)
class ShowWaiting:
    """Show what waits for this robot: what it found in this room, or without one whatever waits longest."""

    robot: int
    room: int | None = None


@dataclass(frozen=True, slots=True)
class EndGame:
    """End this game although robots could still do something; asks once whether that is meant."""


@dataclass(frozen=True, slots=True)
class Confirm:
    """Yes, what a question asks is meant (`Question`); an act of its own, so that no double click says yes unread."""


@dataclass(frozen=True, slots=True)
class Cancel:
    """Take back what a question asked (`Question`), or else the digits typed so far."""


@dataclass(frozen=True, slots=True)
class AnotherGame:
    """Play again once the game is over."""


@dataclass(frozen=True, slots=True)
class ShowHelp:
    """Open or close the sheet of keys."""


@dataclass(frozen=True, slots=True)
class FollowRobot:
    """Keep the selected robot in the middle of the map, or stop doing so."""


@dataclass(frozen=True, slots=True)
class FitMap:
    """Show the whole map."""


Act = (
    AgreeToTakePart
    | ChooseRobot
    | NextRobot
    | ConsiderRoom
    | ChooseRoom
    | TypeDigit
    | FinishNumber
    | AskAdvice
    | StopRobot
    | AskForRobot
    | GiveAnswer
    | TakeThePicture
    | PickName
    | SubmitName
    | LeaveTreasure
    | ShowNext
    | ShowWaiting
    | EndGame
    | Confirm
    | Cancel
    | AnotherGame
    | ShowHelp
    | FollowRobot
    | FitMap
)


@dataclass(frozen=True, slots=True)
class Action:
    """Something to do, as a button shows it.

    Attributes:
        act: what it does.
        label: on the button.
        key: that does the same, as printed on the button ("4", "Tab", "F1"); empty when there is none.
        enabled: whether it can be done just now.
        hint: what it costs or brings; why not, when it cannot be done.
        busy: it was asked for and has not happened yet.
    """

    act: Act
    label: str
    key: str
    enabled: bool = True
    hint: str = ""
    pending: bool = False


# What is shown --------------------------------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class RobotCard:
    """A robot beside the map.

    Attributes:
        robot: index in the team.
        name: for people.
        selected: it is the one commanded.
        energy: what it has left.
        energy_at_start: what it, or the richest of the team, had when the game began; the bar's full length.
        cost: of the move being considered, for the selected robot; None when none is.
        affordable: whether it can pay that.
        place: where it stands, in words; where it set out from while it moves.
        state: what it does, in words: "travelling to room 4", "waiting for robot 2", "lost", "no energy left".
        trouble: the state is one to worry about.
        progress: share of its way that is driven, 0 to 1; None at rest.
        waits: how many things wait for the participant because of it: an answer, a treasure.
        select: selects it.
        stop: calls it back; None at rest, and where somebody else commands it.
        commander: who else commands it, "ground station 255"; empty where the participant does.
        ask_back: asks them to give it back; None where the participant commands it, and once the game is over.
    """

    robot: int
    name: str
    selected: bool
    energy: float
    energy_at_start: float
    cost: float | None
    affordable: bool
    place: str
    state: str
    trouble: bool
    progress: float | None
    waits: int
    select: Action
    stop: Action | None
    commander: str = ""
    ask_back: Action | None = None

    @property
    def commanded(self) -> str:
        """Who else commands it, as a part of a sentence; empty where the participant does."""
        return f"commanded by {self.commander}" if self.commander else ""


@dataclass(frozen=True, slots=True)
class RoomTile:
    """A room's button, and what its mark on the map shows.

    Attributes:
        room: its number.
        name: what people call it.
        state: "unvisited", "reserved" or "visited".
        robot: who visited it or is under way to it.
        cost: for the selected robot; None where there is no way for it, or somebody has been or is on the way there.
        considered: it is being looked at.
        found: what is known of its treasure, in a word or two.
        choose: sends the selected robot.
        warning: what to mind before choosing: enough energy to get there, but not to name what is there.
    """

    room: int
    name: str
    state: Literal["unvisited", "reserved", "visited"]
    robot: int | None
    cost: float | None
    considered: bool
    found: str
    choose: Action
    warning: str = ""


@dataclass(frozen=True, slots=True)
class DialoguePopup:
    """A robot talks with the participant.

    Attributes:
        robot: who.
        title: what about, in words.
        said: (speaker, sentence), oldest first; speaker is "robot" or "you".
        choices: what may be answered; none while the robot thinks.
        aside: puts it aside.
        warning: what to mind before answering: enough energy to get there, but not to name what is there.
    """

    robot: int
    title: str
    sentences: tuple[tuple[Literal["robot", "you"], str], ...]
    choices: tuple[Action, ...]
    aside: Action
    warning: str = ""


@dataclass(frozen=True, slots=True)
class TreasurePopup:
    """A robot found something.

    Attributes:
        robot: who.
        room: where.
        title: in words.
        colour: as sensed; empty while the robot still looks.
        footprint: likewise.
        take_picture: with its cost in the hint; None once there is a picture.
        picture: bytes of the image file; None before, or while it arrives.
        names: what it may be, in alphabetical order.
        picked: the name picked so far; nothing is picked at first.
        name_it: enabled once a name is picked.
        leave: gives it up.
        verdict: what came of the name, in words; None before.
        points: of the verdict.
        aside: puts it aside, or closes it when all is decided.
        picture_note: what to say in the picture's place: that it is on its way, or why it cannot be shown.
    """

    robot: int
    room: int
    title: str
    colour: str
    footprint: str
    take_picture: Action | None
    picture: bytes | None
    names: tuple[str, ...]
    picked: str | None
    name_it: Action
    leave: Action
    verdict: str | None
    points: int | None
    aside: Action
    picture_note: str = ""


@dataclass(frozen=True, slots=True)
class Confirmation:
    """Is that meant? Asked before what cannot be taken back."""

    title: str
    text: str
    yes: Action
    no: Action


@dataclass(frozen=True, slots=True)
class WaitingItem:
    """One thing that waits for the participant: the visible queue of arrivals and questions.

    Attributes:
        robot: because of whom.
        text: "Robot 2 is in room 4 and found something".
        show: shows it.
    """

    robot: int
    text: str
    show: Action


@dataclass(frozen=True, slots=True)
class HistoryLine:
    """A line of what happened and was said, for the history.

    Attributes:
        speaker: "robot", "you" or "game".
        robot: which one speaks or is spoken to; None for the game.
        text: the sentence.
    """

    speaker: Literal["robot", "you", "game"]
    robot: int | None
    text: str


@dataclass(frozen=True, slots=True)
class Banner:
    """A line across the top: connection lost, a wish refused, a game that stands still.

    Attributes:
        text: in plain words.
        kind: "bad" stays until it is over, "note" is shown for some seconds.
    """

    text: str
    kind: Literal["bad", "note"]


@dataclass(frozen=True, slots=True)
class GameOverPage:
    """The game is over: why, and what came of it, in words."""

    title: str
    lines: tuple[str, ...]
    again: Action


@dataclass(frozen=True, slots=True)
class Screen:
    """All that is shown beside the moving map.

    Attributes:
        phase: which page.
        waiting_for: what it waits for while connecting, in words.
        consent: the text to agree to.
        agree: agrees.
        banner: across the top.
        game: number of the game.
        score: so far.
        gained: what the last identification brought, for the moving score; None before the first.
        cards: one a robot.
        tiles: one a room.
        dont_know: asks the selected robot for advice.
        end: ends the game.
        tools: follow, fit, help.
        pop: in the middle of the window; at most one.
        question: above everything.
        waiting: what waits behind the pop-up, oldest first.
        history: oldest first.
        ending: when the game is over.
        help: the sheet of keys as (key, what it does); empty while closed.
        typed: the digits of a room number typed so far.
        announcement: the last thing a blind participant has to be told, and
        announced: its number, so that the same words twice are told twice.
    """

    phase: Phase
    waiting_for: str
    consent: str
    agree: Action
    banner: Banner | None
    game: int
    score: int
    last_points: int | None
    cards: tuple[RobotCard, ...]
    tiles: tuple[RoomTile, ...]
    ask_advice: Action
    end: Action
    tools: tuple[Action, ...]
    popup: DialoguePopup | TreasurePopup | None
    confirmation: Confirmation | None
    waiting: tuple[WaitingItem, ...]
    history: tuple[HistoryLine, ...]
    ending: GameOverPage | None
    help: tuple[tuple[str, str], ...]
    typed: str
    announcement: str
    announcement_number: int
