"""Page on which a person waits for a place in the study or for a game, with a clock and a button to stop waiting."""

import asyncio
import time
from collections.abc import Callable

from msgspec import structs

from ui.hosting.kiosk.pages import KioskPages
from ui.model.kiosk import TurnToAwait, WentOn

CLOCK_PERIOD = 1.0
"""Seconds between two updates of the clock, and between two looks if the turn has come."""


async def await_turn(pages: KioskPages, words: tuple[str, str], has_come: Callable[[], bool]) -> bool:
    """Show the waiting page until the person's turn has come; return False if the person stops waiting.

    Args:
        pages: pages of the person.
        words: heading and text: what the person waits for.
        has_come: function that returns True when the person need not wait any longer. It is called each second.

    Raises:
        RunOver: the person's run has ended meanwhile.
    """
    if has_come():
        return True
    began, page = time.monotonic(), pages.numbered(TurnToAwait(0, *words))
    while not has_come():
        await pages.window.send(structs.replace(page, waited=int(time.monotonic() - began)))
        try:
            async with asyncio.timeout(CLOCK_PERIOD):
                if isinstance(await pages.next(), WentOn):
                    return False
        except TimeoutError:
            pass
        if pages.person:
            pages.check()
    return True
