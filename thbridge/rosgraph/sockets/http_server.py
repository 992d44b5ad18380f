"""XML-RPC over HTTP/1.1: server of ROS 1's master and slave APIs.

A peer may be slow, silent, hostile or gone. Every wait has a deadline; every buffer and every collection has a limit.
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
"""Largest number of bytes read at a time."""

_APPLICATION_ERROR = 1
"""Fault code that Python's XML-RPC servers use for every error, and so do rospy and rosmaster."""

_PARSE_ERROR = -32700
"""Fault code of a malformed call. Source: http://xmlrpc-epi.sourceforge.net/specs/rfc.fault_codes.php."""

CallHandler: TypeAlias = Callable[[MethodCall, str], XmlRpcValue | Fault | Awaitable[XmlRpcValue | Fault]]
"""Function that answers a call from a peer's address, at once or later."""


@dataclass(frozen=True, slots=True)
class HttpLimits:
    """Limits of a server.

    Args:
        connections: largest number of connections. A further connection closes another one: the connection that has
            been idle longest, of the address with the most connections.
        header_bytes: size of a request's header, checked after each read.
        held_bytes: bytes of requests that are not decoded yet, over all connections; the same limit applies to unread
            answers.
        request_seconds: seconds from the first byte of a request to its last; the peer has the same time to read the
            answer.
        idle_seconds: seconds between two requests of a connection.
    """

    connections: int = 512
    header_bytes: int = 16 * 1024
    held_bytes: int = 4 * MAX_BYTES
    request_seconds: float = 10.0
    idle_seconds: float = 300.0


class XmlRpcServer:
    """XML-RPC server that accepts several requests per connection.

    ``system.listMethods`` and ``system.multicall`` are answered here.

    Args:
        methods: names of the handler's methods; it is never called for others.
        handler: answers a call. An exception becomes a fault and a line in the log.
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
        """Peers by connection, longest idle first."""
        self._held = 0
        self._sending = 0
        self._turn = asyncio.Lock()

    @property
    def connections(self) -> int:
        """Number of open connections."""
        return len(self._connections)

    async def start(self, host: str = "127.0.0.1", port: int = 0) -> ListeningAddress | CannotListen:
        """Start to serve; port 0 chooses a free one."""
        if not 0 <= port <= 65535:
            return CannotListen(host, port, "a port is a number from 0 to 65535")
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
        """Answer a call, including calls of this process without a socket."""
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
                    await asyncio.sleep(0)  # there may be thousands of calls
                    answers.append(await self._one_of_many(call, peer))
                    room -= written_size(answers[-1], room)
                    if room < 0:
                        return Fault(_APPLICATION_ERROR, f"the answers are longer than {MAX_BYTES} characters")
                return answers
            case _:
                return Fault(_APPLICATION_ERROR, "system.multicall takes one array of structs")

    async def _one_of_many(self, call: XmlRpcValue, peer: str) -> XmlRpcValue:
        match call:
            case {"methodName": "system.multicall"}:
                answer: XmlRpcValue | Fault = Fault(_APPLICATION_ERROR, "system.multicall must not call itself")
            case {"methodName": str(method), "params": list(params)}:
                answer = await self.answer(MethodCall(method, params), peer)
            case _:
                answer = Fault(_APPLICATION_ERROR, "a call is a struct of methodName and params")
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
        # After draining, all data are in the kernel, so no data waits in this process for a peer that does not read.
        writer.transport.set_write_buffer_limits(0)
        task = asyncio.get_running_loop().create_task(self._serve(reader, writer, peer))
        self._connections[task] = peer

        def ended(task: asyncio.Task[None]) -> None:
            self._connections.pop(task, None)
            writer.close()  # closed here, because a task cancelled before its first step runs no `finally`

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
                    answer = encode_fault(_APPLICATION_ERROR, "too much at a time")
                self._sending += len(answer)
                try:
                    await self._send(http, writer, 200, b"OK", answer)
                finally:
                    self._sending -= len(answer)
                if http.our_state is not h11.DONE:  # the peer asked for the connection to be closed
                    break
                http.start_next_cycle()
        except h11.RemoteProtocolError as error:
            if http.our_state in {h11.IDLE, h11.SEND_RESPONSE}:
                await self._turn_away(http, writer, error)
        except (OSError, asyncio.CancelledError):  # gone, too slow (a TimeoutError), or disconnected
            writer.transport.abort()

    async def _request(
        self, http: h11.Connection, reader: asyncio.StreamReader, writer: asyncio.StreamWriter
    ) -> bytes | None:
        """Return the body of the next request, which counts as held until the caller releases it; None at the end.

        Raises:
            TimeoutError: the peer is idle or too slow.
            OSError: the connection broke.
            h11.RemoteProtocolError: the request is invalid or beyond the limits.
        """
        loop = asyncio.get_running_loop()
        body = bytearray()
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
                            raise h11.RemoteProtocolError("too much at a time", 503)
                    elif isinstance(event, h11.EndOfMessage):
                        complete = bytes(body)
                        body.clear()
                        return complete
                    else:  # closed, or a change of protocols, which is not supported
                        return None
        finally:
            self._held -= len(body)

    def _mark_active(self) -> None:
        task = asyncio.current_task()
        if task is not None and task in self._connections:
            self._connections.move_to_end(task)

    async def _call_in(self, body: bytes) -> MethodCall | MalformedDocument:
        # Only one call runs in each round of the event loop, so that other work is not delayed by many connections.
        async with self._turn:
            await asyncio.sleep(0)
        return await read_document(decode_call, body)

    async def _answer_to(self, call: MethodCall | MalformedDocument, peer: str) -> bytes:
        if isinstance(call, MalformedDocument):
            return encode_fault(_PARSE_ERROR, f"this is no XML-RPC call: {call.reason}")
        answer = await self.answer(call, peer)
        if isinstance(answer, Fault):
            return encode_fault(answer.code, answer.text)
        try:
            return await write_document(lambda: encode_response(answer), answer)
        except ValueError as error:
            return encode_fault(_APPLICATION_ERROR, f"the answer cannot be written: {error}")

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
            writer.write(head + body)  # in one write: a second segment would wait for a delayed acknowledgement
            await writer.drain()


def _check(request: h11.Request) -> None:
    if request.method != b"POST":
        raise h11.RemoteProtocolError("XML-RPC requires POST", 405)
    if any(name == b"origin" for name, _ in request.headers):
        # Only browsers say which page sent a request; no program of a graph is a browser.
        raise h11.RemoteProtocolError("pages in browsers are not served", 403)
    for name, value in request.headers:
        if name == b"content-length" and int(value) > MAX_BYTES:
            raise h11.RemoteProtocolError("the request is too long", 413)
