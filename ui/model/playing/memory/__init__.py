"""Memory of the participant's window: a game as it was told so far."""
