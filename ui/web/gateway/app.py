"""Web application of the gateway: the page, its files, and the socket of each visitor."""

import asyncio
import re
import time
from collections.abc import Callable
from contextlib import suppress
from html import escape

import msgspec
from starlette.applications import Starlette
from starlette.datastructures import MutableHeaders
from starlette.middleware import Middleware
from starlette.middleware.gzip import GZipMiddleware
from starlette.requests import HTTPConnection, Request
from starlette.responses import HTMLResponse, PlainTextResponse, Response
from starlette.routing import Route, WebSocketRoute
from starlette.types import ASGIApp, Message, Receive, Scope, Send
from starlette.websockets import WebSocket, WebSocketDisconnect

from thbridge.dialogue.wording.texts import Texts
from ui.web.gateway.desk import DeskSockets
from ui.web.gateway.entry import EntryRefused, LinkFault
from ui.web.gateway.limits import ClientLimits, network_of
from ui.web.gateway.page_files import STATIC, PageFiles
from ui.web.gateway.people import Tab, Visitor, Visitors
from ui.web.gateway.troubles import PageTroubles
from ui.web.page.study_page import first_text
from ui.web.seat import encoded

COOKIE = "thbridge"
COOKIE_SECONDS = 24 * 3600
"""Seconds for which a browser keeps its cookie, also if the browser crashes or is closed."""
PING_PERIOD = 2.0
"""Seconds between two heartbeats."""
SILENCE = 8.0
"""Seconds without any message of a browser after which its socket is closed."""
QUEUE = 256
"""Messages that may wait for a browser; above it the socket is closed, and the browser connects again."""
HEADERS = {"X-Content-Type-Options": "nosniff", "Referrer-Policy": "no-referrer"}
"""Headers of all answers, next to the content security policy."""
UNKNOWN, TOO_OFTEN, MALFORMED, BUSY = 4403, 4429, 1008, 1013
"""Reasons for which the gateway closes a socket: the page must be loaded again; connected too often; a malformed
message; too many visitors."""
STUDY_MESSAGE = 3.0
"""Cost of a message about a page of a study, whose event is written to the disk; a message about a game costs 1."""
TAKE_OVER = '{"t":"take over"}'
"""Message of a tab in which the person wants to continue."""
OTHER_TAB_DELAY = 1.0
"""Seconds until a tab is informed that another one is live."""
_SECRET = re.compile(r"[\w-]{32}", re.ASCII)
_TAB = re.compile(r"[0-9a-f]{16}")
_PLACEHOLDER = re.compile(r"\{\{([\w.]+)\}\}")
_STYLE, _FIRST_TEXT = "<!-- style -->", "<!-- first text -->"
_NUMBER = re.compile(r"[0-9]{1,9}", re.ASCII)


def application(visitors: Visitors, texts: Texts, limits: ClientLimits, desk: DeskSockets | None = None) -> Starlette:
    """Return the application for these visitors, with texts for the page before it is connected.

    If `desk` is None, there is no page for the researcher.
    """
    files = PageFiles()

    def filled(name: str, **given: str) -> str:
        """Return a page of the static files with its words: those in `given`, otherwise texts."""
        words = {"language": texts.language, "files": files.root, **given}
        page = (STATIC / name).read_text(encoding="utf-8")
        return _PLACEHOLDER.sub(lambda found: escape(words.get(found[1]) or texts.text(found[1])), page)

    index = filled("index.html").replace(_STYLE, files.style)
    notices = {
        fault: filled("notice.html", heading=texts.text(f"web.{fault}"), text=texts.text(f"web.{fault}_text"))
        for fault in LinkFault
    }
    too_many = texts.text("web.too_many")

    async def page(request: Request) -> Response:
        secret, address = request.cookies.get(COOKIE, ""), _address(request)
        # People whose browsers are known go on, even if others in their network try links.
        if limits.failures.delay(address) and (request.query_params or not visitors.knows(secret)):
            limits.refusals.warn(f"{address} has tried too many links; it gets no page for some seconds.")
            return _fresh(PlainTextResponse(too_many, 429, {"Retry-After": "10"}))
        try:
            secret = visitors.expect(secret if _SECRET.fullmatch(secret) else "", request.query_params)
        except EntryRefused as refused:
            if refused.fault is LinkFault.UNKNOWN:
                limits.failures.take(address)
            return _fresh(HTMLResponse(notices[refused.fault], 403))
        response = HTMLResponse(index.replace(_FIRST_TEXT, first_text(visitors.first_page(secret), texts)))
        secure = request.url.scheme == "https"
        # Lax, because people come by a link from another site, also when they come back.
        response.set_cookie(COOKIE, secret, COOKIE_SECONDS, httponly=True, samesite="lax", secure=secure, path="/")
        return _fresh(response)

    troubles = PageTroubles(limits.refusals)

    async def trouble(request: Request) -> Response:
        secret = request.cookies.get(COOKIE, "")
        if not (visitors.knows(secret) and _same_origin(request)):
            return _fresh(Response(status_code=403))
        return _fresh(await troubles.receive(request, secret))

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

    desk_page = filled("desk.html")

    async def show_desk(_request: Request) -> Response:
        return _fresh(HTMLResponse(desk_page))

    async def desk_socket(websocket: WebSocket) -> None:
        address = _address(websocket)
        if desk is None or not (_same_origin(websocket) and limits.sockets.admits(address)):
            await websocket.close()
            return
        await websocket.accept()
        await desk.serve(websocket, address)

    researcher = [Route("/desk", show_desk), WebSocketRoute("/desk/socket", desk_socket)]
    return Starlette(
        routes=[
            *(researcher if desk is not None else ()),
            Route("/", page),
            Route("/trouble", trouble, methods=["POST"]),
            WebSocketRoute("/socket", socket),
            files.route,
        ],
        middleware=[
            Middleware(GZipMiddleware),
            Middleware(_GuardedRequests, policy=files.policy, limits=limits, refusal=too_many),
        ],
    )


class _GuardedRequests:
    """Limit of requests for each address, and headers that forbid what no page needs."""

    def __init__(self, app: ASGIApp, policy: str, limits: ClientLimits, refusal: str) -> None:
        self._app, self._limits = app, limits
        self._headers = HEADERS | {"Content-Security-Policy": policy}
        self._refusal = PlainTextResponse(refusal, 429, {"Retry-After": "10"})

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        if scope["type"] == "http":
            address = _address(HTTPConnection(scope))
            if not self._limits.pages.admits(address):
                self._limits.refusals.warn(f"{address} loads too many pages; it gets no page for some seconds.")
                await self._refusal(scope, receive, send)
                return

        async def guarded(message: Message) -> None:
            if message["type"] == "http.response.start":
                MutableHeaders(scope=message).update(self._headers)
            await send(message)

        await self._app(scope, receive, guarded)


def _address(connection: HTTPConnection) -> str:
    """Return the address of a client, or its network; see `network_of`."""
    return "" if connection.client is None else network_of(connection.client.host)


def _fresh(response: Response) -> Response:
    """Return an answer that browsers do not keep."""
    response.headers["Cache-Control"] = "no-store"
    return response


def _same_origin(connection: HTTPConnection) -> bool:
    """Return True if the page that opened the socket came from this gateway."""
    scheme, _, host = connection.headers.get("origin", "").partition("://")
    is_plain = connection.url.scheme in ("ws", "http")
    return host == connection.headers.get("host", "") and (scheme == "https" or is_plain)


class _Ping(msgspec.Struct, frozen=True, tag_field="t", tag="pong"):
    """Browser: answer to a heartbeat; `at` is the server's time in it."""

    at: float
    visible: bool


_PONG = msgspec.json.Decoder(_Ping)


async def _serve(websocket: WebSocket, visitor: Visitor, limits: ClientLimits) -> None:
    """Serve one socket, which is that of the visitor's live tab or of another tab."""
    waiting: asyncio.Queue[str | None] = asyncio.Queue(QUEUE)

    def send(text: str) -> None:
        if waiting.full():
            # The browser no longer reads. It gets the present state when it connects again.
            while not waiting.empty():
                waiting.get_nowait()
            waiting.put_nowait(None)
        else:
            waiting.put_nowait(text)

    def close() -> None:
        with suppress(asyncio.QueueFull):
            waiting.put_nowait(None)

    def inform() -> None:
        # When a page is loaded again, the earlier connection may close a moment after the new one is open.
        asyncio.get_running_loop().call_later(OTHER_TAB_DELAY, inform_now)

    def inform_now() -> None:
        if tab in visitor.others:
            send(encoded(visitor.window.elsewhere()))

    name, first = (websocket.query_params.get(key, "") for key in ("tab", "first"))
    known = _TAB.fullmatch(name) and _NUMBER.fullmatch(first)
    tab = Tab(name if known else "", int(first) if known else 0, send, inform, close)
    visitor.connect(tab)
    sending = asyncio.create_task(_send(websocket, waiting))
    beating = asyncio.create_task(_beat(send, tab))
    closing = (1000, "")
    try:
        await _receive(websocket, visitor, tab, limits)
    except (WebSocketDisconnect, TimeoutError, RuntimeError):
        pass
    except (msgspec.MsgspecError, RecursionError, UnicodeError, KeyError):
        limits.refusals.warn(f"{_address(websocket)} sent a malformed message; its socket is closed.")
        closing = (MALFORMED, "malformed message")
    finally:
        beating.cancel()
        sending.cancel()
        visitor.disconnect(tab)
        with suppress(RuntimeError, WebSocketDisconnect):
            await websocket.close(*closing)


async def _send(websocket: WebSocket, waiting: "asyncio.Queue[str | None]") -> None:
    while (text := await waiting.get()) is not None:
        await websocket.send_text(text)
    await websocket.close(4000)


async def _beat(send: Callable[[str], None], tab: Tab) -> None:
    while True:
        send(f'{{"t":"ping","at":{time.monotonic() * 1000.0:.1f},"heard":{tab.number}}}')
        await asyncio.sleep(PING_PERIOD)


async def _receive(websocket: WebSocket, visitor: Visitor, tab: Tab, limits: ClientLimits) -> None:
    """Pass on the messages of a tab, at most at the rate of the limits, while it is the live one."""
    while True:
        async with asyncio.timeout(SILENCE):
            text = await websocket.receive_text()
        cost = 1.0 if text.startswith('{"t":') else STUDY_MESSAGE
        if delay := limits.messages.delay(visitor.secret, cost):
            limits.refusals.warn(f"{_address(websocket)} sends too many messages; they are processed later.")
            await asyncio.sleep(delay)
        limits.messages.take(visitor.secret, cost)
        is_pong = text.startswith('{"t":"pong"')
        if text == TAKE_OVER:
            visitor.take_over(tab)
        elif tab is not visitor.live:
            pass  # Another tab is live, and this one may only answer heartbeats.
        elif is_pong:
            pong = _PONG.decode(text)
            visitor.note_pong(time.monotonic() * 1000.0 - pong.at, visible=pong.visible)
        elif visitor.inbox.is_new(tab.number):
            visitor.window.receive(text)
            visitor.inbox.note(tab.number)
        if not is_pong:
            tab.number += 1
