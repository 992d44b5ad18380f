"""Result of a check of the computer."""

from dataclasses import dataclass
from enum import StrEnum


class HealthState(StrEnum):
    """State: all works (ok), some features do not (warning), no game can be played (fault)."""

    OK = "ok"
    WARNING = "warning"
    FAULT = "fault"


@dataclass(frozen=True, slots=True)
class HealthCheck:
    """Result of a check.

    Attributes:
        name: name of the check.
        state: its state.
        message: what was found, as a clause without its full stop.
        remedy: what to do, as a sentence without its full stop; empty if all works.
    """

    name: str
    state: HealthState
    message: str
    remedy: str = ""


def ok(name: str, message: str) -> HealthCheck:
    """Return the result of a check that found no problem."""
    return HealthCheck(name, HealthState.OK, message)


def warning(name: str, message: str, remedy: str) -> HealthCheck:
    """Return the result of a check that found a feature which does not work."""
    return HealthCheck(name, HealthState.WARNING, message, remedy)


def fault(name: str, message: str, remedy: str) -> HealthCheck:
    """Return the result of a check that found why no game can be played."""
    return HealthCheck(name, HealthState.FAULT, message, remedy)
