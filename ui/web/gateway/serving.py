"""Program of the gateway: it serves browsers until it is stopped."""

import contextlib
import socket
import tempfile
from collections.abc import AsyncIterator, Callable
from pathlib import Path

import uvicorn

from thbridge.study.study_file import Study
from ui.web.gateway.app import application
from ui.web.gateway.people import Visitors
from ui.web.gateway.single import SingleGames
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


async def serve_games(
    study: Study,
    file: Path | None,
    listening: socket.socket,
    new_bag: Callable[[], Path],
    ready: Callable[[], None],
    *,
    games: int,
    max_seconds: float,
    tls: tuple[Path, Path] | None = None,
) -> None:
    """Serve one game to each visitor until stopped.

    Args:
        study: the study.
        file: its file, for relative paths.
        listening: bound socket.
        new_bag: function that returns the path of a new recording.
        ready: called when browsers can connect.
        games: greatest number of games at the same time.
        max_seconds: simulated seconds after which a game is stopped.
        tls: files of certificate and key; None for no TLS.
    """
    async with _pool(games) as pool:
        single = SingleGames(study, file, pool, new_bag, max_seconds)
        visitors = Visitors(single.visit, single.window)
        config = uvicorn.Config(
            application(visitors, single.texts),
            log_level="warning",
            ws="websockets",
            ws_max_size=64 * 1024,
            server_header=False,
            ssl_certfile=None if tls is None else str(tls[0]),
            ssl_keyfile=None if tls is None else str(tls[1]),
        )
        try:
            await _Server(config, ready).serve([listening])
        finally:
            await visitors.end()
