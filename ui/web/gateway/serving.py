"""Program of the gateway: it serves browsers until it is stopped."""

import asyncio
import contextlib
import logging
import math
import socket
import ssl
import tempfile
from collections.abc import AsyncIterator, Callable, Iterable, Iterator
from dataclasses import dataclass
from ipaddress import IPv4Network
from pathlib import Path

import uvicorn

from thbridge.dialogue.wording.texts import Texts
from thbridge.experiment.conductor import Conductor
from thbridge.experiment.design.experiment_file import ExperimentDesign
from thbridge.experiment.folder import ExperimentFolder
from thbridge.sockets.admission import OWN_MACHINE, Admission, parse_network
from thbridge.sockets.listening import BACKLOG, ServerDoor
from thbridge.study.study_file import Study
from ui.web.gateway.app import application
from ui.web.gateway.connections import LONGEST_HEAD, LONGEST_MESSAGE, MOST_CONNECTIONS, ConnectionGate, HttpConnection
from ui.web.gateway.limits import ClientLimits
from ui.web.gateway.people import Visitors
from ui.web.gateway.single import SingleGames
from ui.web.gateway.study_visits import StudyVisits, VisitClock
from ui.web.gateway.tickets import Tickets
from ui.web.pool.pool import WorkerPool


class _Server(uvicorn.Server):
    """Server that accepts connections as the other servers do, and limits them."""

    def __init__(self, config: uvicorn.Config, options: "ServerOptions", limits: ClientLimits) -> None:
        super().__init__(config)
        self.servers = []
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
        self._door.close()
        await self._door.wait_closed()
        await super().shutdown(None)

    def _connection(self) -> HttpConnection:
        return HttpConnection(self._gate, self.config, self.server_state)


@contextlib.asynccontextmanager
async def _pool(most: int) -> AsyncIterator[WorkerPool]:
    with tempfile.TemporaryDirectory(prefix="thbridge-") as folder:
        pool = WorkerPool(Path(folder), most)
        await pool.warm_up()
        yield pool


@dataclass(frozen=True, slots=True)
class ServerOptions:
    """Options of the gateway.

    Attributes:
        listening: bound socket.
        games: greatest number of games at the same time.
        tls: context with the certificate of the server. If None, connections are not encrypted.
        ready: called when browsers can connect.
        admission: networks of the admitted machines.
        proxies: networks of proxies, whose headers name the browser's address and scheme.
    """

    listening: socket.socket
    games: int
    tls: ssl.SSLContext | None
    ready: Callable[[], None]
    admission: Admission = OWN_MACHINE
    proxies: tuple[str, ...] = ()


async def serve_games(study: Study, file: Path | None, new_bag: Callable[[], Path], options: ServerOptions) -> None:
    """Serve one game to each visitor until stopped.

    Args:
        study: the study.
        file: its file, for relative paths.
        new_bag: function that returns the path of a new recording.
        options: options of the gateway.
    """
    async with _pool(options.games) as pool:
        single = SingleGames(study, file, pool, new_bag, math.inf)
        await serve_visitors(Visitors(single.visit, single.window), single.texts, options)


async def serve_study(
    place: ExperimentFolder,
    design: ExperimentDesign,
    conductor: Conductor,
    clock: VisitClock,
    report: Callable[[str], None],
    options: ServerOptions,
) -> None:
    """Take visitors through a study until stopped.

    Args:
        place: folder of the study.
        design: its design.
        conductor: its conductor, which uses `clock`.
        clock: clock of the log's events.
        report: function that receives sentences about problems.
        options: options of the gateway.
    """
    tickets = Tickets(place.log.parent / "browsers.json")
    async with _pool(options.games) as pool:
        visits = StudyVisits(place.root, design, conductor, clock, pool, tickets, report)
        await serve_visitors(Visitors(visits.visit, visits.window), visits.texts, options)


async def serve_visitors(visitors: Visitors, texts: Texts, options: ServerOptions) -> None:
    """Serve visitors until stopped; `texts` are those of the page before it is connected."""
    limits = ClientLimits()
    config = uvicorn.Config(
        application(visitors, texts, limits),
        # Of uvicorn's warnings, all are about clients, and the gateway writes its own.
        log_level="error",
        log_config=None,
        access_log=False,
        ws="websockets-sansio",
        ws_max_size=LONGEST_MESSAGE,
        h11_max_incomplete_event_size=LONGEST_HEAD,
        server_header=False,
        lifespan="off",
        proxy_headers=bool(options.proxies),
        forwarded_allow_ips=[*options.proxies, *_mapped(options.proxies)],
    )
    logging.getLogger("uvicorn.error").addFilter(_is_fault)
    forgetting = asyncio.create_task(visitors.forget_idle())
    try:
        await _Server(config, options, limits).serve([options.listening])
    finally:
        forgetting.cancel()
        await asyncio.gather(forgetting, return_exceptions=True)
        await visitors.end()


def _is_fault(record: logging.LogRecord) -> bool:
    """Return False for an error that a client has caused; the connection reports it."""
    return not record.getMessage().startswith("Invalid UTF-8")


def _mapped(networks: Iterable[str]) -> Iterator[str]:
    """Yield IPv4 networks as a socket for both versions of IP shows them."""
    for network in map(parse_network, networks):
        if isinstance(network, IPv4Network):
            yield f"::ffff:{network.network_address}/{96 + network.prefixlen}"
