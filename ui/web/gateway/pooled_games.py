"""Games of a study in workers, as a person's course through the study sees them."""

import asyncio
from collections.abc import Callable, Mapping
from contextlib import AsyncExitStack, suppress
from dataclasses import dataclass, replace
from pathlib import Path
from typing import cast

import msgspec

from thbridge.app.consent import ParticipantDeclined
from thbridge.experiment.design.plan import PlannedStep
from thbridge.experiment.design.steps import PracticeTerm
from thbridge.experiment.progress import Run
from thbridge.experiment.store.events import EventKind, JsonValue
from thbridge.files.errors import BadFile
from thbridge.sockets.addresses import ListeningAddress
from ui.hosting.kiosk import words
from ui.hosting.kiosk.games import GameWatcher
from ui.hosting.kiosk.pages import KioskPages
from ui.model.kiosk import GamePrepared, TextToRead
from ui.web.gateway.browser_window import BrowserWindow
from ui.web.gateway.game_queue import LONGEST_WAIT, GameQueue
from ui.web.gateway.waiting import await_turn, pause
from ui.web.pool.messages import (
    FromWorker,
    GamePassed,
    GameReady,
    GameWatched,
    PersonActed,
    RecordingBrokenOff,
    RecordingCutOff,
    SeatSeenOver,
    SeatWentOn,
    StillToDo,
    TimeIsUp,
    WorkerResult,
)
from ui.web.pool.pool import MOST_DEATHS, DeathCount, WorkerDied, WorkerPool
from ui.web.pool.study_game import StudyGame

LATE = 3.0
"""Seconds without a worker after which the person sees that their game will come back."""
LOOK = 0.1
"""Seconds between two looks if the person has left the game."""


@dataclass(frozen=True, slots=True)
class PlayedPractice:
    """Counts of a practice game; the attributes are those of `PracticeCount`."""

    data: dict[str, JsonValue]
    missing: Mapping[PracticeTerm, float]


class PooledGames:
    """Games of one person; it implements `GamesOfStudy`.

    Args:
        folder: folder of the study.
        pool: pool of workers.
        queue: queue of people who wait for a game.
        window: browser of the person.
        pages: pages of the person.
    """

    def __init__(
        self, folder: Path, pool: WorkerPool, queue: GameQueue, window: BrowserWindow, pages: KioskPages
    ) -> None:
        self._folder = folder
        self._pool = pool
        self._queue = queue
        self._window = window
        self._pages = pages

    async def practise(self, run: Run, step: PlannedStep, watcher: GameWatcher) -> PlayedPractice:
        """See `StudyGames`."""
        key = f"{game_key(run, step)}-practice"
        result = await self._play(key, StudyGame(self._folder, run, step, True, False, ""), watcher)
        self._pool.games.forget(key)
        played = cast("dict[str, dict[str, JsonValue]]", result)
        missing = {PracticeTerm(term): cast(float, number) for term, number in played["missing"].items()}
        return PlayedPractice(played["data"], missing)

    async def play(
        self, run: Run, step: PlannedStep, watcher: GameWatcher, *, goes_on: bool
    ) -> dict[str, JsonValue] | None:
        """See `StudyGames`."""
        key = game_key(run, step)
        if not goes_on:
            await self._pool.end(key)
        result = await self._play(key, StudyGame(self._folder, run, step, False, goes_on, run.agreed_at), watcher)
        return cast("dict[str, JsonValue] | None", result)

    async def _play(self, key: str, request: StudyGame, watcher: GameWatcher) -> JsonValue:
        """Play a game, or continue one that is running; if its worker dies, another one resumes it."""
        if not (self._pool.games.is_running(key) or self._pool.games.result(key)):
            await self._await_turn(key)
        deaths = DeathCount()
        while not deaths.are_too_many:
            try:
                # A server that was killed may have left a result that is not in the log yet.
                ended = self._pool.games.result(key) or await self._play_once(key, request, watcher, deaths)
            except WorkerDied:
                deaths.add()
                request = replace(request, goes_on=not request.practice)
                continue
            if ended.problem:
                raise BadFile(self._folder, ended.problem, "See `thbridge study status`")
            if ended.declined:
                raise ParticipantDeclined(True)
            return cast(JsonValue, msgspec.json.decode(ended.result))
        problem = f"the programs of {MOST_DEATHS} games in a row have ended unexpectedly"
        raise BadFile(self._folder, problem, "See the messages above; `thbridge doctor` checks this machine")

    async def _await_turn(self, key: str) -> None:
        """Let the person wait until their game can start."""
        queue, texts = self._queue, self._pages.texts
        prepared = self._pages.number
        waiting = True
        while waiting:
            queue.enter(key)
            try:
                waiting = not await await_turn(
                    self._pages,
                    words.headed(texts, "waiting_for_game", "web"),
                    lambda: queue.is_closed or queue.admits(key),
                    lambda: queue.before(key),
                    LONGEST_WAIT,
                )
            finally:
                queue.leave(key)
            if waiting:
                heading, text = words.headed(texts, "game_not_awaited", "web")
                await self._pages.read(TextToRead(0, heading, text, button=texts.text("web.wait_again")))
        if queue.is_closed:
            await pause(self._window, texts)
        if self._pages.number != prepared:
            await self._pages.show(GamePrepared(0, texts.text("kiosk.game_comes")))

    async def _play_once(self, key: str, request: StudyGame, watcher: GameWatcher, deaths: DeathCount) -> WorkerResult:
        loop = asyncio.get_running_loop()

        def news(message: FromWorker) -> None:
            match message:
                case GameReady():
                    # The browser is connected through the worker, not through the text server.
                    watcher.ready(ListeningAddress("", 0))
                case GameWatched(port):
                    self._window.watch_port, self._window.watch_host = port, self._pool.games.remote_host(key)
                case SeatSeenOver():
                    # If the worker was running already, the page of the game is sent before.
                    loop.call_soon(self._window.note_seen_over)
                case SeatWentOn():
                    loop.call_soon(self._window.note_went_on)
                case GamePassed(seconds, lag, left):
                    deaths.reached = seconds
                    watcher.passed(seconds, lag, left)
                case PersonActed(act, view_age):
                    self._pages.tell(EventKind.ACTED, {"act": act, "view_age_ms": round(view_age, 1)})
                case StillToDo(missing):
                    watcher.still_to_do({PracticeTerm(term): number for term, number in missing.items()})
                case TimeIsUp():
                    watcher.time_is_up()
                case RecordingBrokenOff(bag):
                    watcher.broken_off(None if bag is None else Path(bag))
                case RecordingCutOff(bag):
                    watcher.cut_off(Path(bag))
                case _:
                    pass

        entering = self._pool.enter(key, request, self._window.show, news)
        late = asyncio.create_task(self._say_when_late(comes_back=request.goes_on))
        async with AsyncExitStack() as stack:
            try:
                game = await stack.enter_async_context(entering)
            finally:
                late.cancel()
            self._window.play(game)
            looking = asyncio.create_task(_look(watcher, game.leave))
            try:
                ended = await game.ended()
                # The last messages, for example that the person continues, reach the person's course first.
                await asyncio.sleep(LOOK)
                watcher.has_left()
                return ended
            finally:
                self._window.play(None)
                looking.cancel()
                with suppress(asyncio.CancelledError):
                    await looking

    async def _say_when_late(self, *, comes_back: bool) -> None:
        """Show the person after a while that their interrupted game comes back."""
        await asyncio.sleep(LATE)
        if comes_back:
            await self._pages.show(GamePrepared(0, self._pages.texts.text("kiosk.game_comes_back")))


def game_key(run: Run, step: PlannedStep) -> str:
    """Return the key of a person's game at a step; each attempt at a step has its own game."""
    return f"{run.participant}-{step.number}-{run.begun.get(step.number, 1)}"


async def _look(watcher: GameWatcher, leave: Callable[[], None]) -> None:
    """End the game once the person has left it."""
    while not watcher.has_left():
        await asyncio.sleep(LOOK)
    leave()
