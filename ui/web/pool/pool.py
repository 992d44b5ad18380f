"""Pool of workers on this machine: each is forked from a warm process, so that a game starts within a second."""

import asyncio
import multiprocessing
import secrets
from collections.abc import AsyncIterator, Callable
from contextlib import asynccontextmanager
from multiprocessing.context import ForkServerContext
from pathlib import Path

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
    WorkerResult,
    encode_line,
)
from ui.web.pool.worker import GameRequest, work

START_TIMEOUT = 30.0
"""Seconds for a worker to open its socket."""
END_TIMEOUT = 10.0
"""Seconds for a worker to end its game and to close its files."""
LOOK = 0.02
"""Seconds between two looks for a worker's socket."""


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

    def join(self) -> None:
        """Let the browser show the game from its present state on."""
        self._stream += 1
        self._send(BrowserJoined(self._stream))

    def part(self) -> None:
        """Note that no browser shows the game."""
        self._send(BrowserLeft())

    def pass_on(self, text: str) -> None:
        """Pass on a message of the browser."""
        self._send(FromBrowser(text))

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
    """Pool that starts a worker for each game.

    Args:
        folder: folder for the workers' sockets, readable by this user alone.
        most: greatest number of games at the same time.
    """

    def __init__(self, folder: Path, most: int) -> None:
        self._folder = folder
        self._most = most
        self._context: ForkServerContext = multiprocessing.get_context("forkserver")
        self._context.set_forkserver_preload(["ui.web.pool.warm"])
        self._playing = 0

    @property
    def free(self) -> int:
        """Number of games that can still start."""
        return self._most - self._playing

    async def warm_up(self) -> None:
        """Start the process from which workers are forked, and wait until it is ready."""
        process = self._context.Process(target=_nothing)
        process.start()
        await asyncio.to_thread(process.join)

    @asynccontextmanager
    async def start(
        self, request: GameRequest, shown: Callable[[str], None], news: Callable[[FromWorker], None]
    ) -> AsyncIterator[HostedGame]:
        """Start a game; at the end of the context its worker is gone.

        Raises:
            WorkerDied: the worker could not be started.
        """
        token = secrets.token_hex(16)
        path = self._folder / f"{token[:12]}.sock"
        process = self._context.Process(target=work, args=(request, path, token))
        self._playing += 1
        writer: asyncio.StreamWriter | None = None
        try:
            process.start()
            reader, writer = await _connected(path, process.is_alive)
            writer.write(encode_line(GatewayHello(token)))
            yield HostedGame(reader, writer, shown, news)
        finally:
            self._playing -= 1
            if writer is not None and not writer.is_closing():
                # A game that is still played ends, and its recording is complete.
                writer.write(encode_line(PersonLeft()))
                await asyncio.to_thread(process.join, END_TIMEOUT)
                writer.close()
            if process.is_alive():
                process.kill()
            await asyncio.to_thread(process.join)
            path.unlink(missing_ok=True)


async def _connected(path: Path, alive: Callable[[], bool]) -> tuple[asyncio.StreamReader, asyncio.StreamWriter]:
    loop = asyncio.get_running_loop()
    late = loop.time() + START_TIMEOUT
    while alive() and loop.time() < late:
        try:
            return await asyncio.open_unix_connection(path, limit=LONGEST_LINE)
        except (FileNotFoundError, ConnectionRefusedError):
            await asyncio.sleep(LOOK)
    raise WorkerDied


def _nothing() -> None:
    """Do nothing: the process exists only to start the server of forks."""
