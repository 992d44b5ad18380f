"""Worker: a process that plays one game, with the seats of its people."""

import asyncio
import hmac
import logging
import os
import secrets
import selectors
import signal
import time
from collections.abc import Awaitable, Callable, Iterator, Mapping
from concurrent.futures import ThreadPoolExecutor
from contextlib import suppress
from functools import partial
from pathlib import Path
from typing import IO, Protocol, TypeAlias

import msgspec
from msgspec import structs

from thbridge.app.consent import ParticipantDeclined
from thbridge.app.listeners import StartServer, WatchAddress
from thbridge.app.play import Checkpoints
from thbridge.dialogue.wording.texts import Texts
from thbridge.files.errors import BadFile
from thbridge.files.keys.key_file import ClientKey
from thbridge.roles.participant.tabui import TabUI
from thbridge.roles.shared.view import GiveConsent
from thbridge.sockets.addresses import LOCALHOST, ListeningAddress
from thbridge.sockets.errors import CannotListen
from ui.hosting.lobby import WILDCARD_ADDRESSES
from ui.model.playing.memory.history import KeptLines
from ui.sources.game import GameConnection
from ui.web.page.messages import FROM_GAME_PAGE
from ui.web.page.patches import Json
from ui.web.pool.history_file import HistoryFile, HistoryInMemory
from ui.web.pool.messages import (
    LONGEST_LINE,
    TO_WORKER,
    BrowserJoined,
    BrowserLeft,
    FromBrowser,
    FromWorker,
    GameReady,
    GameWatched,
    GatewayHello,
    PersonActed,
    PersonLeft,
    RecordingBrokenOff,
    ResultKept,
    SeatDeclined,
    SeatFilled,
    SeatResumed,
    SeatSeenOver,
    SeatWentOn,
    ToBrowser,
    WatchWanted,
    WindowSeenOver,
    WorkerResult,
    encode_line,
)
from ui.web.pool.running_games import RunningGames, WorkerAddress
from ui.web.pool.seat_program import play_seat
from ui.web.pool.sleeping_copies import SleepingCopies, place_of, shut_accepted
from ui.web.seat import GameSeat

_log = logging.getLogger(__name__)

GATEWAY_TIMEOUT = 60.0
"""Seconds without a gateway after which a worker ends its game."""
TICKS_AT_ONCE = 4
"""Number of ticks of a game that run one after the other: 12.5 times a second, so that each time gives one page."""
AWAY = 6.0
"""Seconds without a browser after which a person counts as away for the others in their game."""
FAREWELL_TIMEOUT = 5.0
"""Seconds for a gateway to read the last messages."""

ServeGateway: TypeAlias = Callable[[asyncio.StreamReader, asyncio.StreamWriter], Awaitable[None]]
"""Function that serves the connection of a gateway."""
OpenSocket: TypeAlias = Callable[[ServeGateway], Awaitable[tuple[asyncio.Server, str]]]
"""Function that opens the socket of a worker, and returns its server and its address."""


class PeopleInGame(Protocol):
    """People in a game that a request plays; see `Worker`."""

    @property
    def checkpoints(self) -> Checkpoints:
        """Copies of this process, which continue the game if the process is killed."""

    @property
    def watch(self) -> WatchAddress:
        """Address for researchers' windows, whose server starts when the gateway wants it."""

    def ready(self, where: ListeningAddress, key: ClientKey | None = None) -> None:
        """Seat all people at the game with this address, whose server may require a key."""

    def have_left(self) -> bool:
        """Return True if all people have left the game, so that at most programs play."""

    def have_seen_end(self) -> bool:
        """Return True if the browsers of all people who have not left show the end of the game."""

    def report(self, message: FromWorker) -> None:
        """Send a message to all gateways' connections that are open now."""

    def note(self, message: FromWorker) -> None:
        """Send a message to all gateways' connections, also to later ones."""


class GameRequest(Protocol):
    """Game that a worker plays; it is sent to the worker's process, so it must be possible to pickle it."""

    @property
    def practice(self) -> bool:
        """True for a practice game."""

    @property
    def once(self) -> bool:
        """True if only one game is played, and another page follows."""

    @property
    def joins_next(self) -> bool:
        """True if people who join after the end of a game begin the next game, instead of seeing the result."""

    @property
    def consents(self) -> Mapping[str, str]:
        """Times at which people gave consent, by the names of their seats; empty texts if they were not asked.

        Seats that are empty, or that programs have, for the whole game are missing.
        The only seat of a game with one participant has an empty name.
        """

    @property
    def programs(self) -> frozenset[str]:
        """Names of the seats that programs have at the start."""

    @property
    def windows(self) -> frozenset[str]:
        """Names of the seats whose people have a window, which joins the game itself, instead of a browser."""

    def texts(self) -> Texts:
        """Return the texts until the game has sent its own."""

    def participant(self, seat: str) -> TabUI:
        """Return the simulated participant that plays when a program has this seat.

        Raises:
            BadFile: a file of the study cannot be read any more.
        """

    async def play(self, people: PeopleInGame) -> Json:
        """Play the game; return its result."""


class _GatewayConnection:
    """The gateway's connection for one seat, or for no seat. It is replaced when the gateway connects again.

    Attributes:
        writer: the connection; None while there is none.
    """

    def __init__(self) -> None:
        self.writer: asyncio.StreamWriter | None = None
        # Messages that a gateway needs to know, also one that connects later.
        self._state: list[FromWorker] = []

    def connect(self, writer: asyncio.StreamWriter) -> None:
        """Use this connection from now on; the one before it belongs to a gateway that has died."""
        before, self.writer = self.writer, writer
        if before is not None:
            before.close()
        for message in self._state:
            writer.write(encode_line(message))

    def note(self, message: FromWorker) -> None:
        """Send a message, also to gateways that connect later."""
        self._state.append(message)
        self.report(message)

    def report(self, message: FromWorker) -> None:
        """Send a message if a gateway is connected."""
        if self.writer is not None:
            self.writer.write(encode_line(message))

    def forget_ready(self) -> None:
        """Drop the connection and the message that the game can be joined: this process continues another one."""
        self.writer = None
        self._state = [message for message in self._state if not isinstance(message, GameReady)]


class WorkerSeat:
    """Seat of a game in a worker: a person with the gateway's connection for them, or a program.

    Args:
        name: name of the seat; empty in a game with one participant.
        kept: the person's history, for the next time that they have the seat, and for the next process.
        begins_with_program: True if a program has the seat at the start.

    Attributes:
        gateway: connection of the gateway.
        left: True after the gateway has reported that the person has left.
    """

    def __init__(self, name: str, kept: KeptLines, *, begins_with_program: bool = False) -> None:
        self.gateway = _GatewayConnection()
        self.left = False
        self._name = name
        self._kept = kept
        self._begins_with_program = self._has_program = begins_with_program
        # The person's part in the game; None while a program has the seat.
        self._seat: GameSeat | None = None
        self._running: asyncio.Task[None] | None = None
        self._leaving = False
        self._changed = asyncio.Event()
        self._browser = False
        self._stream = 0
        self._gone_at = time.monotonic()
        self._reported: set[type[FromWorker]] = set()
        self._window_seen_over = False

    def join(self, request: GameRequest, where: ListeningAddress, token: str, key: ClientKey | None = None) -> None:
        """Let the person or the program join the game with this address, whose server may require a key."""
        self._running = asyncio.create_task(self._hold(request, where, token, key))

    async def _hold(self, request: GameRequest, where: ListeningAddress, token: str, key: ClientKey | None) -> None:
        """Let the person or a program play in turn, until `leave` is called; each joins after the other has left.

        A window joins and leaves by itself.
        """
        host = WILDCARD_ADDRESSES.get(where.host, where.host)
        while not self._leaving:
            if self._has_program and (participant := self._participant(request)) is not None:
                await play_seat(participant, host, where.port, token, lambda: self._leaving or not self._has_program)
                continue
            if self._name in request.windows:
                self._changed.clear()
                await self._changed.wait()
                continue
            agreed_at = request.consents.get(self._name, "")
            consent = GiveConsent(agreed_at) if agreed_at else None
            seat = self._seat = GameSeat(
                lambda report, consent=consent: GameConnection(  # type: ignore[misc]
                    host, where.port, token, report, consent, key, self._name
                ),
                request.texts(),
                practice=request.practice,
                once=request.once,
                joins_next=request.joins_next,
                kept=self._kept,
                acted=lambda act, view_age: self.gateway.report(PersonActed(act, view_age)),
            )
            if self._browser:
                seat.show_to(self._show)
            await seat.run()

    def _participant(self, request: GameRequest) -> TabUI | None:
        """Return the simulated participant for this seat. If its files cannot be read, the seat is empty instead."""
        try:
            return request.participant(self._name)
        except BadFile as bad:
            _log.warning("no program takes the seat %s: %s", self._name, bad)
            self._has_program, self.left = False, True
            return None

    async def leave(self) -> None:
        """Leave the game."""
        self._leaving = True
        self._changed.set()
        if self._seat is not None:
            self._seat.stop()
        if self._running is not None:
            await asyncio.gather(self._running, return_exceptions=True)

    def fill(self) -> None:
        """Let a program have the seat."""
        self._has_program = True
        self._changed.set()
        if self._seat is not None:
            self._report_news(self._seat)
            self._seat.show_to(None)
            self._seat.stop()
            self._seat = None

    def resume(self) -> None:
        """Let the person have the seat again."""
        self._has_program = self.left = False

    def wake_up(self) -> None:
        """Drop what belongs to the process that was killed. This process is a copy of it.

        Like a new process, it knows only who has the seat at the start, because the seat may have changed since the
        copy was made.
        """
        self.gateway.forget_ready()
        if self._running is not None:
            self._running.cancel()
        self._seat, self._running, self._browser = None, None, False
        self._has_program = self._begins_with_program
        self._gone_at = time.monotonic()

    def clear_history(self) -> None:
        """Delete the person's history, because the game begins again."""
        self._kept.clear()

    def has_left(self) -> bool:
        """Return True if no person is in the game; report what has happened at the seat."""
        seat = self._seat
        if seat is None:
            return self.left or self._has_program
        self._report_news(seat)
        left = self.left or seat.went_on or seat.declined
        seat.note_presence(present=not left and (self._browser or time.monotonic() - self._gone_at < AWAY))
        return left

    def _report_news(self, seat: GameSeat) -> None:
        for happened, message in (
            (seat.seen_over, SeatSeenOver()),
            (seat.went_on, SeatWentOn()),
            (seat.declined, SeatDeclined()),
        ):
            if happened and type(message) not in self._reported:
                self._reported.add(type(message))
                self.gateway.note(message)

    @property
    def has_seen_end(self) -> bool:
        """True if the person's browser or window has shown the end of the game."""
        return self._window_seen_over or (self._seat is not None and self._seat.seen_over)

    def receive(self, message: object) -> None:
        """Process a message of the gateway about the person."""
        match message:
            case BrowserJoined(stream, again):
                self._browser, self._stream = True, stream
                if self._seat is not None:
                    self._seat.show_to(self._show, again=again)
            case BrowserLeft():
                self.leave_browser()
            case FromBrowser(text) if self._seat is not None:
                try:
                    said = FROM_GAME_PAGE.decode(text)
                except msgspec.MsgspecError:
                    return  # The gateway has no reason to end a game for a browser's mistake.
                self._seat.receive(said)
            case PersonLeft():
                self.left = True
            case WindowSeenOver():
                self._window_seen_over = True
                self.gateway.note(SeatSeenOver())
            case _:
                pass

    def leave_browser(self) -> None:
        """Note that no browser shows the game."""
        if self._browser:
            self._gone_at = time.monotonic()
        self._browser = False
        if self._seat is not None:
            self._seat.show_to(None)

    def _show(self, message: dict[str, Json]) -> None:
        self.gateway.report(ToBrowser(msgspec.json.encode(message).decode(), self._stream))


class Worker:
    """Worker of one game.

    Args:
        request: game to play.
        token: secret of the worker.
        open_socket: function that opens the worker's socket.
        record: file in which the address of the worker is found.
        history: function that returns the file with the history of a seat, for the next process; None for a game that
            is never resumed.
        keep: function that keeps the result, also if no gateway is connected. If None, a gateway must keep it.

    Attributes:
        checkpoints: see `PeopleInGame`.
    """

    def __init__(
        self,
        request: GameRequest,
        token: str,
        open_socket: OpenSocket,
        record: IO[bytes],
        history: Callable[[str], HistoryFile] | None,
        keep: Callable[[WorkerResult], None] | None,
    ) -> None:
        self.checkpoints = SleepingCopies(record, self._wake_up)
        self._record = record
        self._request = request
        self._address = WorkerAddress("", token, os.getpid())
        self._open_socket = open_socket
        self._keep = keep
        self._result_kept = asyncio.Event()
        # Sockets at which other programs connect to this process: the gateway, and researchers' windows.
        self._places: set[str | int] = set()
        self._seats = {
            name: WorkerSeat(
                name,
                HistoryInMemory() if history is None else history(name),
                begins_with_program=name in request.programs,
            )
            for name in dict.fromkeys((*request.consents, *sorted(request.programs)))
        }
        self._without_seat = _GatewayConnection()
        self._connected = asyncio.Event()
        self._watch_wanted = False
        self._start_watching: StartServer | None = None
        self._watching: asyncio.Task[None] | None = None
        self._abandoned = False

    @property
    def _gateways(self) -> Iterator[_GatewayConnection]:
        yield from (seat.gateway for seat in self._seats.values())
        yield self._without_seat

    async def run(self) -> None:
        """Play the game, and report its result to the gateway."""
        server, path = await self._open_socket(self._serve)
        self._places |= {place_of(each) for each in server.sockets}
        self._address = structs.replace(self._address, socket=path)
        self._write_address()
        async with server:
            watching = asyncio.create_task(self._watch_gateway())
            ended = await self._play()
            watching.cancel()
            await asyncio.gather(*(seat.leave() for seat in self._seats.values()))
            if self._abandoned:
                return  # The game is resumed from its log of inputs when its person comes back.
            if self._keep is not None and not ended.problem:
                self._keep(ended)
            self.note(ended)
            if self._keep is None:
                with suppress(TimeoutError):
                    async with asyncio.timeout(GATEWAY_TIMEOUT):
                        await self._result_kept.wait()
            await asyncio.gather(*(_close(each.writer) for each in self._gateways if each.writer is not None))

    async def _watch_gateway(self) -> None:
        """End the game if no gateway is connected for a while: no one can see it any more."""
        while not self._abandoned:
            try:
                async with asyncio.timeout(GATEWAY_TIMEOUT):
                    await self._connected.wait()
            except TimeoutError:
                _log.warning("the gateway is gone; the game ends")
                self._abandoned = True
            await asyncio.sleep(1.0)

    async def _play(self) -> WorkerResult:
        try:
            result = await self._request.play(self)
        except ParticipantDeclined as declined:
            return WorkerResult(declined=declined.answered)
        except BadFile as bad:
            return WorkerResult(problem=str(bad))
        return WorkerResult(msgspec.Raw(msgspec.json.encode(result)))

    def _wake_up(self) -> None:
        """Continue as the worker, which was killed. This process is a copy of it."""
        self._write_address()
        # The threads of the other process do not exist here.
        asyncio.get_running_loop().set_default_executor(ThreadPoolExecutor())
        shut_accepted(self._places)
        self._connected.clear()
        self._without_seat.forget_ready()
        for seat in self._seats.values():
            seat.wake_up()

    def _write_address(self) -> None:
        """Write the address of this process for the gateway."""
        self._record.truncate(0)
        self._record.write(msgspec.json.encode(structs.replace(self._address, process=os.getpid())))

    # The game's side

    @property
    def watch(self) -> WatchAddress:
        """See `PeopleInGame`."""
        return WatchAddress(LOCALHOST, 0, None, later=self._keep_start)

    def _keep_start(self, start: StartServer) -> None:
        self._start_watching = start
        self._start_watch_server()

    def _start_watch_server(self) -> None:
        """Start the server for researchers' windows, unless it is running, or the game has not begun yet."""
        if self._watch_wanted and self._start_watching is not None and self._watching is None:
            self._watching = asyncio.create_task(self._watch(self._start_watching))

    async def _watch(self, start: StartServer) -> None:
        """Let researchers' windows connect to the game."""
        where = await start()
        if isinstance(where, CannotListen):
            _log.warning("%s", where)
        else:
            self._places.add(where.port)
            self.note(GameWatched(where.port))

    def ready(self, where: ListeningAddress, key: ClientKey | None = None) -> None:
        """See `PeopleInGame`."""
        for seat in self._seats.values():
            seat.join(self._request, where, self._address.token, key)
        self.note(GameReady(WILDCARD_ADDRESSES.get(where.host, where.host), where.port))

    def have_left(self) -> bool:
        """See `PeopleInGame`."""
        left = [seat.has_left() for seat in self._seats.values()]  # Each one reports what has happened.
        return self._abandoned or all(left)

    def have_seen_end(self) -> bool:
        """See `PeopleInGame`."""
        return all(seat.has_seen_end or seat.has_left() for seat in self._seats.values())

    def note(self, message: FromWorker) -> None:
        """See `PeopleInGame`."""
        if isinstance(message, RecordingBrokenOff):
            for seat in self._seats.values():
                seat.clear_history()  # The game could not be resumed, and begins again.
        for gateway in self._gateways:
            gateway.note(message)

    def report(self, message: FromWorker) -> None:
        """See `PeopleInGame`."""
        for gateway in self._gateways:
            gateway.report(message)

    # The gateway's side

    async def _serve(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        """Serve a connection of a gateway."""
        seat: WorkerSeat | None = None
        gateway: _GatewayConnection | None = None
        try:
            line = await reader.readline()
            if not line:
                return  # A gateway has looked if this worker lives.
            hello = TO_WORKER.decode(line)
            if not isinstance(hello, GatewayHello) or not hmac.compare_digest(hello.token, self._address.token):
                return
            if hello.seat is not None and hello.seat not in self._seats:
                _log.warning("the game has no seat called %r", hello.seat)
                return
            seat = None if hello.seat is None else self._seats[hello.seat]
            gateway = self._without_seat if seat is None else seat.gateway
            gateway.connect(writer)
            self._connected.set()
            while line := await reader.readline():
                self._receive(seat, TO_WORKER.decode(line))
        except ConnectionError:
            pass  # The gateway has died, or the person has gone on.
        except (msgspec.MsgspecError, ValueError) as error:
            _log.warning("the gateway's connection is closed: %s", error)
        finally:
            if gateway is not None and gateway.writer is writer:
                gateway.writer = None
                if seat is not None:
                    seat.leave_browser()
                if all(each.writer is None for each in self._gateways):
                    self._connected.clear()
            writer.close()

    def _receive(self, seat: WorkerSeat | None, message: object) -> None:
        match message:
            case ResultKept():
                self._result_kept.set()
            case WatchWanted():
                self._watch_wanted = True
                self._start_watch_server()
            case PersonLeft(everybody=True):
                for each in self._seats.values():
                    each.left = True
            case SeatFilled(name) | SeatResumed(name) if name in self._seats:
                changed = self._seats[name]
                changed.fill() if isinstance(message, SeatFilled) else changed.resume()
            case _ if seat is not None:
                seat.receive(message)
            case _:
                pass


async def _close(gateway: asyncio.StreamWriter) -> None:
    """Close a connection after the gateway has read the last messages."""
    with suppress(TimeoutError, ConnectionError):
        async with asyncio.timeout(FAREWELL_TIMEOUT):
            await gateway.drain()
            gateway.close()
            await gateway.wait_closed()


def work(request: GameRequest, folder: Path, key: str, open_socket: OpenSocket | None = None) -> None:
    """Play a game in a process of its own; this process ends at once.

    If the game already has a worker, do nothing.

    Args:
        request: the game.
        folder: folder of running games on this machine.
        key: key of the game.
        open_socket: function that opens a socket for a gateway on another machine, which keeps the result. If None, the
            gateway is on this machine.
    """
    games = RunningGames(folder)
    record = games.claim(key)
    # The server that starts the game does not wait for its worker, which outlives the server.
    if record is None or os.fork() != 0:
        return
    # Ctrl-C in the terminal is for the server.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    os.setsid()
    token = secrets.token_hex(16)
    path = games.socket(token)

    async def open_here(serve: ServeGateway) -> tuple[asyncio.Server, str]:
        return await asyncio.start_unix_server(serve, path, limit=LONGEST_LINE), str(path)

    keep = partial(games.keep, key) if open_socket is None else None
    history = None if request.practice else lambda seat: HistoryFile(games.history(key, seat))
    worker = Worker(request, token, open_socket or open_here, record, history, keep)
    # Copies of this process would share a selector that the system keeps, such as epoll.
    with record, asyncio.Runner(loop_factory=lambda: asyncio.SelectorEventLoop(selectors.PollSelector())) as runner:
        try:
            runner.run(worker.run())
        finally:
            worker.checkpoints.drop()
    path.unlink(missing_ok=True)
