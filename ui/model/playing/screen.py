"""Values that describe the participant's window: the `Screen` to draw, and the `Act`s that a participant can do.

The window draws a `Screen` and gives back `Act`s; it decides nothing. Each offered act carries its label, its key and,
when it is not possible just now, the reason in words.
"""

from dataclasses import dataclass
from enum import IntEnum, StrEnum
from typing import Literal

from thbridge.hunt.properties import PropertyDrawing
from ui.model.shared.scene import RoomState


class GameSound(IntEnum):
    """Things that sound, the least important first."""

    ARRIVAL = 0
    QUESTION = 1
    FIND = 2
    LOST = 3
    WON = 4


class Phase(StrEnum):
    """Page that the window shows."""

    CONNECTING = "connecting"
    """No view has come yet: the game's server is not reached, or its robots are not ready."""
    CONSENT = "consent"
    """The participant is asked to take part."""
    PLAYING = "playing"
    OVER = "over"


# Acts -----------------------------------------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class Act:
    """Something that the participant can do."""


@dataclass(frozen=True, slots=True)
class GiveConsentAct(Act):
    """Take part in the study."""


@dataclass(frozen=True, slots=True)
class DeclineConsentAct(Act):
    """Do not take part in the study; the window thanks and ends."""


@dataclass(frozen=True, slots=True)
class ChooseRobot(Act):
    """Command this robot from now on."""

    robot: int


@dataclass(frozen=True, slots=True)
class NextRobot(Act):
    """Command the next robot (`step` 1) or the one before (-1)."""

    step: int


@dataclass(frozen=True, slots=True)
class ConsiderRoom(Act):
    """Look at a room without choosing it; None looks away."""

    room: int | None


@dataclass(frozen=True, slots=True)
class SelectRoomAct(Act):
    """Ask the selected robot to go to a room; a robot that is driving is stopped first."""

    room: int


@dataclass(frozen=True, slots=True)
class TypeDigit(Act):
    """Type a digit of a room number; with ten rooms or more it is complete after two digits, or by `FinishNumber`."""

    digit: int


@dataclass(frozen=True, slots=True)
class FinishNumber(Act):
    """Take the number typed so far as complete (Enter)."""


@dataclass(frozen=True, slots=True)
class RequestSuggestionAct(Act):
    """Ask the selected robot for its advice."""


@dataclass(frozen=True, slots=True)
class StopRobotAct(Act):
    """Stop a robot that is driving; None: the selected one."""

    robot: int | None = None


@dataclass(frozen=True, slots=True)
class RequestHandbackAct(Act):
    """Ask for a robot that somebody else commands to be given back; None: the selected one."""

    robot: int | None = None


@dataclass(frozen=True, slots=True)
class AnswerDialogueAct(Act):
    """Make a choice in the dialogue shown."""

    choice: int


@dataclass(frozen=True, slots=True)
class TakePictureAct(Act):
    """Take a picture of the treasure shown."""


@dataclass(frozen=True, slots=True)
class MeasurePropertyAct(Act):
    """Let the robot sense one more property of the treasure shown, for energy."""

    property: str


@dataclass(frozen=True, slots=True)
class TellPropertyAct(Act):
    """Say what a property of the treasure shown is."""

    property: str
    value: str


@dataclass(frozen=True, slots=True)
class PickName(Act):
    """Pick a name for the treasure shown, without committing to it; None clears the choice."""

    name: str | None


@dataclass(frozen=True, slots=True)
class TypeLetter(Act):
    """Type a letter of a name in the list shown: letters typed soon after each other are the beginning of the name."""

    letter: str


@dataclass(frozen=True, slots=True)
class IdentifyTreasureAct(Act):
    """Name the treasure shown as picked; this counts for the score."""


@dataclass(frozen=True, slots=True)
class AskWhatItIs(Act):
    """Ask the robot, which argues, what the treasure shown is."""


@dataclass(frozen=True, slots=True)
class LeaveTreasureAct(Act):
    """Leave the treasure shown where it is; `TakeUpTreasureAct` takes that back until its robot sets out."""


@dataclass(frozen=True, slots=True)
class TakeUpTreasureAct(Act):
    """Take up the treasure again that was left where a robot stands; None: the selected one."""

    robot: int | None = None


@dataclass(frozen=True, slots=True)
class ShowNext(Act):
    """Put the pop-up aside and show the next one that waits; the one put aside goes on waiting.

    Without a pop-up, show the one that has waited longest.
    """


@dataclass(frozen=True, slots=True)
class ShowWaiting(Act):
    """Show a pop-up that waits for this robot: its find in this room, or else the one waiting longest."""

    robot: int
    room: int | None = None


@dataclass(frozen=True, slots=True)
class EndGameAct(Act):
    """End this game although robots could still do something; asks for confirmation first."""


@dataclass(frozen=True, slots=True)
class CloseWindow(Act):
    """Close the window while the game goes on, after a confirmation; `ends` where that ends the game."""

    ends: bool


@dataclass(frozen=True, slots=True)
class Confirm(Act):
    """Answer yes to a `Confirmation`; an act of its own, so that a double click never says yes unread."""


@dataclass(frozen=True, slots=True)
class Cancel(Act):
    """Answer no to a `Confirmation`; without one, clear the digits typed so far."""


@dataclass(frozen=True, slots=True)
class PlayAgainAct(Act):
    """Play again once the game is over."""


@dataclass(frozen=True, slots=True)
class GoOnFromGame(Act):
    """Go on with what comes after the game, which is over."""


@dataclass(frozen=True, slots=True)
class ShowSettings(Act):
    """Open the page of settings, which is the window's own."""


@dataclass(frozen=True, slots=True)
class ShowHelp(Act):
    """Open or close the sheet of rules and keys."""


@dataclass(frozen=True, slots=True)
class FollowRobot(Act):
    """Keep the selected robot in the middle of the map, or stop doing so."""


@dataclass(frozen=True, slots=True)
class FitMap(Act):
    """Show the whole map."""


@dataclass(frozen=True, slots=True)
class EnlargePicture(Act):
    """Show the picture of the treasure in the pop-up large, or small again."""


@dataclass(frozen=True, slots=True)
class SwitchSound(Act):
    """Switch sound off or on."""


@dataclass(frozen=True, slots=True)
class Action:
    """An act as a button offers it.

    Attributes:
        act: the act that the button does.
        label: text on the button.
        key: shortcut printed on the button ("4", "Tab", "F1"); empty when there is none.
        enabled: True when it can be done just now.
        hint: its cost or gain; the reason when it cannot be done.
        pending: True when it was requested and has not happened yet.
    """

    act: Act
    label: str
    key: str
    enabled: bool = True
    hint: str = ""
    pending: bool = False


# The screen -----------------------------------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class RobotCard:
    """Card of a robot, beside the map.

    Attributes:
        robot: index in the team.
        name: for people.
        selected: True for the robot that the participant commands.
        energy: energy left.
        energy_at_start: most energy that any robot of the team had so far; the bar's full length.
        cost: energy that the considered move costs; None where no move is considered.
        affordable: True when its energy covers the cost.
        place: place where it stands, in words; while it drives, the place that it left.
        state: its activity in words: "traveling to room 4", "waiting for robot 2", "lost", "no energy left".
        trouble: True when the state is one to worry about.
        progress: driven share of its path, 0 to 1; None at rest.
        waits: number of its pop-ups that wait for the participant: an answer, a treasure.
        select: selects the robot.
        stop: stops it; None at rest, and where somebody else commands it.
        commander: the other party that commands it, "ground station 255"; empty where the participant does.
        commanded: that as part of a sentence, "commanded by ground station 255"; empty likewise.
        ask_back: asks the commander to give it back; None where the participant commands it, and once the game is over.
        take_up: takes up again what was left where it stands; None where nothing was, and beside `ask_back`.
        warning: what its energy will not suffice for where it is going, in words; empty where it suffices.
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
    commanded: str = ""
    ask_back: Action | None = None
    take_up: Action | None = None
    warning: str = ""


@dataclass(frozen=True, slots=True)
class RoomTile:
    """Button of a room, with the state that its mark on the map shows.

    Attributes:
        room: its number.
        name: name for people.
        state: of the room, with the outcome of naming its treasure.
        robot: index of the robot that visited it or drives to it.
        cost: energy for the selected robot; None where it has no path, or the room is visited or reserved, or while it
            drives and nobody knows where it would be stopped.
        considered: True when the participant looks at it.
        found: its treasure as far as it is known, in a word or two.
        found_shorter: the same in fewer and fewer words.
        choose: sends the selected robot.
        warning: caution before choosing: enough energy to get there, but not to take a picture or name the treasure.
        reachable: False where no path leads there from where the selected robot stands.
    """

    room: int
    name: str
    state: RoomState
    robot: int | None
    cost: float | None
    considered: bool
    found: str
    choose: Action
    warning: str = ""
    found_shorter: tuple[str, ...] = ()
    reachable: bool = True


@dataclass(frozen=True, slots=True)
class TreasureFact:
    """Line on one property of a treasure.

    Attributes:
        label: of the property.
        value: as far as it is known; empty before.
        drawn: beside the value.
        sense: lets the robot sense it; None where it is known, or nothing to ask a robot for.
        tell: for each value that the participant may say of it, the act; none where it is not theirs to say.
        words: for the value, in the participant's language; empty: the value itself.
    """

    label: str
    value: str
    drawn: PropertyDrawing = PropertyDrawing.NONE
    sense: Action | None = None
    tell: tuple[Action, ...] = ()
    words: str = ""

    @property
    def shown(self) -> str:
        """The value as the participant reads it."""
        return self.words or self.value

    @property
    def acts(self) -> tuple[Action, ...]:
        """Acts by which it can be found out or told."""
        return self.tell if self.sense is None else (self.sense,)


@dataclass(frozen=True, slots=True)
class DialoguePopup:
    """Pop-up of a dialogue between a robot and the participant.

    Attributes:
        robot: index of the robot.
        title: subject, in words.
        sentences: (speaker, sentence), oldest first; speaker is "robot" or "you".
        choices: possible answers; none while the robot thinks.
        aside: puts the pop-up aside.
        warning: caution before answering: enough energy to get there, but not to take a picture or name the treasure.
        room: number of the room that it is about; None where the robot has not said one yet.
        facts: of the treasure that it is about; none where it is about none.
        picture: bytes of the treasure's image file; None without one.
        note: a quiet remark: who decides in the end, or what there is to do when the robot has nothing to say.
        numbered: digits are keys of the choices, in their order.
        enlarge: shows its picture large; None without one.
        ended: nothing more is said.
        outcome: what came of it, where the robot has not said so itself; empty while it goes on.
    """

    robot: int
    title: str
    sentences: tuple[tuple[Literal["robot", "you"], str], ...]
    choices: tuple[Action, ...]
    aside: Action
    warning: str = ""
    room: int | None = None
    facts: tuple[TreasureFact, ...] = ()
    picture: bytes | None = None
    note: str = ""
    numbered: bool = False
    ended: bool = False
    outcome: str = ""
    enlarge: Action | None = None


@dataclass(frozen=True, slots=True)
class TreasurePopup:
    """Pop-up of a treasure that a robot found.

    Attributes:
        robot: index of the robot.
        room: number of the room.
        title: heading, in words.
        facts: a line for each property that can be known; None while the robot still looks.
        take_picture: with its cost in the hint; None once there is a picture.
        picture: bytes of the image file; None before, or while it arrives.
        names: possible names, in alphabetical order of their words.
        called: the words of each name.
        worth: points of each name, None where it is not known; empty where the study does not tell.
        picked: name picked so far; None at first.
        name_it: enabled once a name is picked.
        leave: leaves the treasure, for good.
        verdict: result of naming it, in words; None before.
        points: points of the verdict.
        aside: puts the pop-up aside, or closes it when all is decided.
        picture_note: text in the picture's place: that it is on its way, or why it cannot be shown.
        typed: the letters of a name typed so far.
        talk: how a dialogue about it has ended, in words, unless that is done; empty where none has.
        unsure: asks the robot what it is; None where robots do not argue.
        enlarge: shows the picture large; None before there is one.
        longest_name_it: `name_it` for the name that needs most space, which is kept for it.
    """

    robot: int
    room: int
    title: str
    facts: tuple[TreasureFact, ...] | None
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
    typed: str = ""
    worth: tuple[int | None, ...] = ()
    talk: str = ""
    unsure: Action | None = None
    enlarge: Action | None = None
    longest_name_it: Action | None = None
    called: tuple[str, ...] = ()

    @property
    def acts(self) -> tuple[Action, ...]:
        """The acts of its facts."""
        return tuple(action for fact in self.facts or () for action in fact.acts)

    @property
    def asks_for_name(self) -> bool:
        """True while the list of names is open."""
        return self.verdict is None


@dataclass(frozen=True, slots=True)
class Confirmation:
    """Question that asks for confirmation before a step that cannot be undone."""

    title: str
    text: str
    yes: Action
    no: Action


@dataclass(frozen=True, slots=True)
class WaitingItem:
    """Entry of the visible queue: a pop-up that waits for the participant.

    Attributes:
        robot: index of the robot that it concerns.
        text: a sentence such as "Robot 2 is in room 4 and found something".
        show: shows the pop-up.
    """

    robot: int
    text: str
    show: Action


@dataclass(frozen=True, slots=True)
class HistoryLine:
    """Line of the history: an event, or a sentence of a dialogue.

    Attributes:
        speaker: "robot", "you" or "game".
        robot: index of the robot that speaks or is spoken to; None for the game.
        text: the sentence.
    """

    speaker: Literal["robot", "you", "game"]
    robot: int | None
    text: str


@dataclass(frozen=True, slots=True)
class Banner:
    """Line across the top: connection lost, a request refused, a game that stands still.

    Attributes:
        text: in plain words.
        kind: "bad" stays until it is over, "note" is shown for some seconds.
    """

    text: str
    kind: Literal["bad", "note"]


@dataclass(frozen=True, slots=True)
class GameOverPage:
    """Page after the game: the reason of its end and its results, in words."""

    title: str
    lines: tuple[str, ...]
    again: Action


@dataclass(frozen=True, slots=True)
class Screen:
    """Everything that is shown beside the moving map.

    Attributes:
        phase: page to show.
        waiting_for: while connecting, the thing waited for, in words.
        consent: the text to agree to.
        agree: agrees to take part.
        decline: does not.
        banner: line across the top.
        game: number of the game; 0: none to show.
        score: score so far.
        progress: time played and rooms left, in words; empty before there is a game.
        cards: one per robot.
        tiles: one per room.
        ask_advice: asks the selected robot for advice.
        end: ends the game.
        tools: follow, fit, help.
        popup: in a corner of the map; at most one.
        enlarged: picture shown large above everything else, bytes of the image file; None without one.
        confirmation: question drawn above everything else.
        waiting: pop-ups that wait behind the one shown, oldest first.
        nothing_waits: the sentence in place of them while there are none, such as "Robot 2 is ready to be sent".
        history: oldest first.
        ending: page after the game; None before its end.
        help: the sheet of keys as (key, effect); empty while closed.
        sound: the last sound to be heard; None before the first.
        sound_number: its number, so that the same sound twice is heard twice.
        rules: of the game in sentences, above the keys on the sheet; empty while closed, and before the game is there.
        typed: the digits of a room number typed so far.
        announcement: last sentence for a screen reader.
        announcement_number: its number, so that the same sentence twice is read out twice.
    """

    phase: Phase
    waiting_for: str
    consent: str
    agree: Action
    decline: Action
    banner: Banner | None
    game: int
    score: int
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
    rules: tuple[str, ...] = ()
    nothing_waits: str = ""
    progress: str = ""
    enlarged: bytes | None = None
    sound: GameSound | None = None
    sound_number: int = 0
