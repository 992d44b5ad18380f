"""Ports for programs that must know their port before they listen."""

import itertools
import os
import socket

_FIRST, _COUNT = 20_000, 12_000
"""First port and number of ports, all below the range from which the system chooses ports for connections and for port
0. No other program takes such a port by accident between its choice and its use."""

_APART = 97
"""Distance between the first ports of workers that were started one after the other; no worker needs more ports."""

_numbers = itertools.count(os.getpid() * _APART)


def free_port(kind: socket.SocketKind = socket.SOCK_STREAM) -> int:
    """Return a port of this machine that no program uses, and that was not returned before."""
    for number in _numbers:
        port = _FIRST + number % _COUNT
        with socket.socket(socket.AF_INET, kind) as probe:
            try:
                probe.bind(("127.0.0.1", port))
            except OSError:
                continue
        return port
    raise AssertionError("numbers have no end")


def free_udp_port() -> int:
    return free_port(socket.SOCK_DGRAM)
