"""Calls of services of other nodes."""

from __future__ import annotations

import asyncio
from asyncio import Transport
from urllib.parse import urlsplit

from thbridge.files.errors import reason_of
from thbridge.protocols.rosgraph.links import LinkEnded, LinkRefused, SendToPeer, ServiceAnswered, ServiceFailed
from thbridge.protocols.rosgraph.outbound import ServiceClientLink


async def ask(uri: str, link: ServiceClientLink, timeout: float) -> bytes | ServiceFailed:
    """Send one request to a service and wait for its answer.

    Args:
        uri: URI of the service, ``rosrpc://host:port``, as the master gives it.
        link: link with the request.
        timeout: seconds for everything.
    """
    try:
        parts = urlsplit(uri)
        host, port = parts.hostname, parts.port
    except ValueError:
        host, port = None, None
    if not host or port is None:
        return ServiceFailed(f"{uri} is no address of a service")
    client = _Client(link)
    try:
        async with asyncio.timeout(timeout):
            await asyncio.get_running_loop().create_connection(lambda: client, host, port)
            return await client.answer
    except TimeoutError:
        return ServiceFailed(f"no answer within {timeout:g} s")
    except OSError as error:
        return ServiceFailed(reason_of(error))
    except UnicodeError:
        return ServiceFailed(f"{host} is not a host's name")
    finally:
        client.cut_off()


class _Client(asyncio.Protocol):
    def __init__(self, link: ServiceClientLink) -> None:
        self.answer: asyncio.Future[bytes | ServiceFailed] = asyncio.get_running_loop().create_future()
        self._link = link
        self._transport: Transport | None = None

    def connection_made(self, transport: asyncio.BaseTransport) -> None:
        if isinstance(transport, Transport):
            self._transport = transport
            transport.write(self._link.opening())

    def data_received(self, data: bytes) -> None:
        for event in self._link.receive(data):
            match event:
                case SendToPeer(data) if self._transport is not None:
                    self._transport.write(data)
                case ServiceAnswered(answer):
                    self._settle(answer)
                case LinkRefused(reason) | LinkEnded(reason):
                    self._settle(ServiceFailed(reason))

    def connection_lost(self, exc: Exception | None) -> None:
        self._settle(ServiceFailed("the connection was closed before the answer"))

    def cut_off(self) -> None:
        """End the connection at once."""
        if self._transport is not None:
            self._transport.abort()

    def _settle(self, answer: bytes | ServiceFailed) -> None:
        if not self.answer.done():
            self.answer.set_result(answer)
