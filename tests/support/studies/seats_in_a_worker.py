"""People in a game in a worker, at connections like those of the gateway."""

import asyncio
import json
from collections.abc import AsyncIterator, Sequence
from contextlib import AsyncExitStack, asynccontextmanager
from typing import Any

from tests.support.programs.browser_client import BrowserClient, applied
from ui.web.pool.pool import HostedGame, WorkerPool
from ui.web.pool.running_games import RunningGames
from ui.web.pool.worker import GameRequest

KEY = "game"


class BrowserAtWorker(BrowserClient):
    """Browser of a person, whose messages go to the worker without a gateway.

    Attributes:
        game: connection of the person's seat.
    """

    game: HostedGame

    def __init__(self) -> None:
        super().__init__(0)

    def open_page(self) -> None:
        """Show the game from now on."""
        self.tree, self.number = {}, 0
        self.game.join()

    def receive(self, text: str) -> None:
        """Show a page."""
        message = json.loads(text)
        if message["t"] == "page":
            self.tree, self.number = applied(self.tree, message["p"]), message["n"]
            self._pass_on({"t": "painted", "n": self.number, "at": self.now})

    async def send(self, message: dict[str, Any]) -> None:
        """Send a message."""
        self._pass_on(message)

    def _pass_on(self, message: dict[str, Any]) -> None:
        self.game.pass_on(json.dumps(message))


@asynccontextmanager
async def at_worker(
    games: RunningGames, request: GameRequest, seats: Sequence[str]
) -> AsyncIterator[dict[str, BrowserAtWorker]]:
    """Enter a game; yield the people in these seats, whose browsers are not open yet.

    After the block, the game must end, or its worker must be killed.
    """
    pool = WorkerPool(games, 1)
    async with AsyncExitStack() as opened:
        people = {seat: BrowserAtWorker() for seat in seats}
        for seat, each in people.items():
            each.game = await opened.enter_async_context(
                pool.enter(KEY, request, each.receive, lambda _message: None, seat)
            )
        ends = [asyncio.create_task(each.game.ended()) for each in people.values()]
        yield people
        await asyncio.gather(*ends, return_exceptions=True)
