"""Data sources of front ends, without Qt: a game at its server, and recordings, read in small pieces."""
