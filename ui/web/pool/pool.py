"""Pool of workers: each is forked from a warm process, on this machine or another one, so that a game starts soon.

Workers outlive the server that has started them. The next server of the same folder connects to them.
"""

import asyncio
import multiprocessing
import os
import signal
from collections import Counter
from collections.abc import AsyncIterator, Callable, Mapping
from contextlib import asynccontextmanager, suppress
from functools import partial
from multiprocessing.context import ForkServerContext
from operator import itemgetter
from typing import Protocol

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
    ResultKept,
    SeatFilled,
    SeatResumed,
    ToBrowser,
    ToWorker,
    WatchWanted,
    WindowSeenOver,
    WorkerResult,
    encode_line,
)
from ui.web.pool.running_games import RunningGames, WorkerAddress
from ui.web.pool.worker import GATEWAY_TIMEOUT, GameRequest, work

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
SILENCE = GATEWAY_TIMEOUT + 40.0
"""Seconds for which a host does not answer after which its games count as ended.

By then, its workers have ended without a gateway, and a shared file system has released their locks.
"""
DIAL_TIMEOUT = 5.0
"""Seconds for another machine to accept a connection."""
PROBE = 5.0
"""Seconds between two looks at games on other machines that no one plays at the moment."""


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


class HostLeft(Exception):  # noqa: N818 - the game starts elsewhere
    """The other machine does not answer any more, and has not received the game."""


class RemoteHosts(Protocol):
    """Other machines with room for games."""

    @property
    def rooms(self) -> Mapping[str, int]:
        """Greatest number of games on each host at present."""

    async def start(self, host: str, key: str, request: GameRequest) -> WorkerAddress | None:
        """Start a game on a host, unless it is running there; return None if its worker has died at once.

        Raises:
            HostLeft: the host has not received the game, and has no room from now on.
            WorkerDied: the host does not answer, and may have started the game.
        """

    async def connect(self, address: WorkerAddress) -> tuple[asyncio.StreamReader, asyncio.StreamWriter]:
        """Connect to a worker on a host."""


class HostedGame:
    """Game in a worker, as the gateway sees it for one person.

    Args:
        reader: connection to the worker.
        writer: connection to the worker.
        shown: function that receives messages for the browser.

    Attributes:
        news: function that receives all other messages.
        result: result of the game; None before its end.
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
        self.result: WorkerResult | None = None

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

    def note_seen_over(self) -> None:
        """Note that the window of a person without a browser shows the end of the game."""
        self._send(WindowSeenOver())

    def watch(self) -> None:
        """Let researchers' windows connect to the game."""
        self._send(WatchWanted())

    def leave(self, *, everybody: bool = False) -> None:
        """Note that the person has left, or that all people of the game have left; then the game ends."""
        self._send(PersonLeft(everybody))

    def fill(self, seat: str) -> None:
        """Let a program have a seat, until its person comes back; a new worker must receive this again."""
        self._send(SeatFilled(seat))

    def resume(self, seat: str) -> None:
        """Let the person of a seat, who has come back, have it again."""
        self._send(SeatResumed(seat))

    def confirm(self) -> None:
        """Confirm to the worker that its result is kept."""
        self._send(ResultKept())

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
                        self.result = message
                        return message
                    case _:
                        self.news(message)
        except (OSError, ValueError, msgspec.MsgspecError):
            pass
        raise WorkerDied

    def _send(self, message: ToWorker) -> None:
        if not self._writer.is_closing():
            self._writer.write(encode_line(message))


class WorkerPool:
    """Pool that starts a worker for each game, or finds the worker that plays it already.

    Args:
        games: the running games.
        most: greatest number of games at the same time on this machine.
        remote: other machines; None for none.
    """

    def __init__(self, games: RunningGames, most: int, remote: RemoteHosts | None = None) -> None:
        self.games = games
        self._most = most
        self._remote = remote
        self._silent: dict[str, float] = {}
        self._homeless = 0
        self._reserved: set[str] = set()
        self._context: ForkServerContext = multiprocessing.get_context("forkserver")
        self._context.set_forkserver_preload(["ui.web.pool.warm"])
        self._entered: dict[str, str] = {}
        self._inside: Counter[str] = Counter()
        self._starting: dict[str, asyncio.Lock] = {}
        self._held: dict[str, asyncio.Task[None]] = {}

    @property
    def free(self) -> int:
        """Number of games that can still start."""
        taken = self._homeless + len(self._reserved)
        return max(sum(max(free, 0) for free in self._free_places().values()) - taken, 0)

    def reserve(self, key: str) -> None:
        """Count a game, whose people enter it in a moment."""
        self._reserved.add(key)

    @property
    def playing(self) -> int:
        """Number of games."""
        return len(self._places())

    def _places(self) -> dict[str, str]:
        """Return the hosts of all games; this machine is the empty text."""
        return {key: self.games.remote_host(key) for key in self.games} | self._entered

    def _free_places(self) -> dict[str, int]:
        """Return the number of games that can still start on each host."""
        taken = Counter(self._places().values())
        rooms = {"": self._most, **(self._remote.rooms if self._remote is not None else {})}
        return {host: room - taken[host] for host, room in rooms.items()}

    async def warm_up(self) -> None:
        """Start the process from which workers are forked, and wait until it is ready."""
        await asyncio.to_thread(self._run, _nothing)

    async def hold(self) -> None:
        """Connect to the games of an earlier server, so that they wait for their people; call this before any other.

        The connection ends when `enter` connects to the game, and after `HOLD_TIMEOUT`.
        """
        await asyncio.gather(*map(self._hold, [*self.games]))

    async def _hold(self, key: str) -> None:
        with suppress(WorkerDied, TimeoutError):
            async with asyncio.timeout(1.0):
                reader, writer = await self._connected(key, None)
            self._held[key] = asyncio.create_task(self._drain(key, reader, writer))

    async def _drain(self, key: str, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        """Read and drop the messages of a worker, but not its result."""
        game = HostedGame(reader, writer, lambda _text: None, lambda _message: None)
        try:
            with suppress(TimeoutError, WorkerDied):
                async with asyncio.timeout(HOLD_TIMEOUT):
                    self._keep(key, game, await game.ended())
        finally:
            writer.close()

    async def probe(self) -> None:
        """Note again and again which games on other machines have ended while no one played them, until cancelled."""
        while True:
            for key in [*self.games]:
                if self.games.remote_host(key) and key not in self._entered:
                    with suppress(WorkerDied, OSError):
                        _, writer = await self._dial(key)
                        writer.close()
            await asyncio.sleep(PROBE)

    @asynccontextmanager
    async def enter(
        self,
        key: str,
        request: GameRequest,
        shown: Callable[[str], None],
        news: Callable[[FromWorker], None],
        seat: str | None = "",
    ) -> AsyncIterator[HostedGame]:
        """Connect to the worker that plays a game, for the person in one of its seats; if there is none, start one.

        If the block ends before the game, the worker waits for another connection. All people of a game give the same
        key and request.

        Args:
            key: key of the game.
            request: the game.
            shown: function that receives messages for the browser.
            news: function that receives all other messages.
            seat: name of the person's seat; empty in a game with one participant. If None, no person is there.

        Raises:
            WorkerDied: the worker could not be started, or died before the connection, or the game has a result.
        """
        writer: asyncio.StreamWriter | None = None
        self._inside[key] += 1
        try:
            # Only the first person of a game starts it.
            async with self._starting.setdefault(key, asyncio.Lock()):
                self._reserved.discard(key)
                if self.games.is_running(key):
                    self._entered[key] = self.games.remote_host(key)
                elif self.games.result(key) is not None:
                    raise WorkerDied  # The game has ended meanwhile, and must not begin again.
                else:
                    await self._start(key, request)
            reader, writer = await self._connected(key, seat)
            if (held := self._held.pop(key, None)) is not None:
                held.cancel()
            game = HostedGame(reader, writer, shown, news)
            yield game
            if game.result is not None:
                self._keep(key, game, game.result)
                await self._gone(key)
        finally:
            self._inside[key] -= 1
            if self._inside[key] == 0:
                del self._inside[key]
                self._starting.pop(key, None)
                self._entered.pop(key, None)
            if writer is not None:
                writer.close()

    async def end(self, key: str) -> None:
        """End a game whose people do not come back to it, if it is running."""
        with suppress(WorkerDied, TimeoutError):
            if self.games.is_running(key):
                reader, writer = await self._connected(key, None)
                game = HostedGame(reader, writer, lambda _text: None, lambda _message: None)
                game.leave(everybody=True)
                if self.games.remote_host(key):
                    async with asyncio.timeout(END_TIMEOUT):
                        await game.ended()
                    game.confirm()
                await self._gone(key)
                writer.close()
        self.games.forget(key)

    async def _start(self, key: str, request: GameRequest) -> None:
        """Start a game where most room is. A window joins only games on this machine."""
        self._entered[key] = host = "" if request.windows else await self._roomiest()
        if self._remote is None or not host:
            await asyncio.to_thread(self._run, partial(work, request, self.games.folder, key))
            return
        # If this server is killed meanwhile, or the host does not answer, the game may have started there.
        shown = f"[{host}]" if ":" in host else host
        self.games.place_remotely(key, WorkerAddress(f"tcp://{shown}:0", "", 0))
        try:
            address = await self._remote.start(host, key, request)
        except HostLeft:
            self.games.end_remotely(key)
            del self._entered[key]
            await self._start(key, request)
            return
        if address is None:
            self.games.end_remotely(key)
            raise WorkerDied
        self.games.place_remotely(key, address)

    async def _roomiest(self) -> str:
        """Return the host with most room; a game that must be resumed may have to wait until there is room again."""
        if self._remote is None:
            return ""
        self._homeless += 1
        try:
            while True:
                host, free = max(self._free_places().items(), key=itemgetter(1))
                if free > 0:
                    return host
                await asyncio.sleep(LOOK)
        finally:
            self._homeless -= 1

    def _keep(self, key: str, game: HostedGame, result: WorkerResult) -> None:
        """Keep the result of a worker on another machine; a worker on this machine has kept it itself."""
        if self.games.remote_host(key):
            if not result.problem:
                self.games.keep(key, result)
            game.confirm()

    async def _connected(self, key: str, seat: str | None) -> tuple[asyncio.StreamReader, asyncio.StreamWriter]:
        loop = asyncio.get_running_loop()
        late = loop.time() + START_TIMEOUT
        while self.games.is_running(key) and (loop.time() < late or self.games.remote_host(key)):
            address = self.games.address(key)
            if address is not None:
                with suppress(OSError):
                    reader, writer = await self._dial(key)
                    writer.write(encode_line(GatewayHello(address.token, seat)))
                    return reader, writer
            await asyncio.sleep(LOOK)
        raise WorkerDied

    async def _dial(self, key: str) -> tuple[asyncio.StreamReader, asyncio.StreamWriter]:
        """Connect to the worker of a game.

        Raises:
            OSError: the worker does not answer now.
            WorkerDied: the worker on another machine has ended.
        """
        address = self.games.address(key)
        if address is None:
            raise WorkerDied
        if not address.host:
            return await asyncio.open_unix_connection(address.socket, limit=LONGEST_LINE)
        now = asyncio.get_running_loop().time()
        try:
            if self._remote is None or not address.token:
                raise TimeoutError
            async with asyncio.timeout(DIAL_TIMEOUT):
                connected = await self._remote.connect(address)
        except OSError as error:
            # A machine that refuses the connection lives, so the process is gone.
            if isinstance(error, ConnectionRefusedError) or now - self._silent.setdefault(key, now) > SILENCE:
                self._silent.pop(key, None)
                self.games.end_remotely(key)
                raise WorkerDied from None
            raise
        self._silent.pop(key, None)
        return connected

    async def _gone(self, key: str) -> None:
        """Wait until the process of an ended game is gone; end it if it hangs."""
        loop = asyncio.get_running_loop()
        late = loop.time() + END_TIMEOUT
        while self.games.is_running(key):
            if self.games.remote_host(key):
                with suppress(WorkerDied, OSError):
                    _, writer = await self._dial(key)
                    writer.close()
                if loop.time() > late:
                    return
            elif loop.time() > late and (address := self.games.address(key)) is not None:
                with suppress(ProcessLookupError):
                    os.kill(address.process, signal.SIGKILL)
            await asyncio.sleep(LOOK)

    def _run(self, program: Callable[[], None]) -> None:
        process = self._context.Process(target=program)
        process.start()
        process.join()


def _nothing() -> None:
    """Do nothing: the process exists only to start the server of forks."""
