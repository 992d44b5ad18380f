"""TCP and UDP sockets for all protocols: addresses, admission of peers, TLS, keys and listening."""
