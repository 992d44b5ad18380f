"""Programs that run games for participants: in a window, at the terminal, or simulated."""
