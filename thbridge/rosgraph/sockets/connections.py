"""Common functions for TCPROS connections of a node: keepalive, orderly close, addresses of both ends."""

from __future__ import annotations

import asyncio
import socket
from asyncio import Transport

HANDSHAKE_SECONDS = 10.0
"""Maximum time in seconds from the connection to the end of the peer's header."""

_LINGER = 60.0
"""Seconds after closing for which a peer can read the remaining data, such as a large map over a slow radio link."""


_KEEPALIVE = ((("TCP_KEEPIDLE", "TCP_KEEPALIVE"), 60), (("TCP_KEEPINTVL",), 10), (("TCP_KEEPCNT",), 9))
"""Names and values of TCP options: seconds of silence, seconds between probes, number of probes. The first option has
another name in macOS."""


def keep_alive(transport: Transport) -> None:
    """Let the system detect within about two minutes that a peer has disappeared. The values are ROS's."""
    link = transport.get_extra_info("socket")
    link.setsockopt(socket.SOL_SOCKET, socket.SO_KEEPALIVE, 1)
    for names, value in _KEEPALIVE:
        option = next((getattr(socket, name) for name in names if hasattr(socket, name)), None)
        if option is not None:
            link.setsockopt(socket.IPPROTO_TCP, option, value)


def close_gently(transport: Transport) -> asyncio.TimerHandle:
    """Close a connection after all data are sent, or after a minute.

    Returns:
        A handle that must be cancelled when the connection is lost.
    """
    transport.close()
    return asyncio.get_running_loop().call_later(_LINGER, transport.abort)


def endpoints(transport: Transport) -> tuple[int, str, int, int]:
    """Return local port, remote host, remote port and socket number of an open transport, as bus info contains them."""
    here = transport.get_extra_info("sockname")
    there = transport.get_extra_info("peername") or ("", 0)  # The address is empty if the peer has left.
    return here[1], there[0], there[1], transport.get_extra_info("socket").fileno()
