"""TCP and UDP sockets for the protocols of `thbridge.wire`, which makes all decisions."""
