"""Result of a check of this computer."""

from dataclasses import dataclass
from enum import StrEnum


class HealthState(StrEnum):
    """State of a check: all is well (ok), some features do not work (warning), or no game can be played (fault)."""

    OK = "ok"
    WARNING = "warning"
    FAULT = "fault"


@dataclass(frozen=True, slots=True)
class HealthCheck:
    """Result of a check.

    Attributes:
        name: name of the check.
        state: its state.
        message: finding, as a clause without its full stop.
        remedy: what to do, as a sentence without its full stop; empty for state ok.
    """

    name: str
    state: HealthState
    message: str
    remedy: str = ""


def ok(name: str, message: str) -> HealthCheck:
    """Return the result of a check if there is no problem."""
    return HealthCheck(name, HealthState.OK, message)


def warning(name: str, message: str, remedy: str) -> HealthCheck:
    """Return the result of a check if some feature does not work."""
    return HealthCheck(name, HealthState.WARNING, message, remedy)


def fault(name: str, message: str, remedy: str) -> HealthCheck:
    """Return the result of a check if no game can be played."""
    return HealthCheck(name, HealthState.FAULT, message, remedy)
