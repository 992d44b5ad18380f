"""Conventions between our vehicles and our ground station that MAVLink's standard leaves open."""

COMMANDER = "COMMANDER"
"""Name of the NAMED_VALUE_INT that holds the commander; common MAVLink has no message for it."""

BY_PARTICIPANT, BY_OTHERS = 0, -1
"""Values of it when no station commands: the game's participant does, or another person, such as a researcher."""

ARRIVED = "Arrived."
"""STATUSTEXT of a robot that has reached its goal."""
