"""Watch protocol, with which a researcher's window observes a session: as bytes in `wire`, over TCP in `sockets`."""
