"""Conventions between thbridge's vehicles and ground station that MAVLink's standard leaves open."""

COMMANDER = "COMMANDER"
"""Name of the NAMED_VALUE_INT with the commander; common MAVLink has no message for it."""

BY_PARTICIPANT, BY_OTHERS = 0, -1
"""Values of `COMMANDER` when no station is in command: the participant is, or a person outside the game (a
researcher)."""

ARRIVED = "Arrived."
"""STATUSTEXT of a robot that has reached its goal."""
