"""Conventions between thbridge's vehicles and ground station that MAVLink's standard does not define."""

COMMANDER = "COMMANDER"
"""Name of the NAMED_VALUE_INT that contains the commander. MAVLink's common messages have no field for it."""

BY_PARTICIPANT, BY_OTHERS = 0, -1
"""Values of `COMMANDER` if no station commands the robot. The commander is the participant, or a person outside the
game, for example a researcher."""

ARRIVED = "Arrived."
"""STATUSTEXT of a robot that has reached its goal."""
