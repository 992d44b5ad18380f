"""The clock of a rehearsal, which advances by the times that simulated people need."""

from datetime import UTC, datetime, timedelta

from thbridge.experiment.store.events import Clocks

BEGIN = datetime(2000, 1, 3, 9, tzinfo=UTC)
"""Start time of all rehearsals. No study with people has this date."""


class RehearsalClock:
    """Clocks that advance only by `advance`, so that equal rehearsals have equal times."""

    def __init__(self) -> None:
        self._seconds = 0.0

    def advance(self, seconds: float) -> None:
        """Advance the clocks."""
        self._seconds += seconds

    def __call__(self) -> Clocks:
        """Return the current time."""
        wall = BEGIN + timedelta(seconds=self._seconds)
        return Clocks(wall.strftime("%Y-%m-%dT%H:%M:%SZ"), round(self._seconds * 1e9))
