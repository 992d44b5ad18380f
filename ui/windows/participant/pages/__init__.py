"""Pages that fill the participant's window: start, connecting, consent, help, and end of the game."""
