"""Presence of people in browsers: how long a person may be absent, and what follows."""

from dataclasses import dataclass
from enum import StrEnum

from sim.parameters import param

LONGEST_GRACE = 7 * 86400.0


class AbsenceRule(StrEnum):
    """Rule for a person who is absent for longer than the grace period."""

    END = "end"
    """The game and the run end. The run does not count, and its place becomes free."""
    WAIT = "wait"
    """The run waits until the person comes back."""


@dataclass(frozen=True, slots=True)
class PresenceSection:
    """Presence of people in browsers: a person is present while the page is connected and visible."""

    grace: float = param(300.0, "time for which a person may be absent from a game", "s", 10, LONGEST_GRACE)
    page_grace: float = param(3600.0, "time for which a person may be absent from a page", "s", 10, LONGEST_GRACE)
    then: AbsenceRule = param(AbsenceRule.END, "what follows if a person is absent for longer")
