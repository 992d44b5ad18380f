"""Program of the gateway: it serves browsers until it is stopped."""

import contextlib
import math
import socket
import tempfile
from collections.abc import AsyncIterator, Callable
from dataclasses import dataclass
from pathlib import Path

import uvicorn

from thbridge.dialogue.wording.texts import Texts
from thbridge.experiment.conductor import Conductor
from thbridge.experiment.design.experiment_file import ExperimentDesign
from thbridge.experiment.folder import ExperimentFolder
from thbridge.study.study_file import Study
from ui.web.gateway.app import application
from ui.web.gateway.people import Visitors
from ui.web.gateway.single import SingleGames
from ui.web.gateway.study_visits import StudyVisits, VisitClock
from ui.web.gateway.tickets import Tickets
from ui.web.pool.pool import WorkerPool


class _Server(uvicorn.Server):
    """Server that reports when it accepts connections."""

    def __init__(self, config: uvicorn.Config, ready: Callable[[], None]) -> None:
        super().__init__(config)
        self._ready = ready

    async def startup(self, sockets: list[socket.socket] | None = None) -> None:
        """See `uvicorn.Server`."""
        await super().startup(sockets)
        self._ready()


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
        tls: files of certificate and key; None for no TLS.
        ready: called when browsers can connect.
    """

    listening: socket.socket
    games: int
    tls: tuple[Path, Path] | None
    ready: Callable[[], None]


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
        await _serve(Visitors(single.visit, single.window), single.texts, options)


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
        await _serve(Visitors(visits.visit, visits.window), visits.texts, options)


async def _serve(visitors: Visitors, texts: Texts, options: ServerOptions) -> None:
    config = uvicorn.Config(
        application(visitors, texts),
        log_level="warning",
        ws_max_size=64 * 1024,
        server_header=False,
        lifespan="off",
        ssl_certfile=None if options.tls is None else str(options.tls[0]),
        ssl_keyfile=None if options.tls is None else str(options.tls[1]),
    )
    try:
        await _Server(config, options.ready).serve([options.listening])
    finally:
        await visitors.end()
