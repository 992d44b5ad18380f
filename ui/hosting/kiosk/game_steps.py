"""Steps of a study in which people play games at the kiosk, with the results of the games."""

import asyncio
import math
import secrets
import time
from collections.abc import Coroutine, Mapping
from pathlib import Path
from typing import Protocol, TypeVar

from msgspec import structs

from thbridge.app.consent import ParticipantDeclined
from thbridge.experiment.conductor import Conductor
from thbridge.experiment.design.plan import PlannedStep
from thbridge.experiment.design.steps import PracticeTerm, ResumeRule
from thbridge.experiment.progress import Run
from thbridge.experiment.store.events import Clocks, EventKind, JsonValue, RunState
from thbridge.sockets.addresses import ListeningAddress
from thbridge.timing.wall_clock import utc_now
from ui.hosting.kiosk import words
from ui.hosting.kiosk.games import GameWatcher, KioskStopped
from ui.hosting.kiosk.pages import KioskPages, Page, RunOver
from ui.hosting.lobby import WILDCARD_ADDRESSES
from ui.model.kiosk import (
    GameNews,
    GamePrepared,
    GameRecorded,
    GameSeenOver,
    GameToJoin,
    TextToRead,
    ToKiosk,
    WentOn,
)


class PracticeResult(Protocol):
    """Counts of a practice game; see `PracticeCount`."""

    @property
    def data(self) -> dict[str, JsonValue]:
        """Data for the log."""

    @property
    def missing(self) -> Mapping[PracticeTerm, float]:
        """Amount of each term that the person must still do."""


class GamesOfStudy(Protocol):
    """Player of games, such as `StudyGames`."""

    async def practise(self, run: Run, step: PlannedStep, watcher: GameWatcher) -> PracticeResult:
        """Play the practice game; return the counts of the person's actions."""

    async def play(
        self, run: Run, step: PlannedStep, watcher: GameWatcher, *, goes_on: bool
    ) -> dict[str, JsonValue] | None:
        """Play a person's game; return its entry in the log, or None if the game did not reach its end."""


class StudyClock:
    """Clocks of a study's events.

    Attributes:
        simulated: simulated time of the running game, seconds; None outside of games.
    """

    def __init__(self) -> None:
        self.simulated: float | None = None

    def __call__(self) -> Clocks:
        """Return the current times."""
        return Clocks(utc_now(), time.monotonic_ns(), self.simulated)


PlayedT = TypeVar("PlayedT")
MOST_PRACTICE = 3
"""Maximum number of practice games for a person who does not reach the step's goals."""


class GameSteps:
    """Steps in which the person at the kiosk plays games.

    Args:
        conductor: conductor of the study, which uses `clock`.
        pages: pages of the kiosk.
        games: player of the games.
        clock: clock of the log's events.
    """

    def __init__(self, conductor: Conductor, pages: KioskPages, games: GamesOfStudy, clock: StudyClock) -> None:
        self._conductor = conductor
        self._pages = pages
        self._games = games
        self._clock = clock
        self._token = secrets.token_hex(8)

    async def practise(self, step: PlannedStep) -> None:
        """Repeat the practice game until all goals of its step are reached, but at most `MOST_PRACTICE` times."""
        for game in range(MOST_PRACTICE):
            await self._pages.show(GamePrepared(0, self._pages.texts.text("kiosk.practice_comes")))
            visit = _Visit(self._pages, self._clock, self._token, practice=True)
            done = await self._at_game(visit, self._games.practise(self._pages.run, step, visit))
            self._conductor.tell(EventKind.PRACTICE_PLAYED, self._pages.person, step, done.data, "program")
            if not visit.went_on:
                await self._read_result(visit, self._result("kiosk.practice_ended", step))
            if not done.missing:
                return
            if game + 1 < MOST_PRACTICE:
                text = words.practice_again(self._pages.texts, words.to_do(self._pages.texts, done.missing))
                await self._pages.read(TextToRead(0, self._pages.texts.text("kiosk.once_more"), text))

    async def play(self, step: PlannedStep, how: ResumeRule | None) -> None:
        """Run the game of a trial. After a crash, `how` is the rule for resuming it; if None, begin a new game."""
        visit = _Visit(self._pages, self._clock, self._token, practice=False)
        if self._pages.run.game is None:
            goes_on = how is ResumeRule.EXACT
            key = "kiosk.game_comes_back" if goes_on else "kiosk.game_comes"
            await self._pages.show(GamePrepared(0, self._pages.texts.text(key)))
            game = await self._at_game(visit, self._games.play(self._pages.run, step, visit, goes_on=goes_on))
            if game is not None:
                self._conductor.tell(EventKind.GAME_PLAYED, self._pages.person, step, game, "program")
        if not visit.went_on:
            await self._read_result(visit, self._result("kiosk.game_ended", step))

    def _result(self, heading: str, step: PlannedStep) -> GameRecorded:
        texts, progress = self._pages.texts, self._conductor.progress
        text = words.result_of_group(texts, progress, self._pages.person, step)
        return GameRecorded(0, texts.text(heading), text)

    async def _at_game(self, visit: "_Visit", game: Coroutine[object, object, PlayedT]) -> PlayedT:
        """Play a game to its end, unless the run or the program ends first."""
        try:
            played = await game
        except ParticipantDeclined as declined:
            visit.check()
            if declined.answered:
                self._conductor.leave(self._pages.person, "did not agree", declined=True)
            raise RunOver from None
        finally:
            self._clock.simulated = None
            self._pages.note_lag(0.0)
            await visit.done()
        visit.check()
        return played

    async def _read_result(self, visit: "_Visit", result: GameRecorded) -> None:
        """Show the result of a game until the person continues.

        If the window still shows the game, show the result on the same page.
        """
        if visit.page != self._pages.number or visit.page == 0:
            await self._pages.read(result)
            return
        await self._pages.window.send(structs.replace(result, page=self._pages.number, progress=self._pages.progress))
        while not isinstance(await self._pages.next_of_run(), WentOn):
            pass


class _Visit:
    """Visit of a person to one game; see `GameWatcher` for the methods."""

    def __init__(self, pages: KioskPages, clock: StudyClock, token: str, *, practice: bool) -> None:
        self._pages = pages
        self._clock = clock
        self._token = token
        self._practice = practice
        self._sending: list[asyncio.Task[None]] = []
        self._stopped: KioskStopped | None = None
        self._seen_end = False
        self._news = GameNews(0, -1)
        self._to_do: tuple[str, ...] = ()
        self.page = 0
        """Number of the game's page; 0 if the page has not been shown."""
        self.went_on = False
        """True after the person has left the game."""

    def ready(self, where: ListeningAddress) -> None:
        agreed_at = "" if self._practice else self._pages.run.agreed_at
        address, run = WILDCARD_ADDRESSES.get(where.host, where.host), self._pages.run
        seat = run.seats[run.step].seat if run.step in run.seats else ""
        self.page = self._send(
            GameToJoin(0, address, where.port, self._token, self._practice, agreed_at, to_do=self._to_do, seat=seat)
        )

    def passed(self, seconds: float, lag: float, left: float) -> None:
        self._clock.simulated = None if self._practice else seconds
        self._pages.note_lag(lag)
        news = GameNews(self.page, max(math.ceil(left), 0), self._to_do)
        if self.page != 0 and news != self._news:
            self._news = news
            self._say(news)

    def still_to_do(self, missing: Mapping[PracticeTerm, float]) -> None:
        self._to_do = words.to_do(self._pages.texts, missing)

    def time_is_up(self) -> None:
        self._send(GamePrepared(0, self._pages.texts.text("kiosk.time_is_up")))

    def has_left(self) -> bool:
        try:
            for message in self._pages.waiting():
                match message:
                    case GameSeenOver():
                        self._seen_end = True
                    case WentOn():
                        self.went_on = self._seen_end or not self._to_do
        except KioskStopped as stopped:
            self._stopped = stopped
        return self.went_on or self._stopped is not None or self._pages.run.state is not RunState.UNDER_WAY

    def has_seen_end(self) -> bool:
        return self._seen_end

    def broken_off(self, bag: Path | None) -> None:
        name = None if bag is None else bag.name
        if name is None or name not in self._pages.run.cut_off:
            self._pages.tell(EventKind.GAME_BROKEN_OFF, {"bag": name})

    def cut_off(self, bag: Path) -> None:
        if bag.name not in self._pages.run.cut_off:
            self._pages.tell(EventKind.RECORDING_CUT_OFF, {"bag": bag.name})

    def check(self) -> None:
        """Raise an exception if the run or the program has ended."""
        if self._stopped is not None:
            raise self._stopped
        self._pages.check()

    async def done(self) -> None:
        """Wait until all messages are sent."""
        await asyncio.gather(*self._sending, return_exceptions=True)

    def _send(self, page: Page) -> int:
        """Schedule showing a page, and return its number at once."""
        shown = self._pages.numbered(page)
        self._say(shown)
        return shown.page

    def _say(self, message: ToKiosk) -> None:
        self._sending = [task for task in self._sending if not task.done()]
        self._sending.append(asyncio.get_running_loop().create_task(self._pages.window.send(message)))
