"""Gateway that shows given states of the page, for pictures and for tests in a real browser."""

import asyncio
import contextlib
import socket
import threading
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass

import msgspec
import uvicorn

from thbridge.dialogue.wording.texts import Texts
from thbridge.roles.shared.notices import FloorPlan, GameTexts
from ui.model.kiosk import StudyTexts, ToKiosk
from ui.model.playing.screen import Screen
from ui.model.shared.scene import RobotMark
from ui.web.gateway.app import application
from ui.web.gateway.browser_window import BrowserWindow
from ui.web.gateway.entry import open_to_all
from ui.web.gateway.limits import ClientLimits
from ui.web.gateway.people import Visitor, Visitors
from ui.web.page.floor import floor_shapes
from ui.web.page.game_page import BrowserPage, BrowserPageMaker
from ui.web.page.patches import Json, tree

NO_SOCKET = "WebSocket = class extends WebSocket { constructor() { super(`ws://${location.host}/nothing`); } };"
"""JavaScript after which the page cannot connect."""


@dataclass(frozen=True)
class ShownGame:
    """Page of a game, with the floor and the pictures that the browser receives before it."""

    page: BrowserPage
    floor: FloorPlan | None
    pictures: Mapping[str, bytes]


@dataclass(frozen=True)
class PageState:
    """State of the page in a browser.

    Attributes:
        name: name of the picture.
        messages: messages of the study's host.
        game: game that is shown; None outside of games.
        before: JavaScript that runs before the page's own scripts.
        blocked: addresses that the browser cannot reach, with `*` for any text.
        deed: JavaScript that does on the page what a person does.
    """

    name: str
    messages: Sequence[ToKiosk] = ()
    game: ShownGame | None = None
    before: str = ""
    blocked: tuple[str, ...] = ()
    deed: str = ""


def shown_game(
    texts: Texts,
    screen: Screen,
    robots: Iterable[RobotMark] = (),
    floor: FloorPlan | None = None,
    followed: int | None = None,
    advise: str = "",
) -> ShownGame:
    """Return the page of a game that shows a screen."""
    pictures: dict[str, bytes] = {}

    def picture_id(picture: bytes | None) -> str:
        if picture is None:
            return ""
        pictures[name := f"{hash(picture):x}"] = picture
        return name

    page = BrowserPageMaker(picture_id).page(texts, screen, robots, followed, advise)
    return ShownGame(page, floor, pictures)


class _Game:
    """Game that shows one page, and passes on the messages of the browser."""

    def __init__(self, window: BrowserWindow, shown: ShownGame, received: Callable[[str], None]) -> None:
        self._window, self._shown, self.pass_on = window, shown, received

    def join(self, *, again: bool = False) -> None:
        """Show everything."""
        shown = self._shown
        if shown.floor is not None:
            self._show({"t": "floor", "floor": tree(floor_shapes(shown.floor))})
        for name, picture in shown.pictures.items():
            self._show({"t": "picture", "id": name, "data": msgspec.json.encode(picture).decode().strip('"')})
        self._show({"t": "page", "n": 1, "p": {"v": tree(shown.page)}})

    def part(self) -> None:
        """Do nothing: the page does not change."""

    def _show(self, message: dict[str, Json]) -> None:
        self._window.show(msgspec.json.encode(message).decode())


class StateServer:
    """The gateway, whose visitors all see one state.

    Args:
        texts: texts of all pages.

    Attributes:
        state: state that the next visitors see.
        received: messages of the browsers about games.
    """

    def __init__(self, texts: Texts) -> None:
        self._texts = texts
        self.state = PageState("")
        self.received: list[str] = []
        self._listening = socket.create_server(("127.0.0.1", 0))

    @property
    def address(self) -> str:
        """Address of the page."""
        return f"http://127.0.0.1:{self._listening.getsockname()[1]}/"

    @contextlib.contextmanager
    def running(self) -> Iterator["StateServer"]:
        """Serve in a thread."""
        visitors = Visitors(self._visit, lambda: BrowserWindow(self._texts), open_to_all)
        config = uvicorn.Config(application(visitors, self._texts, ClientLimits()), log_level="warning", lifespan="off")
        server = uvicorn.Server(config)
        thread = threading.Thread(target=lambda: asyncio.run(server.serve([self._listening])), daemon=True)
        thread.start()
        try:
            yield self
        finally:
            server.should_exit = server.force_exit = True
            thread.join(30)

    async def _visit(self, visitor: Visitor) -> None:
        window = visitor.window
        state = self.state
        await window.send(StudyTexts(GameTexts.of(self._texts)))
        if state.game is not None:
            window.play(_Game(window, state.game, self.received.append))  # type: ignore[arg-type]
        for message in state.messages:
            await window.send(message)
        await asyncio.Event().wait()
