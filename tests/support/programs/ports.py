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


_DOMAINS = 48
"""Domains of ROS 2 for tests. Their UDP ports are below those of `free_port`."""

_domains = itertools.count(os.getpid() * 13)


def free_domain() -> int:
    """Return a ROS 2 domain in which no program of this machine takes part, and that was not returned lately."""
    for number in _domains:
        domain = 1 + number % _DOMAINS
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
            try:
                # The port at which the first participant of a domain hears of others (DDSI-RTPS, section 9.6.1.1).
                probe.bind(("127.0.0.1", 7400 + 250 * domain + 10))
            except OSError:
                continue
        return domain
    raise AssertionError("numbers have no end")
