"""XML-RPC over HTTP/1.1: server for ROS 1's master and slave APIs.

A peer may be slow, silent, hostile or gone. So every wait has a timeout, and every buffer and collection has a limit.
"""

from __future__ import annotations

import asyncio
import logging
from collections import Counter, OrderedDict
from collections.abc import Awaitable, Callable, Collection
from dataclasses import dataclass
from typing import TypeAlias

import h11

from thbridge.rosgraph.sockets.documents import read_document, write_document
from thbridge.rosgraph.wire.xmlrpc import (
    MAX_BYTES,
    Fault,
    MalformedDocument,
    MethodCall,
    XmlRpcValue,
    decode_call,
    encode_fault,
    encode_response,
    written_size,
)
from thbridge.sockets.addresses import ListeningAddress
from thbridge.sockets.admission import OWN_MACHINE, Admission
from thbridge.sockets.errors import CannotListen
from thbridge.sockets.listening import ServerDoor

_log = logging.getLogger(__name__)

_SEGMENT = 64 * 1024
"""Maximum number of bytes that are read at a time."""

_APPLICATION_ERROR = 1
"""Fault code of every error in Python's XML-RPC servers, and so in rospy and rosmaster."""

_PARSE_ERROR = -32700
"""Fault code of a malformed call. Source: http://xmlrpc-epi.sourceforge.net/specs/rfc.fault_codes.php."""

CallHandler: TypeAlias = Callable[[MethodCall, str], XmlRpcValue | Fault | Awaitable[XmlRpcValue | Fault]]
"""Function that answers a call, at once or later. Its arguments are the call and the peer's address."""


@dataclass(frozen=True, slots=True)
class HttpLimits:
    """Limits of a server.

    Args:
        connections: maximum number of connections. A further connection replaces another connection: of the address
            with the most connections, the connection that has been idle longest.
        header_bytes: maximum size of a request's header. It is checked after each read.
        held_bytes: maximum number of bytes in requests of all connections that are not decoded yet. The same limit
            applies to unread answers.
        request_seconds: maximum time from the first to the last byte of a request, seconds. The peer has the same time
            to read the answer.
        idle_seconds: maximum time between two requests of a connection, seconds.
    """

    connections: int = 512
    header_bytes: int = 16 * 1024
    held_bytes: int = 4 * MAX_BYTES
    request_seconds: float = 10.0
    idle_seconds: float = 300.0


class XmlRpcServer:
    """XML-RPC server that accepts several requests per connection.

    The server itself answers ``system.listMethods`` and ``system.multicall``.

    Args:
        methods: names of the handler's methods. The handler is only called for these.
        handler: answers a call. If it raises, the answer is a fault, and the exception is logged.
        limits: limits of the server.
    """

    def __init__(
        self,
        methods: Collection[str],
        handler: CallHandler,
        limits: HttpLimits | None = None,
        admission: Admission = OWN_MACHINE,
    ) -> None:
        self._admission = admission
        self._methods = frozenset(methods)
        self._handler = handler
        self._limits = limits or HttpLimits()
        self._door = ServerDoor(self._limits.connections)
        self._connections: OrderedDict[asyncio.Task[None], str] = OrderedDict()
        """Peers by connection. The connection that has been idle longest is first."""
        self._held = 0
        self._sending = 0
        self._turn = asyncio.Lock()

    @property
    def connections(self) -> int:
        """Number of open connections."""
        return len(self._connections)

    async def start(self, host: str = "127.0.0.1", port: int = 0) -> ListeningAddress | CannotListen:
        """Start to serve. Port 0 selects any free port."""
        if not 0 <= port <= 65535:
            return CannotListen(host, port, "a port must be a number from 0 to 65535")
        try:
            return await self._door.listen(self._connection, host, port)
        except (OSError, UnicodeError) as error:
            return CannotListen.because(error, host, port)

    async def stop(self) -> None:
        """Close the port and every connection."""
        self._door.close()
        for connection in self._connections:
            connection.cancel()
        while self._connections:
            await asyncio.wait(self._connections)
        await self._door.wait_closed()

    async def answer(self, call: MethodCall, peer: str) -> XmlRpcValue | Fault:
        """Answer a call. Calls of this process need no socket."""
        if call.method == "system.listMethods":
            return [*sorted(self._methods), "system.listMethods", "system.multicall"]
        if call.method == "system.multicall":
            return await self._multicall(call, peer)
        if call.method not in self._methods:
            return Fault(_APPLICATION_ERROR, f'method "{call.method}" is not supported')
        try:
            value = self._handler(call, peer)
            return await value if isinstance(value, Awaitable) else value
        except Exception as error:
            _log.exception("the call %s of %s failed", call.method, peer)
            return Fault(_APPLICATION_ERROR, f"internal error: {error!r}")

    async def _multicall(self, multicall: MethodCall, peer: str) -> XmlRpcValue | Fault:
        """Answer several calls. The answer is a list of one-element lists, with faults as structs.

        Source: https://mirrors.talideon.com/articles/multicall.html
        """
        match multicall.params:
            case [list(calls)]:
                answers: list[XmlRpcValue] = []
                room = MAX_BYTES
                for call in calls:
                    await asyncio.sleep(0)  # There may be thousands of calls, and the event loop has other work.
                    answers.append(await self._one_of_many(call, peer))
                    room -= written_size(answers[-1], room)
                    if room < 0:
                        return Fault(_APPLICATION_ERROR, f"the answers are longer than {MAX_BYTES} characters")
                return answers
            case _:
                return Fault(_APPLICATION_ERROR, "system.multicall requires one array of structs")

    async def _one_of_many(self, call: XmlRpcValue, peer: str) -> XmlRpcValue:
        match call:
            case {"methodName": "system.multicall"}:
                answer: XmlRpcValue | Fault = Fault(_APPLICATION_ERROR, "system.multicall must not call itself")
            case {"methodName": str(method), "params": list(params)}:
                answer = await self.answer(MethodCall(method, params), peer)
            case _:
                answer = Fault(_APPLICATION_ERROR, "a call must be a struct of methodName and params")
        if isinstance(answer, Fault):
            return {"faultCode": answer.code, "faultString": answer.text}
        return [answer]

    def _connection(self) -> asyncio.StreamReaderProtocol:
        return asyncio.StreamReaderProtocol(asyncio.StreamReader(), self._connected)

    def _connected(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        if self._admission.refused(writer.transport) is not None:
            writer.transport.abort()
            return
        name = writer.get_extra_info("peername")
        peer = str(name[0]) if name else "?"
        if len(self._connections) >= self._door.most:
            ((most, _),) = Counter(self._connections.values()).most_common(1)
            longest_idle = next(task for task, other in self._connections.items() if other == most)
            del self._connections[longest_idle]
            longest_idle.cancel()
        # With limit 0, `drain` returns when all data are in the kernel. So no data of a peer that does not read wait in
        # this process.
        writer.transport.set_write_buffer_limits(0)
        task = asyncio.get_running_loop().create_task(self._serve(reader, writer, peer))
        self._connections[task] = peer

        def ended(task: asyncio.Task[None]) -> None:
            self._connections.pop(task, None)
            writer.close()  # Not in `_serve`: a task that is cancelled before its first step runs no `finally`.

        task.add_done_callback(ended)

    async def _serve(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter, peer: str) -> None:
        """Serve one connection until its end."""
        http = h11.Connection(h11.SERVER, max_incomplete_event_size=self._limits.header_bytes)
        try:
            while (body := await self._request(http, reader, writer)) is not None:
                try:
                    call = await self._call_in(body)
                finally:
                    self._held -= len(body)
                answer = await self._answer_to(call, peer)
                if self._sending + len(answer) > self._limits.held_bytes:
                    answer = encode_fault(_APPLICATION_ERROR, "the server has too many unread answers")
                self._sending += len(answer)
                try:
                    await self._send(http, writer, 200, b"OK", answer)
                finally:
                    self._sending -= len(answer)
                if http.our_state is not h11.DONE:  # The peer has requested that the connection is closed.
                    break
                http.start_next_cycle()
        except h11.RemoteProtocolError as error:
            if http.our_state in {h11.IDLE, h11.SEND_RESPONSE}:
                await self._turn_away(http, writer, error)
        except (OSError, asyncio.CancelledError):  # The peer is gone, too slow (TimeoutError), or was disconnected.
            writer.transport.abort()

    async def _request(
        self, http: h11.Connection, reader: asyncio.StreamReader, writer: asyncio.StreamWriter
    ) -> bytes | None:
        """Return the body of the next request, or None at the end of the connection.

        The size of the body counts toward the limit of held bytes until the caller subtracts it.

        Raises:
            TimeoutError: the peer is idle or too slow.
            OSError: the connection broke.
            h11.RemoteProtocolError: the request is invalid or beyond the limits.
        """
        loop = asyncio.get_running_loop()
        body = bytearray()
        # The peer may have sent the next request together with the last one.
        begun = bool(http.trailing_data[0])
        timeout = self._limits.request_seconds if begun else self._limits.idle_seconds
        try:
            async with asyncio.timeout(timeout) as deadline:
                while True:
                    event = http.next_event()
                    if event is h11.NEED_DATA:
                        if http.they_are_waiting_for_100_continue:
                            writer.write(http.send(h11.InformationalResponse(status_code=100, headers=[])) or b"")
                        http.receive_data(await reader.read(_SEGMENT))
                        if not begun:
                            begun = True
                            self._mark_active()
                            deadline.reschedule(loop.time() + self._limits.request_seconds)
                    elif isinstance(event, h11.Request):
                        _check(event)
                    elif isinstance(event, h11.Data):
                        body += event.data
                        self._held += len(event.data)
                        if len(body) > MAX_BYTES:
                            raise h11.RemoteProtocolError("the request is too long", 413)
                        if self._held > self._limits.held_bytes:
                            raise h11.RemoteProtocolError("too many bytes of requests are waiting", 503)
                    elif isinstance(event, h11.EndOfMessage):
                        complete = bytes(body)
                        body.clear()
                        return complete
                    else:  # The connection is closed, or the peer requests another protocol, which is not supported.
                        return None
        finally:
            self._held -= len(body)

    def _mark_active(self) -> None:
        task = asyncio.current_task()
        if task is not None and task in self._connections:
            self._connections.move_to_end(task)

    async def _call_in(self, body: bytes) -> MethodCall | MalformedDocument:
        # Only one call runs in each round of the event loop, so that many connections do not delay other work.
        async with self._turn:
            await asyncio.sleep(0)
        return await read_document(decode_call, body)

    async def _answer_to(self, call: MethodCall | MalformedDocument, peer: str) -> bytes:
        if isinstance(call, MalformedDocument):
            return encode_fault(_PARSE_ERROR, f"this is not an XML-RPC call: {call.reason}")
        answer = await self.answer(call, peer)
        if isinstance(answer, Fault):
            return encode_fault(answer.code, answer.text)
        try:
            return await write_document(lambda: encode_response(answer), answer)
        except ValueError as error:
            return encode_fault(_APPLICATION_ERROR, f"the answer cannot be encoded: {error}")

    async def _turn_away(
        self, http: h11.Connection, writer: asyncio.StreamWriter, error: h11.RemoteProtocolError
    ) -> None:
        text = f"{error}\n".encode(errors="replace")
        try:
            await self._send(http, writer, error.error_status_hint, b"", text, (("Connection", "close"),))
        except OSError:
            writer.transport.abort()

    async def _send(
        self,
        http: h11.Connection,
        writer: asyncio.StreamWriter,
        status: int,
        reason: bytes,
        body: bytes,
        headers: tuple[tuple[str, str], ...] = (),
    ) -> None:
        described = [("Content-Type", "text/xml"), ("Content-Length", str(len(body))), *headers]
        head = http.send(h11.Response(status_code=status, reason=reason, headers=described)) or b""
        http.send(h11.Data(data=body))
        http.send(h11.EndOfMessage())
        async with asyncio.timeout(self._limits.request_seconds):
            writer.write(head + body)  # One write, because a second segment would wait for a delayed acknowledgement.
            await writer.drain()


def _check(request: h11.Request) -> None:
    if request.method != b"POST":
        raise h11.RemoteProtocolError("XML-RPC requires POST", 405)
    if any(name == b"origin" for name, _ in request.headers):
        # Only browsers send this header, with the page that sent the request. No program of a graph is a browser.
        raise h11.RemoteProtocolError("requests of web pages are refused", 403)
    for name, value in request.headers:
        if name == b"content-length" and int(value) > MAX_BYTES:
            raise h11.RemoteProtocolError("the request is too long", 413)
