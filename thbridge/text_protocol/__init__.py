"""Text protocol of 2016: its lines, messages and router as `wire`, and server and client over TCP as `sockets`."""
