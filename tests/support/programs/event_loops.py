"""Tests that are coroutines, and a wait for conditions in them."""

import asyncio
from collections.abc import Awaitable, Callable


def in_event_loop(test: Callable[[], Awaitable[None]]) -> Callable[[], None]:
    def call() -> None:
        async def whole() -> None:
            await test()

        asyncio.run(whole())

    call.__name__ = test.__name__
    return call


async def eventually(true: Callable[[], object]) -> None:
    while not true():
        await asyncio.sleep(0.005)
