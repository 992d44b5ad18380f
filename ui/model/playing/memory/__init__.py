"""Memory of the participant's window: all data of the game that the window has received."""
