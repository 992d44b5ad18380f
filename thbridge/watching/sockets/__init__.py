"""Watch server and client: the bag of a session, sent over TCP while it is recorded."""
