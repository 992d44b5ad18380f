"""Common functions for TCPROS connections of a node: keepalive, orderly close, endpoints for bus info."""

from __future__ import annotations

import asyncio
import socket
from asyncio import Transport

HANDSHAKE_SECONDS = 10.0
"""Largest time in seconds from the connection to the end of the peer's header."""

_LINGER = 60.0
"""Seconds that a peer has to read the remaining data after the close, such as a large map over a slow radio link."""


_KEEPALIVE = ((("TCP_KEEPIDLE", "TCP_KEEPALIVE"), 60), (("TCP_KEEPINTVL",), 10), (("TCP_KEEPCNT",), 9))
"""TCP options and their values: seconds of silence, seconds between probes, number of probes. macOS has another name
for one option."""


def keep_alive(transport: Transport) -> None:
    """Make the system detect a peer that disappeared, with ROS's values, within about two minutes."""
    link = transport.get_extra_info("socket")
    link.setsockopt(socket.SOL_SOCKET, socket.SO_KEEPALIVE, 1)
    for names, value in _KEEPALIVE:
        option = next((getattr(socket, name) for name in names if hasattr(socket, name)), None)
        if option is not None:
            link.setsockopt(socket.IPPROTO_TCP, option, value)


def close_gently(transport: Transport) -> asyncio.TimerHandle:
    """Close once everything is sent, at the latest after a minute; cancel the handle when the connection is lost."""
    transport.close()
    return asyncio.get_running_loop().call_later(_LINGER, transport.abort)


def endpoints(transport: Transport) -> tuple[int, str, int, int]:
    """Return local port, remote host, remote port and socket number of an open transport."""
    here = transport.get_extra_info("sockname")
    there = transport.get_extra_info("peername") or ("", 0)  # empty if the peer has already left
    return here[1], there[0], there[1], transport.get_extra_info("socket").fileno()
