"""TCP and UDP sockets for the protocols of `thbridge.protocols`, which makes all decisions."""
