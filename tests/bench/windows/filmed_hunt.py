"""A whole hunt as the participant's program hears it, taken down so that windows can be shown it again."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from sim.common.observations import TICK, TICKS_PER_SECOND
from thbridge.app.compose.game import build_hider, build_keeper
from thbridge.app.compose.robots import build_simr
from thbridge.app.compose.setting import read_setting
from thbridge.app.session.session import Session
from thbridge.dialogue.wording.texts import Texts
from thbridge.roles.participant.tabui import ParticipantUpdate, TabUI
from thbridge.roles.shared.notices import FloorPlan
from thbridge.roles.shared.view import ParticipantRequest, View
from thbridge.study.study_file import ParticipantSection, ShowsSection, Study
from ui.model.playing.keys import act_for
from ui.model.playing.participant import Participant
from ui.model.playing.screen import Act, DialoguePopup, Screen, TreasurePopup
from ui.model.shared.scene import RobotMark, RoomMark

EVERYTHING = ParticipantSection(shows=ShowsSection(uncertainty=True, truth=True))
"""What a study can show of robots at most."""


@dataclass(frozen=True, slots=True)
class Film:
    """What was heard, oldest first.

    Attributes:
        heard: seconds of the session, and what was heard then.
        seconds: how long it lasts.
    """

    heard: tuple[tuple[float, ParticipantUpdate], ...]
    seconds: float


PACE = 20
"""Ticks from one key to the next of whoever played while the film was shot."""


def shoot(robots: int, seconds: float, place: str = "warehouse12") -> Film:
    """The beginning of a hunt: rooms, talks, treasures and pictures, played by keys that the screen offers."""
    study = replace(Study(), map=place, robots=robots, seed=4, participant=EVERYTHING)
    setting = read_setting(study, Path())
    seat = _Seat()
    session = Session(
        build_keeper(setting),
        [build_simr(setting), build_hider(setting.templates, setting.study.seed)],
        [],
        seat.tabui,
    )
    for tick in range(int(seconds * TICKS_PER_SECOND)):
        seat.now = tick * TICK
        if tick % PACE == 0:
            seat.play()
        session.step()
    return Film(tuple(seat.heard), seconds)


class _Seat:
    """Somebody who trusts the robots, has pictures taken, and names the first thing on the list."""

    def __init__(self) -> None:
        self.model, self.now = Participant(), 0.0
        self.heard: list[tuple[float, ParticipantUpdate]] = []
        self.tabui = TabUI(self, self)
        self.model.connected(0.0)

    def observe(self, level: ParticipantUpdate) -> None:
        self.heard.append((self.now, level))
        self.model.receive(level, self.now)

    def requests(self, view: View) -> Sequence[ParticipantRequest]:
        return self.model.requests()

    def play(self) -> None:
        screen = self.model.screen(self.now)
        act = act_for(key_for(screen), screen)
        if act is not None:
            self.model.do(act, self.now)
        self.tabui.poll_player()


def key_for(screen: Screen) -> str:
    match screen.popup:
        case DialoguePopup() as talk:
            return "Enter" if talk.choices else "Esc"
        case TreasurePopup(verdict=str()):
            return "Enter"
        case TreasurePopup() as found if found.take_picture is not None and found.take_picture.enabled:
            return "Ctrl+P"
        case TreasurePopup() as found if found.picked is None and found.names:
            return "Down"
        case TreasurePopup() as found:
            return "Ctrl+N" if found.name_it.enabled else "Ctrl+L"
    return "D" if screen.ask_advice.enabled else "Tab"


class Shown:
    """The participant's real model, which hears a film by the clock of whoever looks at it; after its end, again.

    Args:
        film: what is heard.
        begin: monotonic seconds at which it begins.
    """

    def __init__(self, film: Film, begin: float) -> None:
        self._film = film
        self._model = Participant()
        self._model.connected(begin)
        self._begin = begin
        self._at = 0
        self.done: list[Act] = []

    def take(self, now: float) -> None:
        """Hear what is due; each at the moment at which it was said, as a quick network would bring it."""
        heard = self._film.heard
        while self._at < len(heard) and heard[self._at][0] <= now - self._begin:
            self._model.receive(heard[self._at][1], self._begin + heard[self._at][0])
            self._at += 1

    @property
    def texts(self) -> Texts:
        return self._model.texts

    @property
    def floor_plan(self) -> FloorPlan | None:
        return self._model.floor_plan

    @property
    def followed(self) -> int | None:
        return self._model.followed

    def screen(self, now: float) -> Screen:
        self.take(now)
        return self._model.screen(now)

    def rooms(self, now: float) -> Sequence[RoomMark]:
        return self._model.rooms(now)

    def robots(self, now: float) -> Sequence[RobotMark]:
        return self._model.robots(now)

    def do(self, act: Act, now: float) -> None:
        self.done.append(act)
        self._model.do(act, now)
