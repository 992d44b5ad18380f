"""Connections of the gateway: admitted by address, limited in number and in time, and closed if a client is too slow.

uvicorn has no limits for slow clients, for connections of one address, or for messages that a client sends in one
piece. The protocols of this module add them.
"""

import asyncio
from collections import Counter
from collections.abc import Callable
from functools import partial

import uvicorn
from uvicorn.protocols.http.h11_impl import H11Protocol
from uvicorn.protocols.websockets.websockets_sansio_impl import WebSocketsSansIOProtocol
from uvicorn.server import ServerState
from websockets.frames import CloseCode, Frame

from thbridge.sockets.admission import Admission, peer_of
from thbridge.sockets.tls import is_encrypted
from ui.web.gateway.limits import RefusalLog, network_of

MOST_CONNECTIONS = 2048
"""Maximum number of connections, if there are enough file descriptors."""
MOST_OF_ADDRESS = 1024
"""Maximum number of connections of one address."""
REQUEST_SECONDS = 10.0
"""Seconds in which a request must be complete, from the beginning of its connection or the last answer."""
ANSWER_SECONDS = 60.0
"""Seconds in which a client must have read an answer, and for which a socket may leave messages unread."""
LONGEST_HEAD = 16 * 1024
"""Maximum number of bytes of a request's line and headers."""
LONGEST_MESSAGE = 64 * 1024
"""Maximum number of bytes of a browser's message, also after decompression."""
MOST_QUEUED = 256
"""Maximum number of messages that a client may send before the first of them is processed."""
MOST_PIECES = 64
"""Maximum number of frames of one message."""

FAULTS = frozenset({CloseCode.PROTOCOL_ERROR, CloseCode.INVALID_DATA, CloseCode.MESSAGE_TOO_BIG})
"""Reasons for which the protocol closes a socket by itself (RFC 6455, 7.4.1)."""


class ConnectionGate:
    """Gate for all connections of a gateway.

    If there are too many connections, a new connection replaces the oldest connection without a socket, because only
    sockets belong to people.

    Args:
        admission: networks of the admitted machines.
        proxies: networks of the proxies in front of the gateway; many people come from one address of these.
        encrypted: True if the gateway accepts only TLS.
        most: function that returns the maximum number of connections at present.
        refusals: log of refused clients.
    """

    def __init__(
        self,
        admission: Admission,
        proxies: Admission | None,
        most: Callable[[], int],
        refusals: RefusalLog,
        *,
        encrypted: bool,
    ) -> None:
        self._admission, self._proxies = admission, proxies
        self._encrypted = encrypted
        self._most = most
        self.refusals = refusals
        self._requests: dict[asyncio.Transport, str] = {}
        self._sockets: dict[asyncio.Transport, str] = {}
        self._of_address: Counter[str] = Counter()

    def arrived(self, transport: asyncio.Transport) -> bool:
        """Admit a new connection; return False if it is refused."""
        host = str((transport.get_extra_info("peername") or ("a client that has left",))[0])
        peer, address = peer_of(transport), network_of(host)
        if peer is not None and not self._admission.admits(peer):
            self.refusals.warn(f"A browser at {peer} is refused: its address is in no network of open_to.")
            return False
        if self._encrypted and not is_encrypted(transport):
            return False
        shared = self._proxies is not None and self._proxies.admits(host)
        if not shared and self._of_address[address] >= MOST_OF_ADDRESS:
            self.refusals.warn(f"{address} has {MOST_OF_ADDRESS} connections; further connections replace older ones.")
            oldest = next((each for each, its in self._requests.items() if its == address), None)
        elif len(self._requests) + len(self._sockets) >= self._most():
            self.refusals.warn("All connections are in use; further connections replace older ones.")
            oldest = next(iter(self._requests), None)
        else:
            oldest = transport
        if oldest is None:
            return False
        if oldest is not transport:
            oldest.abort()
            self.left(oldest)
        self._requests[transport] = address
        self._of_address[address] += 1
        return True

    def upgraded(self, transport: asyncio.Transport) -> None:
        """Note that a connection is a socket now."""
        address = self._requests.pop(transport, None)
        if address is not None:
            self._sockets[transport] = address

    def left(self, transport: asyncio.Transport) -> None:
        """Note that a connection has ended."""
        address = self._requests.pop(transport, None) or self._sockets.pop(transport, None)
        if address is not None:
            self._of_address[address] -= 1
            if self._of_address[address] == 0:
                del self._of_address[address]


class HttpConnection(H11Protocol):
    """Connection for requests.

    Args:
        gate: gate of the gateway.
        config: configuration of uvicorn.
        state: state of uvicorn.
    """

    def __init__(self, gate: ConnectionGate, config: uvicorn.Config, state: ServerState) -> None:
        super().__init__(config, state, {})
        self.ws_protocol_class = partial(SocketConnection, gate)  # type: ignore[assignment]
        self._gate = gate
        self._late: asyncio.TimerHandle | None = None

    def connection_made(self, transport: asyncio.Transport) -> None:  # type: ignore[override]
        """See `asyncio.Protocol`."""
        super().connection_made(transport)
        if self._gate.arrived(transport):
            self._expect_within(REQUEST_SECONDS)
        else:
            transport.abort()

    def connection_lost(self, exc: Exception | None) -> None:
        """See `asyncio.Protocol`."""
        self._expect_nothing()
        self._gate.left(self.transport)
        super().connection_lost(exc)

    def data_received(self, data: bytes) -> None:
        """See `asyncio.Protocol`."""
        if self.transport.is_closing():
            return
        before = self.cycle
        super().data_received(data)
        if self.cycle is not before:
            self._expect_within(ANSWER_SECONDS)

    def handle_websocket_upgrade(self, event: object) -> None:
        """Replace this protocol by that of a socket."""
        self._expect_nothing()
        self._gate.upgraded(self.transport)
        super().handle_websocket_upgrade(event)  # type: ignore[arg-type]

    def on_response_complete(self) -> None:
        """Expect the next request. A request whose body is still being sent is cut off: no page needs one."""
        if not self.cycle.more_body:
            self._expect_within(REQUEST_SECONDS)
            super().on_response_complete()
        else:
            self.transport.close()
            self._expect_within(1.0)

    def send_400_response(self, msg: str) -> None:
        """Refuse a request that is not HTTP, or too long."""
        self._refuse("sent an invalid or too long request")
        super().send_400_response(msg)

    def _expect_within(self, seconds: float) -> None:
        self._expect_nothing()
        self._late = self.loop.call_later(seconds, self._cut_off)

    def _expect_nothing(self) -> None:
        if self._late is not None:
            self._late.cancel()
            self._late = None

    def _cut_off(self) -> None:
        if not self.transport.is_closing():
            self._refuse("is too slow")
        self.transport.abort()

    def _refuse(self, why: str) -> None:
        host = "A client" if self.client is None else network_of(self.client[0])
        self._gate.refusals.warn(f"{host} {why}; the connection is closed.")


class SocketConnection(WebSocketsSansIOProtocol):
    """WebSocket of a browser.

    Args:
        gate: gate of the gateway.
        config: configuration of uvicorn.
        server_state: state of uvicorn.
        app_state: state of the application.
    """

    def __init__(
        self, gate: ConnectionGate, config: uvicorn.Config, server_state: ServerState, app_state: dict[str, object]
    ) -> None:
        super().__init__(config, server_state, app_state)
        self._gate = gate
        self._pieces = 0
        self._unread: asyncio.TimerHandle | None = None

    def connection_lost(self, exc: Exception | None) -> None:
        """See `asyncio.Protocol`."""
        self._forget_unread()
        self._gate.left(self.transport)
        super().connection_lost(exc)

    def data_received(self, data: bytes) -> None:
        """See `asyncio.Protocol`."""
        super().data_received(data)
        closed = self.conn.close_sent
        if closed is not None and closed.code in FAULTS:
            self._refuse("sent a message that is too long or malformed")
            self._close_within(1.0)
        elif self.queue.qsize() > MOST_QUEUED:
            self._refuse("sent too many messages at once")
            self.transport.abort()

    def handle_cont(self, event: Frame) -> None:
        """Count the pieces of a message: there is no limit for empty pieces otherwise."""
        self._pieces += 1
        if self._pieces > MOST_PIECES:
            self._refuse("sent a message in too many pieces")
            self.transport.abort()
            return
        super().handle_cont(event)

    def send_receive_event_to_app(self) -> None:
        """Begin to count the pieces of the next message."""
        self._pieces = 0
        super().send_receive_event_to_app()

    def pause_writing(self) -> None:
        """Close the connection if its client reads nothing for a long time."""
        super().pause_writing()
        self._close_within(ANSWER_SECONDS)

    def resume_writing(self) -> None:
        """See `asyncio.Protocol`."""
        self._forget_unread()
        super().resume_writing()

    def _close_within(self, seconds: float) -> None:
        self._forget_unread()
        self._unread = self.loop.call_later(seconds, self.transport.abort)

    def _forget_unread(self) -> None:
        if self._unread is not None:
            self._unread.cancel()
            self._unread = None

    def _refuse(self, why: str) -> None:
        host = "A browser" if self.client is None else network_of(self.client[0])
        self._gate.refusals.warn(f"{host} {why}; the socket is closed.")
