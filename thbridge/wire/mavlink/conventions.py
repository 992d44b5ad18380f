"""What our vehicles and our ground station agree on, and MAVLink's standard leaves open."""

COMMANDER = "COMMANDER"
"""The name of the NAMED_VALUE_INT that tells who commands; common MAVLink has no message for it."""

BY_PARTICIPANT, BY_OTHERS = 0, -1
"""Its value when no station commands: the participant of the game does, or somebody beside it, such as a researcher."""

ARRIVED = "Arrived."
"""The sentence of a robot that is where it was sent."""
