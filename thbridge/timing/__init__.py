"""Loop of ticks in wall time: pace, end of the program, and heartbeats during pauses."""
