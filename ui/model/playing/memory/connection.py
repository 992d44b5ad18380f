"""State of the connection to the game, in words."""

import math

from thbridge.dialogue.wording.texts import Texts

STALE_AFTER = 1.5
"""Seconds without telemetry of the robots after which the game counts as stopped.

Telemetry arrives 25 times per second.
"""


class ConnectionStatus:
    """Connection to the game, and the age of its telemetry; `now` is monotonic time in seconds."""

    def __init__(self) -> None:
        self._lost: tuple[str, float] | None = None
        self._was_there = False
        self._received_at: float | None = None

    @property
    def is_lost(self) -> bool:
        """True if the connection was lost, or could not be made."""
        return self._lost is not None

    @property
    def is_there(self) -> bool:
        """True if the game is reached."""
        return self._was_there and self._lost is None

    def connected(self, now: float) -> None:
        """Record that the game is reached."""
        self._lost, self._was_there = None, True
        # Telemetry restarts with a new connection, so the connection is not stale yet.
        self._received_at = None if self._received_at is None else now

    def lose(self, sentence: str, now: float) -> None:
        """Record that the game is not reached, with the reason; time counts from the first call."""
        self._lost = (sentence, self._lost[1] if self._lost else now)

    @property
    def why_lost(self) -> str:
        """Reason why the game is not reached, as a sentence.

        It is empty if no reason is known, or the game is reached.
        """
        return self._lost[0] if self._lost else ""

    def receive(self, now: float) -> None:
        """Record that telemetry of the robots arrived."""
        self._received_at = now

    def trouble(self, texts: Texts, now: float) -> str | None:
        """Return a sentence about the trouble, or None if there is none."""
        if self._lost is not None:
            why, since = self._lost
            cut = "connection_lost" if self._was_there else "not_reached"
            seconds = int(now - since)
            lasting = texts.text(f"game.{cut}_for", count=seconds) if seconds else texts.text(f"game.{cut}")
            goes_on = texts.text("game.goes_on_after") if self._was_there else ""
            return " ".join(filter(None, (lasting, why, texts.text("game.reconnecting"), goes_on)))
        return texts.text("game.no_news") if self.is_still(now) else None

    def is_still(self, now: float) -> bool:
        """Return True while the game is not reached, or its telemetry has stopped."""
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

        Without any telemetry it is infinite, so that the connection never counts as stale.
        """
        return math.inf if self._received_at is None else self._received_at
