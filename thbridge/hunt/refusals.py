"""Refusals as values: game, tour planner and dialogue engine return them instead of raising."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class RequestRefused:
    """A request that was understood and is not granted; it changed nothing.

    Attributes:
        reason: a stable code for programs and logs, e.g. `not-enough-energy`; each module that refuses lists its own
            codes as a `StrEnum`.
        sentence: the reason for people, a complete sentence that windows show as it is.
    """

    reason: str
    sentence: str
