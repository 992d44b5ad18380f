"""TLS for our programs on other machines. The session has a certificate, and its clients check the fingerprint.

One port accepts both plain and encrypted connections, because no line of our protocols begins with the first byte of
TLS.
"""

from __future__ import annotations

import asyncio
import contextlib
import hashlib
import hmac
import socket
import ssl
from asyncio import BaseProtocol, BaseTransport
from collections.abc import Callable
from pathlib import Path

from thbridge.files.disk.regular_files import content_of
from thbridge.files.errors import BadFile, reason_of
from thbridge.files.keys.certificate import Certificate
from thbridge.files.keys.key_file import ClientKey
from thbridge.files.keys.private_file import check_private

_HANDSHAKE = b"\x16"
"""First byte of a TLS connection: the type of its first record (RFC 8446, 5.1)."""
_FIRST_BYTE_SECONDS = 1.0
"""A connection counts as not encrypted if its client sends nothing for this number of seconds. Programs of 2016 may
wait for the server to speak."""
_HANDSHAKE_SECONDS = 10.0
_SHUTDOWN_SECONDS = 1.0
_LARGEST = 1 << 20
"""Maximum number of bytes of a certificate's file."""


class UntrustedServer(ConnectionError):  # noqa: N818 - not a fault of the program
    """The key is for another server. The key was not sent."""


def server_context(certificate: Certificate) -> ssl.SSLContext:
    """Return the context of a server with a certificate. Raises OSError if its files are missing."""
    context = ssl.SSLContext(ssl.PROTOCOL_TLS_SERVER)
    context.minimum_version = ssl.TLSVersion.TLSv1_3
    # With an empty password, OpenSSL does not ask for one on the terminal if the file is encrypted.
    context.load_cert_chain(certificate.path, password="")
    return context


def browser_context(certificate: Path, key: Path) -> ssl.SSLContext:
    """Return the context of a server for browsers.

    Args:
        certificate: PEM file with the certificate, and the certificates of its authorities if browsers need them.
        key: PEM file with the private key of the certificate.

    Raises:
        BadFile: a file cannot be read or is damaged, the files do not belong together, or other accounts may read the
            private key.
    """
    context = ssl.SSLContext(ssl.PROTOCOL_TLS_SERVER)
    context.minimum_version = ssl.TLSVersion.TLSv1_3
    for path in (certificate, key):
        try:
            content_of(path, _LARGEST)
        except OSError as error:
            raise BadFile(path, f"it cannot be read ({reason_of(error)})", "check the name of the file") from None
    check_private(key)
    try:
        context.load_cert_chain(certificate, key, password="")
    except ssl.SSLError as error:
        if error.reason == "KEY_VALUES_MISMATCH":
            problem, remedy = f"this is not the private key of {certificate}", "give the key of this certificate"
        else:
            problem = f"certificate and private key are not usable ({error.reason or error})"
            remedy = "give files in PEM format, with a private key that needs no password"
        raise BadFile(key, problem, remedy) from None
    return context


def client_context(key: ClientKey) -> ssl.SSLContext:
    """Return the context of a client. Without a fingerprint in the key, a public authority must certify the server."""
    context = ssl.create_default_context() if key.fingerprint is None else ssl.SSLContext(ssl.PROTOCOL_TLS_CLIENT)
    if key.fingerprint is not None:
        # The order matters: Python refuses CERT_NONE while check_hostname is True.
        context.check_hostname = False
        context.verify_mode = ssl.CERT_NONE  # `check_server` compares the fingerprint instead.
    context.minimum_version = ssl.TLSVersion.TLSv1_3
    return context


def check_server(transport: BaseTransport, key: ClientKey) -> None:
    """Check that a key is for this server, before the key is sent. Raises UntrustedServer."""
    if key.fingerprint is None:
        return
    encrypted: ssl.SSLObject | None = transport.get_extra_info("ssl_object")
    shown = None if encrypted is None else encrypted.getpeercert(binary_form=True)
    fingerprint = hashlib.sha256(shown or b"").hexdigest()
    if not hmac.compare_digest(fingerprint, key.fingerprint):
        raise UntrustedServer(f"its certificate is sha256:{fingerprint}, but the key is for another certificate")


def is_encrypted(transport: BaseTransport) -> bool:
    """Return True for a TLS connection."""
    return transport.get_extra_info("ssl_object") is not None


async def begin_connection(
    connection: Callable[[], BaseProtocol], accepted: socket.socket, tls: ssl.SSLContext | None
) -> None:
    """Start the protocol of an accepted connection, over TLS if the client begins a handshake and `tls` is given.

    Args:
        connection: factory of the protocol.
        accepted: socket of the connection, not blocking.
        tls: context of the server. If None, all connections are plain.

    Raises:
        OSError: the connection was lost before its protocol started, for example by a failed handshake.
    """
    loop = asyncio.get_running_loop()
    try:
        encrypted = tls is not None and await _begins_tls(accepted)
    except (OSError, asyncio.CancelledError):
        accepted.close()  # Later errors need no close, because the transport closes its socket.
        raise
    if encrypted:
        await loop.connect_accepted_socket(
            connection,
            accepted,
            ssl=tls,
            ssl_handshake_timeout=_HANDSHAKE_SECONDS,
            ssl_shutdown_timeout=_SHUTDOWN_SECONDS,
        )
    else:
        await loop.connect_accepted_socket(connection, accepted)


async def _begins_tls(accepted: socket.socket) -> bool:
    """Return True if a connection's first byte begins a handshake. The byte stays in the socket for the protocol."""
    loop = asyncio.get_running_loop()
    readable = asyncio.Event()
    loop.add_reader(accepted, readable.set)
    try:
        with contextlib.suppress(TimeoutError):
            async with asyncio.timeout(_FIRST_BYTE_SECONDS):
                await readable.wait()
    finally:
        loop.remove_reader(accepted)
    # Check even after a timeout, because this event loop may have been blocked while the byte arrived.
    with contextlib.suppress(BlockingIOError):
        return accepted.recv(1, socket.MSG_PEEK) == _HANDSHAKE
    return False
