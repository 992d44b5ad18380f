"""View model of the participant's window, which converts messages of the game into a screen, and acts into requests."""

import math
from collections.abc import Callable
from dataclasses import dataclass, replace

from thbridge.dialogue.wording.texts import Texts
from thbridge.files.language_texts import shipped_texts
from thbridge.roles.participant.tabui import ParticipantUpdate
from thbridge.roles.shared.notices import FloorPlan, GameTexts, PicturePiece, PlannedPaths, PoseTelemetry, RobotMotion
from thbridge.roles.shared.team_notices import TeamTalk
from thbridge.roles.shared.view import ParticipantRequest, PlayAgain, View
from thbridge.timing.wall_clock import utc_now
from ui.model.playing.acts import do
from ui.model.playing.compose import compose, next_change, with_motions
from ui.model.playing.marks import MapMarks
from ui.model.playing.memory.history import GameHistory, KeptLines
from ui.model.playing.memory.popup_queue import DestinationItem, TreasureItem
from ui.model.playing.memory.state import DrawnState, HuntMemory, ParticipantMemory
from ui.model.playing.motion import MotionPlayback
from ui.model.playing.offers import offer
from ui.model.playing.people import receive_talk
from ui.model.playing.screen import Act, RoomTile, Screen
from ui.model.playing.sounds import why_silent
from ui.model.playing.view_update import open_requests, receive_tick, receive_view
from ui.model.shared.scene import RobotMark, RoomMark


@dataclass(frozen=True, slots=True)
class ComposedScreen:
    """Screen, and the state of the game that it shows; an act on the screen applies to this state."""

    screen: Screen
    drawn: DrawnState


class Participant:
    """View model of the participant's window.

    The input is messages of the game and acts of the participant; the output is the screen to show and the requests to
    send. Arguments called `now` are monotonic seconds that never decrease. There is one exception: a message may have
    arrived slightly before the last call of `screen`.

    Args:
        time_of_day: function that returns the time of day, for the record of consent.
        sound_on: True if the participant wants sounds.
        can_sound: True if the computer can play sounds.
        once: True if only one game is played, and another part of a study follows.
        joins_next: True if a participant who joins after the end of a game begins the next game, instead of seeing the
            result. This has no effect if `kept` has lines.
        texts: texts until the game sends other texts. If None, the texts are English.
        kept: lines of the history from a program that showed the game before. If None, there is no such program.
    """

    def __init__(
        self,
        time_of_day: Callable[[], str] = utc_now,
        texts: Texts | None = None,
        *,
        sound_on: bool = True,
        can_sound: bool = True,
        once: bool = False,
        joins_next: bool = False,
        kept: KeptLines | None = None,
    ) -> None:
        self._memory = ParticipantMemory(
            texts=shipped_texts() if texts is None else texts,
            time_of_day=time_of_day,
            sound_on=sound_on,
            can_sound=can_sound,
            once=once,
            history=GameHistory(kept),
        )
        # True until the participant has seen a game that is not over.
        self._joins_next = joins_next and not (kept is not None and kept.read())
        self._next_game: PlayAgain | None = None
        self._playback = MotionPlayback()
        self._marks: MapMarks | None = None
        self._screen: Screen | None = None
        self._rooms: tuple[RoomMark, ...] = ()
        # Inputs of the last computation of the rooms' marks: tiles and shapes.
        self._marked: tuple[tuple[RoomTile, ...], MapMarks | None] = ((), None)
        # Time at which the screen is computed again. A message or an act causes a computation at once.
        self._due = -math.inf
        # Robots whose motions are newer than the screen, and a flag that is True if the time played is newer. Both
        # arrive many times a second and change little on the screen.
        self._moved: set[int] = set()
        self._ticked = False

    @property
    def floor_plan(self) -> FloorPlan | None:
        """Floor plan of the game; None until it has arrived."""
        return self._memory.floor_plan

    @property
    def texts(self) -> Texts:
        """Texts of the window; as soon as the game's language is known, they are in this language."""
        return self._memory.texts

    @property
    def followed(self) -> int | None:
        """Robot that the map follows."""
        return self._memory.followed

    @property
    def why_silent(self) -> str:
        """Reason why there is no sound, as a sentence; empty if sound is possible, or before the first game."""
        memory = self._memory
        return "" if memory.hunt is None else why_silent(memory, memory.hunt)

    @property
    def leaving(self) -> bool:
        """True after the participant has agreed to close the window."""
        return self._memory.leaving

    @property
    def sound_on(self) -> bool:
        """True while the participant wants sounds."""
        return self._memory.sound_on

    def receive(self, level: ParticipantUpdate, now: float) -> None:
        """Process a message of the game."""
        memory = self._memory
        match level:
            case View():
                if self._awaits_next(level):
                    return
                if level.robots and (level.ready or memory.hunt is not None):
                    receive_view(memory, level, now)
            case TeamTalk():
                receive_talk(memory, level)
            case GameTexts():
                memory.texts = level.texts() or memory.texts
                if memory.hunt is not None:
                    memory.hunt.texts = memory.texts
            case FloorPlan():
                if level != memory.floor_plan:
                    memory.floor_plan, self._marks = level, MapMarks(level)
            case PicturePiece():
                memory.pictures.receive(level)
            case PoseTelemetry():
                self._playback.receive(level, now)
                self._ticked |= memory.hunt is not None and receive_tick(memory.hunt, level.tick)
                if not self._receive_motions(level.motions, now):
                    return
            case PlannedPaths():
                self._playback.receive(level, now)
                return
        self._due = -math.inf

    def connected(self, now: float) -> None:
        """Record that the connection to the game exists now."""
        self._memory.connection.connected(now)
        self._due = -math.inf

    def lost(self, sentence: str, now: float) -> None:
        """Record that the connection to the game was lost, or could not be made.

        Args:
            sentence: reason in words for people; may be empty.
            now: monotonic seconds.
        """
        memory = self._memory
        if not memory.connection.is_lost and memory.hunt is not None:
            texts = memory.texts
            memory.history.announce(f"{texts.text('game.connection_lost')} {texts.text('game.reconnecting')}")
        memory.connection.lose(sentence, now)
        self._due = -math.inf

    @property
    def composed(self) -> ComposedScreen | None:
        """Last screen, to be passed to `do` if a person acts on it later; None before the first."""
        return None if self._screen is None else ComposedScreen(self._screen, self._memory.last_drawn)

    def do(self, act: Act, now: float, seen: ComposedScreen | None = None) -> None:
        """Carry out an act of the participant on a screen.

        An act has no effect if this screen does not offer the act, or if the object of the act no longer exists. If the
        screen offers an act that is impossible at the moment, the reason is shown.

        Args:
            act: the act.
            now: see the class.
            seen: screen that the participant saw, which may be older than the last one. If None, it is the last one.
        """
        seen = seen or self.composed
        offered = None if seen is None else offer(seen.screen, act)
        if offered is not None and offered.pending:
            return
        memory = self._memory
        last = memory.last_drawn
        if seen is not None:
            memory.last_drawn = seen.drawn
        do(memory, act, now)
        memory.last_drawn = last
        self._due = -math.inf

    def screen(self, now: float) -> Screen:
        """Return the screen to show now. As long as nothing changes, the same object is returned."""
        memory = self._memory
        if self._screen is not None and now < self._due:
            if self._moved or self._ticked:
                self._screen = with_motions(self._screen, memory, self._moved)
                self._moved, self._ticked = set(), False
            return self._screen
        if now >= memory.typed_until:
            memory.typed, memory.typed_until = "", math.inf
        drawn = _drawn(memory.hunt)
        fresh = compose(memory, now)
        if fresh.confirmation is not None and drawn.pending_step != memory.last_drawn.pending_step:
            memory.history.announce(f"{fresh.confirmation.title} {fresh.confirmation.text}")
        elif fresh.popup is not None and drawn.subject != memory.last_drawn.subject:
            memory.history.announce(fresh.popup.title)
        memory.last_drawn = drawn
        fresh = self._sounding(self._announcing(fresh))
        self._due = next_change(memory, now)
        self._moved, self._ticked = set(), False
        if fresh != self._screen:
            self._screen = fresh
        return self._screen or fresh

    def rooms(self, now: float) -> tuple[RoomMark, ...]:
        """Return the rooms on the map of the last screen. As long as nothing changes, the same object is returned."""
        tiles = (self._screen or self.screen(now)).tiles
        if self._marked[0] is not tiles or self._marked[1] is not self._marks:
            self._marked = (tiles, self._marks)
            self._rooms = () if self._marks is None else self._marks.rooms(tiles)
        return self._rooms

    def robots(self, now: float) -> tuple[RobotMark, ...]:
        """Return the marks of the robots on the map at the time `now`."""
        hunt = self._memory.hunt
        if self._marks is None or hunt is None:
            return ()
        return self._marks.robots(hunt.texts, self._playback.at(now), hunt.view, self._memory.selected)

    def requests(self) -> tuple[ParticipantRequest, ...]:
        """Return all requests to the game, oldest first.

        A request must be sent repeatedly as long as it is in this list.
        """
        hunt = self._memory.hunt
        if self._next_game is not None:
            return (self._next_game,)
        if hunt is None:
            return ()
        team = hunt.view.team
        return (*open_requests(hunt), *(() if team is None else self._memory.talk.requests(team.read)))

    def _awaits_next(self, view: View) -> bool:
        """Return True if the participant awaits the next game, because a view shows the game before they joined."""
        self._joins_next = self._joins_next and view.over is not None
        awaits = self._joins_next and view.consent is None
        self._next_game = PlayAgain(view.game) if awaits else None
        return awaits

    def _receive_motions(self, motions: tuple[RobotMotion, ...], now: float) -> bool:
        """Process the robots' motions; return True if parts of the screen other than the cards change."""
        memory = self._memory
        was_still = memory.connection.is_still(now)
        memory.connection.receive(now)
        before, memory.motions = memory.motions, self._until_arrived(motions)
        if was_still or len(before) != len(memory.motions):
            return True
        moved = [robot for robot, pair in enumerate(zip(before, memory.motions, strict=True)) if _differ(*pair)]
        self._moved.update(moved)
        # A question can contain the energy that a robot gets back if it stops.
        return bool(moved) and self._screen is not None and self._screen.confirmation is not None

    def _until_arrived(self, motions: tuple[RobotMotion, ...]) -> tuple[RobotMotion, ...]:
        """Return the motions of all robots.

        If a robot has come to rest, its last motion is returned until the view shows the robot at its goal.
        """
        hunt, before = self._memory.hunt, self._memory.motions
        if hunt is None or not len(motions) == len(before) == len(hunt.view.robots):
            return motions
        return tuple(
            old if new.doing == "resting" and robot.moving_to is not None else new
            for robot, old, new in zip(hunt.view.robots, before, motions, strict=True)
        )

    def _announcing(self, fresh: Screen) -> Screen:
        """Return the screen with the newest announcement. If there is no new announcement, the previous one remains."""
        announcement = self._memory.history.take_announcements()
        before = ("", 0) if self._screen is None else (self._screen.announcement, self._screen.announcement_number)
        announcement, number = (announcement, before[1] + 1) if announcement else before
        return replace(fresh, announcement=announcement, announcement_number=number)

    def _sounding(self, fresh: Screen) -> Screen:
        """Return the screen with the most important new sound. If there is no new sound, the previous sound remains."""
        memory = self._memory
        heard = memory.sounds if memory.sound_on and memory.hunt is not None and memory.hunt.view.sound else []
        before = (None, 0) if self._screen is None else (self._screen.sound, self._screen.sound_number)
        sound, number = (max(heard), before[1] + 1) if heard else before
        memory.sounds.clear()
        return replace(fresh, sound=sound, sound_number=number)


def _drawn(hunt: HuntMemory | None) -> DrawnState:
    """Return the state of a game that a screen shows."""
    if hunt is None:
        return DrawnState()
    item = hunt.popups.shown
    match item:
        case DestinationItem(robot):
            dialogue = hunt.destination_dialogue(robot)
        case TreasureItem():
            dialogue = hunt.treasure_dialogue(item)
        case None:
            dialogue = None
    turn = None if dialogue is None else (dialogue.dialogue, dialogue.turn)
    return DrawnState(item, turn, hunt.pending_step, hunt.view.game, hunt.picked)


def _differ(one: RobotMotion, other: RobotMotion) -> bool:
    """Return True if two motions of a robot look different on its card."""
    return (one.doing, one.waits_for, round(one.progress, 2), one.makes_way_for) != (
        other.doing,
        other.waits_for,
        round(other.progress, 2),
        other.makes_way_for,
    )
