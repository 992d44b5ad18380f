"""People who visit the gateway: each has a secret in a cookie, a course, and one live tab."""

import asyncio
import secrets
import time
from collections.abc import Awaitable, Callable, Mapping
from dataclasses import dataclass, field

from ui.model.kiosk import ToKiosk
from ui.web.gateway.browser_window import BrowserWindow
from ui.web.gateway.entry import EntryRule, LinkEntry
from ui.web.gateway.inbox import Inbox
from ui.web.page.patches import Json

MOST_EXPECTED = 10_000
"""Maximum number of browsers that have loaded the page but not connected yet; further browsers replace the oldest."""
MOST_WITHOUT_PLACE = 1000
"""Maximum number of visitors without a place."""
FORGOTTEN_AFTER = 600.0
"""Seconds after which a visitor without a place is forgotten if their browser is gone."""
LOOK = 5.0
"""Seconds between two looks for visitors to forget."""
MOST_TABS = 4
"""Tabs of one person that may be connected at the same time; if another one connects, the oldest is closed."""


@dataclass(slots=True, eq=False)
class Tab:
    """Page of a visitor that is connected.

    Attributes:
        name: random name that the page has given itself; it keeps the name when it connects again. If empty, its
            messages have no numbers.
        number: number of its next message.
        send: function that sends a message to the page.
        inform: function that informs the page that another tab is live.
        close: function that closes the connection.
    """

    name: str
    number: int
    send: Callable[[str], None]
    inform: Callable[[], None]
    close: Callable[[], None]


@dataclass(slots=True, eq=False)
class Visitor:
    """Person who visits.

    Attributes:
        secret: secret that their browser shows in its cookie.
        window: their browser as the window of the study.
        entry: contents of their link.
        course: task that takes them through the study.
        live: tab that shows the study; None if there is none.
        others: tabs that may take over, the latest last.
        round_trip: last measured round-trip time in milliseconds; None before the first.
        greatest_round_trip: largest round-trip time since it was last set to 0, milliseconds.
        present_at: monotonic time at which the page was last known to be connected and visible.
        inbox: messages of their live tab that were processed.
    """

    secret: str
    window: BrowserWindow
    entry: LinkEntry
    course: asyncio.Task[None] | None = None
    live: Tab | None = None
    others: list[Tab] = field(default_factory=list)
    round_trip: float | None = None
    greatest_round_trip: float = 0.0
    present_at: float = field(default_factory=time.monotonic)
    inbox: Inbox = field(default_factory=Inbox)

    def connect(self, tab: Tab) -> None:
        """Make a tab live if there is no other live tab; otherwise inform it of the live tab."""
        if self.live is None or (tab.name and tab.name == self.live.name):
            self.take_over(tab)
            return
        self.others.append(tab)
        tab.inform()
        if len(self.others) >= MOST_TABS:
            self.others[0].close()

    def take_over(self, tab: Tab) -> None:
        """Make a tab live. The tab that was live is informed, or closed if it is an earlier connection of the tab."""
        before, self.live = self.live, tab
        if tab in self.others:
            self.others.remove(tab)
        if before is not None and before is not tab:
            if before.name == tab.name:
                before.close()
            else:
                self.others.append(before)
                before.inform()
        self.window.connect(tab.send, again=self.inbox.connect(tab.name, tab.number))

    def disconnect(self, tab: Tab) -> None:
        """Note that a tab is gone. If it was live, the latest of the other tabs takes over."""
        if tab in self.others:
            self.others.remove(tab)
        elif tab is self.live:
            self.live = None
            self.window.disconnect()
            if self.others:
                self.take_over(self.others[-1])

    def note_pong(self, round_trip: float, *, visible: bool) -> None:
        """Receive the answer of the live tab to a heartbeat, with the round-trip time in milliseconds."""
        self.round_trip = round_trip
        self.greatest_round_trip = max(self.greatest_round_trip, round_trip)
        if visible:
            self.present_at = time.monotonic()


@dataclass(slots=True)
class Visitors:
    """All visitors.

    Attributes:
        begin: function that takes a visitor through their course.
        make_window: function that returns a window for a new visitor.
        entry: rule of who may enter.
        greet: function that returns the first page of the visitor with a secret and a link; None if it is not known.
        begins_again: True to begin a course again if the page is loaded after the end of the course.
    """

    begin: Callable[[Visitor], Awaitable[None]]
    make_window: Callable[[], BrowserWindow]
    entry: EntryRule
    greet: Callable[[str, LinkEntry], ToKiosk | None] = lambda _secret, _entry: None
    begins_again: bool = False
    _by_secret: dict[str, Visitor] = field(default_factory=dict)
    _expected: dict[str, LinkEntry] = field(default_factory=dict)
    _secrets: dict[str, str] = field(default_factory=dict)
    # Secret of each expected browser or visitor with a code or an id of a recruiting service.

    def expect(self, secret: str, query: Mapping[str, str]) -> str:
        """Return the secret of a browser that loads the page: its own, that of the person with the link, or a new one.

        A visit begins only when the browser connects. See also `begins_again`.

        Args:
            secret: secret in the browser's cookie; empty if there is none.
            query: parameters in the address.

        Raises:
            EntryRefused: the link admits no one.
        """
        entry = self.entry(query, secret)
        if entry.external_id and self._secrets.get(entry.external_id) != secret:
            # The link decides who the person is, and not the browser, which may belong to someone else.
            secret = self._secrets.get(entry.external_id, "")
        secret = secret or secrets.token_urlsafe(24)
        visitor = self._by_secret.get(secret)
        if visitor is None:
            before = self._expected.pop(secret, entry)
            entry = entry if entry.external_id else before
            if len(self._expected) >= MOST_EXPECTED:
                oldest = next(iter(self._expected))
                self._forget_link(self._expected.pop(oldest), oldest)
            self._expected[secret] = entry
            if entry.external_id:
                self._secrets[entry.external_id] = secret
        elif self.begins_again and (visitor.course is None or visitor.course.done()):
            visitor.course = asyncio.ensure_future(self.begin(visitor))
        return secret

    def first_page(self, secret: str) -> dict[str, Json] | None:
        """Return the page that an expected browser sees first; None if it is not known."""
        if (visitor := self._by_secret.get(secret)) is not None:
            return visitor.window.page_of()
        message = self.greet(secret, self._expected[secret])
        return None if message is None else self.make_window().page_of(message)

    def knows(self, secret: str) -> bool:
        """Return True if there is a visitor with this secret, or a page was loaded with it."""
        return secret in self._by_secret or secret in self._expected

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
        entry = self._expected.pop(secret)
        visitor = self._by_secret[secret] = Visitor(secret, self.make_window(), entry)
        visitor.course = asyncio.ensure_future(self.begin(visitor))
        return visitor

    async def forget_idle(self) -> None:
        """Forget visitors who have no place and do not come back, until cancelled."""
        while True:
            await asyncio.sleep(LOOK)
            for visitor in self._without_place():
                if visitor.window.absence > FORGOTTEN_AFTER:
                    self._forget(visitor)

    @property
    def see_games(self) -> bool:
        """True while the browser of a visitor shows a game."""
        return any(visitor.window.shows_game for visitor in self._by_secret.values())

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
        self._forget_link(visitor.entry, visitor.secret)
        if visitor.course is not None:
            visitor.course.cancel()

    def _forget_link(self, entry: LinkEntry, secret: str) -> None:
        if self._secrets.get(entry.external_id) == secret:
            del self._secrets[entry.external_id]
