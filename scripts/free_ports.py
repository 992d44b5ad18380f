"""Free ports of this machine, for the programs that a script starts."""

import socket


def free_ports(count: int) -> list[int]:
    """Return TCP ports at which no program listens."""
    sockets = [socket.create_server(("127.0.0.1", 0)) for _ in range(count)]
    ports = [each.getsockname()[1] for each in sockets]
    for each in sockets:
        each.close()
    return ports
