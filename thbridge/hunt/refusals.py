"""Refusals as values: game, tour planner and dialogue engine return them instead of exceptions."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class RequestRefused:
    """A request that was understood but refused; it changed nothing.

    Attributes:
        reason: a stable code for programs and logs, e.g. `not-enough-energy`; each module that refuses requests lists
            its own codes as a `StrEnum`.
        sentence: the reason for people, a complete sentence that windows show unchanged.
    """

    reason: str
    sentence: str
