"""The loop of ticks in wall time: pace, end of the program, heartbeats during pauses."""
