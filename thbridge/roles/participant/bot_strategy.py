"""Names of the built-in simulated participants."""

from enum import StrEnum


class BotStrategy(StrEnum):
    """Strategy of a simulated participant for the choice of rooms.

    `suggestion` follows the robot's advice. `nearest` chooses the room with the lowest cost for the robot. `random`
    chooses a random room, and stops one dialogue in ten.
    """

    SUGGESTION = "suggestion"
    NEAREST = "nearest"
    RANDOM = "random"
