"""Modes: the mode state machine, the station in command, manual control, the home position."""
