"""Kiosk of a served study: people take part at a window on the server's machine while others take part in browsers."""

import asyncio
from collections.abc import AsyncIterator, Callable
from contextlib import asynccontextmanager
from pathlib import Path

from thbridge.app.compose.setting import texts_of
from thbridge.experiment.conductor import Conductor
from thbridge.experiment.design.experiment_file import ExperimentDesign
from ui.hosting.kiosk.game_steps import StudyClock
from ui.hosting.kiosk.host import KioskHost
from ui.hosting.kiosk.pages import KioskPages, WindowOfKiosk
from ui.model.kiosk import FromKiosk, GameSeenOver, ToKiosk
from ui.web.gateway.game_queue import GameQueue
from ui.web.gateway.group_games import GroupGames
from ui.web.gateway.players_window import PlayersWindow
from ui.web.gateway.pooled_games import PooledGames
from ui.web.pool.pool import WorkerPool

_CLOSED = (
    "The window of the study is closed. People in browsers go on. To open the window again, stop this command, and "
    "start it again."
)


class KioskAtGateway(PlayersWindow):
    """Window on the server's machine, which joins games of the pool itself; it implements `WindowOfKiosk`.

    Args:
        window: the window.
    """

    def __init__(self, window: WindowOfKiosk) -> None:
        super().__init__()
        self._window = window

    async def send(self, message: ToKiosk) -> None:
        """See `WindowOfKiosk`."""
        await self._window.send(message)

    async def next_request(self) -> FromKiosk:
        """See `WindowOfKiosk`. If the window shows the end of a game, report it to the game's worker as well."""
        message = await self._window.next_request()
        if isinstance(message, GameSeenOver) and self._game is not None:
            self._game.note_seen_over()
        return message

    @asynccontextmanager
    async def opened(self) -> AsyncIterator[None]:
        """See `WindowOfKiosk`."""
        async with self._window.opened():
            yield

    def leave_open(self) -> None:
        """See `WindowOfKiosk`."""
        self._window.leave_open()


class ServedKiosk:
    """Kiosk of a served study, at which one person after the other takes part.

    Args:
        folder: folder of the study.
        design: its design.
        conductor: its conductor, which uses `clock`.
        clock: clock of the log's events.
        pool: pool of workers.
        queue: queue of people who wait for a game.
        groups: games of groups.
        window: window on this machine.
        report: function that receives sentences about problems, for the researcher.

    Attributes:
        window: the window, as games see it.
        pages: its pages.
    """

    def __init__(
        self,
        folder: Path,
        design: ExperimentDesign,
        conductor: Conductor,
        clock: StudyClock,
        pool: WorkerPool,
        queue: GameQueue,
        groups: GroupGames,
        window: WindowOfKiosk,
        report: Callable[[str], None],
    ) -> None:
        self._report = report
        self.window = KioskAtGateway(window)
        self.pages = KioskPages(conductor, self.window, texts_of(design.study, design.beside))
        games = PooledGames(folder, pool, queue, groups, self.window, self.pages)
        self._host = KioskHost(
            design, conductor, self.window, games, clock, self.pages, is_closed=lambda: queue.is_closed
        )
        self._hosting: asyncio.Task[None] | None = None

    @asynccontextmanager
    async def opened(self) -> AsyncIterator[None]:
        """Lead people at the window through the study inside this context, or until `close` is called."""
        self._hosting = asyncio.create_task(self._host.run())
        self._hosting.add_done_callback(self._ended)
        try:
            yield
        finally:
            await self.close()

    async def close(self) -> None:
        """Close the window; if a person is in the middle of the study, leave it open with a message instead."""
        if self._hosting is not None:
            self._hosting.cancel()
            await asyncio.gather(self._hosting, return_exceptions=True)

    @property
    def person(self) -> str:
        """Id of the participant at the window; empty if there is none, or if the window is closed."""
        return self.pages.person if self._hosting is not None and not self._hosting.done() else ""

    def _ended(self, hosting: asyncio.Task[None]) -> None:
        """Report that the window is closed while the server runs."""
        if not hosting.cancelled():
            error = hosting.exception()
            self._report(_CLOSED if error is None else str(error))
