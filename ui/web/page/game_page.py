"""Page of a game in a browser: every word, button and mark that it shows.

The page is made from the same `Screen` that the Qt window draws. The browser adds no words and decides nothing: it
turns each field into an element, and returns the act of a pressed button, or the name of a pressed key.
"""

import string
from collections.abc import Callable, Iterable
from dataclasses import dataclass, replace
from typing import TypeVar, cast

import numpy as np

from sim.common.geometry import Pose2
from sim.common.robot_numbers import number_of
from thbridge.dialogue.wording.texts import Texts
from thbridge.hunt.properties import PropertyDrawing
from thbridge.roles.shared.notices import Ellipse
from ui.model.playing.keys import HELP, act_for, button_keys, shown_key
from ui.model.playing.screen import (
    Act,
    Action,
    CastVote,
    DialoguePopup,
    OpenVote,
    PickName,
    RobotCard,
    RoomTile,
    Screen,
    ShowHelp,
    TellPropertyAct,
    TreasureFact,
    TreasurePopup,
)
from ui.model.playing.spoken import (
    energy_words,
    name_of_speaker,
    remark_of,
    signed,
    speaker_of,
    spoken_act,
    spoken_card,
    spoken_request,
    spoken_tile,
    state_of,
    tile_words,
)
from ui.model.shared.scene import RobotMark
from ui.web.page.people import PagePeople, page_of_people

SourceT = TypeVar("SourceT")
MadeT = TypeVar("MadeT")

KEYS = (
    *string.ascii_uppercase,
    *string.digits,
    *(f"Ctrl+{key}" for key in f"{string.ascii_uppercase}123456789,"),
    *("?", "Tab", "Shift+Tab", "Enter", "Esc", "Space", "Up", "Down", "Home", "End", "F1"),
)
"""Names of all keys that can have an act; see `ui.model.playing.keys`."""


@dataclass(frozen=True, slots=True)
class PageButton:
    """Button.

    Attributes:
        act: act to return when the button is pressed.
        label: text on it.
        key: name of its key in the participant's language; empty if there is none.
        hint: cost or gain of the act; if the act is not possible, the reason.
        enabled: True if the act is possible. A press on a button that is not enabled still returns the act, and the
            answer is the reason in words.
        pending: True if the act was requested and has not happened yet.
        spoken: name for screen readers.
    """

    act: Act
    label: str
    key: str
    hint: str
    enabled: bool
    pending: bool
    spoken: str


@dataclass(frozen=True, slots=True)
class PageCard:
    """Card of a robot.

    Attributes:
        robot: index of the robot, which determines its color.
        number: its number, as people count.
        name: its name.
        selected: True for the robot that the participant commands.
        energy: energy and the cost of the considered move in words, in decreasing length; empty if it is hidden.
        left: share of the bar for the energy left, 0 to 1.
        kept: share of the bar for the energy that the considered move leaves, 0 to 1.
        affordable: True if the energy covers the considered move.
        commander: the other party that commands it; empty if there is none.
        state: its activity.
        place: the place where it is.
        trouble: True if the state needs attention.
        warning: warning that replaces state and place; empty if there is none.
        progress: driven share of its path, 0 to 1; None at rest.
        waits: number of pop-ups that wait for the participant.
        select: selects the robot.
        buttons: further acts with the robot.
        asked_for: True if a teammate asks for the robot.
    """

    robot: int
    number: int
    name: str
    selected: bool
    energy: tuple[str, ...]
    left: float
    kept: float
    affordable: bool
    commander: str
    state: str
    place: str
    trouble: bool
    warning: str
    progress: float | None
    waits: int
    select: PageButton
    buttons: tuple[PageButton, ...]
    asked_for: bool


@dataclass(frozen=True, slots=True)
class PageTile:
    """Tile of a room; the map shows the same state.

    Attributes:
        room: number of the room.
        name: its name.
        state: its state, as in `RoomTile`.
        robot: index of the robot that visited it or drives to it; None without one.
        considered: True if the participant looks at it.
        words: line below its number, in decreasing length.
        warning: True if the energy is enough to get there, but not for all acts there.
        choose: sends the selected robot there.
        found: the known properties of its treasure, for the map, in decreasing length.
    """

    room: int
    name: str
    state: str
    robot: int | None
    considered: bool
    words: tuple[str, ...]
    warning: bool
    choose: PageButton
    found: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class PageFact:
    """Known or unknown property of a treasure.

    Attributes:
        words: the property and its value; empty while it is unknown.
        drawn: kind of drawing next to the words, as in `PropertyDrawing`.
        value: value to draw, in lower case.
        asked: question above the values that the participant can report; empty if there are none.
        key: key that moves from one of these values to the next; empty for none.
        acts: acts that sense or report it.
    """

    words: str
    drawn: str
    value: str
    asked: str
    key: str
    acts: tuple[PageButton, ...]


@dataclass(frozen=True, slots=True)
class PageSentence:
    """Sentence in a dialogue or in the history.

    Attributes:
        speaker: "robot", "you", "teammate", "objection" or "game".
        who: name of the speaker; empty for the game, and for an objection, whose sentence contains it.
        text: the sentence.
        robot: index of the robot that speaks or is addressed; None without one.
    """

    speaker: str
    who: str
    text: str
    robot: int | None


@dataclass(frozen=True, slots=True)
class PageObjection:
    """Objection that the participant may raise in the dialogue of a teammate.

    Attributes:
        button: objects; the browser adds the text of the field to its act.
        own_words: words in the empty field for the participant's own words; empty if there is no field.
    """

    button: PageButton
    own_words: str


@dataclass(frozen=True, slots=True)
class PageDialogue:
    """Pop-up of a dialogue.

    Attributes:
        robot: index of the robot.
        room: number of the room that it is about; None if there is none yet.
        title: subject.
        sentences: all sentences, oldest first.
        choices: possible answers.
        aside: puts the pop-up aside.
        state: remark about the side that decides, or that the robot is thinking; empty if there is none.
        outcome: the result, if the robot has not stated it.
        warning: warning about acts at the destination.
        facts: known properties of the treasure that it is about.
        picture: id of the treasure's picture; empty without one.
        enlarge: enlarges the picture; None without one.
        objection: objection of the participant; None if that is not possible.
    """

    robot: int
    room: int | None
    title: str
    sentences: tuple[PageSentence, ...]
    choices: tuple[PageButton, ...]
    aside: PageButton
    state: str
    outcome: str
    warning: str
    facts: tuple[PageFact, ...]
    picture: str
    enlarge: PageButton | None
    objection: PageObjection | None


@dataclass(frozen=True, slots=True)
class PageName:
    """Possible name of a treasure, with its points if they are known; `pick` selects it."""

    words: str
    picked: bool
    pick: Act


@dataclass(frozen=True, slots=True)
class PageTreasure:
    """Pop-up of a treasure.

    Attributes:
        robot: index of the robot.
        room: number of the room.
        title: heading.
        talk: outcome of a dialogue about it, until it is carried out.
        facts: properties, known and unknown.
        nothing: sentence that no property is known, and why; empty if there is one.
        picture: id of its picture; empty without one.
        unseen: text in place of the picture.
        take: takes a picture; None once there is one.
        enlarge: enlarges the picture; None without one.
        asking: question above the list of names; empty after the decision.
        names: possible names; empty after the decision.
        name_it: submits the selected name; None after the decision.
        unsure: asks the robot for its opinion; None if that is not possible.
        leave: leaves the treasure; None after the decision.
        verdict: result of naming it; empty before.
        points: points of the verdict with their sign; empty without a verdict.
        won: True if the verdict brought points, False if it cost points, None otherwise.
        aside: puts the pop-up aside, or closes it.
    """

    robot: int
    room: int
    title: str
    talk: str
    facts: tuple[PageFact, ...]
    nothing: str
    picture: str
    unseen: str
    take: PageButton | None
    enlarge: PageButton | None
    asking: str
    names: tuple[PageName, ...]
    name_it: PageButton | None
    unsure: PageButton | None
    leave: PageButton | None
    verdict: str
    points: str
    won: bool | None
    aside: PageButton


@dataclass(frozen=True, slots=True)
class PageVote:
    """Open vote.

    Attributes:
        decision: number of the decision.
        robot: index of the robot that it is about; None without one.
        title: sentence that says who proposes what.
        votes: votes that were cast.
        needed: number of people who must still agree, in words.
        left: time left, in words; empty if it is unknown.
        buttons: votes that the participant may cast; empty if they have proposed the decision.
    """

    decision: int
    robot: int | None
    title: str
    votes: tuple[CastVote, ...]
    needed: str
    left: str
    buttons: tuple[PageButton, ...]


@dataclass(frozen=True, slots=True)
class PageQuestion:
    """Question that asks for confirmation, or the page after the game; `lines` are its sentences."""

    title: str
    lines: tuple[str, ...]
    buttons: tuple[PageButton, ...]


@dataclass(frozen=True, slots=True)
class PageWaiting:
    """Entry of the queue of pop-ups that wait."""

    robot: int
    text: str
    show: PageButton


@dataclass(frozen=True, slots=True)
class PageRobot:
    """Robot on the map.

    Attributes:
        x, y, theta: estimated pose, map frame: centimeters and thousandths of a radian.
        selected: True for the robot that the participant commands.
        trouble: True if it is in trouble.
        commander: the other party that commands it; empty if there is none.
        path: x, y, x, y, ... of the rest of its planned path, centimeters.
        ellipse: half axes in centimeters and angle in thousandths of a radian of its uncertainty; None if not shown.
        truth: its true pose like the estimated one; None if not shown.
    """

    x: int
    y: int
    theta: int
    selected: bool
    trouble: bool
    commander: str
    path: tuple[int, ...]
    ellipse: tuple[int, int, int] | None
    truth: tuple[int, int, int] | None


@dataclass(frozen=True, slots=True)
class BrowserPage:
    """Everything that the page of a game shows.

    Attributes:
        phase: page to show, as in `Phase`.
        waiting_for: while connecting, a sentence about what the page waits for.
        consent: text of the consent; empty without one.
        consent_buttons: answers to the consent.
        banner: text of the line across the top; empty without one.
        trouble: True if the banner reports a problem.
        game: number of the game in words; empty if there is only one.
        score: points with their sign; empty if the participant does not see the score.
        score_spoken: the score as a sentence.
        progress: time and rooms left.
        tools: buttons at the top.
        cards: one per robot.
        advice: asks for advice.
        remark: remark about the considered room, or about digits typed so far.
        tiles: one per room.
        queue: words about the queue.
        waiting: pop-ups that wait.
        history: lines of the history, oldest first.
        dialogue: pop-up of a dialogue; None without one.
        treasure: pop-up of a treasure; None without one.
        question: question above everything else; None without one.
        ending: page after the game; None before.
        rules: sentences of the sheet of rules and keys; empty while it is closed.
        help: lines of the sheet as (keys, effect); empty while it is closed.
        close_help: closes the sheet.
        enlarged: id of the picture that is shown enlarged; empty without one.
        followed: index of the robot that the map follows; None without one.
        robots: robots on the map.
        keys: names of the keys that have an act now; the browser keeps all others.
        announcement: last sentence for a screen reader.
        announcement_number: number of the announcement.
        sound: name of the last sound; empty before the first.
        sound_number: number of the sound.
        advise: in a practice game, a sentence about what to do next.
        votes: open votes of the participants.
        no_map: sentence that replaces the map if the participant does not see it; otherwise empty.
        people: the people in the game, and their texts; None if there is only one participant.
    """

    phase: str
    waiting_for: str
    consent: str
    consent_buttons: tuple[PageButton, ...]
    banner: str
    trouble: bool
    game: str
    score: str
    score_spoken: str
    progress: str
    tools: tuple[PageButton, ...]
    cards: tuple[PageCard, ...]
    advice: PageButton
    remark: str
    tiles: tuple[PageTile, ...]
    queue: str
    waiting: tuple[PageWaiting, ...]
    history: tuple[PageSentence, ...]
    dialogue: PageDialogue | None
    treasure: PageTreasure | None
    question: PageQuestion | None
    ending: PageQuestion | None
    rules: tuple[str, ...]
    help: tuple[tuple[str, str], ...]
    close_help: PageButton
    enlarged: str
    followed: int | None
    robots: tuple[PageRobot, ...]
    keys: tuple[str, ...]
    announcement: str
    announcement_number: int
    sound: str
    sound_number: int
    advise: str
    votes: tuple[PageVote, ...]
    no_map: str
    people: PagePeople | None


class BrowserPageMaker:
    """Maker of a game's page from the screen of its model.

    Parts of a screen that are the same objects as before are not made again.

    Args:
        picture_id: returns the id under which the browser has, or receives, a picture; empty for None.
    """

    def __init__(self, picture_id: Callable[[bytes | None], str]) -> None:
        self._picture_id = picture_id
        self._made: dict[str, tuple[object, object]] = {}
        self._page: BrowserPage | None = None
        self._source: tuple[object, object] = (None, None)

    def page(
        self,
        texts: Texts,
        screen: Screen,
        robots: Iterable[RobotMark],
        followed: int | None,
        advise: str = "",
    ) -> BrowserPage:
        """Return the page.

        Args:
            texts: texts of the game's language.
            screen: screen to show.
            robots: robots on the map at this moment.
            followed: index of the robot that the map follows; None without one.
            advise: in a practice game, a sentence about what to do next.
        """
        marks = tuple(_robot(mark) for mark in robots)
        screened, others = self._source
        if self._page is None or screen is not screened or (texts, followed, advise) != others:
            self._source = screen, (texts, followed, advise)
            self._page = self._made_of(texts, screen, followed, advise)
        return replace(self._page, robots=marks)

    def _made_of(self, texts: Texts, screen: Screen, followed: int | None, advise: str) -> BrowserPage:
        """Return the page without robots on its map."""
        button, kept = _ButtonMaker(texts), self._kept
        waiting, ending = screen.waiting, screen.ending
        return BrowserPage(
            phase=screen.phase.value,
            waiting_for=screen.waiting_for,
            consent=screen.consent,
            consent_buttons=kept("consent", (screen.agree, screen.decline), button.all) if screen.consent else (),
            banner="" if screen.banner is None else screen.banner.text,
            trouble=screen.banner is not None and screen.banner.kind == "bad",
            game=texts.text("window.game", number=screen.game) if screen.game else "",
            score="" if screen.score is None else signed(screen.score),
            score_spoken="" if screen.score is None else texts.text("window.score_is", score=screen.score),
            progress=screen.progress,
            tools=kept("tools", (*screen.tools, screen.end), button.all),
            cards=tuple(kept(f"card{card.robot}", card, button.card) for card in screen.cards),
            advice=kept("advice", screen.ask_advice, button.one),
            remark=remark_of(texts, screen),
            tiles=tuple(kept(f"tile{tile.room}", tile, button.tile) for tile in screen.tiles),
            queue=texts.text("window.waiting", count=len(waiting)) if waiting else screen.nothing_waits,
            waiting=kept(
                "waiting",
                waiting,
                lambda items: tuple(
                    PageWaiting(item.robot, item.text, button.one(item.show, item.text)) for item in items
                ),
            ),
            history=kept(
                "history",
                screen.history,
                lambda lines: tuple(
                    PageSentence(line.speaker, speaker_of(texts, line), line.text, line.robot) for line in lines
                ),
            ),
            dialogue=kept("dialogue", screen.popup, lambda pop: self._dialogue(button, pop)),
            treasure=kept("treasure", screen.popup, lambda pop: self._treasure(button, pop)),
            question=_question(button, screen),
            ending=None if ending is None else PageQuestion(ending.title, ending.lines, (button.one(ending.again),)),
            rules=screen.rules,
            help=(*screen.help, ("F6", texts.text("browser.pages.key_next_part")), *button_keys(texts))
            if screen.help
            else (),
            close_help=button.one(Action(ShowHelp(), texts.text("popups.close"), HELP.keys[0])),
            enlarged=self._picture_id(screen.enlarged),
            followed=followed,
            robots=(),
            keys=tuple(key for key in KEYS if act_for(key, screen) is not None),
            announcement=screen.announcement,
            announcement_number=screen.announcement_number,
            sound="" if screen.sound is None else screen.sound.name.lower(),
            sound_number=screen.sound_number,
            advise=advise,
            votes=kept("votes", screen.votes, lambda votes: tuple(button.vote(vote) for vote in votes)),
            no_map=screen.no_map,
            people=kept("people", screen.people, lambda panel: page_of_people(texts, panel)),
        )

    def _kept(self, name: str, source: SourceT, make: Callable[[SourceT], MadeT]) -> MadeT:
        """Return what `make` returns for a source; the object of the last call if the source is equal to the last."""
        last = self._made.get(name)
        if last is not None and last[0] == source:
            return cast(MadeT, last[1])
        made = make(source)
        self._made[name] = source, made
        return made

    def _dialogue(self, button: "_ButtonMaker", pop: DialoguePopup | TreasurePopup | None) -> PageDialogue | None:
        if not isinstance(pop, DialoguePopup):
            return None
        texts = button.texts
        return PageDialogue(
            robot=pop.robot,
            room=pop.room,
            title=pop.title,
            sentences=tuple(
                PageSentence(speaker, name_of_speaker(texts, pop, speaker), text, pop.robot)
                for speaker, text in pop.sentences
            ),
            choices=button.all(pop.choices),
            aside=button.one(pop.aside),
            state=state_of(texts, pop),
            outcome=pop.outcome,
            warning=texts.text("window.warning", warning=pop.warning) if pop.warning else "",
            facts=tuple(button.fact(fact) for fact in pop.facts if fact.value),
            picture=self._picture_id(pop.picture),
            enlarge=button.optional(pop.enlarge, texts.text("window.picture_of_find")),
            objection=None if pop.objects is None else PageObjection(button.one(pop.objects), pop.own_words),
        )

    def _treasure(self, button: "_ButtonMaker", pop: DialoguePopup | TreasurePopup | None) -> PageTreasure | None:
        if not isinstance(pop, TreasurePopup):
            return None
        texts, asks = button.texts, pop.asks_for_name
        facts = pop.facts or ()
        known = any(fact.value for fact in facts)
        nothing = "window.looking" if pop.facts is None else "window.nothing_sensed"
        unseen = "window.no_picture_yet" if asks else "window.no_picture"
        asking = "window.what_is_it_typed" if pop.typed else "window.what_is_it"
        points = pop.points or 0
        return PageTreasure(
            robot=pop.robot,
            room=pop.room,
            title=pop.title,
            talk=pop.talk,
            facts=tuple(button.fact(fact) for fact in facts),
            nothing="" if known else texts.text(nothing),
            picture=self._picture_id(pop.picture),
            unseen=pop.picture_note or texts.text(unseen),
            take=button.optional(pop.take_picture),
            enlarge=button.optional(pop.enlarge, texts.text("window.picture_of_find")),
            asking=texts.text(asking, typed=pop.typed) if asks else "",
            names=_names(texts, pop) if asks else (),
            name_it=button.one(pop.name_it) if asks else None,
            unsure=button.optional(pop.unsure) if asks else None,
            leave=button.one(pop.leave) if asks else None,
            verdict=pop.verdict or "",
            points="" if pop.points is None else f"{pop.points:+d}".replace("-", "−"),
            won=True if points > 0 else False if points < 0 else None,
            aside=button.one(pop.aside),
        )


class _ButtonMaker:
    """Maker of buttons, and of the parts of a page that consist of buttons, in one language."""

    def __init__(self, texts: Texts) -> None:
        self.texts = texts

    def one(self, action: Action, spoken: str = "") -> PageButton:
        """Return the button of an action; without `spoken`, its label is its name."""
        texts, name = self.texts, spoken or action.label
        if action.pending:
            name = texts.text("window.asked_for", name=name)
        elif not action.enabled:
            name = texts.text("window.impossible", name=name)
        key = shown_key(texts, action.key) if action.key else ""
        return PageButton(action.act, action.label, key, action.hint, action.enabled, action.pending, name)

    def optional(self, action: Action | None, spoken: str = "") -> PageButton | None:
        """Return the button of an action, if there is one; without `spoken`, its label is its name."""
        return None if action is None else self.one(action, spoken)

    def all(self, actions: Iterable[Action]) -> tuple[PageButton, ...]:
        """Return the buttons of these actions."""
        return tuple(self.one(action) for action in actions)

    def card(self, card: RobotCard) -> PageCard:
        """Return the card of a robot."""
        texts = self.texts
        energy = card.energy or 0.0
        full = max(card.energy_at_start, energy, 1e-9)
        return PageCard(
            robot=card.robot,
            number=number_of(card.robot),
            name=card.name,
            selected=card.selected,
            energy=() if card.energy is None else energy_words(texts, card),
            left=round(energy / full, 3),
            kept=round(max(0.0, energy - (card.cost or 0.0)) / full, 3),
            affordable=card.affordable,
            commander=card.shown_commander[:1].upper() + card.shown_commander[1:],
            state=card.state,
            place=card.place,
            trouble=card.trouble,
            warning=card.warning,
            progress=None if card.progress is None else round(card.progress, 2),
            waits=card.waits,
            select=self.one(card.select, spoken_card(texts, card)),
            buttons=tuple(
                replace(self.one(action), spoken=spoken_request(texts, spoken_act(texts, card, name), action))
                for name, action in card.buttons
            ),
            asked_for=card.asked_for,
        )

    def vote(self, vote: OpenVote) -> PageVote:
        """Return an open vote."""
        return PageVote(
            vote.decision, vote.robot, vote.title, vote.votes, vote.needed, vote.left, self.all(vote.buttons)
        )

    def tile(self, tile: RoomTile) -> PageTile:
        """Return the tile of a room."""
        return PageTile(
            room=tile.room,
            name=tile.name,
            state=tile.state,
            robot=tile.robot,
            considered=tile.considered,
            words=tile_words(self.texts, tile),
            warning=bool(tile.warning),
            choose=self.one(tile.choose, spoken_tile(self.texts, tile)),
            found=(tile.found, *tile.found_shorter) if tile.found else (),
        )

    def fact(self, fact: TreasureFact) -> PageFact:
        """Return the line of a property."""
        texts = self.texts
        drawn = fact.drawn is not PropertyDrawing.NONE
        words = fact.shown if drawn else texts.text("window.fact", label=fact.label, value=fact.shown)
        asked = key = ""
        if fact.tell:
            key = shown_key(texts, next((action.key for action in fact.tell if action.key), ""))
            asked = texts.text("window.as_you_see_it", label=fact.label)
        # The key of the values is shown next to the question, because it moves from one value to the next.
        acts = [replace(act, key="") if isinstance(act.act, TellPropertyAct) else act for act in fact.acts]
        return PageFact(
            words=words if fact.value else "",
            drawn=fact.drawn.value if fact.value else PropertyDrawing.NONE.value,
            value=fact.value.casefold(),
            asked=asked,
            key=key,
            acts=self.all(acts),
        )


def _names(texts: Texts, pop: TreasurePopup) -> tuple[PageName, ...]:
    called = pop.called or pop.names
    worth = pop.worth or (None,) * len(pop.names)
    return tuple(
        PageName(
            words
            if points is None
            else texts.text("window.name_points", name=words, points=texts.text("words.points", count=points)),
            name == pop.picked,
            PickName(name),
        )
        for name, words, points in zip(pop.names, called, worth, strict=True)
    )


def _question(button: _ButtonMaker, screen: Screen) -> PageQuestion | None:
    asked = screen.confirmation
    return None if asked is None else PageQuestion(asked.title, (asked.text,), button.all(asked.answers))


def _robot(mark: RobotMark) -> PageRobot:
    ellipse = mark.ellipse
    return PageRobot(
        *_pose(mark.pose),
        selected=mark.selected,
        trouble=mark.trouble,
        commander=mark.commander,
        path=tuple(int(number) for number in np.rint(100.0 * mark.path).ravel()),
        ellipse=None if ellipse is None else _ellipse(ellipse),
        truth=None if mark.truth is None else _pose(mark.truth),
    )


def _pose(pose: Pose2) -> tuple[int, int, int]:
    return round(100.0 * pose.x), round(100.0 * pose.y), round(1000.0 * pose.theta)


def _ellipse(ellipse: Ellipse) -> tuple[int, int, int]:
    return round(100.0 * ellipse.major), round(100.0 * ellipse.minor), round(1000.0 * ellipse.angle)
