"""The simulated participants that there are, by name."""

from enum import StrEnum


class BotStrategy(StrEnum):
    """Strategy by which a simulated participant chooses rooms.

    `suggestion` takes the robot's advice, `nearest` the room that costs the robot least, `random` any room; the last
    one also breaks off one dialogue in ten.
    """

    SUGGESTION = "suggestion"
    NEAREST = "nearest"
    RANDOM = "random"
