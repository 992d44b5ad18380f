"""Browser of one person as the window of a study: the same messages as the kiosk's window, over a WebSocket."""

import asyncio
import time
from collections.abc import AsyncIterator, Callable
from contextlib import asynccontextmanager

import msgspec

from thbridge.dialogue.wording.texts import Texts
from ui.model.kiosk import (
    KIOSK,
    FromKiosk,
    GameSeenOver,
    GameToJoin,
    KioskClosed,
    MessageClosed,
    ResearcherMessage,
    StudyTexts,
    ToKiosk,
    WentOn,
)
from ui.web.gateway.players_window import PlayersWindow
from ui.web.page.messages import FROM_GAME_PAGE, leads_on
from ui.web.page.patches import Json
from ui.web.page.study_page import StudyPageMaker
from ui.web.pool.pool import HostedGame

GAME_MESSAGES = ('{"t":"painted"', '{"t":"act"', '{"t":"key"')
"""Beginnings of messages that concern the page of a game; they are passed on unchanged."""


class BrowserWindow(PlayersWindow):
    """Window of one person, which lives as long as their visit; their browser may come and go.

    It implements `WindowOfKiosk`.

    Args:
        texts: texts until the study has sent its own.

    Attributes:
        has_place: True while the person has a place in the study or plays a game. A visitor without a place may be
            forgotten.
    """

    def __init__(self, texts: Texts) -> None:
        super().__init__()
        self.has_place = False
        self._maker = StudyPageMaker(texts)
        self._kept: list[ToKiosk] = []
        self._requests: asyncio.Queue[FromKiosk] = asyncio.Queue()
        self._send_text: Callable[[str], None] | None = None
        self._game_page = 0
        self._gone_at: float | None = time.monotonic()

    # The study's side

    async def send(self, message: ToKiosk) -> None:
        """Show a message; a browser that connects later receives it too, if it still matters."""
        self._kept = list(KIOSK.kept(self._kept, message))
        if isinstance(message, GameToJoin):
            self._game_page = message.page
        self._show(message)
        if isinstance(message, GameToJoin) and self._game is not None and self._send_text is not None:
            # The page of the game exists only now, so everything that the game has sent before is sent again.
            self._game.join()

    async def next_request(self) -> FromKiosk:
        """Wait for the next message of the browser."""
        return await self._requests.get()

    @asynccontextmanager
    async def opened(self) -> AsyncIterator[None]:
        """Do nothing: the browser opens the page."""
        yield

    def leave_open(self) -> None:
        """Do nothing: the page stays open by itself."""

    def close(self) -> None:
        """End the visit."""
        self._requests.put_nowait(KioskClosed())

    def play(self, game: HostedGame | None) -> None:
        """Connect the browser to this game, whose page is `GameToJoin`. If None, disconnect it."""
        if game is not None and self._send_text is not None:
            game.join()
        super().play(game)

    def note_seen_over(self) -> None:
        """Report to the study that the browser shows the end of the game."""
        self._requests.put_nowait(GameSeenOver(self._game_page))

    def note_went_on(self) -> None:
        """Report to the study that the person continues after the game."""
        self._requests.put_nowait(WentOn(self._game_page))

    def show(self, text: str) -> None:
        """Pass on a message of the game to the browser."""
        if self._send_text is not None:
            self._send_text(text)

    @property
    def shows_game(self) -> bool:
        """True while a connected browser shows a game, or the page before the next page of the study."""
        return self.absence == 0.0 and any(isinstance(message, GameToJoin) for message in self._kept)

    @property
    def is_connected(self) -> bool:
        """True while the browser is connected."""
        return self._gone_at is None

    @property
    def absence(self) -> float:
        """Seconds since the browser was last connected; 0 while it is connected."""
        return 0.0 if self._gone_at is None else time.monotonic() - self._gone_at

    # The browser's side

    def connect(self, send: Callable[[str], None], *, again: bool = False) -> None:
        """Show everything to this browser from now on; `again` is True if the page of the last one connects again."""
        self._send_text, self._gone_at = send, None
        for message in self._kept:
            self._show(message)
        if self._game is not None:
            self._game.join(again=again)

    def page_of(self, message: ToKiosk | None = None) -> dict[str, Json] | None:
        """Return the page of a message; without a message, the page that the person sees. None if there is none."""
        pages = (self._maker.page(each) for each in ([message] if message is not None else reversed(self._kept)))
        return next((page for page in pages if page is not None and page["t"] != "message" and "heading" in page), None)

    def elsewhere(self) -> dict[str, Json]:
        """Return the page for a tab while another tab is live."""
        return self._maker.elsewhere()

    def disconnect(self) -> None:
        """Note that the browser is gone."""
        self._send_text, self._gone_at = None, time.monotonic()
        if self._game is not None:
            self._game.part()

    def receive(self, text: str) -> None:
        """Process a message of the browser.

        Raises:
            msgspec.MsgspecError: the message is malformed.
        """
        if text.startswith(GAME_MESSAGES):
            about_game = FROM_GAME_PAGE.decode(text)
            if self._game is not None:
                self._game.pass_on(text)
            elif leads_on(about_game):
                # The worker ends with the game, and people may read the result for longer.
                self.note_went_on()
            return
        message = KIOSK.decode_from_window(text.encode())
        if isinstance(message, MessageClosed):
            self._kept = [each for each in self._kept if not isinstance(each, ResearcherMessage)]
        if not isinstance(message, KioskClosed):  # Only the host may end the visit.
            self._requests.put_nowait(message)

    def _show(self, message: ToKiosk) -> None:
        if isinstance(message, StudyTexts):
            self._maker.texts = message.texts.texts() or self._maker.texts
        page = self._maker.page(message)
        if page is not None and self._send_text is not None:
            self._send_text(msgspec.json.encode(page).decode())
