"""Pool of workers on this machine: each is forked from a warm process, so that a game starts within a second.

Workers outlive the server that has started them. The next server of the same folder connects to them.
"""

import asyncio
import multiprocessing
import os
import signal
from collections.abc import AsyncIterator, Callable
from contextlib import asynccontextmanager, suppress
from functools import partial
from multiprocessing.context import ForkServerContext

import msgspec

from ui.web.pool.messages import (
    FROM_WORKER,
    LONGEST_LINE,
    BrowserJoined,
    BrowserLeft,
    FromBrowser,
    FromWorker,
    GatewayHello,
    PersonLeft,
    ToBrowser,
    ToWorker,
    WatchWanted,
    WorkerResult,
    encode_line,
)
from ui.web.pool.running_games import RunningGames
from ui.web.pool.worker import GameRequest, work

START_TIMEOUT = 30.0
"""Seconds for a worker to open its socket."""
END_TIMEOUT = 10.0
"""Seconds for a worker to end its game and to close its files."""
HOLD_TIMEOUT = 300.0
"""Seconds for which the games of an earlier server wait for their people."""
MOST_DEATHS = 5
"""Number of a game's workers that may die in a row at the same time of the game."""
LOOK = 0.02
"""Seconds between two looks for a worker."""


class DeathCount:
    """Number of a game's workers that have died in a row, at the same time of the game.

    Attributes:
        reached: simulated time of the game, seconds.
    """

    def __init__(self) -> None:
        self.reached = 0.0
        self._at = -1.0
        self._number = 0

    def add(self) -> None:
        """Count a death."""
        self._number = self._number + 1 if self.reached <= self._at else 1
        self._at = self.reached

    @property
    def are_too_many(self) -> bool:
        """True if the game counts as impossible."""
        return self._number >= MOST_DEATHS


class WorkerDied(Exception):  # noqa: N818 - the game is resumed
    """The worker's process has ended without a result."""


class HostedGame:
    """Game in a worker, as the gateway sees it.

    Args:
        reader: connection to the worker.
        writer: connection to the worker.
        shown: function that receives messages for the browser.

    Attributes:
        news: function that receives all other messages.
        over: True after the worker has sent its result.
    """

    def __init__(
        self,
        reader: asyncio.StreamReader,
        writer: asyncio.StreamWriter,
        shown: Callable[[str], None],
        news: Callable[[FromWorker], None],
    ) -> None:
        self._reader, self._writer = reader, writer
        self._shown, self.news = shown, news
        self._stream = 0
        self.over = False

    def join(self, *, again: bool = False) -> None:
        """Let the browser show the game from its present state on; `again` is as in `BrowserJoined`."""
        self._stream += 1
        self._send(BrowserJoined(self._stream, again))

    def part(self) -> None:
        """Note that no browser shows the game."""
        self._send(BrowserLeft())

    def pass_on(self, text: str) -> None:
        """Pass on a message of the browser."""
        self._send(FromBrowser(text))

    def watch(self) -> None:
        """Let researchers' windows connect to the game."""
        self._send(WatchWanted())

    def leave(self) -> None:
        """End the game, because its person has left."""
        self._send(PersonLeft())

    async def ended(self) -> WorkerResult:
        """Pass on all messages until the game has ended.

        Raises:
            WorkerDied: the worker has ended without a result.
        """
        try:
            while line := await self._reader.readline():
                message = FROM_WORKER.decode(line)
                match message:
                    case ToBrowser(text, stream):
                        if stream == self._stream:
                            self._shown(text)
                    case WorkerResult():
                        self.over = True
                        return message
                    case _:
                        self.news(message)
        except (ConnectionError, ValueError, msgspec.MsgspecError):
            pass
        raise WorkerDied

    def _send(self, message: ToWorker) -> None:
        if not self._writer.is_closing():
            self._writer.write(encode_line(message))


class WorkerPool:
    """Pool that starts a worker for each game, or finds the worker that plays it already.

    Args:
        games: the running games.
        most: greatest number of games at the same time.
    """

    def __init__(self, games: RunningGames, most: int) -> None:
        self.games = games
        self._most = most
        self._context: ForkServerContext = multiprocessing.get_context("forkserver")
        self._context.set_forkserver_preload(["ui.web.pool.warm"])
        self._entered: set[str] = set()
        self._held: list[asyncio.Task[None]] = []

    @property
    def free(self) -> int:
        """Number of games that can still start."""
        return self._most - len({*self.games, *self._entered})

    async def warm_up(self) -> None:
        """Start the process from which workers are forked, and wait until it is ready."""
        await asyncio.to_thread(self._run, _nothing)

    async def hold(self) -> None:
        """Connect to the games of an earlier server, so that they wait for their people; call this before any other.

        The connection ends when `enter` connects to the game, and after `HOLD_TIMEOUT`.
        """
        for key in [*self.games]:
            with suppress(WorkerDied, TimeoutError):
                async with asyncio.timeout(1.0):
                    reader, writer = await self._connected(key)
                self._held.append(asyncio.create_task(_drain(reader, writer)))

    @asynccontextmanager
    async def enter(
        self, key: str, request: GameRequest, shown: Callable[[str], None], news: Callable[[FromWorker], None]
    ) -> AsyncIterator[HostedGame]:
        """Connect to the worker that plays a game; if there is none, start one.

        If the block ends before the game, the worker waits for another connection.

        Args:
            key: key of the game.
            request: the game.
            shown: function that receives messages for the browser.
            news: function that receives all other messages.

        Raises:
            WorkerDied: the worker could not be started, or died before the connection.
        """
        writer: asyncio.StreamWriter | None = None
        self._entered.add(key)
        try:
            if not self.games.is_running(key):
                await asyncio.to_thread(self._run, partial(work, request, self.games.folder, key))
            reader, writer = await self._connected(key)
            game = HostedGame(reader, writer, shown, news)
            yield game
            if game.over:
                await self._gone(key)
        finally:
            self._entered.discard(key)
            if writer is not None:
                writer.close()

    async def end(self, key: str) -> None:
        """End a game whose person does not come back to it, if it is running."""
        with suppress(WorkerDied):
            if self.games.is_running(key):
                _, writer = await self._connected(key)
                writer.write(encode_line(PersonLeft()))
                await self._gone(key)
                writer.close()
        self.games.forget(key)

    async def _connected(self, key: str) -> tuple[asyncio.StreamReader, asyncio.StreamWriter]:
        loop = asyncio.get_running_loop()
        late = loop.time() + START_TIMEOUT
        while self.games.is_running(key) and loop.time() < late:
            address = self.games.address(key)
            if address is not None:
                with suppress(FileNotFoundError, ConnectionRefusedError):
                    reader, writer = await asyncio.open_unix_connection(address.socket, limit=LONGEST_LINE)
                    writer.write(encode_line(GatewayHello(address.token)))
                    return reader, writer
            await asyncio.sleep(LOOK)
        raise WorkerDied

    async def _gone(self, key: str) -> None:
        """Wait until the process of an ended game is gone; end it if it hangs."""
        loop = asyncio.get_running_loop()
        late = loop.time() + END_TIMEOUT
        while self.games.is_running(key):
            if loop.time() > late and (address := self.games.address(key)) is not None:
                with suppress(ProcessLookupError):
                    os.kill(address.process, signal.SIGKILL)
            await asyncio.sleep(LOOK)

    def _run(self, program: Callable[[], None]) -> None:
        process = self._context.Process(target=program)
        process.start()
        process.join()


async def _drain(reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
    """Read and drop the messages of a worker."""
    with suppress(TimeoutError, ConnectionError):
        async with asyncio.timeout(HOLD_TIMEOUT):
            while await reader.read(LONGEST_LINE):
                pass
    writer.close()


def _nothing() -> None:
    """Do nothing: the process exists only to start the server of forks."""
