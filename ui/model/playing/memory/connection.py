"""State of the connection to the game, in words."""

import math

from thbridge.dialogue.wording.texts import Texts

STALE_AFTER = 1.5
"""The game counts as stopped after this number of seconds without telemetry of the robots.

Telemetry arrives 25 times per second.
"""


class ConnectionStatus:
    """State of the connection to the game, and age of the telemetry; `now` is monotonic time in seconds."""

    def __init__(self) -> None:
        self._lost: tuple[str, float] | None = None
        self._was_there = False
        self._received_at: float | None = None

    @property
    def is_lost(self) -> bool:
        """True if the connection is lost or could not be made."""
        return self._lost is not None

    @property
    def is_there(self) -> bool:
        """True while the program is connected to the game."""
        return self._was_there and self._lost is None

    def connected(self, now: float) -> None:
        """Record that the program is connected to the game."""
        self._lost, self._was_there = None, True
        # Telemetry starts again after a new connection. Until then, the connection does not count as stale.
        self._received_at = None if self._received_at is None else now

    def lose(self, sentence: str, now: float) -> None:
        """Record that there is no connection to the game, with the reason. The first call starts the clock."""
        self._lost = (sentence, self._lost[1] if self._lost else now)

    @property
    def why_lost(self) -> str:
        """Reason why there is no connection to the game, as a sentence.

        The reason is empty if it is unknown, or if there is a connection.
        """
        return self._lost[0] if self._lost else ""

    def receive(self, now: float) -> None:
        """Record that telemetry of the robots has arrived."""
        self._received_at = now

    def trouble(self, texts: Texts, now: float) -> str | None:
        """Return a sentence about the problem with the connection, or None if there is no problem."""
        if self._lost is not None:
            why, since = self._lost
            cut = "connection_lost" if self._was_there else "not_reached"
            seconds = int(now - since)
            lasting = texts.text(f"game.{cut}_for", count=seconds) if seconds else texts.text(f"game.{cut}")
            goes_on = texts.text("game.goes_on_after") if self._was_there else ""
            return " ".join(filter(None, (lasting, why, texts.text("game.reconnecting"), goes_on)))
        return texts.text("game.no_news") if self.is_still(now) else None

    def is_still(self, now: float) -> bool:
        """Return True while there is no connection, or no telemetry arrives."""
        return self._lost is not None or self._last_received() + STALE_AFTER <= now

    def next_change(self, now: float) -> float:
        """Return the time at which `trouble` changes if no more telemetry arrives."""
        if self._lost is not None:
            since = self._lost[1]
            return since + math.floor(now - since) + 1.0
        due = self._last_received() + STALE_AFTER
        return due if due > now else math.inf

    def _last_received(self) -> float:
        """Return the time of the last telemetry.

        Before the first telemetry, return infinity, so that the connection does not count as stale.
        """
        return math.inf if self._received_at is None else self._received_at
