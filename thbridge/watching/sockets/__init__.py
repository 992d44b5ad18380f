"""Watch server and client, which transfer the messages of a running session over TCP."""
