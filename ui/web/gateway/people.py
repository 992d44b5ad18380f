"""People who visit the gateway: each has a secret in a cookie, one live socket, and a course."""

import asyncio
import secrets
from collections.abc import Awaitable, Callable
from dataclasses import dataclass, field

from ui.web.gateway.browser_window import BrowserWindow


@dataclass(slots=True, eq=False)
class Visitor:
    """Person who visits.

    Attributes:
        secret: secret that their browser shows in its cookie.
        window: their browser as the window of the study.
        course: task that takes them through the study.
        take_over: function that informs the browser with the live socket that another one takes over; None without a
            live socket.
        round_trip: last measured round-trip time in milliseconds; None before the first.
        visible: True while the page is visible.
    """

    secret: str
    window: BrowserWindow
    course: asyncio.Task[None] | None = None
    take_over: Callable[[], None] | None = None
    round_trip: float | None = None
    visible: bool = True


@dataclass(slots=True)
class Visitors:
    """All visitors.

    Attributes:
        begin: function that takes a visitor through their course, given their window and their secret.
        make_window: function that returns a window for a new visitor.
    """

    begin: Callable[[BrowserWindow, str], Awaitable[None]]
    make_window: Callable[[], BrowserWindow]
    _by_secret: dict[str, Visitor] = field(default_factory=dict)

    def known(self, secret: str) -> Visitor | None:
        """Return the visitor with this secret, if there is one."""
        return self._by_secret.get(secret)

    def admit(self, secret: str = "") -> Visitor:
        """Return a new visitor, whose course begins; `secret` is that of a browser from before a restart."""
        visitor = Visitor(secret or secrets.token_urlsafe(24), self.make_window())
        self._by_secret[visitor.secret] = visitor
        visitor.course = asyncio.ensure_future(self.begin(visitor.window, visitor.secret))
        return visitor

    async def end(self) -> None:
        """End all courses."""
        courses = [visitor.course for visitor in self._by_secret.values() if visitor.course is not None]
        for course in courses:
            course.cancel()
        await asyncio.gather(*courses, return_exceptions=True)
