"""TCP and UDP sockets: addresses, who is admitted, TLS, keys, and listening, for the wires of all features."""
