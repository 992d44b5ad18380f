"""Attacks on the port for browsers (`thbridge serve`) during a game of a person; `attack.py` runs them.

The attackers open pages and sockets like browsers, or like programs that pretend to be browsers.
"""

import asyncio
import base64
import contextlib
import http.client
import json
import os
import random
import re
import secrets
import struct
import subprocess
import sys
import time
import zlib
from pathlib import Path

from websockets.asyncio.client import ClientConnection, connect
from websockets.exceptions import ConnectionClosed, InvalidStatus
from websockets.sync.client import ClientConnection as OwnConnection
from websockets.sync.client import connect as connect_own
from websockets.typing import Origin

HOST = "127.0.0.1"
STUDY = """\
title: Attacked
seed: 1
base: {map: practice, templates: practice, robots: 2, server.port: 0}
quota: 100
consent_elsewhere: Programs need no consent.
steps:
  - {step: trial, name: game, max_seconds: 3600}
"""
PATIENCE = 30.0
SILENCE = 6.0
"""Seconds without a message of the server after which the person's game counts as interrupted; heartbeats come every 2
seconds."""
SCRIPT = "<script>alert(1)</script>"


class BrowserBreachError(Exception):
    """An attack on the port for browsers achieved something that must be impossible."""


def serve(folder: Path, port: int) -> subprocess.Popen[bytes]:
    """Start a study in a folder; return its process when browsers can connect."""
    place = folder / "study"
    place.mkdir()
    (place / "experiment.yaml").write_text(STUDY)
    output = folder / "serve.txt"
    with output.open("wb") as file:
        process = subprocess.Popen(
            [sys.executable, "-c", "from ui.cli import main; main()", "serve", place, "--port", str(port)],
            cwd=folder,
            stdout=file,
            stderr=file,
            env={**os.environ, "PYTHONPATH": str(Path.cwd())},
        )
    while "Open http" not in output.read_text():
        if process.poll() is not None:
            raise RuntimeError(output.read_text())
        time.sleep(0.1)
    return process


def server_of(process: subprocess.Popen[bytes]) -> int:
    """Return the id of the process that serves; `process` starts it again if it dies. 0 if there is none."""
    try:
        children = Path(f"/proc/{process.pid}/task/{process.pid}/children").read_text().split()
    except OSError:
        return 0
    return min(map(int, children), default=0)


def load(port: int, path: str = "/", cookie: str = "") -> tuple[str, str]:
    """Load a page; return its text and the cookie."""
    connection = http.client.HTTPConnection(HOST, port, timeout=PATIENCE)
    with contextlib.closing(connection):
        connection.request("GET", path, headers={"Cookie": cookie} if cookie else {})
        answer = connection.getresponse()
        given = (answer.getheader("set-cookie") or cookie).partition(";")[0]
        return answer.read().decode(errors="replace"), given


class PlayingPerson:
    """Program that plays a game like a person, and loads the page again and again.

    Args:
        port: port of the gateway.
    """

    def __init__(self, port: int) -> None:
        self._port = port
        _, self._cookie = load(port)
        self._socket: OwnConnection | None = None
        self._heard = time.monotonic()
        self.page = 0
        """Number of the game's last page."""
        while self.page == 0:
            self.go_on(1.0)

    def go_on(self, seconds: float = 0.0) -> None:
        """Load the page, and read and answer all messages.

        Args:
            seconds: time to wait for messages.

        Raises:
            OSError: the page or the game is interrupted.
        """
        load(self._port, cookie=self._cookie)
        if self._socket is None:
            self._heard = time.monotonic()
            self._socket = connect_own(
                f"ws://{HOST}:{self._port}/socket",
                origin=Origin(f"http://{HOST}:{self._port}"),
                additional_headers={"Cookie": self._cookie},
                open_timeout=PATIENCE,
            )
        end = time.monotonic() + seconds
        try:
            while True:
                self._answer(json.loads(self._socket.recv(timeout=max(end - time.monotonic(), 0.0))))
                self._heard = time.monotonic()
        except TimeoutError:
            if time.monotonic() - self._heard > SILENCE:
                self._socket = None
                raise ConnectionError from None
        except ConnectionClosed:
            self._socket = None
            raise ConnectionError from None

    def _answer(self, message: dict[str, object]) -> None:
        now = time.monotonic() * 1000.0
        match message["t"]:
            case "ping":
                self._send({"t": "pong", "at": message["at"], "visible": True})
            case "page":
                self.page = int(str(message["n"]))
                self._send({"t": "painted", "n": self.page, "at": now})
            case "text" if message["button"]:
                self._send({"type": "WentOn", "page": message["page"]})

    def _send(self, message: dict[str, object]) -> None:
        if self._socket is not None:
            self._socket.send(json.dumps(message, separators=(",", ":")))


async def opened(port: int, cookie: str, path: str = "/socket", origin: str = "") -> ClientConnection:
    """Open a socket as a page does."""
    return await connect(
        f"ws://{HOST}:{port}{path}",
        origin=Origin(origin or f"http://{HOST}:{port}"),
        additional_headers={"Cookie": cookie} if cookie else {},
        open_timeout=PATIENCE,
    )


async def heard(client: ClientConnection) -> list[str]:
    """Return all messages until the socket is closed, at most those of two seconds."""
    messages = []
    with contextlib.suppress(ConnectionClosed, TimeoutError):
        async with asyncio.timeout(2.0):
            while True:
                messages.append(str(await client.recv()))
    return messages


async def forged_origins(port: int, count: int) -> int:
    """Open sockets from pages of other sites, with a valid cookie."""
    _, cookie = await asyncio.to_thread(load, port)
    for number in range(count):
        origin = ("http://elsewhere.example", f"http://{HOST}.example:{port}", "null", f"http://{HOST}")[number % 4]
        for path in ("/socket", "/desk/socket"):
            with contextlib.suppress(InvalidStatus):
                await opened(port, cookie, path, origin)
                raise BrowserBreachError
    return 2 * count


async def guessed_cookies(port: int, count: int) -> int:
    """Open sockets with cookies that no page was given."""
    for _ in range(count):
        client = await opened(port, f"thbridge={secrets.token_urlsafe(24)}")
        if any('"words"' in message for message in await heard(client)):
            raise BrowserBreachError
    return count


async def guessed_keys(port: int, count: int) -> int:
    """Send wrong keys to the researcher's page."""
    clients = [await opened(port, "", "/desk/socket") for _ in range(count)]
    for client in clients:
        with contextlib.suppress(ConnectionClosed):
            await client.send(json.dumps({"t": "key", "key": secrets.token_urlsafe(24)}))
    for messages in await asyncio.gather(*map(heard, clients)):
        if any('"page"' in message for message in messages):
            raise BrowserBreachError
    return count


async def many_visitors(port: int, count: int) -> int:
    """Load the page without a cookie."""
    for _ in range(count):
        await asyncio.to_thread(load, port)
    return count


async def one_secret(port: int, count: int) -> int:
    """Open sockets with the same cookie, which take over from each other, and repeat old messages."""
    _, cookie = await asyncio.to_thread(load, port)
    clients = []
    for _ in range(count):
        with contextlib.suppress(InvalidStatus, ConnectionClosed):
            clients.append(await opened(port, cookie))
            for client in clients[-2:]:
                await client.send('{"t":"act","n":1,"at":1,"act":{"act":"GoOnFromGame"},"on_map":false}')
    for client in clients:
        await client.close()
    return len(clients)


async def said_on_sockets(port: int, messages: list[str | bytes], count: int) -> int:
    """Send wrong messages, each on a new socket."""
    said = 0
    for number in range(count):
        _, cookie = await asyncio.to_thread(load, port)
        with contextlib.suppress(ConnectionClosed, InvalidStatus, OSError):
            client = await opened(port, cookie)
            await client.send(messages[number % len(messages)])
            said += 1
            await heard(client)
    return said


def wrong_messages(draws: random.Random) -> list[str | bytes]:
    """Return malformed and deeply nested messages."""
    deep = '{"type":"ItemNews","answer":' + 30_000 * "["
    act = '{"t":"act","n":1,"at":1,"act":' + 30_000 * '{"a":'
    return ["{", "[]", "null", '"\\ud800"', deep, act, '{"t":"pong","at":1e999}', draws.randbytes(1000), "9" * 60_000]


def handshake(port: int, cookie: str, extensions: str = "") -> bytes:
    """Return a request that opens a socket."""
    key = base64.b64encode(os.urandom(16)).decode()
    return (
        f"GET /socket HTTP/1.1\r\nHost: {HOST}:{port}\r\nOrigin: http://{HOST}:{port}\r\nCookie: {cookie}\r\n"
        f"Upgrade: websocket\r\nConnection: Upgrade\r\nSec-WebSocket-Version: 13\r\nSec-WebSocket-Key: {key}\r\n"
        f"{extensions}\r\n"
    ).encode()


def frame(data: bytes, first: int, length: int | None = None) -> bytes:
    """Return a masked frame; `length` is the announced length if it differs from that of the data."""
    return bytes([first, 0x80 | 127]) + struct.pack("!QI", len(data) if length is None else length, 0) + data


async def raw_frames(port: int, data: bytes, times: int, extensions: str = "") -> int:
    """Send frames again and again on one socket, until the server closes it or the data are sent."""
    _, cookie = await asyncio.to_thread(load, port)
    said = 0
    with contextlib.suppress(OSError, TimeoutError):
        async with asyncio.timeout(10.0):
            inside, outside = await asyncio.open_connection(HOST, port)
            outside.write(handshake(port, cookie, extensions))
            await inside.readuntil(b"\r\n\r\n")
            for _ in range(times):
                outside.write(data)
                await outside.drain()
                said += 1
    return said


def bomb() -> bytes:
    """Return a compressed frame of 200 kB that contains 200 MB."""
    squeeze = zlib.compressobj(9, zlib.DEFLATED, -12)
    packed = b"".join(squeeze.compress(bytes(2**20)) for _ in range(200)) + squeeze.flush(zlib.Z_SYNC_FLUSH)[:-4]
    return frame(packed, 0xC1)


async def slowly(port: int, begin: bytes, piece: bytes, count: int, seconds: float) -> int:
    """Keep connections open by sending a piece twice per second."""
    writers = []
    for _ in range(count):
        with contextlib.suppress(OSError):
            writers.append((await asyncio.open_connection(HOST, port))[1])
    end = time.monotonic() + seconds
    for writer in writers:
        writer.write(begin)
    while time.monotonic() < end:
        for writer in writers:
            writer.write(piece)
        await asyncio.sleep(0.5)
    for writer in writers:
        writer.transport.abort()
    return len(writers)


async def scripts_in_texts(port: int) -> int:
    """Send scripts in all texts of a request, and look for them in the pages."""
    quoted = SCRIPT.replace(" ", "%20")
    for path in (f"/?code={quoted}&PROLIFIC_PID={quoted}", f"/{quoted}", f"/static/{quoted}", f"/desk?{quoted}"):
        page, _ = await asyncio.to_thread(load, port, path, f"thbridge={SCRIPT}")
        if SCRIPT in page or re.search(r"<script(?! type=\"module\" src=\"/static/)", page):
            raise BrowserBreachError
    return 4
