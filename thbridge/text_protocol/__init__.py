"""Text protocol of 2016: lines, messages and router in `wire`; server and client over TCP in `sockets`."""
