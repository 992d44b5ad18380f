"""The clock of a rehearsal, in which time passes as simulated people need it."""

from datetime import UTC, datetime, timedelta

from thbridge.experiment.store.events import Clocks

BEGIN = datetime(2000, 1, 3, 9, tzinfo=UTC)
"""When all rehearsals begin: no study with people has that date."""


class RehearsalClock:
    """Clocks that stand still until they are advanced, so that the same rehearsal has the same times."""

    def __init__(self) -> None:
        self._seconds = 0.0

    def advance(self, seconds: float) -> None:
        """Let time pass."""
        self._seconds += seconds

    def __call__(self) -> Clocks:
        """Return the time."""
        wall = BEGIN + timedelta(seconds=self._seconds)
        return Clocks(wall.strftime("%Y-%m-%dT%H:%M:%SZ"), round(self._seconds * 1e9))
