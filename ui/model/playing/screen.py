"""Values that describe the participant's window: the `Screen` to draw, and the `Act`s of a participant.

The window draws a `Screen` and returns `Act`s; it decides nothing. Each offered act has a label and a key. If the act
is not possible at the moment, it also has the reason in words.
"""

from dataclasses import dataclass
from enum import IntEnum, StrEnum
from typing import Literal

from thbridge.hunt.properties import PropertyDrawing
from ui.model.shared.scene import RoomState


class GameSound(IntEnum):
    """Events that have a sound; the least important event is the first."""

    ARRIVAL = 0
    QUESTION = 1
    FIND = 2
    LOST = 3
    WON = 4


class Phase(StrEnum):
    """Page that the window shows."""

    CONNECTING = "connecting"
    """No view has arrived yet: the game's server is not reached, or its robots are not ready."""
    CONSENT = "consent"
    """The window asks the participant to take part."""
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
    """Do not take part in the study; the window thanks the participant."""


@dataclass(frozen=True, slots=True)
class ChooseRobot(Act):
    """Command this robot from now on."""

    robot: int


@dataclass(frozen=True, slots=True)
class NextRobot(Act):
    """Command the next robot (`step` 1) or the previous one (-1)."""

    step: int


@dataclass(frozen=True, slots=True)
class ConsiderRoom(Act):
    """Look at a room without choosing it. If None, look at no room."""

    room: int | None


@dataclass(frozen=True, slots=True)
class SelectRoomAct(Act):
    """Ask the selected robot to go to a room; a robot that is driving is stopped first."""

    room: int


@dataclass(frozen=True, slots=True)
class TypeDigit(Act):
    """Type a digit of a room number; with ten rooms or more, two digits or `FinishNumber` complete it."""

    digit: int


@dataclass(frozen=True, slots=True)
class FinishNumber(Act):
    """Accept the number typed so far as complete (Enter)."""


@dataclass(frozen=True, slots=True)
class RequestSuggestionAct(Act):
    """Ask the selected robot for its advice."""


@dataclass(frozen=True, slots=True)
class StopRobotAct(Act):
    """Stop a driving robot. If `robot` is None, stop the selected one."""

    robot: int | None = None


@dataclass(frozen=True, slots=True)
class RequestHandbackAct(Act):
    """Ask the other commander of a robot to give it back. If `robot` is None, it is the selected robot."""

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
    """Report a property of the treasure shown."""

    property: str
    value: str


@dataclass(frozen=True, slots=True)
class PickName(Act):
    """Select a name for the treasure shown without submitting it. If None, clear the selection."""

    name: str | None


@dataclass(frozen=True, slots=True)
class TypeLetter(Act):
    """Type a letter of a name in the list shown.

    Letters typed shortly after each other form the beginning of the name.
    """

    letter: str


@dataclass(frozen=True, slots=True)
class IdentifyTreasureAct(Act):
    """Submit the selected name of the treasure shown; this counts for the score."""


@dataclass(frozen=True, slots=True)
class AskWhatItIs(Act):
    """Ask a robot that argues what the treasure shown is."""


@dataclass(frozen=True, slots=True)
class LeaveTreasureAct(Act):
    """Leave the treasure shown; until its robot leaves the room, `TakeUpTreasureAct` undoes this."""


@dataclass(frozen=True, slots=True)
class TakeUpTreasureAct(Act):
    """Resume the treasure that was left in the room of a robot. If `robot` is None, it is the selected robot."""

    robot: int | None = None


@dataclass(frozen=True, slots=True)
class ShowNext(Act):
    """Put the pop-up aside and show the next one that waits; the pop-up put aside keeps waiting.

    If no pop-up is shown, show the one that has waited longest.
    """


@dataclass(frozen=True, slots=True)
class ShowWaiting(Act):
    """Show a pop-up that waits for this robot.

    It is the pop-up for its treasure in this room, or otherwise the pop-up that has waited longest.
    """

    robot: int
    room: int | None = None


@dataclass(frozen=True, slots=True)
class EndGameAct(Act):
    """End this game although robots could still act; the window asks for confirmation first."""


@dataclass(frozen=True, slots=True)
class CloseWindow(Act):
    """Close the window during the game, after a confirmation; `ends` is True if that ends the game."""

    ends: bool


@dataclass(frozen=True, slots=True)
class Confirm(Act):
    """Answer yes to a `Confirmation`.

    It is a separate act, so that a double click never confirms an unread question.
    """


@dataclass(frozen=True, slots=True)
class Cancel(Act):
    """Answer no to a `Confirmation`; without one, clear the digits typed so far."""


@dataclass(frozen=True, slots=True)
class PlayAgainAct(Act):
    """Play again after the game."""


@dataclass(frozen=True, slots=True)
class GoOnFromGame(Act):
    """Continue after the game with the next part of the study."""


@dataclass(frozen=True, slots=True)
class ShowSettings(Act):
    """Open the page of settings, which belongs to the window."""


@dataclass(frozen=True, slots=True)
class ShowHelp(Act):
    """Open or close the sheet of rules and keys."""


@dataclass(frozen=True, slots=True)
class FollowRobot(Act):
    """Keep the selected robot in the middle of the map, or stop following it."""


@dataclass(frozen=True, slots=True)
class FitMap(Act):
    """Show the whole map."""


@dataclass(frozen=True, slots=True)
class EnlargePicture(Act):
    """Enlarge the picture of the treasure in the pop-up, or make it small again."""


@dataclass(frozen=True, slots=True)
class SwitchSound(Act):
    """Switch sound off or on."""


@dataclass(frozen=True, slots=True)
class Action:
    """Act on a button.

    Attributes:
        act: the act of the button.
        label: text on the button.
        key: shortcut printed on the button ("4", "Tab", "F1"); empty if there is none.
        enabled: True if the act is possible at the moment.
        hint: cost or gain of the act; if the act is not possible, the reason.
        pending: True if the act was requested and has not happened yet.
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
    """Card of a robot, next to the map.

    Attributes:
        robot: index in the team.
        name: name for people.
        selected: True for the robot that the participant commands.
        energy: energy left.
        energy_at_start: greatest energy that any robot of the team has had, which is the bar's full length.
        cost: energy for the considered move; None if no move is considered.
        affordable: True if its energy covers the cost.
        place: the place where it is at rest, in words; while it drives, the place that it left.
        state: its activity in words: "traveling to room 4", "waiting for robot 2", "lost", "no energy left".
        trouble: True if the state needs attention.
        progress: driven share of its path, 0 to 1; None at rest.
        waits: number of its pop-ups that wait for the participant: an answer, a treasure.
        select: selects the robot.
        stop: stops it; None at rest, and while another party commands it.
        commander: the other party that commands it, such as "ground station 255"; empty if the participant commands it.
        commanded: the commander as part of a sentence, "commanded by ground station 255"; empty if the participant
            commands it.
        ask_back: asks the commander to give it back; None if the participant commands it, and after the game.
        take_up: resumes the treasure that was left in its room; None if there is no such treasure, or if `ask_back` is
            not None.
        warning: warning about acts at its destination for which its energy will be too low, in words; empty if there
            are none.
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
        state: state of the room, with the outcome of naming its treasure.
        robot: index of the robot that visited it or drives to it.
        cost: energy for the selected robot. None if there is no path, if the room is visited or reserved, or if the
            robot drives and the place where it would stop is unknown.
        considered: True if the participant looks at it.
        found: the known properties of its treasure, in one or two words.
        found_shorter: shorter versions of `found`, in the order of decreasing length.
        choose: sends the selected robot.
        warning: warning that the energy is enough to get there, but not to take a picture or name the treasure; empty
            if it is.
        reachable: False if no path leads there from the place of the selected robot.
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
        label: label of the property.
        value: the value; empty while unknown.
        drawn: the drawing next to the value.
        sense: lets the robot sense it; None if it is known, or robots cannot sense it.
        `tell`: for each value that the participant can report, the act; empty if the participant cannot report this
            property.
        words: words for the value in the participant's language; if empty, the value itself is shown.
    """

    label: str
    value: str
    drawn: PropertyDrawing = PropertyDrawing.NONE
    sense: Action | None = None
    tell: tuple[Action, ...] = ()
    words: str = ""

    @property
    def shown(self) -> str:
        """Value in the participant's language."""
        return self.words or self.value

    @property
    def acts(self) -> tuple[Action, ...]:
        """Acts that sense or report it."""
        return self.tell if self.sense is None else (self.sense,)


@dataclass(frozen=True, slots=True)
class DialoguePopup:
    """Pop-up of a dialogue between a robot and the participant.

    Attributes:
        robot: index of the robot.
        title: subject, in words.
        sentences: (speaker, sentence), oldest first; speaker is "robot" or "you".
        choices: possible answers; empty while the robot thinks.
        aside: puts the pop-up aside.
        warning: warning that the energy is enough to get there, but not to take a picture or name the treasure; empty
            if it is.
        room: number of the room that the dialogue is about; None if the robot has not named one yet.
        facts: facts about the treasure that the dialogue is about; empty if there is no treasure.
        picture: bytes of the treasure's image file; None without one.
        note: short remark about which side decides in the end, or about what to do if the robot has nothing to say.
        numbered: True if digits are the keys of the choices, in their order.
        enlarge: enlarges its picture; None without one.
        ended: True if the dialogue has ended.
        outcome: the result, if the robot has not stated it; empty until the end.
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
        facts: a line for each property that can be known; None while the robot is still looking.
        take_picture: takes a picture, with the cost in the hint; None once there is a picture.
        picture: bytes of the image file; None until it has arrived.
        names: possible names, in alphabetical order of their words.
        called: words of each name in the participant's language.
        worth: points of each name, None if unknown; empty if the study does not reveal points.
        picked: selected name; None if no name is selected.
        name_it: names the treasure; enabled after a name is selected.
        leave: leaves the treasure.
        verdict: result of naming it, in words; None before it is named.
        points: points of the verdict.
        aside: puts the pop-up aside, or closes it after all decisions.
        picture_note: text in place of the picture: that it is being sent, or the reason why it cannot be shown.
        typed: the letters of a name typed so far.
        talk: outcome of a dialogue about it, in words, until it is carried out; empty without a dialogue.
        unsure: asks the robot what it is; None if robots do not argue.
        enlarge: enlarges the picture; None before there is one.
        longest_name_it: `name_it` for the name that needs most space; the layout reserves this space.
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
        """All acts of its facts."""
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
    """Entry of the visible queue: a pop-up that waits.

    Attributes:
        robot: index of the robot.
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
        robot: index of the robot that speaks or is addressed; None for the game.
        text: the sentence.
    """

    speaker: Literal["robot", "you", "game"]
    robot: int | None
    text: str


@dataclass(frozen=True, slots=True)
class Banner:
    """Line across the top about a lost connection, a refused request, a stopped game, or similar.

    Attributes:
        text: the text in plain words.
        kind: a banner of kind "bad" stays until the problem is over; a banner of kind "note" is shown for some seconds.
    """

    text: str
    kind: Literal["bad", "note"]


@dataclass(frozen=True, slots=True)
class GameOverPage:
    """Page after the game: the reason for its end and its results, in words."""

    title: str
    lines: tuple[str, ...]
    again: Action


@dataclass(frozen=True, slots=True)
class Screen:
    """All contents of the window next to the moving map.

    Attributes:
        phase: page to show.
        waiting_for: while connecting, a sentence about what the window waits for.
        consent: the text of the consent.
        agree: gives consent.
        decline: declines consent.
        banner: line across the top.
        game: number of the game; 0 if there is none to show.
        score: score so far.
        progress: time played and rooms left, in words; empty before there is a game.
        cards: one per robot.
        tiles: one per room.
        ask_advice: asks the selected robot for advice.
        end: ends the game.
        tools: buttons to follow a robot, to fit the map, and for help.
        popup: the pop-up in a corner of the map; at most one.
        enlarged: picture shown enlarged above everything else, bytes of the image file; None without one.
        confirmation: question drawn above everything else.
        waiting: pop-ups that wait behind the one shown, oldest first.
        nothing_waits: sentence to show if no pop-ups wait, such as "Robot 2 is ready to be sent".
        history: lines of the history, oldest first.
        ending: page after the game; None before its end.
        help: lines of the sheet of keys as (key, effect); empty while the sheet is closed.
        sound: the last sound to play; None before the first.
        sound_number: number of the sound, so that the same sound twice is played twice.
        rules: sentences about the rules of the game, above the keys on the sheet; empty while the sheet is closed, and
            before the game.
        typed: the digits of a room number typed so far.
        announcement: last sentence for a screen reader.
        announcement_number: number of the announcement, so that the same sentence twice is read out twice.
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
