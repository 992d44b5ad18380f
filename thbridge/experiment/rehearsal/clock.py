"""The clock of a rehearsal, which advances by the times that simulated people need."""

from datetime import UTC, datetime, timedelta

from thbridge.experiment.store.events import Clocks

BEGIN = datetime(2000, 1, 3, 9, tzinfo=UTC)
"""Start time of all rehearsals. No study with people has this date."""


class RehearsalClock:
    """Clocks that advance only on request, so that equal rehearsals have equal times."""

    def __init__(self) -> None:
        self.seconds = 0.0
        """Time since the start of the rehearsal, s."""

    def advance(self, seconds: float) -> None:
        """Advance the clocks."""
        self.seconds += seconds

    def advance_to(self, seconds: float) -> None:
        """Set the clocks to a time since the start of the rehearsal, s. A time in the past has no effect."""
        self.seconds = max(self.seconds, seconds)

    def __call__(self) -> Clocks:
        """Return the current time."""
        wall = BEGIN + timedelta(seconds=self.seconds)
        return Clocks(wall.strftime("%Y-%m-%dT%H:%M:%SZ"), round(self.seconds * 1e9))
