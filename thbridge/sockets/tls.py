"""TLS for programs of ours on other machines: the session shows a certificate, and its clients know it by fingerprint.

A port of ours takes both what is plain and what is encrypted: TLS begins with a byte that begins no line of ours.
"""

from __future__ import annotations

import asyncio
import hashlib
import hmac
import logging
import os
import socket
import ssl
from asyncio import BaseProtocol, BaseTransport
from collections.abc import Callable

from thbridge.files.keys.certificate import Certificate
from thbridge.files.keys.key_file import ClientKey
from thbridge.sockets.admission import is_own

_log = logging.getLogger(__name__)

_HANDSHAKE = 0x16
"""First byte of a TLS connection: the type of its first record (RFC 8446, 5.1)."""
_FIRST_BYTE_SECONDS = 1.0
"""Seconds that a connection may be silent before it counts as plain: programs of 2016 may wait to be spoken to."""
_HANDSHAKE_SECONDS = 10.0
_SHUTDOWN_SECONDS = 1.0
_MOST_ARRIVING = 64
"""Connections that have not shown yet what they speak; one more takes the place of the oldest."""


class UntrustedServer(ConnectionError):
    """The server is not the one that the key is for; the key was not shown to it."""


def server_context(certificate: Certificate) -> ssl.SSLContext:
    """Return the context of a server with a certificate. Raises OSError where its files are gone."""
    context = ssl.SSLContext(ssl.PROTOCOL_TLS_SERVER)
    context.minimum_version = ssl.TLSVersion.TLSv1_3
    context.load_cert_chain(certificate.path, certificate.private_key)
    return context


def needs_tls(host: str, key: ClientKey | None) -> bool:
    """Return True where a client encrypts: with a key of a session, or any key that leaves this machine."""
    return key is not None and (key.fingerprint is not None or not is_own(host))


def client_context(key: ClientKey) -> ssl.SSLContext:
    """Return the context of a client, whose key has a fingerprint to be compared, or else public authorities vouch."""
    context = ssl.create_default_context() if key.fingerprint is None else ssl.SSLContext(ssl.PROTOCOL_TLS_CLIENT)
    if key.fingerprint is not None:
        context.check_hostname = False
        context.verify_mode = ssl.CERT_NONE  # `check_server` does.
    context.minimum_version = ssl.TLSVersion.TLSv1_3
    return context


def check_server(transport: BaseTransport, key: ClientKey) -> None:
    """Check that a server is the one that a key is for, before the key is shown. Raises UntrustedServer."""
    if key.fingerprint is None:
        return
    encrypted: ssl.SSLObject | None = transport.get_extra_info("ssl_object")
    shown = None if encrypted is None else encrypted.getpeercert(binary_form=True)
    fingerprint = hashlib.sha256(shown or b"").hexdigest()
    if not hmac.compare_digest(fingerprint, key.fingerprint):
        raise UntrustedServer(f"it shows the certificate sha256:{fingerprint}, not the one of the key")


def is_encrypted(transport: BaseTransport) -> bool:
    """Return True for a connection that speaks TLS."""
    return transport.get_extra_info("ssl_object") is not None


class TlsDetector:
    """Makes protocols for connections, in TLS where these begin so, else plain; to be given to `create_server`.

    Args:
        make: makes the protocol of a connection.
        context: of the server.
    """

    def __init__(self, make: Callable[[], BaseProtocol], context: ssl.SSLContext) -> None:
        self._make = make
        self._context = context
        self._arriving: dict[_Arrival, None] = {}

    def __call__(self) -> BaseProtocol:
        """Return the protocol of a new connection, until it is known what it speaks."""
        return _Arrival(self)

    def close(self) -> None:
        """Cut off whoever has not shown yet what it speaks."""
        for arrival in tuple(self._arriving):
            arrival.abandon()

    def arrived(self, arrival: _Arrival) -> None:
        """Add a connection; the oldest that is still silent makes room."""
        if len(self._arriving) >= _MOST_ARRIVING:
            next(iter(self._arriving)).abandon()
        self._arriving[arrival] = None

    def gone(self, arrival: _Arrival) -> None:
        """Remove a connection."""
        self._arriving.pop(arrival, None)

    async def take(self, peer: socket.socket, *, encrypted: bool) -> None:
        """Give a connection its protocol. Raises OSError, of which failed handshakes are one kind."""
        loop = asyncio.get_running_loop()
        if encrypted:
            await loop.connect_accepted_socket(
                self._make,
                peer,
                ssl=self._context,
                ssl_handshake_timeout=_HANDSHAKE_SECONDS,
                ssl_shutdown_timeout=_SHUTDOWN_SECONDS,
            )
        else:
            await loop.connect_accepted_socket(self._make, peer)


class _Arrival(BaseProtocol):
    """A connection whose first byte is looked at, and left for its protocol to read.

    The socket is taken over from the transport that the loop has made for it: of a transport nothing can be read
    without taking it away from whoever comes next.
    """

    def __init__(self, detector: TlsDetector) -> None:
        self._detector = detector
        self._socket: socket.socket | None = None
        self._timer: asyncio.TimerHandle | None = None
        self._task: asyncio.Task[None] | None = None

    def connection_made(self, transport: BaseTransport) -> None:
        if not isinstance(transport, asyncio.Transport):
            return
        try:
            self._socket = socket.socket(fileno=os.dup(transport.get_extra_info("socket").fileno()))
        except OSError as error:
            _log.warning("a client is turned away: %s", error)
            transport.abort()
            return
        self._socket.setblocking(False)
        transport.abort()  # The other end notices nothing: our copy is open.
        self._detector.arrived(self)
        loop = asyncio.get_running_loop()
        loop.add_reader(self._socket, self._look)
        self._timer = loop.call_later(_FIRST_BYTE_SECONDS, self._begin, b"")

    def abandon(self) -> None:
        """Cut the connection off."""
        if self._task is not None:
            self._task.cancel()
        self._leave()
        if self._socket is not None:
            self._socket.close()

    def _look(self) -> None:
        if self._socket is None:
            return
        try:
            first = self._socket.recv(1, socket.MSG_PEEK)
        except (BlockingIOError, InterruptedError):
            return
        except OSError:
            self.abandon()
            return
        self._begin(first)

    def _begin(self, first: bytes) -> None:
        self._stop_looking()
        self._task = asyncio.get_running_loop().create_task(self._hand_over(encrypted=first[:1] == bytes([_HANDSHAKE])))

    async def _hand_over(self, *, encrypted: bool) -> None:
        if self._socket is None:
            return
        try:
            await self._detector.take(self._socket, encrypted=encrypted)
        except OSError as error:
            _log.info("a client's TLS handshake failed: %s", error)
            self._socket.close()
        finally:
            self._detector.gone(self)

    def _stop_looking(self) -> None:
        if self._socket is not None:
            asyncio.get_running_loop().remove_reader(self._socket)
        if self._timer is not None:
            self._timer.cancel()

    def _leave(self) -> None:
        self._stop_looking()
        self._detector.gone(self)
