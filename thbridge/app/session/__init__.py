"""The session: roles around one router, the tick they share, inputs from outside, recording."""
