"""Refusals as values: what the game, the planner of tours and the dialogue answer instead of raising."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class RequestRefused:
    """A request that was understood and is not granted. Nothing changed.

    Attributes:
        reason: a stable code for programs and logs, e.g. `not-enough-energy`; each module that refuses lists its own
            codes as a `StrEnum`.
        sentence: the same for people, a complete sentence that the dialogue or a window can show as it is.
    """

    reason: str
    sentence: str
