"""Writing, reading and repair of the recordings of sessions: bags and journals."""
