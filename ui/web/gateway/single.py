"""Course of a visitor to a study file: rules, consent, one game, thanks."""

import asyncio
import hashlib
from collections.abc import Callable
from pathlib import Path

from thbridge.dialogue.wording.texts import Texts
from thbridge.roles.shared.notices import GameTexts
from thbridge.study.study_file import Study
from thbridge.timing.wall_clock import utc_now
from ui.command_line.settings import setting_of
from ui.hosting.games import offer_of
from ui.hosting.kiosk.words import headed
from ui.model.kiosk import (
    ConsentReply,
    ConsentToAsk,
    FromKiosk,
    GamePrepared,
    GameRecorded,
    GameToJoin,
    StudyTexts,
    TextToRead,
    ToKiosk,
    TurnToAwait,
    WentOn,
)
from ui.web.gateway.browser_window import BrowserWindow
from ui.web.gateway.entry import LinkEntry
from ui.web.gateway.game_queue import LONGEST_WAIT, GameQueue
from ui.web.gateway.people import Visitor
from ui.web.gateway.waiting import pause, show_turn
from ui.web.pool.messages import FromWorker, GamePassed, SeatWentOn
from ui.web.pool.pool import DeathCount, HostedGame, WorkerDied, WorkerPool
from ui.web.pool.single_game import SingleGame

MOST_ABSENCE = 300.0
"""Seconds without the person's browser after which their game ends."""
_DIGEST = 16


class SingleGames:
    """Games of a study file: each visitor plays one.

    Args:
        study: the study.
        file: its file, for relative paths.
        pool: pool of workers.
        queue: queue of people who wait for a game.
        new_bag: function that returns the path of a new recording.
        max_seconds: simulated seconds after which a game is stopped.

    Attributes:
        texts: texts of the study's language.
    """

    def __init__(
        self,
        study: Study,
        file: Path | None,
        pool: WorkerPool,
        queue: GameQueue,
        new_bag: Callable[[], Path],
        max_seconds: float,
    ) -> None:
        self._study, self._file = study, file
        self._setting = setting_of(study, file)
        self.texts: Texts = self._setting.texts.in_browser()
        self._pool = pool
        self._queue = queue
        self._new_bag = new_bag
        self._max_seconds = max_seconds

    def window(self) -> BrowserWindow:
        """Return a window in the study's language."""
        return BrowserWindow(self.texts)

    def greet(self, secret: str, _entry: LinkEntry) -> ToKiosk | None:
        """Return the first page of a visitor; None if their game has begun."""
        return None if self._has_begun(_key(secret)) else self._consent() or self._rules(1)

    async def visit(self, visitor: Visitor) -> None:
        """Take a visitor through the course, or lead them back to their game."""
        window = visitor.window
        await window.send(StudyTexts(GameTexts.of(self.texts)))
        key = _key(visitor.secret)
        page, agreed_at = 1, ""
        if not self._has_begun(key):
            before = await self._prepare(window)
            if before is None:
                return
            page, agreed_at = before
            await self._await_turn(window, key, page)
            page += 1
        await self._play(window, key, page, agreed_at)

    async def _prepare(self, window: BrowserWindow) -> tuple[int, str] | None:
        """Show rules and consent; return the number of the next page and the time of consent, or None if declined."""
        texts = self.texts
        page, agreed_at = 1, ""
        if (consent := self._consent()) is not None:
            await window.send(consent)
            reply = await _about(window, page)
            while not isinstance(reply, ConsentReply):
                reply = await _about(window, page)
            if not reply.agrees:
                await window.send(TextToRead(0, texts.text("pages.thanks"), texts.text("pages.not_taking_part"), ""))
                return None
            agreed_at = utc_now()
            page += 1
        await window.send(self._rules(page))
        while not isinstance(await _about(window, page), WentOn):
            pass
        return page + 1, agreed_at

    def _consent(self) -> ConsentToAsk | None:
        """Return the page that asks for consent; None if the study asks for none."""
        text = offer_of(self._setting, given=True).consent
        return ConsentToAsk(1, text) if text else None

    def _rules(self, page: int) -> TextToRead:
        """Return the page with the rules of the game."""
        texts, offer = self.texts, offer_of(self._setting, given=True)
        rules = "\n\n".join((texts.text("start.introduction"), *offer.rules))
        return TextToRead(page, texts.text("window.title"), rules, texts.text("start.begin", count=offer.usual))

    def _has_begun(self, key: str) -> bool:
        return self._pool.games.is_running(key) or self._pool.games.result(key) is not None

    async def _await_turn(self, window: BrowserWindow, key: str, page: int) -> None:
        """Let the visitor wait until their game can start."""
        texts, queue, waiting = self.texts, self._queue, True
        while waiting:
            queue.enter(key)
            try:
                waiting = not await show_turn(
                    TurnToAwait(page, *headed(texts, "waiting_for_game", "web")),
                    window,
                    lambda: _about(window, page),
                    lambda: queue.is_closed or queue.admits(key),
                    lambda: queue.before(key),
                    LONGEST_WAIT,
                )
            finally:
                queue.leave(key)
            if waiting:
                heading, text = headed(texts, "game_not_awaited", "web")
                await window.send(TextToRead(page, heading, text, texts.text("web.wait_again")))
                while not isinstance(await _about(window, page), WentOn):
                    pass
        if queue.is_closed:
            await pause(window, texts)

    async def _play(self, window: BrowserWindow, key: str, page: int, agreed_at: str) -> None:
        texts = self.texts
        await window.send(GamePrepared(page, texts.text("pages.preparing", count=self._study.robots)))
        request = SingleGame(self._study, self._file, self._new_bag(), False, agreed_at, self._max_seconds)
        went_on, deaths = False, DeathCount()

        def news(message: FromWorker) -> None:
            nonlocal went_on
            match message:
                case SeatWentOn():
                    went_on = True
                case GamePassed(seconds):
                    deaths.reached = seconds
                case _:
                    pass

        while not deaths.are_too_many:
            try:
                if self._pool.games.result(key) is None:
                    await self._play_once(window, key, page + 1, request, news)
                break
            except WorkerDied:
                deaths.add()  # Another worker resumes the game.
        else:
            stopped = texts.text("kiosk.program_stopped")
            await window.send(TextToRead(0, stopped, texts.text("kiosk.cannot_go_on"), ""))
            return
        self._pool.games.forget(key)
        ended = texts.text("kiosk.game_ended")
        if not went_on:
            await window.send(GameRecorded(page + 2, ended, texts.text("kiosk.go_on_when_ready")))
            while not isinstance(await _about(window, page + 2), WentOn):
                pass
        await window.send(TextToRead(0, texts.text("pages.thanks"), texts.text("web.played"), ""))

    async def _play_once(
        self, window: BrowserWindow, key: str, page: int, request: SingleGame, news: Callable[[FromWorker], None]
    ) -> None:
        async with self._pool.enter(key, request, window.show, news) as game:
            window.has_place = True
            window.play(game)
            await window.send(GameToJoin(page, "", 0, "", practice=False))
            watching = asyncio.create_task(_watch(window, game))
            try:
                await game.ended()
            finally:
                watching.cancel()
                window.play(None)
                window.has_place = False


def _key(secret: str) -> str:
    """Return the key of a visitor's game."""
    return f"visitor-{hashlib.sha256(secret.encode()).hexdigest()[:_DIGEST]}"


async def _watch(window: BrowserWindow, game: HostedGame) -> None:
    """End a game whose person does not come back."""
    while window.absence < MOST_ABSENCE:
        await asyncio.sleep(1.0)
    game.leave()


async def _about(window: BrowserWindow, page: int) -> FromKiosk:
    """Return the next message about a page."""
    while True:
        message = await window.next_request()
        if getattr(message, "page", page) == page:
            return message
