"""The built-in simulated participants, by name."""

from enum import StrEnum


class BotStrategy(StrEnum):
    """Strategy of a simulated participant for choosing rooms.

    `suggestion` follows the robot's advice; `nearest` chooses the room that costs the robot least; `random` chooses any
    room. `random` also breaks off one dialogue in ten.
    """

    SUGGESTION = "suggestion"
    NEAREST = "nearest"
    RANDOM = "random"
