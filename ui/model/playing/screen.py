"""Values that describe the participant's window: the `Screen` to draw, and the `Act`s of a participant.

The window draws a `Screen` and returns `Act`s; it makes no decisions. Each offered act has a label and a key. If an act
is impossible at the moment, it also has a reason in words.
"""

from dataclasses import dataclass
from enum import IntEnum, StrEnum
from typing import Literal, TypeAlias

from thbridge.hunt.events import ObjectionReason
from thbridge.hunt.properties import PropertyDrawing
from ui.model.shared.scene import RoomState


class GameSound(IntEnum):
    """Kinds of events that have a sound, in the order of increasing importance."""

    ARRIVAL = 0
    QUESTION = 1
    FIND = 2
    LOST = 3
    WON = 4


class Phase(StrEnum):
    """Kind of page that the window shows."""

    CONNECTING = "connecting"
    """The first view of the game has not arrived yet: the server is not reached, or the robots are not ready."""
    CONSENT = "consent"
    """The window asks the participant to take part."""
    PLAYING = "playing"
    OVER = "over"


# Acts -----------------------------------------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class Act:
    """Action of the participant in the window."""


@dataclass(frozen=True, slots=True)
class GiveConsentAct(Act):
    """Take part in the study."""


@dataclass(frozen=True, slots=True)
class DeclineConsentAct(Act):
    """Decline to take part in the study; the window thanks the participant."""


@dataclass(frozen=True, slots=True)
class ChooseRobot(Act):
    """Command this robot from now on."""

    robot: int


@dataclass(frozen=True, slots=True)
class NextRobot(Act):
    """Command the next robot (`step` 1) or the previous robot (-1)."""

    step: int


@dataclass(frozen=True, slots=True)
class ConsiderRoom(Act):
    """Look at a room without choosing it. If `room` is None, look at no room."""

    room: int | None


@dataclass(frozen=True, slots=True)
class SelectRoomAct(Act):
    """Ask the selected robot to go to a room; if the robot is driving, it is stopped first."""

    room: int


@dataclass(frozen=True, slots=True)
class TypeDigit(Act):
    """Type a digit of a room number. With ten rooms or more, a second digit or `FinishNumber` completes the number."""

    digit: int


@dataclass(frozen=True, slots=True)
class FinishNumber(Act):
    """Complete the number that was typed so far (Enter)."""


@dataclass(frozen=True, slots=True)
class RequestSuggestionAct(Act):
    """Ask the selected robot for advice."""


@dataclass(frozen=True, slots=True)
class StopRobotAct(Act):
    """Stop a driving robot. If `robot` is None, stop the selected robot."""

    robot: int | None = None


@dataclass(frozen=True, slots=True)
class RequestHandbackAct(Act):
    """Ask another commander to give a robot back to the participant. If `robot` is None, ask for the selected robot."""

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
    """Let the robot use energy to sense one more property of the treasure shown."""

    property: str


@dataclass(frozen=True, slots=True)
class TellPropertyAct(Act):
    """Report a property of the treasure shown."""

    property: str
    value: str


@dataclass(frozen=True, slots=True)
class PickName(Act):
    """Select a name for the treasure shown, without submitting it. If the name is None, clear the selection."""

    name: str | None


@dataclass(frozen=True, slots=True)
class TypeLetter(Act):
    """Type a letter of a name in the list shown.

    Several letters typed within a short time are the beginning of the name.
    """

    letter: str


@dataclass(frozen=True, slots=True)
class IdentifyTreasureAct(Act):
    """Submit the selected name of the treasure shown. The name changes the score."""


@dataclass(frozen=True, slots=True)
class AskWhatItIs(Act):
    """Ask a robot that argues for the name of the treasure shown."""


@dataclass(frozen=True, slots=True)
class LeaveTreasureAct(Act):
    """Leave the treasure shown unnamed. Until the robot leaves the room, `TakeUpTreasureAct` undoes this act."""


@dataclass(frozen=True, slots=True)
class TakeUpTreasureAct(Act):
    """Return to the treasure that was left unnamed in a robot's room. If `robot` is None, it is the selected robot."""

    robot: int | None = None


@dataclass(frozen=True, slots=True)
class ShowNext(Act):
    """Put the pop-up aside and show the next waiting pop-up. A pop-up that was put aside also waits.

    If no pop-up is shown, show the pop-up that has waited longest.
    """


@dataclass(frozen=True, slots=True)
class ShowWaiting(Act):
    """Show a pop-up that waits for this robot.

    This is the pop-up for the treasure in `room` or, if there is none, the pop-up that has waited longest.
    """

    robot: int
    room: int | None = None


@dataclass(frozen=True, slots=True)
class EndGameAct(Act):
    """End the game although robots can still act; the window asks for confirmation first."""


@dataclass(frozen=True, slots=True)
class CloseWindow(Act):
    """Close the window during the game after a confirmation; `ends` is True if this also ends the game."""

    ends: bool


@dataclass(frozen=True, slots=True)
class Confirm(Act):
    """Answer yes to a `Confirmation`.

    Because this is a separate act, a double click never confirms a question that was not read.
    """


@dataclass(frozen=True, slots=True)
class Cancel(Act):
    """Answer no to a `Confirmation`; if there is none, clear the digits typed so far."""


@dataclass(frozen=True, slots=True)
class PlayAgainAct(Act):
    """Play again after the game."""


@dataclass(frozen=True, slots=True)
class GoOnFromGame(Act):
    """Continue after the game with the next part of the study."""


@dataclass(frozen=True, slots=True)
class ShowSettings(Act):
    """Open the page of settings of the window."""


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
    """Enlarge the picture of the treasure in the pop-up, or restore its size."""


@dataclass(frozen=True, slots=True)
class SwitchSound(Act):
    """Turn sound off or on."""


@dataclass(frozen=True, slots=True)
class HandOverAct(Act):
    """Choose a teammate to hand over a robot to. If `robot` is None, it is the selected robot."""

    robot: int | None = None


@dataclass(frozen=True, slots=True)
class HandOverTo(Act):
    """Hand over the robot of the question shown to a teammate, by the name of their seat."""

    seat: str


@dataclass(frozen=True, slots=True)
class VoteAct(Act):
    """Vote on an open decision, with a reason for the teammates, which may be empty."""

    decision: int
    agrees: bool
    reason: str = ""


@dataclass(frozen=True, slots=True)
class RaiseObjectionAct(Act):
    """Object in the dialogue of a teammate that is shown; the window asks for the reason.

    The front end inserts the text of its field, the person's own words, which may be empty.
    """

    text: str = ""


@dataclass(frozen=True, slots=True)
class ObjectBecause(Act):
    """Give the reason of the objection in the question shown."""

    reason: ObjectionReason


@dataclass(frozen=True, slots=True)
class ChooseAddressee(Act):
    """Write the next text to this seat; if it is empty, to all."""

    seat: str


@dataclass(frozen=True, slots=True)
class WriteText(Act):
    """Report the text that is being written."""

    text: str


@dataclass(frozen=True, slots=True)
class SayToPeopleAct(Act):
    """Send a text to a seat; if it is empty, to all.

    The front end inserts the text of its field, and empties the field.
    """

    to: str
    text: str = ""


@dataclass(frozen=True, slots=True)
class MarkReadAct(Act):
    """Report that all texts up to the one with this number were shown."""

    line: int


PeopleAct: TypeAlias = ChooseAddressee | WriteText | SayToPeopleAct | MarkReadAct
"""Act on the panel of the people in the game. It never depends on other parts of the screen."""


@dataclass(frozen=True, slots=True)
class GoToPeople(Act):
    """Move the focus to the field for texts to other people. The front end does this itself."""


@dataclass(frozen=True, slots=True)
class Action:
    """Button for an act.

    Attributes:
        act: the act of the button.
        label: text on the button.
        key: shortcut on the button ("4", "Tab", "F1"); empty if there is none.
        enabled: True if the act is possible at the moment.
        hint: cost or gain of the act; if the act is impossible, the reason.
        pending: True if the act was requested but has not happened yet.
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
        energy: remaining energy; None if the participant does not see the energy.
        energy_at_start: greatest energy that any robot of the team has had: the full length of the energy bar.
        cost: energy of the move that the participant considers; None if no move is considered.
        affordable: True if the robot has enough energy for this move.
        place: place where the robot is at rest, in words; while the robot drives, the place that it left.
        state: activity in words: "traveling to room 4", "waiting for robot 2", "lost", "no energy left".
        trouble: True if the state needs attention.
        progress: driven share of the robot's path, 0 to 1; None if the robot is at rest.
        waits: number of the robot's pop-ups that wait for the participant.
        select: button that selects the robot.
        stop: button that stops the robot; None if the robot is at rest or the participant does not command it.
        commander: the other commander, such as "ground station 255"; empty if the participant commands the robot.
        commanded: the other commander as part of a sentence, "commanded by ground station 255"; empty if the
            participant commands the robot.
        ask_back: button to get the robot back from the other commander; None if the participant commands the robot,
            and after the game.
        take_up: button to return to the treasure that was left unnamed in the robot's room; None if there is no such
            treasure, or if `ask_back` is not None.
        warning: warning that the robot will have too little energy for acts at its destination, in words; empty if the
            energy is enough.
        holder: in a game with several participants, the party that commands the robot, in words, also if it is the
            participant; otherwise empty.
        hand_over: button to hand over the robot to a teammate; None if no teammate can take it over, or if the
            participant does not command it.
        asked_for: True if a teammate asks for the robot.
    """

    robot: int
    name: str
    selected: bool
    energy: float | None
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
    holder: str = ""
    hand_over: Action | None = None
    asked_for: bool = False

    @property
    def shown_commander(self) -> str:
        """Line about the party that commands the robot; empty in a game with one participant who commands it."""
        return self.holder or self.commander

    @property
    def buttons(self) -> tuple[tuple[str, Action], ...]:
        """Buttons on the card, each with the name of its act in texts."""
        named = (
            ("stop", self.stop),
            ("hand_over", self.hand_over),
            ("ask_back", self.ask_back),
            ("take_up", self.take_up),
        )
        return tuple((name, action) for name, action in named if action is not None)


@dataclass(frozen=True, slots=True)
class RoomTile:
    """Button of a room, which shows the same state as the room's mark on the map.

    Attributes:
        room: number of the room.
        name: name for people.
        state: state of the room, including the result of naming the treasure.
        robot: index of the robot that visited the room or drives to it.
        cost: energy that the selected robot needs to go there. None if there is no path, if the room is visited or
            reserved, or if the robot is driving and the place where it would stop is unknown.
        considered: True if the participant looks at the room.
        found: known properties of the treasure, in one or two words.
        found_shorter: shorter versions of `found`, in the order of decreasing length.
        choose: button that sends the selected robot to the room.
        warning: warning that the robot has enough energy to reach the room, but too little to take a picture or name
            the treasure; empty if the energy is enough.
        reachable: False if no path leads to the room from the place of the selected robot.
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
    """Line about one property of a treasure.

    Attributes:
        label: label of the property.
        value: the value; empty if unknown.
        drawn: form of the drawing next to the value.
        sense: button that lets the robot sense the property; None if the value is known, or robots cannot sense it.
        `tell`: buttons that report a value, one for each value; empty if the participant cannot report the property.
        words: the value in words of the participant's language; if empty, the value itself is shown.
    """

    label: str
    value: str
    drawn: PropertyDrawing = PropertyDrawing.NONE
    sense: Action | None = None
    tell: tuple[Action, ...] = ()
    words: str = ""

    @property
    def shown(self) -> str:
        """Value in words of the participant's language."""
        return self.words or self.value

    @property
    def acts(self) -> tuple[Action, ...]:
        """Buttons that sense or report the property."""
        return self.tell if self.sense is None else (self.sense,)


@dataclass(frozen=True, slots=True)
class DialoguePopup:
    """Pop-up of a dialogue between a robot and the participant.

    Attributes:
        robot: index of the robot.
        title: subject of the dialogue, in words.
        sentences: (speaker, sentence), oldest first; the speaker is "robot", "you" or "teammate". The sentence of an
            "objection" says who objects.
        choices: possible answers; empty while the robot prepares its next sentence.
        aside: button that puts the pop-up aside.
        warning: warning that the robot has enough energy to reach the room, but too little to take a picture or name
            the treasure; empty if the energy is enough.
        room: number of the room that the dialogue is about; None if the robot has not named one yet.
        facts: known properties of the treasure that the dialogue is about; empty if it is not about a treasure.
        picture: bytes of the treasure's image file; None if there is no picture.
        note: short remark that says which side decides in the end, or that the robot waits for an answer.
        numbered: True if digits are the keys of the choices, in the order of the choices.
        enlarge: button that enlarges the picture; None if there is no picture.
        ended: True if the dialogue has ended.
        outcome: result of the dialogue; empty until the end, and if the robot's last sentence states the result.
        partner: teammate who talks with the robot; empty if it is the participant.
        objects: button to object in the dialogue of a teammate; None if that is not possible.
        own_words: words in the empty field for the person's own words in an objection; empty if there is no field.
    """

    robot: int
    title: str
    sentences: tuple[tuple[Literal["robot", "you", "teammate", "objection"], str], ...]
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
    partner: str = ""
    objects: Action | None = None
    own_words: str = ""


@dataclass(frozen=True, slots=True)
class TreasurePopup:
    """Pop-up of a treasure that a robot found.

    Attributes:
        robot: index of the robot.
        room: number of the room.
        title: heading, in words.
        facts: a line for each property that can be known; None until the robot has sensed the treasure.
        take_picture: button that takes a picture, with the cost in the hint; None if there is already a picture.
        picture: bytes of the image file; None until the file has arrived.
        names: possible names, in the alphabetical order of the displayed names.
        called: displayed names, in the participant's language.
        worth: points of each name, None if unknown; empty if the study does not reveal points.
        picked: selected name; None if no name is selected.
        name_it: button that names the treasure; enabled after a name is selected.
        leave: button that leaves the treasure unnamed.
        verdict: result of naming the treasure, in words; None before the treasure is named.
        points: points that the name won or lost.
        aside: button that puts the pop-up aside or, after all decisions, closes it.
        picture_note: text shown if there is no picture: the picture is being sent, or cannot be shown for a reason.
        typed: letters of a name typed so far.
        talk: result of a dialogue about the treasure, in words, until it is carried out; empty if there is none.
        unsure: button that asks the robot for the name; None if robots do not argue.
        enlarge: button that enlarges the picture; None if there is no picture.
        longest_name_it: `name_it` for the name that needs the most space; the layout reserves this space.
        may_name: False if only teammates may name treasures. Then `names` is empty, and `talk` says who may.
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
    may_name: bool = True

    @property
    def acts(self) -> tuple[Action, ...]:
        """Buttons of all lines about properties."""
        return tuple(action for fact in self.facts or () for action in fact.acts)

    @property
    def asks_for_name(self) -> bool:
        """True if the list of names is shown."""
        return self.verdict is None and self.may_name


@dataclass(frozen=True, slots=True)
class Confirmation:
    """Question before a step that cannot be undone, or that needs a choice.

    Attributes:
        title: the question.
        text: more about it.
        yes: button of the step.
        no: button that leaves everything as it is.
        others: buttons of other possible steps.
    """

    title: str
    text: str
    yes: Action
    no: Action
    others: tuple[Action, ...] = ()

    @property
    def answers(self) -> tuple[Action, ...]:
        """All buttons."""
        return (self.yes, *self.others, self.no)


@dataclass(frozen=True, slots=True)
class WaitingItem:
    """Entry in the list of waiting pop-ups.

    Attributes:
        robot: index of the robot.
        text: a sentence such as "Robot 2 is in room 4 and found something".
        show: button that shows the pop-up.
    """

    robot: int
    text: str
    show: Action


@dataclass(frozen=True, slots=True)
class CastVote:
    """Vote that was cast.

    Attributes:
        words: the vote as a sentence, with the reason.
        agrees: True if the person agrees.
    """

    words: str
    agrees: bool


@dataclass(frozen=True, slots=True)
class OpenVote:
    """Decision on which the participants of a game vote.

    Attributes:
        decision: number of the decision.
        robot: index of the robot that it is about; None if it is about no robot.
        title: sentence that says who proposes what.
        votes: votes that were cast, oldest first.
        needed: number of people who must still agree, in words.
        left: time until the vote ends, in words; empty if it is unknown.
        agree: button to agree; None if the participant has proposed the decision.
        disagree: button to disagree; None if `agree` is None.
    """

    decision: int
    robot: int | None
    title: str
    votes: tuple[CastVote, ...]
    needed: str
    left: str
    agree: Action | None
    disagree: Action | None

    @property
    def buttons(self) -> tuple[Action, ...]:
        """Buttons of the votes that the participant may cast."""
        return tuple(action for action in (self.agree, self.disagree) if action is not None)


@dataclass(frozen=True, slots=True)
class HistoryLine:
    """Line of the history: an event, or a sentence of a dialogue.

    Attributes:
        speaker: "robot", "you", "teammate" or "game".
        robot: index of the robot that speaks or is addressed; None if the speaker is the game.
        text: the sentence.
        teammate: label of the teammate who speaks; empty for other speakers.
    """

    speaker: Literal["robot", "you", "teammate", "game"]
    robot: int | None
    text: str
    teammate: str = ""


@dataclass(frozen=True, slots=True)
class PersonRow:
    """Person in the game: the participant, or a teammate.

    Attributes:
        seat: name of the seat.
        name: words for the seat.
        present: True if the person has joined.
        presence: the same in words.
        commands: robots that the person commands, in words.
        robots: indices of these robots.
        may: what the person may do, in words.
    """

    seat: str
    name: str
    present: bool
    presence: str
    commands: str
    robots: tuple[int, ...]
    may: str


@dataclass(frozen=True, slots=True)
class PersonText:
    """Text of a person.

    Attributes:
        line: number of the text in the game; 0 while it is on its way.
        who: author and addressee, in words.
        text: the text, on one line and without control characters.
        time: time of the game at which it was sent; words while it is on its way.
        own: True if the participant wrote it.
        pending: True while it is on its way.
        new: True if the participant has not seen it yet.
    """

    line: int
    who: str
    text: str
    time: str
    own: bool
    pending: bool = False
    new: bool = False


@dataclass(frozen=True, slots=True)
class PeoplePanel:
    """Panel of the people in the game, with their texts.

    Attributes:
        title: heading.
        own: the participant.
        others: the teammates.
        texts: all texts, oldest first.
        nothing: sentence in place of texts; empty if there are texts.
        unread: number of texts that the participant has not seen.
        news: the same in words; empty for 0.
        read: reports that all texts are shown; None if all are read.
        writes: True if the panel shows a field for texts.
        closed: reason why no text can be sent now; empty if one can.
        addressees: buttons that choose an addressee; `Action.pending` is never set.
        to: seat of the chosen addressee; empty for all.
        prompt: label of the field, with the addressee.
        draft: text in the field.
        restored: number of times that the game replaced the text of the field; after a higher number than before, the
            field must show `draft` again.
        send: button that sends the text of the field.
        longest: greatest length of a text, characters.
    """

    title: str
    own: PersonRow
    others: tuple[PersonRow, ...]
    texts: tuple[PersonText, ...]
    nothing: str
    unread: int
    news: str
    read: MarkReadAct | None
    writes: bool
    closed: str
    addressees: tuple[Action, ...]
    to: str
    prompt: str
    draft: str
    restored: int
    send: Action
    longest: int

    @property
    def addressee_act(self) -> ChooseAddressee:
        """Act that chooses the present addressee."""
        return ChooseAddressee(self.to)


@dataclass(frozen=True, slots=True)
class Banner:
    """Line at the top of the window, for example about a lost connection or a refused request.

    Attributes:
        text: the text of the line.
        kind: "bad" for a line that stays until a problem is solved; "note" for a line that is shown for some seconds.
    """

    text: str
    kind: Literal["bad", "note"]


@dataclass(frozen=True, slots=True)
class GameOverPage:
    """Page after the game: the reason why the game ended, and the results, in words."""

    title: str
    lines: tuple[str, ...]
    again: Action


@dataclass(frozen=True, slots=True)
class Screen:
    """All contents of the window except the map with the moving robots.

    Attributes:
        phase: kind of page to show.
        waiting_for: sentence that says what the window waits for while it connects.
        consent: text of the consent.
        agree: button that gives consent.
        decline: button that declines consent.
        banner: line at the top of the window.
        game: number of the game; 0 if there is no game to show.
        score: score so far; None if the participant does not see the score.
        progress: time played and number of rooms left, in words; empty before the game.
        cards: cards of the robots, one per robot.
        tiles: buttons of the rooms, one per room.
        ask_advice: button that asks the selected robot for advice.
        end: button that ends the game.
        tools: buttons to follow a robot, to show the whole map, and for help.
        popup: pop-up in a corner of the map; None if there is none.
        enlarged: bytes of the image file of an enlarged picture, shown above everything else; None if there is none.
        confirmation: question shown above everything else.
        waiting: waiting pop-ups, oldest first.
        nothing_waits: sentence to show if no pop-ups wait, such as "Robot 2 is ready to be sent".
        history: lines of the history, oldest first.
        ending: page after the game; None before the end of the game.
        help: lines of the help sheet as (key, effect); empty if the sheet is closed.
        sound: last sound to play; None before the first sound.
        sound_number: number of the sound; it increases with each sound, so equal sounds can follow each other.
        rules: sentences about the rules of the game, shown above the keys on the help sheet; empty if the sheet is
            closed, and before the game.
        typed: digits of a room number typed so far.
        announcement: last sentence for screen readers.
        announcement_number: number of the sentence; it increases, so equal sentences can follow each other.
        people: the people in the game, and their texts; None if there is only one participant.
        votes: open votes of the participants, oldest first.
        no_map: sentence that replaces the map if the participant does not see it; otherwise empty.
    """

    phase: Phase
    waiting_for: str
    consent: str
    agree: Action
    decline: Action
    banner: Banner | None
    game: int
    score: int | None
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
    people: PeoplePanel | None = None
    votes: tuple[OpenVote, ...] = ()
    no_map: str = ""
