"""Peers whose connection to a session of zenoh was lost, and what connects the session with them again.

zenoh connects to a peer once, when gossip of the router names it, and never again, for example if the peer was
suspended for longer than its lease. Only connections to the router are repeated. So this module sends gossip to its own
session, through a short connection, and zenoh connects to the peers that it names.
"""

import asyncio
import secrets
from collections.abc import Callable
from contextlib import suppress
from functools import partial

import zenoh
from zenoh.handlers import Callback

from thbridge.ros2graph.sockets.last_items import Job
from thbridge.ros2graph.wire.zenoh.gossip import cookie_of, gossip, init_request, open_request
from thbridge.sockets.addresses import Address, parse_address

_PAUSE_SECONDS = 2.0
"""Seconds between attempts."""
_ANSWER_SECONDS = 1.0
_MOST = 64
"""Maximum number of lost peers. Without a limit, programs could use any amount of memory and time."""
_PIECE = 1 << 16


class LostPeers:
    """Peers to which a session had connected. They are named again until they are connected or have ended.

    Args:
        session: session that lost them.
        own: address on which the session listens.
        router: address of its router on this machine.
        wake: function that makes a call on the event loop. Any thread may use it.
    """

    def __init__(self, session: zenoh.Session, own: Address, router: Address, wake: Callable[[Job], None]) -> None:
        self._info = session.info
        self._own = own
        self._router = router
        self._wake = wake
        self._lost: dict[str, Address] = {}
        self._task: asyncio.Task[None] | None = None
        self._listener = self._info.declare_link_events_listener(Callback(self._change, indirect=False))

    async def stop(self) -> None:
        """Make no further attempts."""
        if self._task is not None:
            self._task.cancel()
            await asyncio.gather(self._task, return_exceptions=True)

    def _change(self, event: zenoh.LinkEvent) -> None:
        """Remember a connection that ended, on a thread of zenoh. Peers that connected themselves have no address."""
        here, there = _address(event.link.src), _address(event.link.dst)
        is_lost = event.kind == zenoh.SampleKind.DELETE and here != self._own
        if is_lost and there is not None and there.port != self._router.port:
            self._wake(partial(self._lose, str(event.link.zid), there))

    def _lose(self, peer: str, address: Address) -> None:
        self._lost[peer] = address
        if len(self._lost) > _MOST:
            del self._lost[next(iter(self._lost))]
        if self._task is None or self._task.done():
            self._task = asyncio.create_task(self._repeat())

    async def _repeat(self) -> None:
        while self._lost:
            await asyncio.sleep(_PAUSE_SECONDS)
            for peer, address in list(self._lost.items()):
                has_ended = not await _listens(address)
                if has_ended or self._is_connected(peer, address):
                    self._lost.pop(peer, None)
            if self._lost:
                await self._name()

    def _is_connected(self, peer: str, address: Address) -> bool:
        """Return True if the session is connected with this peer, or with another one that now has its address."""
        return any(str(link.zid) == peer or _address(link.dst) == address for link in self._info.links())

    async def _name(self) -> None:
        with suppress(OSError, EOFError):  # TimeoutError is an OSError, too.
            async with asyncio.timeout(_ANSWER_SECONDS):
                reader, writer = await asyncio.open_connection(*self._own)
                try:
                    writer.write(init_request(secrets.token_bytes(15) + b"\x01"))
                    cookie = cookie_of(await _message(reader))
                    if cookie is not None:
                        writer.write(open_request(cookie))
                        await _message(reader)
                        writer.write(gossip({peer: f"tcp/{address}" for peer, address in self._lost.items()}))
                        writer.write_eof()
                        while await reader.read(_PIECE):
                            pass
                finally:
                    writer.transport.abort()


async def _message(reader: asyncio.StreamReader) -> bytes:
    return await reader.readexactly(int.from_bytes(await reader.readexactly(2), "little"))


async def _listens(address: Address) -> bool:
    """Return False if no program listens at an address. A suspended program listens, although it does not answer."""
    try:
        async with asyncio.timeout(_ANSWER_SECONDS):
            _, writer = await asyncio.open_connection(*address)
    except TimeoutError:
        return True
    except OSError:
        return False
    writer.transport.abort()
    return True


def _address(locator: str) -> Address | None:
    protocol, _, address = locator.partition("/")
    return parse_address(address) if protocol == "tcp" else None
