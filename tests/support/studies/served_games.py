"""Games of a study file that are served to browsers in this process."""

import asyncio
import socket
from collections.abc import AsyncIterator, Awaitable, Callable
from contextlib import asynccontextmanager, suppress
from pathlib import Path

from thbridge.study.study_file import ServerSection, Study
from ui.web.gateway.serving import ServerOptions, serve_games
from ui.web.pool.joined_game import JoinedGame
from ui.web.pool.running_games import RunningGames

STUDY = Study(map="practice", templates="practice", robots=1, rate=10.0, server=ServerSection(port=0))


@asynccontextmanager
async def served(
    folder: Path,
    study: Study = STUDY,
    running: RunningGames | None = None,
    games: int = 2,
    joined: JoinedGame | None = None,
) -> AsyncIterator[int]:
    """Serve games of a study, or a game elsewhere; yield the port. Games outlive the server if `running` is given."""
    listening = socket.create_server(("127.0.0.1", 0))
    ready = asyncio.Event()
    options = ServerOptions(listening, games, None, ready.set, running=running)
    bags = iter(range(100))
    serving = asyncio.create_task(
        serve_games(study, None, lambda: folder / f"{next(bags)}.bag", print, options, joined)
    )
    await asyncio.wait([serving, asyncio.create_task(ready.wait())], return_when=asyncio.FIRST_COMPLETED)
    try:
        yield listening.getsockname()[1]
    finally:
        serving.cancel()
        with suppress(asyncio.CancelledError):
            await serving


def scenario(folder: Path, play: Callable[[int], Awaitable[None]]) -> None:
    """Serve games, and run a function with the port."""

    async def run() -> None:
        async with served(folder) as port:
            await play(port)

    asyncio.run(asyncio.wait_for(run(), 300.0))
