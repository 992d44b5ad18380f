"""Watch protocol, with which a researcher's window observes a session: bytes in `wire`, connections in `sockets`."""
