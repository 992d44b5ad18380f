"""Seat of a person in a game: the model of their page on the server, connected to the game and to their browser."""

import asyncio
import base64
import hashlib
import time
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Protocol

import msgspec

from thbridge.dialogue.wording.texts import Texts
from thbridge.roles.shared.notices import FloorPlan, PoseTelemetry
from thbridge.roles.shared.view import ParticipantRequest
from thbridge.sockets.reconnecting import ConnectionLost
from ui.model.playing.answer_guard import AnswerGuard
from ui.model.playing.keys import act_for
from ui.model.playing.memory.history import KeptLines
from ui.model.playing.participant import ComposedScreen, Participant
from ui.model.playing.practice import advice
from ui.model.playing.screen import Act, DeclineConsentAct, GoOnFromGame, PeopleAct, Phase, ShowSettings
from ui.sources.game import ReceivedEvent, ServerReached, why_lost
from ui.web.page.floor import floor_shapes
from ui.web.page.game_page import BrowserPage, BrowserPageMaker
from ui.web.page.messages import ActDone, FromGamePage, KeyPressed, PagePainted, decode_act
from ui.web.page.patches import UNCHANGED, Json, patch, tree

PAGE_PERIOD = 1.0 / 15.0
"""Seconds between two pages, unless the person acts: robots glide between two pages."""

POLL_PERIOD = 0.02
"""Seconds between two polls of the game."""

MOST_UNSEEN = 8
"""Largest number of sent pages that the browser has not painted yet; until it paints one, no further page is sent. The
next page then contains the latest state, and the states between are never sent."""


@dataclass(slots=True)
class _SentPage:
    """Page that was sent at a time of the seat's clock, until the browser has painted a later one."""

    composed: ComposedScreen | None
    acting: bool
    at: float


@dataclass(slots=True)
class PageStream:
    """Pages that one browser has received, as differences.

    A browser that connects, or connects again, gets a new stream: its first page is complete.

    Args:
        send: function that sends one message; None while the browser is not connected.
        first: number of the first page.
    """

    send: Callable[[dict[str, Json]], None] | None
    first: int
    page: BrowserPage | None = None
    texts: Texts | None = None
    floor: FloorPlan | None = None
    pictures: set[str] = field(default_factory=set)
    unseen: dict[int, _SentPage] = field(default_factory=dict)
    seen: _SentPage | None = None
    guard: AnswerGuard = field(default_factory=AnswerGuard)

    @property
    def is_full(self) -> bool:
        """True if the browser must paint a page before it receives another one."""
        return sum(number >= self.first for number in self.unseen) >= MOST_UNSEEN


class SeatConnection(Protocol):
    """Connection of a seat to its game; `GameConnection` describes the attributes."""

    requested: tuple[ParticipantRequest, ...]
    declined: bool
    present: bool

    async def run(self, stopped: Callable[[], bool], period: float) -> None:
        """Stay connected until `stopped` returns True; poll the connection after each `period` in seconds."""


class GameSeat:
    """Seat of one person in one game.

    Args:
        connect: returns the connection to the game; its argument is the function that receives the game's events.
        texts: texts until the game has sent its own.
        practice: True for the practice game.
        once: True if only one game is played, and another part of a study follows.
        joins_next: see `Participant`.
        kept: lines of the history from an earlier process of the game. If None, there is no earlier process.
        acted: function that receives the kind of each act, and the age of the page on which the person acted, in
            milliseconds.
        clock: monotonic clock, seconds.

    Attributes:
        went_on: True after the person has left the game for the next part of the study.
        seen_over: True after the browser has shown the end of the game.
        declined: True after the person has declined to take part.
    """

    def __init__(
        self,
        connect: Callable[[Callable[[ReceivedEvent], None]], SeatConnection],
        texts: Texts,
        *,
        practice: bool = False,
        once: bool = True,
        joins_next: bool = False,
        kept: KeptLines | None = None,
        acted: Callable[[str, float], None] = lambda _act, _view_age: None,
        clock: Callable[[], float] = time.monotonic,
    ) -> None:
        self._clock = clock
        self._practice = practice
        self._acted = acted
        self._model = Participant(texts=texts, once=once, joins_next=joins_next, kept=kept)
        self._events: list[ReceivedEvent] = []
        self._connection = connect(self._events.append)
        self._maker = BrowserPageMaker(self._picture_id)
        self._pictures: dict[str, bytes] = {}
        self._ids: dict[int, tuple[bytes, str]] = {}
        self._stream: PageStream | None = None
        self._number = 0
        self._acting = self._replying = False
        self._due = 0.0
        self._stopped = False
        self.went_on = self.seen_over = self.declined = False

    async def run(self) -> None:
        """Keep the seat connected to its game until `stop` is called."""
        connected = asyncio.create_task(self._connection.run(lambda: self._stopped, POLL_PERIOD))
        try:
            while not self._stopped:
                self.refresh()
                await asyncio.sleep(POLL_PERIOD)
            await connected
        finally:
            connected.cancel()

    def stop(self) -> None:
        """Leave the game."""
        self._stopped = True

    def note_presence(self, *, present: bool) -> None:
        """Note if the person is at their browser; the others in a game with several seats see it."""
        self._connection.present = present

    def show_to(self, send: Callable[[dict[str, Json]], None] | None, *, again: bool = False) -> None:
        """Send all pages to this browser from now on, beginning with a complete page. If None, send no pages.

        If `again` is True, the page of the last browser has connected again. It may still send messages about pages
        that it received before.
        """
        before = self._stream
        if send is None:
            if before is not None:
                before.send = None
            return
        self._stream = PageStream(send, self._number + 1)
        if again and before is not None:
            self._stream.unseen, self._stream.seen, self._stream.guard = before.unseen, before.seen, before.guard
        self._due = 0.0

    def receive(self, message: FromGamePage) -> None:
        """Process a message of the browser."""
        stream = self._stream
        if stream is None:
            return
        match message:
            case PagePainted(number, at):
                self._painted(stream, number, at / 1000.0)
            case ActDone(number, at, given, on_map):
                act = decode_act(given)
                if act is not None:
                    self._do(stream, act, number, at / 1000.0, on_map=on_map)
                self._reply()
            case KeyPressed(number, at, key):
                sent = self._sent(stream, number)
                act = None if sent is None or sent.composed is None else act_for(key, sent.composed.screen)
                if act is not None:
                    self._do(stream, act, number, at / 1000.0)
                self._reply()

    def _reply(self) -> None:
        """Send the page after an act or a key at once, also if the page is unchanged."""
        self._replying = True
        self._due = self._clock()
        self.refresh()

    def refresh(self) -> None:
        """Pass the events of the game to the model, and send a page if one is due and differs from the last."""
        now = self._clock()
        events, self._events[:] = list(self._events), []
        # Poses that a page would never show need no processing.
        latest = next((each for each in reversed(events) if isinstance(each.event, PoseTelemetry)), None)
        for received in events:
            match received.event:
                case PoseTelemetry() if received is not latest:
                    pass
                case ServerReached():
                    self._model.connected(received.time)
                case ConnectionLost() as lost:
                    self._model.lost(why_lost(self._model.texts, lost), received.time)
                case notice:
                    self._model.receive(notice, received.time)
        self._connection.requested = self._model.requests()
        if now >= self._due:
            self._due = now + PAGE_PERIOD
            self._send_page(now)

    def _send_page(self, now: float) -> None:
        stream = self._stream
        if stream is None or stream.send is None or stream.is_full:
            return
        screen = self._model.screen(now)
        texts = self._model.texts
        plan = self._model.floor_plan
        if plan is not None and plan is not stream.floor:
            stream.floor = plan
            stream.send({"t": "floor", "floor": tree(floor_shapes(plan))})
        advise = advice(texts, screen) if self._practice else ""
        page = self._maker.page(texts, screen, self._model.robots(now), self._model.followed, advise)
        for picture in (page.enlarged, *(each.picture for each in (page.dialogue, page.treasure) if each is not None)):
            if picture and picture not in stream.pictures:
                stream.pictures.add(picture)
                data = base64.b64encode(self._pictures[picture]).decode("ascii")
                stream.send({"t": "picture", "id": picture, "data": data})
        difference = {"v": tree(page)} if stream.page is None else patch(stream.page, page)
        if difference is None and not self._replying:
            return
        self._number += 1
        stream.page = page
        stream.unseen[self._number] = _SentPage(self._model.composed, self._acting, now)
        self._acting = False
        message: dict[str, Json] = {"t": "page", "n": self._number, "p": difference or UNCHANGED}
        # The first page after an act or a key is marked, so that the time from input to view can be measured.
        stream.send({**message, "reply": True} if self._replying else message)
        self._replying = False

    def _painted(self, stream: PageStream, number: int, at: float) -> None:
        """Note that the browser shows a page, and the pages before it no longer."""
        if number not in stream.unseen:
            return
        before = None if stream.seen is None or stream.seen.composed is None else stream.seen.composed.screen
        acting = any(stream.unseen[each].acting for each in stream.unseen if each <= number)
        stream.seen = stream.unseen[number]
        for earlier in [each for each in stream.unseen if each <= number]:
            del stream.unseen[earlier]
        if stream.seen.composed is not None:
            stream.guard.show(stream.seen.composed.screen, before, at, acting=acting)
            self.seen_over |= stream.seen.composed.screen.phase is Phase.OVER

    def _sent(self, stream: PageStream, number: int) -> _SentPage | None:
        """Return the page that a person acted on: a sent page that is not painted yet is never one."""
        return stream.seen if number not in stream.unseen else None

    def _do(self, stream: PageStream, act: Act, number: int, at: float, *, on_map: bool = False) -> None:
        if isinstance(act, PeopleAct):
            # A text counts on whatever page it was written, because no part of it may be lost.
            self._model.do(act, self._clock())
            return
        sent = self._sent(stream, number)
        if sent is None or sent.composed is None or not stream.guard.admits(act, at, on_map=on_map):
            return
        self._acted(type(act).__name__, (self._clock() - sent.at) * 1000.0)
        match act:
            case DeclineConsentAct():
                self.declined = self._connection.declined = True
            case GoOnFromGame():
                self.went_on = True
            case ShowSettings():
                pass  # The browser has its own settings.
            case _:
                self._model.do(act, self._clock(), sent.composed)
                self._acting = True

    def _picture_id(self, picture: bytes | None) -> str:
        """Return the id of a picture, which is its digest."""
        if picture is None:
            return ""
        known = self._ids.get(id(picture))
        if known is None or known[0] is not picture:
            digest = hashlib.blake2b(picture, digest_size=12).hexdigest()
            self._pictures[digest] = picture
            known = self._ids[id(picture)] = (picture, digest)
        return known[1]


def encoded(message: dict[str, Json]) -> str:
    """Return a message as the text of a WebSocket frame."""
    return msgspec.json.encode(message).decode()
