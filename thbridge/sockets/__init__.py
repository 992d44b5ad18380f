"""TCP and UDP sockets: addresses, admission, TLS, keys, and listening, for the wires of all features."""
