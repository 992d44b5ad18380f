"""Modes: the mode state machine, the station in command, driving by hand, the home position."""
