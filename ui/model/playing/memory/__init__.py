"""Memory of the participant's window: the game as the window has received it."""
