"""Course of a visitor to a study file: rules, consent, one game, thanks."""

import asyncio
from collections.abc import Callable
from pathlib import Path

from thbridge.dialogue.wording.texts import Texts
from thbridge.roles.shared.notices import GameTexts
from thbridge.study.study_file import Study
from thbridge.timing.wall_clock import utc_now
from ui.command_line.settings import setting_of
from ui.hosting.games import offer_of
from ui.model.kiosk import (
    ConsentReply,
    ConsentToAsk,
    FromKiosk,
    GamePrepared,
    GameRecorded,
    GameToJoin,
    StudyTexts,
    TextToRead,
    WentOn,
)
from ui.web.gateway.browser_window import BrowserWindow
from ui.web.pool.messages import FromWorker, SeatWentOn
from ui.web.pool.pool import HostedGame, WorkerDied, WorkerPool
from ui.web.pool.single_game import SingleGame

MOST_ABSENCE = 300.0
"""Seconds without the person's browser after which their game ends."""


class SingleGames:
    """Games of a study file: each visitor plays one.

    Args:
        study: the study.
        file: its file, for relative paths.
        pool: pool of workers.
        new_bag: function that returns the path of a new recording.
        max_seconds: simulated seconds after which a game is stopped.
    """

    def __init__(
        self, study: Study, file: Path | None, pool: WorkerPool, new_bag: Callable[[], Path], max_seconds: float
    ) -> None:
        self._study, self._file = study, file
        self._setting = setting_of(study, file)
        self._pool = pool
        self._new_bag = new_bag
        self._max_seconds = max_seconds

    @property
    def texts(self) -> Texts:
        """Texts of the study's language."""
        return self._setting.texts

    def window(self) -> BrowserWindow:
        """Return a window in the study's language."""
        return BrowserWindow(self._setting.texts)

    async def visit(self, window: BrowserWindow, _secret: str) -> None:
        """Take a visitor through the course."""
        texts = self._setting.texts
        offer = offer_of(self._setting, given=True)
        await window.send(StudyTexts(GameTexts.of(texts)))
        agreed_at = ""
        page = 1
        if offer.consent:
            await window.send(ConsentToAsk(page, offer.consent))
            reply = await _about(window, page)
            while not isinstance(reply, ConsentReply):
                reply = await _about(window, page)
            if not reply.agrees:
                await window.send(TextToRead(0, texts.text("pages.thanks"), texts.text("pages.not_taking_part"), ""))
                return
            agreed_at = utc_now()
            page += 1
        rules = "\n\n".join((texts.text("start.introduction"), *offer.rules))
        begin = texts.text("start.begin", count=offer.usual)
        await window.send(TextToRead(page, texts.text("window.title"), rules, begin))
        while not isinstance(await _about(window, page), WentOn):
            pass
        await self._play(window, page + 1, agreed_at)

    async def _play(self, window: BrowserWindow, page: int, agreed_at: str) -> None:
        texts = self._setting.texts
        await window.send(GamePrepared(page, texts.text("pages.preparing", count=self._study.robots)))
        request = SingleGame(self._study, self._file, self._new_bag(), False, agreed_at, self._max_seconds)
        went_on = False

        def news(message: FromWorker) -> None:
            nonlocal went_on
            went_on |= isinstance(message, SeatWentOn)

        window.has_place = True
        try:
            async with self._pool.start(request, window.show, news) as game:
                window.play(game)
                await window.send(GameToJoin(page + 1, "", 0, "", practice=False))
                watching = asyncio.create_task(_watch(window, game))
                try:
                    await game.ended()
                finally:
                    watching.cancel()
        except WorkerDied:
            stopped = texts.text("kiosk.program_stopped")
            await window.send(TextToRead(0, stopped, texts.text("kiosk.cannot_go_on"), ""))
            return
        finally:
            window.has_place = False
            window.play(None)
        ended = texts.text("kiosk.game_ended")
        if not went_on:
            await window.send(GameRecorded(page + 2, ended, texts.text("kiosk.go_on_when_ready")))
            while not isinstance(await _about(window, page + 2), WentOn):
                pass
        await window.send(TextToRead(0, texts.text("pages.thanks"), texts.text("web.played"), ""))


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
