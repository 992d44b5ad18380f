"""Server and client of watching: the bag of a session as it is recorded, over TCP."""
