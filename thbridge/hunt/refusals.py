"""Refusals. The game, the tour planner and the dialogue engine return refusals instead of raising exceptions."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class RequestRefused:
    """Refusal of a valid request. The state of the game did not change.

    Attributes:
        reason: a stable code for programs and logs, such as `not-enough-energy`. Each module lists its codes in a
            `StrEnum`.
        sentence: complete sentence with the reason for people. Windows show this sentence.
    """

    reason: str
    sentence: str
