"""Modes: mode state machine, station that commands the robot, manual control, home position."""
