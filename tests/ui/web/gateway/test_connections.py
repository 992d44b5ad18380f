"""Clients of the gateway's port that are not browsers of people: they get nothing, and people go on."""

import asyncio
import socket
import ssl
import zlib
from collections.abc import AsyncIterator, Awaitable, Callable
from contextlib import asynccontextmanager, suppress
from dataclasses import replace
from pathlib import Path

import pytest
from websockets.exceptions import InvalidStatus
from websockets.frames import Frame, Opcode

from tests.support.programs.browser_client import BrowserClient
from thbridge.files.keys.certificate import certificate_of
from thbridge.files.language_texts import shipped_texts
from thbridge.sockets.tls import browser_context
from ui.model.kiosk import TextToRead, WentOn
from ui.web.gateway import connections, people
from ui.web.gateway.browser_window import BrowserWindow
from ui.web.gateway.entry import open_to_all
from ui.web.gateway.people import Visitor, Visitors
from ui.web.gateway.serving import ServerOptions, serve_visitors

TEXTS = shipped_texts("en")


async def read_pages(visitor: Visitor) -> None:
    """Show one page after another."""
    window = visitor.window
    for number in range(1, 1000):
        await window.send(TextToRead(number, f"Page {number}", "A text."))
        while not isinstance(await window.next_request(), WentOn):
            pass


@asynccontextmanager
async def served(**changes: object) -> AsyncIterator[tuple[int, Visitors]]:
    """Serve pages; yield the port and the visitors."""
    listening, ready = socket.create_server(("127.0.0.1", 0)), asyncio.Event()
    options = replace(ServerOptions(listening, 1, None, ready.set), **changes)
    visitors = Visitors(read_pages, lambda: BrowserWindow(TEXTS), open_to_all)
    serving = asyncio.create_task(serve_visitors(visitors, TEXTS, options))
    await asyncio.wait([serving, asyncio.create_task(ready.wait())], return_when=asyncio.FIRST_COMPLETED)
    try:
        yield listening.getsockname()[1], visitors
    finally:
        serving.cancel()
        with suppress(asyncio.CancelledError):
            await serving


def scenario(play: Callable[[int, Visitors], Awaitable[None]], **changes: object) -> None:
    async def run() -> None:
        async with served(**changes) as (port, visitors):
            await play(port, visitors)

    asyncio.run(asyncio.wait_for(run(), 120.0))


async def reader(port: int) -> BrowserClient:
    """Return a browser that shows the first page."""
    browser = BrowserClient(port)
    await asyncio.to_thread(browser.load)
    await browser.open()
    await browser.until(lambda: browser.study)
    return browser


async def goes_on(browser: BrowserClient) -> None:
    """Read a page, and expect the next one."""
    page = browser.study[-1]["page"]
    await browser.send({"type": "WentOn", "page": page})
    await browser.until(lambda: browser.study[-1]["page"] == page + 1)


async def said(port: int, data: bytes) -> bytes:
    """Send bytes, and return all bytes until the server closes the connection."""
    inside, outside = await asyncio.open_connection("127.0.0.1", port)
    answer = b""
    with suppress(ConnectionError):
        outside.write(data)
        await outside.drain()
        while more := await inside.read(2**16):
            answer += more
    outside.close()
    return answer


def test_foreign_pages_and_guessed_cookies_get_no_visit() -> None:
    async def play(port: int, visitors: Visitors) -> None:
        browser = BrowserClient(port)
        await asyncio.to_thread(browser.load)
        for origin in ("http://elsewhere.example", f"http://127.0.0.1.example:{port}", "null"):
            with pytest.raises(InvalidStatus):
                await browser.open(origin)
        for cookie in ("thbridge=" + 32 * "A", "thbridge=;", ""):
            guess = BrowserClient(port, cookie)
            await guess.open()
            assert await guess.closed() == 4403
            assert not guess.study
        assert not visitors._by_secret

    scenario(play)


def test_all_answers_forbid_scripts_of_others() -> None:
    async def play(port: int, _visitors: Visitors) -> None:
        for path in (b"/", b"/static/main.js", b"/missing"):
            answer = (await said(port, b"GET " + path + b" HTTP/1.1\r\nHost: x\r\nConnection: close\r\n\r\n")).lower()
            assert b"content-security-policy: default-src 'none'; script-src 'self'" in answer
            assert b"x-content-type-options: nosniff" in answer

    scenario(play)


def test_a_visit_begins_when_the_browser_connects_and_not_when_it_loads_the_page() -> None:
    async def play(port: int, visitors: Visitors) -> None:
        for _ in range(20):
            await asyncio.to_thread(BrowserClient(port).load)
        assert not visitors._by_secret
        await reader(port)
        assert len(visitors._by_secret) == 1

    scenario(play)


def test_visitors_who_are_gone_make_room_but_people_with_a_place_stay(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(people, "MOST_WITHOUT_PLACE", 2)

    async def play(port: int, visitors: Visitors) -> None:
        first, second, placed = [await reader(port) for _ in range(2)] + [BrowserClient(port)]
        secret = first.cookie.partition("=")[2]
        visitors._by_secret[secret].window.has_place = True
        await first.close()
        third = await reader(port)
        await asyncio.to_thread(placed.load)
        await placed.open()
        assert await placed.closed() == 1013
        await second.close()
        await placed.open()
        await placed.until(lambda: placed.study)
        again = BrowserClient(port, first.cookie)
        await asyncio.to_thread(again.load)
        await again.open()
        await again.until(lambda: again.study)
        assert visitors._by_secret[secret].window.has_place
        await goes_on(third)

    scenario(play)


def test_malformed_messages_close_the_socket_and_the_visit_goes_on() -> None:
    wrong = ("{", '{"type":"WentOn","page":"1"}', '{"t":"act"', '{"t":"key","n":' + 30_000 * "[", b"\0", '["\\ud800"]')

    async def play(port: int, _visitors: Visitors) -> None:
        browser = await reader(port)
        await goes_on(browser)
        for text in wrong:
            await browser.send_text(text)
            assert await browser.closed() == 1008
            await browser.open()
        await browser.send_text("x" * 70_000)
        assert await browser.closed() == 1009
        browser.study.clear()
        await browser.open()
        await browser.until(lambda: browser.study)
        assert browser.study[0]["page"] == 2

    scenario(play)


def test_frames_that_are_bombs_or_have_no_end_are_cut_off() -> None:
    async def play(port: int, _visitors: Visitors) -> None:
        squeeze = zlib.compressobj(9, zlib.DEFLATED, -12)
        packed = squeeze.compress(bytes(50_000_000)) + squeeze.flush(zlib.Z_SYNC_FLUSH)[:-4]
        bomb = Frame(Opcode.TEXT, packed).serialize(mask=True)
        bomb = bytes([bomb[0] | 0x40]) + bomb[1:]  # This bit says that the frame is compressed.
        piece = Frame(Opcode.CONT, b"", fin=False).serialize(mask=True)
        pieces = Frame(Opcode.TEXT, b"{", fin=False).serialize(mask=True) + 100 * piece
        many = 5000 * Frame(Opcode.TEXT, b"{}").serialize(mask=True)
        for data in (bomb, pieces, many):
            browser = await reader(port)
            assert browser._socket is not None
            browser._socket.transport.write(data)
            assert await browser.closed() in {1006, 1008, 1009}

    scenario(play)


def test_only_the_live_tab_speaks() -> None:
    async def play(port: int, _visitors: Visitors) -> None:
        first = await reader(port)
        second = BrowserClient(port, first.cookie)
        await second.open()
        await second.until(lambda: second.shown["t"] == "elsewhere")
        await second.send({"type": "WentOn", "page": 1})
        await goes_on(first)
        await second.send({"t": "take over"})
        await second.until(lambda: second.shown["page"] == 2)
        await first.until(lambda: first.shown["t"] == "elsewhere")
        await first.send({"type": "WentOn", "page": 2})
        await goes_on(second)
        assert [message["page"] for message in second.study] == [0, 2, 3]

    scenario(play)


def test_slow_requests_endless_headers_and_bodies_are_cut_off(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(connections, "REQUEST_SECONDS", 0.3)

    async def play(port: int, _visitors: Visitors) -> None:
        browser = await reader(port)
        assert await said(port, b"") == b""
        assert await said(port, b"GET / HTTP/1.1\r\nHost: x\r\nX-Slow: ") == b""
        assert b" 400 " in await said(port, b"GET / HTTP/1.1\r\nX-Long: " + bytes(40_000))
        assert b" 405 " in await said(port, b"POST / HTTP/1.1\r\nHost: x\r\nContent-Length: 9999999\r\n\r\nxx")
        await goes_on(browser)

    scenario(play)


def test_many_connections_leave_room_for_people(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(connections, "MOST_OF_ADDRESS", 20)

    async def play(port: int, _visitors: Visitors) -> None:
        browser = await reader(port)
        silent = [await asyncio.open_connection("127.0.0.1", port) for _ in range(100)]
        await goes_on(browser)
        await goes_on(await reader(port))
        for _, outside in silent:
            outside.close()

    scenario(play)


def test_other_machines_are_refused_unless_their_network_is_open(monkeypatch: pytest.MonkeyPatch) -> None:
    # No test has another machine, so all peers count as one.
    monkeypatch.setattr(connections, "peer_of", lambda transport: "203.0.113.9")

    async def play(port: int, _visitors: Visitors) -> None:
        assert await said(port, b"GET / HTTP/1.1\r\nHost: x\r\nConnection: close\r\n\r\n") == b""

    scenario(play)


@pytest.mark.parametrize(("proxies", "secure"), [((), False), (("127.0.0.1/32",), True)])
def test_the_cookie_is_secure_behind_a_named_proxy_that_encrypts(proxies: tuple[str, ...], secure: bool) -> None:
    async def play(port: int, _visitors: Visitors) -> None:
        request = b"GET / HTTP/1.1\r\nHost: x\r\nX-Forwarded-Proto: https\r\nConnection: close\r\n\r\n"
        answer = await said(port, request)
        assert b" 200 " in answer
        assert (b"; secure" in answer.lower()) is secure

    scenario(play, proxies=proxies)


def test_with_a_certificate_only_encrypted_connections_are_served(tmp_path: Path) -> None:
    certificate = certificate_of(tmp_path, "2026-03-01T12:00:00+00:00").path

    async def play(port: int, _visitors: Visitors) -> None:
        request = b"GET / HTTP/1.1\r\nHost: x\r\nConnection: close\r\n\r\n"
        assert await said(port, request) == b""
        client = ssl.create_default_context(cafile=certificate)
        client.check_hostname = False
        inside, outside = await asyncio.open_connection("127.0.0.1", port, ssl=client)
        outside.write(request)
        assert b"; secure" in (await inside.read()).lower()

    scenario(play, tls=browser_context(certificate, certificate))
