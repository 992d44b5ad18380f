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
from starlette.requests import Request
from starlette.responses import HTMLResponse, PlainTextResponse, Response
from starlette.routing import Mount, Route, WebSocketRoute
from starlette.staticfiles import StaticFiles
from starlette.websockets import WebSocket, WebSocketDisconnect

from thbridge.dialogue.wording.texts import Texts
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


_SECRET = re.compile(r"[\w-]{32}")


def application(visitors: Visitors, texts: Texts) -> Starlette:
    """Return the application for these visitors, with texts for the page before it is connected."""
    index = (STATIC / "index.html").read_text(encoding="utf-8").replace("{{language}}", texts.language)
    for key in ("window.title", "pages.one_moment", "web.needs_newer", "web.needs_script"):
        index = index.replace(f"{{{{{key}}}}}", escape(texts.text(key)))

    async def page(request: Request) -> Response:
        response = HTMLResponse(index)
        secret = request.cookies.get(COOKIE, "")
        visitor = visitors.known(secret) or visitors.admit(secret if _SECRET.fullmatch(secret) else "")
        secure = request.url.scheme == "https"
        response.set_cookie(COOKIE, visitor.secret, httponly=True, samesite="strict", secure=secure, path="/")
        return _guarded(response)

    async def theme(_request: Request) -> Response:
        return _guarded(PlainTextResponse(THEME_CSS, media_type="text/css"))

    async def socket(websocket: WebSocket) -> None:
        visitor = visitors.known(websocket.cookies.get(COOKIE, ""))
        if visitor is None or not _same_origin(websocket):
            await websocket.close(4403)
            return
        await websocket.accept()
        await _serve(websocket, visitor)

    return Starlette(
        routes=[
            Route("/", page),
            Route("/theme.css", theme),
            WebSocketRoute("/socket", socket),
            Mount("/static", StaticFiles(directory=STATIC)),
        ]
    )


def _guarded(response: Response) -> Response:
    response.headers["Content-Security-Policy"] = POLICY
    response.headers["X-Content-Type-Options"] = "nosniff"
    response.headers["Referrer-Policy"] = "no-referrer"
    response.headers["Cache-Control"] = "no-store"
    return response


def _same_origin(websocket: WebSocket) -> bool:
    """Return True if the page that opened the socket came from this gateway."""
    origin = websocket.headers.get("origin", "")
    return origin.partition("://")[2] == websocket.headers.get("host", "")


class _Ping(msgspec.Struct, frozen=True, tag_field="t", tag="pong"):
    """Browser: answer to a heartbeat; `at` is the server's time in it."""

    at: float
    visible: bool


_PONG = msgspec.json.Decoder(_Ping)


async def _serve(websocket: WebSocket, visitor: Visitor) -> None:
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
    try:
        await _receive(websocket, visitor)
    except (WebSocketDisconnect, TimeoutError, msgspec.MsgspecError, RuntimeError):
        pass
    finally:
        beating.cancel()
        sending.cancel()
        if visitor.take_over is give_way:
            visitor.take_over = None
            visitor.window.disconnect()
        with suppress(RuntimeError, WebSocketDisconnect):
            await websocket.close()


async def _send(websocket: WebSocket, waiting: "asyncio.Queue[str | None]") -> None:
    while (text := await waiting.get()) is not None:
        await websocket.send_text(text)
    await websocket.close(4000)


async def _beat(send: Callable[[str], None]) -> None:
    while True:
        send(f'{{"t":"ping","at":{time.monotonic() * 1000.0:.1f}}}')
        await asyncio.sleep(PING_PERIOD)


async def _receive(websocket: WebSocket, visitor: Visitor) -> None:
    while True:
        async with asyncio.timeout(SILENCE):
            text = await websocket.receive_text()
        if text.startswith('{"t":"pong"'):
            pong = _PONG.decode(text)
            visitor.round_trip = time.monotonic() * 1000.0 - pong.at
            visitor.visible = pong.visible
        else:
            visitor.window.receive(text)
