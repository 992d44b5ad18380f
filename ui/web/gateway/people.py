"""People who visit the gateway: each has a secret in a cookie, one live socket, and a course."""

import asyncio
import secrets
from collections.abc import Awaitable, Callable
from dataclasses import dataclass, field

from ui.web.gateway.browser_window import BrowserWindow

MOST_EXPECTED = 10_000
"""Maximum number of browsers that have loaded the page but not connected yet; further browsers replace the oldest."""
MOST_WITHOUT_PLACE = 1000
"""Maximum number of visitors without a place."""
FORGOTTEN_AFTER = 600.0
"""Seconds after which a visitor without a place is forgotten if their browser is gone."""
LOOK = 5.0
"""Seconds between two looks for visitors to forget."""


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
    _expected: dict[str, None] = field(default_factory=dict)

    def expect(self, secret: str = "") -> str:
        """Return the secret of a browser that loads the page: its own one, or a new one if it has none.

        A visit begins only when the browser connects.
        """
        secret = secret or secrets.token_urlsafe(24)
        if secret not in self._by_secret:
            self._expected.pop(secret, None)
            if len(self._expected) >= MOST_EXPECTED:
                del self._expected[next(iter(self._expected))]
            self._expected[secret] = None
        return secret

    def expects(self, secret: str) -> bool:
        """Return True if a page was loaded with this secret, and its visit has not begun."""
        return secret in self._expected

    def connected(self, secret: str) -> Visitor | None:
        """Return the visitor whose browser connects. The course of a new visitor begins.

        If None, no page was loaded with this secret, or there are too many visitors.
        """
        visitor = self._by_secret.get(secret)
        if visitor is not None or secret not in self._expected or not self._has_room():
            return visitor
        del self._expected[secret]
        visitor = self._by_secret[secret] = Visitor(secret, self.make_window())
        visitor.course = asyncio.ensure_future(self.begin(visitor.window, secret))
        return visitor

    async def forget_idle(self) -> None:
        """Forget visitors who have no place and do not come back, until cancelled."""
        while True:
            await asyncio.sleep(LOOK)
            for visitor in self._without_place():
                if visitor.window.absence > FORGOTTEN_AFTER:
                    self._forget(visitor)

    async def end(self) -> None:
        """End all courses."""
        courses = [visitor.course for visitor in self._by_secret.values() if visitor.course is not None]
        for course in courses:
            course.cancel()
        await asyncio.gather(*courses, return_exceptions=True)

    def _has_room(self) -> bool:
        """Return True if another visitor is possible; the visitor who has been away longest may be forgotten."""
        without = self._without_place()
        if len(without) < MOST_WITHOUT_PLACE:
            return True
        longest = max(without, key=lambda visitor: visitor.window.absence)
        if longest.window.absence > 0.0:
            self._forget(longest)
        return longest.window.absence > 0.0

    def _without_place(self) -> list[Visitor]:
        return [visitor for visitor in self._by_secret.values() if not visitor.window.has_place]

    def _forget(self, visitor: Visitor) -> None:
        del self._by_secret[visitor.secret]
        if visitor.course is not None:
            visitor.course.cancel()
