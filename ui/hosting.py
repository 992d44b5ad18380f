"""Games for a window: the start page, a practice game, and games one after the other until the participant leaves."""

import asyncio
from collections.abc import Awaitable, Callable

from sim.common.kernels import is_compiled
from thbridge.sockets.addresses import ListeningAddress
from ui.model.lobby import Back, Begin, Join, Offer, Practise, Preparing, WindowClosed
from ui.window_process import WindowProcess

WILDCARD_ADDRESSES = {"0.0.0.0": "127.0.0.1", "::": "::1"}
"""Addresses that a server listens on, and where the window finds it."""


class GameVisit:
    """A participant at one game: joins it, and leaves it some time.

    Args:
        front: the window.
        token: by which the server knows the window again.
        practice: it is the practice game.
    """

    def __init__(self, front: WindowProcess, token: str, practice: bool) -> None:
        self._front = front
        self._token = token
        self._practice = practice
        self._joining: asyncio.Task[None] | None = None
        self.ended: Back | WindowClosed | None = None
        """How the participant left; None while they are there."""

    def ready(self, where: ListeningAddress) -> None:
        """The game waits there."""
        host = WILDCARD_ADDRESSES.get(where.host, where.host)
        join = Join(host, where.port, self._token, self._practice)
        self._joining = asyncio.get_running_loop().create_task(self._front.send(join))

    def has_left(self) -> bool:
        """Whether the participant has left; asked between two ticks."""
        said = self._front.pending_request()
        if isinstance(said, Back | WindowClosed):
            self.ended = said
        return self.ended is not None


PlayGame = Callable[[GameVisit], Awaitable[None]]
"""Plays a game until the participant has left."""


async def host(
    front: WindowProcess, offer: Offer, token: str, play: Callable[[int], PlayGame], practise: Callable[[], PlayGame]
) -> None:
    """Play games until the participant leaves for good.

    Args:
        front: the window; it is opened here.
        offer: how many robots may be chosen.
        token: by which the server knows the window again.
        play: gives a game with so many robots.
        practise: gives the practice game.
    """
    async with front.opened():
        await front.send(offer)
        while True:
            asked = await front.next_request()
            match asked:
                case Begin(robots) if offer.least <= robots <= offer.most:
                    number = "robot is" if robots == 1 else f"{robots} robots are"
                    await front.send(Preparing(f"The {number} being made ready.{_compile_notice()}"))
                    visit, game = GameVisit(front, token, practice=False), play(robots)
                case Practise():
                    await front.send(Preparing(f"The practice game is being made ready.{_compile_notice()}"))
                    visit, game = GameVisit(front, token, practice=True), practise()
                case WindowClosed():
                    return
                case _:
                    continue
            await game(visit)
            if isinstance(visit.ended, WindowClosed):
                return
            await front.send(offer)


def _compile_notice() -> str:
    """What to add where it takes its time."""
    return "" if is_compiled() else " The first time on this computer takes half a minute."
