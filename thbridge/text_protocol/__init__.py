"""Text protocol of 2016. `wire` has lines, messages and the router; `sockets` has the TCP server and client."""
