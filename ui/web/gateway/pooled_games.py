"""Games of a study in workers, as a person's course through the study sees them."""

import asyncio
from collections.abc import Callable, Mapping
from contextlib import suppress
from dataclasses import dataclass, replace
from pathlib import Path
from typing import cast

import msgspec

from thbridge.app.consent import ParticipantDeclined
from thbridge.experiment.design.plan import PlannedStep
from thbridge.experiment.design.steps import PracticeTerm
from thbridge.experiment.progress import Run
from thbridge.experiment.store.events import JsonValue
from thbridge.files.errors import BadFile
from thbridge.sockets.addresses import ListeningAddress
from ui.hosting.kiosk.games import GameWatcher
from ui.web.gateway.browser_window import BrowserWindow
from ui.web.pool.messages import (
    FromWorker,
    GamePassed,
    GameReady,
    RecordingBrokenOff,
    RecordingCutOff,
    SeatSeenOver,
    SeatWentOn,
    StillToDo,
    TimeIsUp,
)
from ui.web.pool.pool import WorkerDied, WorkerPool
from ui.web.pool.study_game import StudyGame

LOOK = 0.1
"""Seconds between two looks if the person has left the game."""
MOST_DEATHS = 5
"""Number of workers of one game that may die; then the game counts as impossible."""


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
        window: browser of the person.
    """

    def __init__(self, folder: Path, pool: WorkerPool, window: BrowserWindow) -> None:
        self._folder = folder
        self._pool = pool
        self._window = window

    async def practise(self, run: Run, step: PlannedStep, watcher: GameWatcher) -> PlayedPractice:
        """See `StudyGames`."""
        result = await self._play(StudyGame(self._folder, run, step, True, False, ""), watcher)
        played = cast("dict[str, dict[str, JsonValue]]", result)
        missing = {PracticeTerm(term): cast(float, number) for term, number in played["missing"].items()}
        return PlayedPractice(played["data"], missing)

    async def play(
        self, run: Run, step: PlannedStep, watcher: GameWatcher, *, goes_on: bool
    ) -> dict[str, JsonValue] | None:
        """See `StudyGames`."""
        result = await self._play(StudyGame(self._folder, run, step, False, goes_on, run.agreed_at), watcher)
        return cast("dict[str, JsonValue] | None", result)

    async def _play(self, request: StudyGame, watcher: GameWatcher) -> JsonValue:
        """Play a game; if its worker dies, another one resumes it."""
        for _ in range(MOST_DEATHS):
            try:
                return await self._play_once(request, watcher)
            except WorkerDied:
                request = replace(request, goes_on=not request.practice)
        problem = f"the programs of {MOST_DEATHS} games in a row have ended unexpectedly"
        raise BadFile(self._folder, problem, "See the messages above; `thbridge doctor` checks this machine")

    async def _play_once(self, request: StudyGame, watcher: GameWatcher) -> JsonValue:
        def news(message: FromWorker) -> None:
            match message:
                case GameReady():
                    # The browser is connected through the worker, not through the text server.
                    watcher.ready(ListeningAddress("", 0))
                case SeatSeenOver():
                    self._window.note_seen_over()
                case SeatWentOn():
                    self._window.note_went_on()
                case GamePassed(seconds, lag, left):
                    watcher.passed(seconds, lag, left)
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

        async with self._pool.start(request, self._window.show, news) as game:
            self._window.play(game)
            looking = asyncio.create_task(_look(watcher, game.leave))
            try:
                ended = await game.ended()
            finally:
                self._window.play(None)
                looking.cancel()
                with suppress(asyncio.CancelledError):
                    await looking
        if ended.problem:
            raise BadFile(self._folder, ended.problem, "See `thbridge study status`")
        if ended.declined:
            raise ParticipantDeclined(True)
        return cast(JsonValue, msgspec.json.decode(ended.result))


async def _look(watcher: GameWatcher, leave: Callable[[], None]) -> None:
    """End the game once the person has left it."""
    while not watcher.has_left():
        await asyncio.sleep(LOOK)
    leave()
