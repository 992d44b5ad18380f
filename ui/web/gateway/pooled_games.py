"""Games of a study in workers, as a person's course through the study sees them."""

import asyncio
from collections.abc import AsyncIterator, Callable, Mapping
from contextlib import AbstractAsyncContextManager, AsyncExitStack, asynccontextmanager
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
from ui.web.gateway.game_queue import LONGEST_WAIT, GameQueue
from ui.web.gateway.group_games import GroupGames
from ui.web.gateway.players_window import PlayersWindow
from ui.web.gateway.waiting import await_turn, pause
from ui.web.pool.messages import (
    FromWorker,
    GamePassed,
    GameReady,
    GameWatched,
    PersonActed,
    RecordingBrokenOff,
    RecordingCutOff,
    SeatDeclined,
    SeatSeenOver,
    SeatWentOn,
    StillToDo,
    TimeIsUp,
    WorkerResult,
)
from ui.web.pool.pool import MOST_DEATHS, DeathCount, HostedGame, WorkerDied, WorkerPool
from ui.web.pool.study_game import StudyGame, seats_at_windows

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
        groups: games of groups.
        window: browser or window of the person.
        pages: pages of the person.
    """

    def __init__(
        self,
        folder: Path,
        pool: WorkerPool,
        queue: GameQueue,
        groups: GroupGames,
        window: PlayersWindow,
        pages: KioskPages,
    ) -> None:
        self._folder = folder
        self._pool = pool
        self._queue = queue
        self._groups = groups
        self._window = window
        self._pages = pages

    async def practise(self, run: Run, step: PlannedStep, watcher: GameWatcher) -> PlayedPractice:
        """See `StudyGames`. A group plays one practice game, also if it does not reach all goals."""
        if self._groups.has(run, step):
            played = cast("dict[str, dict[str, JsonValue]]", await self._play_together(step, watcher))
            return PlayedPractice(played["data"], {})
        key = f"{game_key(run, step)}-practice"
        request = StudyGame(self._folder, run, step, True, False, {"": ""}, windows=seats_at_windows({"": run}))
        result = await self._play(key, request, watcher)
        self._pool.games.forget(key)
        played = cast("dict[str, dict[str, JsonValue]]", result)
        missing = {PracticeTerm(term): cast(float, number) for term, number in played["missing"].items()}
        return PlayedPractice(played["data"], missing)

    async def play(
        self, run: Run, step: PlannedStep, watcher: GameWatcher, *, goes_on: bool
    ) -> dict[str, JsonValue] | None:
        """See `StudyGames`. The runner of a group's game logs it, so its entry is not returned."""
        if self._groups.has(run, step):
            await self._play_together(step, watcher)
            if self._pages.run.game is None:
                await self._groups.pass_over(self._pages, step)
            return None
        key = game_key(run, step)
        if not goes_on:
            await self._pool.end(key)
        windows = seats_at_windows({"": run})
        request = StudyGame(self._folder, run, step, False, goes_on, {"": run.agreed_at}, windows=windows)
        result = await self._play(key, request, watcher)
        return cast("dict[str, JsonValue] | None", result)

    async def _play_together(self, step: PlannedStep, watcher: GameWatcher) -> JsonValue:
        """Play the game of the person's group to its end; return the worker's result.

        Raises:
            ParticipantDeclined: the person did not agree to the study's own consent text.
            RunOver: the person's run has ended meanwhile.
            StepOver: see `GroupGames.join`.
        """
        pages, declined = self._pages, False
        group = await self._groups.join(pages, step, lambda: self._window.is_connected)
        seat, has_died = group.seat_of(pages.person), False

        def seen(message: FromWorker) -> None:
            nonlocal declined
            if isinstance(message, SeatSeenOver):
                group.note_seen_over()
            declined = declined or isinstance(message, SeatDeclined)

        # A game with a result has ended, even if the runner has not logged it yet.
        while not (group.is_over or self._pool.games.result(group.key)):
            request = await group.request()
            receive = self._receiver(group.key, watcher, DeathCount(), seen)
            entering = self._pool.enter(group.key, request, self._window.show, receive, seat)
            try:
                async with self._shown(entering, watcher, comes_back=has_died) as (ending, leaving):
                    # The others may play on after the person has left.
                    await asyncio.wait((ending, leaving), return_when=asyncio.FIRST_COMPLETED)
                    if ending.done():
                        await ending
                        await _process_last(watcher)
                break
            except WorkerDied:
                has_died = True  # The runner of the game counts the deaths.
        if declined:
            raise ParticipantDeclined(True)
        pages.check()
        return await group.ended()

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
            await pause(self._pages.window, texts)
        if self._pages.number != prepared:
            await self._pages.show(GamePrepared(0, texts.text("kiosk.game_comes")))

    async def _play_once(self, key: str, request: StudyGame, watcher: GameWatcher, deaths: DeathCount) -> WorkerResult:
        entering = self._pool.enter(key, request, self._window.show, self._receiver(key, watcher, deaths))
        async with self._shown(entering, watcher, comes_back=request.goes_on) as (ending, _):
            ended = await ending
            await _process_last(watcher)
            return ended

    def _receiver(
        self, key: str, watcher: GameWatcher, deaths: DeathCount, seen: Callable[[FromWorker], None] | None = None
    ) -> Callable[[FromWorker], None]:
        """Return the function that receives the messages of a game's worker; `seen` also receives them."""
        loop = asyncio.get_running_loop()

        def receive(message: FromWorker) -> None:
            if seen is not None:
                seen(message)
            match message:
                case GameReady(host, port):
                    # A browser is connected through the worker, not through the text server.
                    watcher.ready(ListeningAddress(host, port))
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

        return receive

    @asynccontextmanager
    async def _shown(
        self, entering: AbstractAsyncContextManager[HostedGame], watcher: GameWatcher, *, comes_back: bool
    ) -> AsyncIterator[tuple[asyncio.Task[WorkerResult], asyncio.Task[None]]]:
        """Show a game inside this context. Yield a task that ends with the game, and one that ends when the person
        leaves it.

        Args:
            entering: connection to the game.
            watcher: host of the person.
            comes_back: True if the person has seen the game before.
        """
        late = asyncio.create_task(self._say_when_late(comes_back=comes_back))
        async with AsyncExitStack() as stack:
            try:
                game = await stack.enter_async_context(entering)
            finally:
                late.cancel()
            self._window.play(game)
            tasks = asyncio.create_task(game.ended()), asyncio.create_task(_look(watcher, game.leave))
            try:
                yield tasks
            finally:
                self._window.play(None)
                for task in tasks:
                    task.cancel()
                await asyncio.gather(*tasks, return_exceptions=True)

    async def _say_when_late(self, *, comes_back: bool) -> None:
        """Show the person after a while that their interrupted game comes back."""
        await asyncio.sleep(LATE)
        if comes_back:
            await self._pages.show(GamePrepared(0, self._pages.texts.text("kiosk.game_comes_back")))


def game_key(run: Run, step: PlannedStep) -> str:
    """Return the key of a person's game at a step; each attempt at a step has its own game."""
    return f"{run.participant}-{step.number}-{run.begun.get(step.number, 1)}"


async def _process_last(watcher: GameWatcher) -> None:
    """Let the last messages, for example that the person continues, reach the person's course."""
    await asyncio.sleep(LOOK)
    watcher.has_left()


async def _look(watcher: GameWatcher, leave: Callable[[], None]) -> None:
    """End the game once the person has left it."""
    while not watcher.has_left():
        await asyncio.sleep(LOOK)
    leave()
