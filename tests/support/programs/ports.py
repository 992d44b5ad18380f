"""Ports for programs that have to be told theirs before they listen."""

import itertools
import os
import socket

_FIRST, _COUNT = 20_000, 12_000
"""All below those that the system itself hands out, to whoever connects or asks for any port: none of them is taken
between its choice and its use by a program that did not mean to."""

_APART = 97
"""How far apart workers begin that were started one after the other; none needs so many."""

_numbers = itertools.count(os.getpid() * _APART)


def free_port(kind: socket.SocketKind = socket.SOCK_STREAM) -> int:
    """A port of this machine that nobody has, and that is not given out twice."""
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
