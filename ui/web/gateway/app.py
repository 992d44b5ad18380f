"""Web application of the gateway: the page, its files, and the socket of each visitor."""

import asyncio
import re
import time
from collections.abc import Callable
from contextlib import suppress
from html import escape
from pathlib import Path

import msgspec
from starlette.applications import Starlette
from starlette.middleware import Middleware
from starlette.requests import HTTPConnection, Request
from starlette.responses import HTMLResponse, PlainTextResponse, Response
from starlette.routing import Mount, Route, WebSocketRoute
from starlette.staticfiles import StaticFiles
from starlette.types import ASGIApp, Receive, Scope, Send
from starlette.websockets import WebSocket, WebSocketDisconnect

from thbridge.dialogue.wording.texts import Texts
from ui.web.gateway.limits import ClientLimits, network_of
from ui.web.gateway.people import Visitor, Visitors
from ui.web.page.theme_css import THEME_CSS

STATIC = Path(__file__).parents[1] / "static"
COOKIE = "thbridge"
PING_PERIOD = 2.0
"""Seconds between two heartbeats."""
SILENCE = 8.0
"""Seconds without any message of a browser after which its socket is closed."""
QUEUE = 256
"""Messages that may wait for a browser; above it the socket is closed, and the browser connects again."""
POLICY = (
    "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' blob: data:; connect-src 'self'; "
    "base-uri 'none'; form-action 'none'; frame-ancestors 'none'"
)


UNKNOWN, TOO_OFTEN, MALFORMED, BUSY = 4403, 4429, 1008, 1013
"""Reasons for which the gateway closes a socket: the page must be loaded again; connected too often; a malformed
message; too many visitors."""
STUDY_MESSAGE = 3.0
"""Cost of a message about a page of a study, whose event is written to the disk; a message about a game costs 1."""
_SECRET = re.compile(r"[\w-]{32}", re.ASCII)


def application(visitors: Visitors, texts: Texts, limits: ClientLimits) -> Starlette:
    """Return the application for these visitors, with texts for the page before it is connected."""
    index = (STATIC / "index.html").read_text(encoding="utf-8").replace("{{language}}", texts.language)
    for key in ("window.title", "pages.one_moment", "web.needs_newer", "web.needs_script", "web.needs_cookies"):
        index = index.replace(f"{{{{{key}}}}}", escape(texts.text(key)))

    async def page(request: Request) -> Response:
        response = HTMLResponse(index)
        secret = request.cookies.get(COOKIE, "")
        secret = visitors.expect(secret if _SECRET.fullmatch(secret) else "")
        secure = request.url.scheme == "https"
        response.set_cookie(COOKIE, secret, httponly=True, samesite="strict", secure=secure, path="/")
        return _guarded(response)

    async def theme(_request: Request) -> Response:
        return _guarded(PlainTextResponse(THEME_CSS, media_type="text/css"))

    async def socket(websocket: WebSocket) -> None:
        secret, address = websocket.cookies.get(COOKIE, ""), _address(websocket)
        if not _same_origin(websocket):
            limits.refusals.warn(f"{address} opened a socket from a page of another site; it is refused.")
            await websocket.close()
            return
        # The page receives the reason only after the socket is accepted.
        await websocket.accept()
        if not (limits.sockets.admits(address) and limits.tabs.admits(secret)):
            limits.refusals.warn(f"{address} connects too often; its sockets are closed.")
            await websocket.close(TOO_OFTEN)
        elif (visitor := visitors.connected(secret)) is None:
            await websocket.close(BUSY if visitors.expects(secret) else UNKNOWN)
        else:
            await _serve(websocket, visitor, limits)

    return Starlette(
        routes=[
            Route("/", page),
            Route("/theme.css", theme),
            WebSocketRoute("/socket", socket),
            Mount("/static", StaticFiles(directory=STATIC)),
        ],
        middleware=[Middleware(_LimitedRequests, limits=limits, refusal=texts.text("web.too_many"))],
    )


class _LimitedRequests:
    """Limit of requests for each address."""

    def __init__(self, app: ASGIApp, limits: ClientLimits, refusal: str) -> None:
        self._app, self._limits = app, limits
        self._refusal = PlainTextResponse(refusal, 429, {"Retry-After": "10"})

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        if scope["type"] == "http":
            address = _address(HTTPConnection(scope))
            if not self._limits.pages.admits(address):
                self._limits.refusals.warn(f"{address} loads too many pages; it gets no page for some seconds.")
                await self._refusal(scope, receive, send)
                return
        await self._app(scope, receive, send)


def _address(connection: HTTPConnection) -> str:
    """Return the address of a client, or its network; see `network_of`."""
    return "" if connection.client is None else network_of(connection.client.host)


def _guarded(response: Response) -> Response:
    response.headers["Content-Security-Policy"] = POLICY
    response.headers["X-Content-Type-Options"] = "nosniff"
    response.headers["Referrer-Policy"] = "no-referrer"
    response.headers["Cache-Control"] = "no-store"
    return response


def _same_origin(websocket: WebSocket) -> bool:
    """Return True if the page that opened the socket came from this gateway."""
    scheme, _, host = websocket.headers.get("origin", "").partition("://")
    return host == websocket.headers.get("host", "") and (scheme == "https" or websocket.url.scheme == "ws")


class _Ping(msgspec.Struct, frozen=True, tag_field="t", tag="pong"):
    """Browser: answer to a heartbeat; `at` is the server's time in it."""

    at: float
    visible: bool


_PONG = msgspec.json.Decoder(_Ping)


async def _serve(websocket: WebSocket, visitor: Visitor, limits: ClientLimits) -> None:
    """Serve one socket; the browser that had the visitor's live socket before is informed."""
    waiting: asyncio.Queue[str | None] = asyncio.Queue(QUEUE)

    def send(text: str) -> None:
        if waiting.full():
            # The browser no longer reads. It gets the present state when it connects again.
            while not waiting.empty():
                waiting.get_nowait()
            waiting.put_nowait(None)
        else:
            waiting.put_nowait(text)

    def give_way() -> None:
        send('{"t":"taken over"}')
        send_end()

    def send_end() -> None:
        with suppress(asyncio.QueueFull):
            waiting.put_nowait(None)

    if visitor.take_over is not None:
        visitor.take_over()
    visitor.take_over = give_way
    visitor.window.connect(send)
    sending = asyncio.create_task(_send(websocket, waiting))
    beating = asyncio.create_task(_beat(send))
    closing = (1000, "")
    try:
        await _receive(websocket, visitor, limits, lambda: visitor.take_over is give_way)
    except (WebSocketDisconnect, TimeoutError, RuntimeError):
        pass
    except (msgspec.MsgspecError, RecursionError, UnicodeError, KeyError):
        limits.refusals.warn(f"{_address(websocket)} sent a malformed message; its socket is closed.")
        closing = (MALFORMED, "malformed message")
    finally:
        beating.cancel()
        sending.cancel()
        if visitor.take_over is give_way:
            visitor.take_over = None
            visitor.window.disconnect()
        with suppress(RuntimeError, WebSocketDisconnect):
            await websocket.close(*closing)


async def _send(websocket: WebSocket, waiting: "asyncio.Queue[str | None]") -> None:
    while (text := await waiting.get()) is not None:
        await websocket.send_text(text)
    await websocket.close(4000)


async def _beat(send: Callable[[str], None]) -> None:
    while True:
        send(f'{{"t":"ping","at":{time.monotonic() * 1000.0:.1f}}}')
        await asyncio.sleep(PING_PERIOD)


async def _receive(websocket: WebSocket, visitor: Visitor, limits: ClientLimits, is_live: Callable[[], bool]) -> None:
    """Pass on the messages of a browser, at most at the rate of the limits, while its socket is the live one."""
    while True:
        async with asyncio.timeout(SILENCE):
            text = await websocket.receive_text()
        if not is_live():
            continue
        cost = 1.0 if text.startswith('{"t":') else STUDY_MESSAGE
        if delay := limits.messages.delay(visitor.secret, cost):
            limits.refusals.warn(f"{_address(websocket)} sends too many messages; they are processed later.")
            await asyncio.sleep(delay)
        limits.messages.take(visitor.secret, cost)
        if text.startswith('{"t":"pong"'):
            pong = _PONG.decode(text)
            visitor.round_trip = time.monotonic() * 1000.0 - pong.at
            visitor.visible = pong.visible
        else:
            visitor.window.receive(text)
