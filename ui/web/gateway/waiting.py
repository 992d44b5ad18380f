"""Page on which a person waits for a place in the study or for a game, with a clock and a button to stop waiting."""

import asyncio
import math
import time
from collections.abc import Awaitable, Callable

from msgspec import structs

from thbridge.dialogue.wording.texts import Texts
from ui.hosting.kiosk.pages import KioskPages, WindowOfKiosk
from ui.model.kiosk import HostStops, TurnToAwait, WentOn

CLOCK_PERIOD = 1.0
"""Seconds between two updates of the clock, and between two looks if the turn has come."""


async def await_turn(
    pages: KioskPages,
    words: tuple[str, str],
    has_come: Callable[[], bool],
    before: Callable[[], int] = lambda: 0,
    longest: float = math.inf,
) -> bool:
    """Show the waiting page until the person's turn has come; return False if the person stops waiting, or must.

    Args:
        pages: pages of the person.
        words: heading and text: what the person waits for.
        has_come: function that returns True when the person need not wait any longer. It is called each second.
        before: function that returns the number of people who come first.
        longest: seconds after which the person must stop waiting.

    Raises:
        RunOver: the person's run has ended meanwhile.
    """
    if has_come():
        return True

    def has_come_in_run() -> bool:
        if pages.person:
            pages.check()
        return has_come()

    page = pages.numbered(TurnToAwait(0, *words))
    return await show_turn(page, pages.window, pages.next, has_come_in_run, before, longest)  # type: ignore[arg-type]


async def show_turn(
    page: TurnToAwait,
    window: WindowOfKiosk,
    next_message: Callable[[], Awaitable[object]],
    has_come: Callable[[], bool],
    before: Callable[[], int] = lambda: 0,
    longest: float = math.inf,
) -> bool:
    """Show a waiting page until a turn has come; see `await_turn`."""
    began = time.monotonic()
    while not has_come():
        waited = time.monotonic() - began
        if waited > longest:
            return False
        await window.send(structs.replace(page, waited=int(waited), before=before()))
        try:
            async with asyncio.timeout(CLOCK_PERIOD):
                if isinstance(await next_message(), WentOn):
                    return False
        except TimeoutError:
            pass
    return True


async def pause(window: WindowOfKiosk, texts: Texts) -> None:
    """Show that nothing further begins on this server, until it ends."""
    await window.send(HostStops(texts.text("kiosk.pauses"), texts.text("web.pauses_text")))
    await asyncio.Event().wait()
