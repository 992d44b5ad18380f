"""End of a server after its games: `thbridge serve --drain` asks for it over a socket in the folder of the games."""

import asyncio
import re
import socket
from collections.abc import AsyncIterator, Callable, Iterable
from contextlib import asynccontextmanager, suppress
from pathlib import Path

import msgspec

from ui.web.gateway.game_queue import GameQueue
from ui.web.gateway.single import SHARED_GAME
from ui.web.pool.running_games import RunningGames

LOOK = 0.2
"""Seconds between two looks at the running games."""
MOST_LINGER = 60.0
"""Greatest number of seconds for which a server waits until people see the page after their game."""
_STUDY_GAME = re.compile(r"(?P<person>.+)-(?P<step>\d+)-\d+(-practice)?")
_NAMES = msgspec.json.Decoder(list[str])


class DrainPort:
    """Port for requests to end the server after its games.

    Args:
        games: games of the server.
        queue: queue for further games, which is closed after a request.
    """

    def __init__(self, games: RunningGames, queue: GameQueue) -> None:
        self._games = games
        self._queue = queue
        self._over: Callable[[], None] = lambda: None
        self._is_seen: Callable[[], bool] = lambda: False
        self._ending: asyncio.Task[None] | None = None

    @asynccontextmanager
    async def opened(self, over: Callable[[], None], is_seen: Callable[[], bool]) -> AsyncIterator[None]:
        """Accept requests inside this context.

        Args:
            over: function that is called after a request, when the last game has ended and no person sees it any more.
            is_seen: function that returns True while a person sees a game, also one that has just ended.
        """
        self._over, self._is_seen = over, is_seen
        path = _path(self._games)
        path.unlink(missing_ok=True)
        server = await asyncio.start_unix_server(self._serve, path)
        try:
            yield
        finally:
            server.close()
            path.unlink(missing_ok=True)

    async def _serve(self, _reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        """Send the keys of the running games, and send them again when they change."""
        self._queue.is_closed = True
        if self._ending is None:
            self._ending = asyncio.create_task(self._end())
        before: list[str] | None = None
        with suppress(ConnectionError):
            while True:
                keys = [*self._games]
                if keys != before:
                    before = keys
                    writer.write(msgspec.json.encode(keys) + b"\n")
                    await writer.drain()
                await asyncio.sleep(LOOK)

    async def _end(self) -> None:
        while [*self._games]:
            await asyncio.sleep(LOOK)
        # People must receive the page after their game before the server ends.
        with suppress(TimeoutError):
            async with asyncio.timeout(MOST_LINGER):
                while self._is_seen():
                    await asyncio.sleep(LOOK)
        self._over()


def drain(games: RunningGames, report: Callable[[str], None]) -> bool:
    """Ask the server of these games to end after them, and wait for its end; return False if there is no server.

    Args:
        games: games of the server.
        report: function that receives sentences about who still plays.
    """
    with socket.socket(socket.AF_UNIX) as connection:
        try:
            connection.connect(str(_path(games)))
        except (FileNotFoundError, ConnectionRefusedError):
            return False
        with suppress(ConnectionError), connection.makefile("rb") as lines:
            for line in lines:
                report(_sentence(_NAMES.decode(line)))
    games.await_server()
    return True


def _path(games: RunningGames) -> Path:
    return games.folder / "drain.sock"


def _sentence(keys: Iterable[str]) -> str:
    """Return a sentence about the people who play."""
    named = []
    for key in keys:
        found = _STUDY_GAME.fullmatch(key)
        if found is not None:
            named.append(f"{found['person']} (step {found['step']})")
        else:
            named.append("several visitors" if key.startswith(SHARED_GAME) else "a visitor")
    return f"Still playing: {', '.join(named)}." if named else "All games have ended."
