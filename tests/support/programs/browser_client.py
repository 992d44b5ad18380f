"""Program that visits the gateway like a browser: it keeps the tree of the page, and paints every page at once."""

import asyncio
import http.client
import json
import math
import secrets
import socket
import time
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass, field
from typing import Any

from websockets.asyncio.client import ClientConnection, connect
from websockets.exceptions import ConnectionClosed, InvalidHandshake

SILENCE = 6000.0
"""Milliseconds without any message of the server after which the page connects again."""


@dataclass
class BrowserClient:
    """Browser at the gateway.

    Attributes:
        port: port of the gateway.
        cookie: its cookie.
        study: messages about pages of the study, newest last.
        tree: tree of the game's page; empty before.
        texts: all text that it has received, to be searched.
        host: host of the gateway.
        whole_pages: number of complete pages of games.
        replies: number of replies of the game to acts and keys.
        dial: function that returns a socket connected to the gateway, for a browser on another machine.
        tab: name of the tab.
        visible: True if the page is visible.
        answers: True if it answers heartbeats.
    """

    port: int
    cookie: str = ""
    study: list[dict[str, Any]] = field(default_factory=list)
    tree: dict[str, Any] = field(default_factory=dict)
    texts: list[str] = field(default_factory=list)
    number: int = 0
    whole_pages: int = 0
    replies: int = 0
    tab: str = field(default_factory=lambda: secrets.token_hex(8))
    visible: bool = True
    answers: bool = True
    host: str = "127.0.0.1"
    dial: Callable[[], socket.socket] | None = None
    _outbox: list[str] = field(default_factory=list)
    _confirmed: int = 0
    _left: int = 0
    _painted: asyncio.Event = field(default_factory=asyncio.Event)
    _game: int = 0
    _heard_at: float = math.inf
    _socket: ClientConnection | None = None
    _reading: asyncio.Task[None] | None = None

    def load(self, query: str = "") -> str:
        """Load the page in a new tab, with these parameters in its address; keep the cookie."""
        connection = http.client.HTTPConnection(self.host, self.port, timeout=20)
        connection.sock = self._dial()
        connection.request("GET", f"/{query}", headers={"Cookie": self.cookie} if self.cookie else {})
        answer = connection.getresponse()
        self.cookie = (answer.getheader("set-cookie") or self.cookie).partition(";")[0]
        self.tab = secrets.token_hex(8)
        self._outbox, self._confirmed, self._game = [], 0, 0
        return answer.read().decode()

    async def open(self, origin: str | None = None) -> None:
        """Connect, send what the server has not confirmed, and read from now on."""
        here = f"{self.host}:{self.port}"
        connection = await asyncio.to_thread(self._dial)
        self._socket = await connect(
            f"ws://{here}/socket?tab={self.tab}&first={self._confirmed}",
            origin=origin or f"http://{here}",  # type: ignore[arg-type]
            additional_headers={"Cookie": self.cookie},
            sock=connection,
        )
        with suppress(ConnectionClosed):
            for text in self._outbox:
                await self._socket.send(text)
        self._reading = asyncio.create_task(self._read(self._socket))

    async def keep_connected(self) -> None:
        """Connect again, as the page does, whenever the connection is lost or silent; until cancelled."""
        while True:
            await asyncio.sleep(0.1)
            if self.is_connected and self.now - self._heard_at < SILENCE:
                continue
            self.abort()
            self._heard_at = self.now
            with suppress(OSError, InvalidHandshake, ConnectionClosed):
                async with asyncio.timeout(SILENCE / 1000.0):
                    await self.open()

    def _dial(self) -> socket.socket:
        return self.dial() if self.dial else socket.create_connection((self.host, self.port), 20)

    @classmethod
    async def arrived(cls, port: int, query: str = "", cookie: str = "") -> "BrowserClient":
        """Return a browser that has loaded the page and is connected."""
        browser = cls(port, cookie)
        await asyncio.to_thread(browser.load, query)
        await browser.open()
        return browser

    async def come_back(self, port: int, seconds: float = 60.0) -> None:
        """Load the page again and connect, like a browser that has lost its connection; try until it works."""
        await self.close()
        self.port, self.tree, self.number, self._left = port, {}, 0, 0
        self.study.clear()
        async with asyncio.timeout(seconds):
            while True:
                with suppress(OSError, InvalidHandshake, http.client.HTTPException):
                    await asyncio.to_thread(self.load)
                    await self.open()
                    return
                await asyncio.sleep(0.05)

    @property
    def shown(self) -> dict[str, Any]:
        """The last message about a page of the study; before the first, a message without contents."""
        pages = [message for message in self.study if "page" in message and message["t"] != "kept"]
        return {"t": "", "page": 0, "heading": "", "html": "", **(pages[-1] if pages else {})}

    async def press_button(self) -> None:
        """Wait for a page that is not yet left, and press its main button."""
        await self.until(lambda: self.shown["page"] > self._left and self.shown.get("button"))
        self._left = self.shown["page"]
        await self.send({"type": "WentOn", "page": self._left})

    async def end_game(self) -> None:
        """End a game that is played, and continue."""
        await asyncio.sleep(0.4)  # Answers right after a change of the page are not accepted.
        await self.act({"act": "EndGameAct"})
        await self.until(lambda: self.tree["question"])
        await asyncio.sleep(0.4)
        await self.act(self.tree["question"]["buttons"][0]["act"])
        await self.until(lambda: self.tree["ending"])
        await asyncio.sleep(0.4)
        await self.act(self.tree["ending"]["buttons"][0]["act"])
        # If the game was over before, its result is another page.
        await self.until(lambda: self.shown["t"] in {"recorded", "text"})
        if self.shown["t"] == "recorded":
            await self.send({"type": "WentOn", "page": self.shown["page"]})

    @property
    def is_connected(self) -> bool:
        """True while the connection is open."""
        return self._reading is not None and not self._reading.done()

    def abort(self) -> None:
        """Break the connection at once, as if the browser were killed."""
        if self._socket is not None:
            self._socket.transport.abort()

    async def close(self) -> None:
        """Close the connection."""
        if self._socket is not None:
            await self._socket.close()
        if self._reading is not None:
            await asyncio.gather(self._reading, return_exceptions=True)

    async def send(self, message: dict[str, Any]) -> None:
        """Send a message, which is sent again after a lost connection."""
        assert self._socket is not None
        self._outbox.append(json.dumps(message, separators=(",", ":")))
        await self._socket.send(self._outbox[-1])

    async def send_text(self, text: str | bytes) -> None:
        """Send a message that need not be valid."""
        assert self._socket is not None
        await self._socket.send(text)

    async def closed(self) -> int:
        """Wait until the server closes the connection; return its reason."""
        assert self._socket is not None
        await self._socket.wait_closed()
        return self._socket.close_code or 0

    async def press(self, key: str) -> None:
        """Press a key."""
        await self.send({"t": "key", "n": self.number, "at": self.now, "key": key})

    async def act(self, act: dict[str, Any]) -> None:
        """Press the button of an act."""
        await self.send({"t": "act", "n": self.number, "at": self.now, "act": act, "on_map": False})

    async def until(self, happened: Callable[[], object], seconds: float = 60.0) -> None:
        """Wait for something."""
        async with asyncio.timeout(seconds):
            while not happened():
                await asyncio.sleep(0.02)

    async def received(self) -> None:
        """Wait for the next page of the game, for at most a second."""
        self._painted.clear()
        with suppress(TimeoutError):
            async with asyncio.timeout(1.0):
                await self._painted.wait()

    @property
    def now(self) -> float:
        """The browser's clock, milliseconds."""
        return time.monotonic() * 1000.0

    async def _read(self, connection: ClientConnection) -> None:
        with suppress(ConnectionClosed):
            await self._read_all(connection)

    async def _read_all(self, connection: ClientConnection) -> None:
        async for text in connection:
            self._heard_at = self.now
            self.texts.append(str(text))
            message = json.loads(text)
            match message["t"]:
                case "ping" if not self.answers:
                    pass
                case "ping":
                    del self._outbox[: message["heard"] - self._confirmed]
                    self._confirmed = message["heard"]
                    pong = {"t": "pong", "at": message["at"], "visible": self.visible}
                    await connection.send(json.dumps(pong, separators=(",", ":")))
                case "page":
                    self.tree = applied(self.tree, message["p"])
                    self.number = message["n"]
                    self.whole_pages += "v" in message["p"]
                    self.replies += message.get("reply", False)
                    self._painted.set()
                    await self.send({"t": "painted", "n": self.number, "at": self.now})
                case "floor" | "picture":
                    pass
                case "game":
                    if message["page"] != self._game:
                        # The page of another game, or of the same game in another process, begins without contents.
                        self.tree, self.number, self._game = {}, 0, message["page"]
                    self.study.append(message)
                case _:
                    self.study.append(message)


def applied(before: Any, change: dict[str, Any]) -> Any:
    """Apply a difference, as `ui/web/static/patches.js` does."""
    if "v" in change:
        return change["v"]
    if "f" in change:
        return {**before, **{name: applied(before[name], each) for name, each in change["f"].items()}}
    length, changes, added = change["l"]
    after = list(before[:length])
    for index, each in changes.items():
        after[int(index)] = applied(after[int(index)], each)
    return [*after, *added]
