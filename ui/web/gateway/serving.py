"""Program of the gateway: it serves browsers until it is stopped."""

import asyncio
import contextlib
import logging
import math
import secrets
import socket
import ssl
import tempfile
from collections.abc import AsyncIterator, Awaitable, Callable, Iterable, Iterator
from contextlib import AbstractAsyncContextManager
from dataclasses import dataclass, field
from ipaddress import IPv4Network
from pathlib import Path

import uvicorn

from thbridge.dialogue.wording.texts import Texts
from thbridge.experiment.conductor import Conductor
from thbridge.experiment.design.experiment_file import ExperimentDesign
from thbridge.experiment.design.recruiting import LinkCodes
from thbridge.experiment.folder import ExperimentFolder
from thbridge.sockets.admission import OWN_MACHINE, Admission, parse_network
from thbridge.sockets.keys import KeyVerifier, SingleKey
from thbridge.sockets.listening import BACKLOG, ServerDoor
from thbridge.study.study_file import Study
from ui.hosting.kiosk.pages import WindowOfKiosk
from ui.web.gateway.app import application
from ui.web.gateway.connections import LONGEST_HEAD, LONGEST_MESSAGE, MOST_CONNECTIONS, ConnectionGate, HttpConnection
from ui.web.gateway.desk import DeskSockets, ServedDesk
from ui.web.gateway.draining import DrainPort
from ui.web.gateway.entry import StudyEntry, open_to_all
from ui.web.gateway.game_queue import GameQueue
from ui.web.gateway.limits import ClientLimits
from ui.web.gateway.people import Visitors
from ui.web.gateway.presence import PresenceWatch
from ui.web.gateway.single import SingleGames
from ui.web.gateway.study_visits import StudyVisits, VisitClock
from ui.web.pool.joined_game import JoinedGame
from ui.web.pool.pool import RemoteHosts, WorkerPool
from ui.web.pool.running_games import RunningGames

CLOSING_SECONDS = 5
"""Seconds for clients to close their connections when the server is stopped."""


class _Server(uvicorn.Server):
    """Server that accepts connections as the other servers do, and limits them."""

    def __init__(
        self,
        config: uvicorn.Config,
        options: "ServerOptions",
        limits: ClientLimits,
        closing: Callable[[], Awaitable[None]] | None,
    ) -> None:
        super().__init__(config)
        self.servers = []
        self._closing = closing
        self._options = options
        self._door = ServerDoor(MOST_CONNECTIONS)
        self._gate = ConnectionGate(
            options.admission,
            Admission.to(options.proxies) if options.proxies else None,
            lambda: self._door.most,
            limits.refusals,
            encrypted=options.tls is not None,
        )

    async def startup(self, sockets: list[socket.socket] | None = None) -> None:
        """Accept connections, and report it."""
        await self.lifespan.startup()
        for each in sockets or ():
            each.listen(BACKLOG)
            self._door.accept(self._connection, each, self._options.tls)
        self.started = True
        self._options.ready()

    async def shutdown(self, sockets: list[socket.socket] | None = None) -> None:
        """Accept no further connections, and close all connections."""
        self._options.stopping()
        self._door.close()
        await self._door.wait_closed()
        await super().shutdown(None)
        if self._closing is not None:
            await self._closing()

    def _connection(self) -> HttpConnection:
        return HttpConnection(self._gate, self.config, self.server_state)


@contextlib.asynccontextmanager
async def _pool(options: "ServerOptions", report: Callable[[str], None]) -> AsyncIterator[WorkerPool]:
    """Yield the pool of workers. Running games outlive the server only if another server can find them."""
    async with contextlib.AsyncExitStack() as stack:
        running = options.running
        if running is None:
            folder = stack.enter_context(tempfile.TemporaryDirectory(prefix="thbridge-"))
            running = RunningGames(Path(folder, "games"))
        running.tidy()
        remote = None if options.remote is None else await stack.enter_async_context(options.remote(report))
        pool = WorkerPool(running, options.games, remote)
        await pool.hold()
        probing = asyncio.create_task(pool.probe())
        # Running games continue at once. A game that starts before the end of the warm-up waits for it.
        warming = asyncio.create_task(pool.warm_up())
        try:
            yield pool
        finally:
            probing.cancel()
            if options.running is None:
                await asyncio.gather(*map(pool.end, [*running]))
            await asyncio.gather(warming, return_exceptions=True)


@dataclass(frozen=True, slots=True)
class ServerOptions:
    """Options of the gateway.

    Attributes:
        listening: bound socket.
        games: greatest number of games at the same time on this machine.
        tls: context with the certificate of the server. If None, connections are not encrypted.
        ready: called when browsers can connect.
        stopping: called when the server is stopped.
        admission: networks of the admitted machines.
        proxies: networks of proxies, whose headers name the browser's address and scheme.
        running: running games, which the next server continues. If None, games end with the server.
        remote: function that opens the other machines for games; its argument receives sentences about problems.
        keys: keys of researchers. The default is a random key, which no one knows.
    """

    listening: socket.socket
    games: int
    tls: ssl.SSLContext | None
    ready: Callable[[], None]
    admission: Admission = OWN_MACHINE
    proxies: tuple[str, ...] = ()
    running: RunningGames | None = None
    stopping: Callable[[], None] = lambda: None
    remote: Callable[[Callable[[str], None]], AbstractAsyncContextManager[RemoteHosts]] | None = None
    keys: KeyVerifier = field(default_factory=lambda: SingleKey(secrets.token_urlsafe(24)))


async def serve_games(
    study: Study,
    file: Path | None,
    new_bag: Callable[[], Path],
    report: Callable[[str], None],
    options: ServerOptions,
    joined: JoinedGame | None = None,
) -> None:
    """Serve one game to each visitor until stopped.

    Args:
        study: the study.
        file: its file, for relative paths.
        new_bag: function that returns the path of a new recording.
        report: function that receives sentences about problems.
        options: options of the gateway.
        joined: game elsewhere, which one visitor after another joins. If None, each visitor has a new game.
    """
    async with _pool(options, report) as pool:
        queue = GameQueue(pool)
        single = SingleGames(study, file, pool, queue, new_bag, math.inf, joined)
        drain = DrainPort(pool.games, queue)
        visitors = Visitors(single.visit, single.window, open_to_all, single.greet)
        await serve_visitors(visitors, single.texts, options, drain)


async def serve_study(
    place: ExperimentFolder,
    design: ExperimentDesign,
    conductor: Conductor,
    clock: VisitClock,
    report: Callable[[str], None],
    options: ServerOptions,
    codes: LinkCodes | None = None,
    window: WindowOfKiosk | None = None,
) -> None:
    """Take visitors through a study until stopped.

    Args:
        place: folder of the study.
        design: its design.
        conductor: its conductor, which uses `clock`.
        clock: clock of the log's events.
        report: function that receives sentences about problems.
        options: options of the gateway.
        codes: codes that admit people; if None, no code is needed.
        window: window on this machine, at which people take part as well; None for none.
    """
    tickets = place.tickets
    entry = StudyEntry(design.file.recruiting, codes, conductor, tickets, place.withdrawn_links.read())
    problems = [report]

    def report_to_all(problem: str) -> None:
        for each in problems:
            each(problem)

    async with _pool(options, report_to_all) as pool:
        queue = GameQueue(pool)
        visits = StudyVisits(place.root, design, conductor, clock, pool, queue, tickets, report_to_all)
        desk = ServedDesk(design, conductor, visits, lambda: (pool.playing, pool.free), visits.texts)
        problems.append(desk.report)
        drain = DrainPort(pool.games, queue)
        watching = asyncio.create_task(PresenceWatch(design.file.presence, conductor, visits.here, report_to_all).run())
        try:
            visitors = Visitors(visits.visit, visits.window, entry, visits.greet, begins_again=True)
            async with visits.groups.opened():
                if window is None:
                    await serve_visitors(visitors, visits.texts, options, drain, desk)
                    return
                async with visits.kiosk_opened(window) as kiosk:
                    await serve_visitors(visitors, visits.texts, options, drain, desk, kiosk.close)
        finally:
            watching.cancel()
            await asyncio.gather(watching, return_exceptions=True)


async def serve_visitors(
    visitors: Visitors,
    texts: Texts,
    options: ServerOptions,
    drain: DrainPort | None = None,
    desk: ServedDesk | None = None,
    closing: Callable[[], Awaitable[None]] | None = None,
) -> None:
    """Serve visitors, and the researcher if there is a desk, until stopped.

    Args:
        visitors: the visitors.
        texts: texts of the page before it is connected.
        options: options of the gateway.
        drain: port for requests to end after the games; None for none.
        desk: desk of the researcher; None if there is none.
        closing: function that is called when the server is stopped, before a signal can end the program; None for none.
    """
    limits = ClientLimits()
    config = uvicorn.Config(
        application(visitors, texts, limits, None if desk is None else DeskSockets(desk, options.keys, limits)),
        # Of uvicorn's warnings, all are about clients, and the gateway writes its own.
        log_level="error",
        log_config=None,
        access_log=False,
        ws="websockets-sansio",
        ws_max_size=LONGEST_MESSAGE,
        h11_max_incomplete_event_size=LONGEST_HEAD,
        server_header=False,
        timeout_graceful_shutdown=CLOSING_SECONDS,
        lifespan="off",
        proxy_headers=bool(options.proxies),
        forwarded_allow_ips=[*options.proxies, *_mapped(options.proxies)],
    )
    logging.getLogger("uvicorn.error").addFilter(_is_fault)
    forgetting = asyncio.create_task(visitors.forget_idle())
    server = _Server(config, options, limits, closing)

    def end() -> None:
        server.should_exit = True

    try:
        async with contextlib.nullcontext() if drain is None else drain.opened(end, lambda: visitors.see_games):
            await server.serve([options.listening])
    finally:
        forgetting.cancel()
        await asyncio.gather(forgetting, return_exceptions=True)
        await visitors.end()


def _is_fault(record: logging.LogRecord) -> bool:
    """Return False for an error that a client has caused, which the connection reports, and for the end of a server."""
    error = record.exc_info[1] if record.exc_info else None
    return not (
        isinstance(error, asyncio.CancelledError) or record.getMessage().startswith(("Invalid UTF-8", "Cancel "))
    )


def _mapped(networks: Iterable[str]) -> Iterator[str]:
    """Yield IPv4 networks as a socket for both versions of IP shows them."""
    for network in map(parse_network, networks):
        if isinstance(network, IPv4Network):
            yield f"::ffff:{network.network_address}/{96 + network.prefixlen}"
