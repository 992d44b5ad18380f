"""XML-RPC over HTTP/1.1: client for ROS 1's master and slave APIs.

A server may be slow, silent, hostile or gone. Network errors are returned as values.
"""

from __future__ import annotations

import asyncio
from collections import OrderedDict
from dataclasses import dataclass
from urllib.parse import urlsplit

import h11

from thbridge.files.errors import reason_of
from thbridge.rosgraph.sockets.documents import read_document, write_document
from thbridge.rosgraph.wire.xmlrpc import (
    MAX_BYTES,
    Fault,
    MalformedDocument,
    MethodResponse,
    XmlRpcValue,
    decode_response,
    encode_call,
)
from thbridge.sockets.listening import check_room

_SEGMENT = 64 * 1024
"""Maximum number of bytes that are read at a time."""


@dataclass(frozen=True, slots=True)
class CallFailed:
    """Call without a valid answer: no server, too slow, or not XML-RPC. `str` returns one line."""

    uri: str
    reason: str

    def __str__(self) -> str:
        return f"{self.uri}: {self.reason}"


@dataclass(frozen=True, slots=True)
class _Address:
    host: str
    port: int
    netloc: str
    target: str


@dataclass(frozen=True, slots=True)
class _Link:
    """Connection to a server."""

    reader: asyncio.StreamReader
    writer: asyncio.StreamWriter
    http: h11.Connection


class _HungUpError(Exception):
    """Raised if the server closed the connection before it answered."""


class _NotAnAnswerError(Exception):
    """Raised if the answer is not XML-RPC."""


class XmlRpcClient:
    """XML-RPC client. It keeps one idle connection to each of the servers that it called most recently.

    If a server has closed an idle connection, the client opens a new connection, like ROS's own clients.

    Args:
        kept: maximum number of idle connections.
    """

    def __init__(self, kept: int = 32) -> None:
        self._kept = kept
        self._idle: OrderedDict[tuple[str, int], _Link] = OrderedDict()

    async def call(
        self, uri: str, method: str, *params: XmlRpcValue, timeout: float = 5.0
    ) -> MethodResponse | Fault | CallFailed:
        """Call a method.

        Args:
            uri: URI of the server, ``http://host:port/``.
            method: name of the method.
            params: parameters by position.
            timeout: seconds for the complete call, including the connection.

        Raises:
            ValueError: XML-RPC cannot represent a parameter.
        """
        given = [*params]
        return await self.post(uri, await write_document(lambda: encode_call(method, given), given), timeout)

    async def post(self, uri: str, body: bytes, timeout: float = 5.0) -> MethodResponse | Fault | CallFailed:
        """Make a call that is already encoded. See `call`."""
        address = _address_of(uri)
        if address is None:
            return CallFailed(uri, "this is not an http URI")
        try:
            async with asyncio.timeout(timeout):
                answer = await read_document(decode_response, await self._exchange(address, body))
        except TimeoutError:
            return CallFailed(uri, f"no answer within {timeout:g} s")
        except OSError as error:
            return CallFailed(uri, reason_of(error))
        except _HungUpError:
            return CallFailed(uri, "the server closed the connection without an answer")
        except (h11.ProtocolError, _NotAnAnswerError, UnicodeError) as error:  # UnicodeError: invalid host name
            return CallFailed(uri, str(error))
        if isinstance(answer, MalformedDocument):
            return CallFailed(uri, f"the answer is not XML-RPC: {answer.reason}")
        return answer

    async def close(self) -> None:
        """Close the idle connections. Calls in progress continue."""
        while self._idle:
            _, link = self._idle.popitem()
            link.writer.close()

    async def _exchange(self, address: _Address, body: bytes) -> bytes:
        # Servers close idle connections at any time.
        for key, link in [*self._idle.items()]:
            if link.reader.at_eof():
                link.writer.close()
                del self._idle[key]
        kept = self._idle.pop((address.host, address.port), None)
        if kept is not None:
            try:
                return await self._ask(kept, address, body)
            except (_HungUpError, ConnectionError):
                pass  # The server has closed this idle connection. If the server is gone, the next attempt fails too.
        # Other nodes choose the addresses that are called. They must not use up the descriptors for recording.
        check_room()
        reader, writer = await asyncio.open_connection(address.host, address.port)
        return await self._ask(_Link(reader, writer, h11.Connection(h11.CLIENT)), address, body)

    async def _ask(self, link: _Link, address: _Address, body: bytes) -> bytes:
        """Send a request and return the body of the answer. Afterwards the connection becomes idle or is closed."""
        try:
            head = link.http.send(
                h11.Request(
                    method="POST",
                    target=address.target,
                    headers=[
                        ("Host", address.netloc),
                        ("User-Agent", "thbridge"),
                        ("Content-Type", "text/xml"),
                        ("Content-Length", str(len(body))),
                    ],
                )
            )
            link.http.send(h11.Data(data=body))
            link.http.send(h11.EndOfMessage())
            link.writer.write((head or b"") + body)
            await link.writer.drain()
            answer = await _answer(link)
            if link.http.our_state is not h11.DONE or link.http.their_state is not h11.DONE:
                link.writer.close()
                return answer
            link.http.start_next_cycle()
        except BaseException:
            link.writer.transport.abort()
            raise
        self._keep((address.host, address.port), link)
        return answer

    def _keep(self, key: tuple[str, int], link: _Link) -> None:
        replaced = self._idle.pop(key, None)
        if replaced is not None:
            replaced.writer.close()
        self._idle[key] = link
        if len(self._idle) > self._kept:
            _, oldest = self._idle.popitem(last=False)
            oldest.writer.close()


async def _answer(link: _Link) -> bytes:
    body = bytearray()
    received = False
    while True:
        event = link.http.next_event()
        if event is h11.NEED_DATA:
            data = await link.reader.read(_SEGMENT)
            if not data and not received:
                raise _HungUpError
            received = True
            link.http.receive_data(data)
        elif isinstance(event, h11.Response):
            if event.status_code != 200:
                raise _NotAnAnswerError(f"HTTP status {event.status_code}")
        elif isinstance(event, h11.Data):
            body += event.data
            if len(body) > MAX_BYTES:
                raise _NotAnAnswerError("the answer is too long")
        elif isinstance(event, h11.EndOfMessage):
            return bytes(body)
        elif not isinstance(event, h11.InformationalResponse):
            raise _NotAnAnswerError("the connection ended during the answer")


def _address_of(uri: str) -> _Address | None:
    try:
        parts = urlsplit(uri)
        port = parts.port
    except ValueError:
        return None
    if parts.scheme != "http" or not parts.hostname:
        return None
    # `/RPC2` is the path that Python's XML-RPC clients use if the URI has none.
    return _Address(parts.hostname, 80 if port is None else port, parts.netloc, parts.path or "/RPC2")
