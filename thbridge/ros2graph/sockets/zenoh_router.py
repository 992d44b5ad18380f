"""zenoh router for ROS 2 programs, where no other router runs.

zenoh does not filter clients by address. If other machines may connect, the router listens on this machine only, and a
gate in front of it accepts connections of admitted addresses and forwards their bytes.
"""

from __future__ import annotations

import asyncio
import logging
import socket
from asyncio import StreamReader, StreamReaderProtocol, StreamWriter
from collections.abc import AsyncIterator, Callable
from contextlib import asynccontextmanager, suppress

import zenoh

from thbridge.ros2graph.sockets.zenoh_settings import router_settings
from thbridge.sockets.addresses import LOCALHOST, Address, ListeningAddress
from thbridge.sockets.admission import OWN_MACHINE, Admission, is_own
from thbridge.sockets.errors import CannotListen
from thbridge.sockets.listening import ServerDoor
from thbridge.sockets.warn_once import WarnOnce
from thbridge.timing.loop import stopping

_warnings = WarnOnce(logging.getLogger(__name__))

_MOST = 256
"""Maximum number of connections through the gate."""
_PIECE = 1 << 16
"""Number of bytes that are forwarded at once."""


@asynccontextmanager
async def zenoh_router(
    address: Address, admission: Admission = OWN_MACHINE
) -> AsyncIterator[ListeningAddress | CannotListen]:
    """Run a router inside the context.

    Args:
        address: address to listen on. Port 0 selects any free port.
        admission: decides by address which other machines are accepted.
    """
    at = address if is_own(address.host) else Address(LOCALHOST, 0)
    router = await asyncio.to_thread(_open, at)
    if isinstance(router, CannotListen):
        yield router
        return
    session, listens = router
    gate = None if at is address else _Gate(listens, admission)
    try:
        yield listens if gate is None else await gate.start(address)
    finally:
        if gate is not None:
            await gate.stop()
        await asyncio.to_thread(session.close)


async def serve(
    address: Address, ready: Callable[[ListeningAddress | CannotListen], None], admission: Admission = OWN_MACHINE
) -> None:
    """Run a router until Ctrl-C, SIGTERM or SIGHUP.

    Args:
        address: see `zenoh_router`.
        ready: called with the address, or with the reason for a failure.
        admission: see `zenoh_router`.
    """
    with stopping() as stopped:
        async with zenoh_router(address, admission) as where:
            ready(where)
            if isinstance(where, ListeningAddress):
                await stopped.wait()


def _open(address: Address) -> tuple[zenoh.Session, ListeningAddress] | CannotListen:
    try:
        # zenoh reports neither the system's reason of a failure nor the port that the system selects.
        with socket.create_server(address, family=socket.AF_INET6 if ":" in address.host else socket.AF_INET) as probe:
            free = Address(address.host, probe.getsockname()[1])
        return zenoh.open(router_settings(free)), ListeningAddress(*free)
    except (OSError, UnicodeError) as error:
        return CannotListen.because(error, *address)
    except zenoh.ZError as error:
        return CannotListen(*address, str(error))


class _Gate:
    """Server that forwards the bytes of admitted clients to the router."""

    def __init__(self, router: ListeningAddress, admission: Admission) -> None:
        self._router = router
        self._admission = admission
        self._door = ServerDoor(_MOST)
        self._tasks: set[asyncio.Task[None]] = set()

    async def start(self, address: Address) -> ListeningAddress | CannotListen:
        """Begin to accept connections."""
        try:
            return await self._door.listen(self._connection, *address)
        except (OSError, UnicodeError) as error:
            return CannotListen.because(error, *address)

    async def stop(self) -> None:
        """Close all connections."""
        self._door.close()
        await self._door.wait_closed()
        for task in self._tasks:
            task.cancel()
        await asyncio.gather(*self._tasks, return_exceptions=True)

    def _connection(self) -> StreamReaderProtocol:
        return StreamReaderProtocol(StreamReader(), self._accept)

    def _accept(self, reader: StreamReader, writer: StreamWriter) -> None:
        refused = self._admission.refused(writer.transport)
        if refused is not None:
            _warnings.warn(f"{refused} may not connect. To allow it, add --open-to {refused}")
        elif len(self._tasks) >= self._door.most:
            _warnings.warn(f"more than {self._door.most} connections from other machines: further ones are refused")
        else:
            task = asyncio.create_task(self._forward(reader, writer))
            self._tasks.add(task)
            task.add_done_callback(self._tasks.discard)
            return
        writer.transport.abort()

    async def _forward(self, reader: StreamReader, writer: StreamWriter) -> None:
        """Forward bytes in both directions, until one side closes its connection."""
        try:
            from_router, to_router = await asyncio.open_connection(self._router.host, self._router.port)
        except OSError as error:
            _warnings.warn(f"the router does not accept a connection: {error}")
            writer.transport.abort()
            return
        directions = [asyncio.create_task(_copy(reader, to_router)), asyncio.create_task(_copy(from_router, writer))]
        try:
            await asyncio.wait(directions, return_when=asyncio.FIRST_COMPLETED)
        finally:
            for direction in directions:
                direction.cancel()
            await asyncio.gather(*directions, return_exceptions=True)
            for end in (writer, to_router):
                end.transport.abort()


async def _copy(reader: StreamReader, writer: StreamWriter) -> None:
    with suppress(OSError):
        while data := await reader.read(_PIECE):
            writer.write(data)
            await writer.drain()
