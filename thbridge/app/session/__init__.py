"""The session: programs around one router, the tick they share, what comes in from outside, what is recorded."""
