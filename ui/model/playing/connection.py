"""Whether the game is reached, and whether it moves, in words."""

import math

from ui.model.playing.words import as_sentence

STALE_AFTER = 1.5
"""Seconds without news of the robots after which the game stands still; they come 25 times a second."""


class ConnectionStatus:
    """What is known of the connection; `now` is monotonic seconds."""

    def __init__(self) -> None:
        self._lost: tuple[str, float] | None = None
        self._was_there = False
        self._heard: float | None = None

    @property
    def is_lost(self) -> bool:
        """Whether it is cut off, after it had been there or before."""
        return self._lost is not None

    @property
    def is_there(self) -> bool:
        """Whether it is there now."""
        return self._was_there and self._lost is None

    def connected(self, now: float) -> None:
        """It is there."""
        self._lost, self._was_there = None, True
        # A program whose robots tell where they are does so again at once.
        self._heard = None if self._heard is None else now

    def lose(self, sentence: str, now: float) -> None:
        """It is not there, for the reason in this sentence; how long is counted from the first time."""
        self._lost = (sentence, self._lost[1] if self._lost else now)

    def receive(self, now: float) -> None:
        """News of the robots came."""
        self._heard = now

    def trouble(self, now: float) -> str | None:
        """What the participant should know, or None while all is well."""
        if self._lost is not None:
            sentence, since = self._lost
            seconds = int(now - since)
            lasting = f" for {seconds} second{'s' if seconds > 1 else ''}" if seconds else ""
            if self._was_there:
                cut = "The connection to the game has been lost" if lasting else "The connection to the game is lost"
            else:
                cut = "The game has not been reached" if lasting else "The game is not reached yet"
            again = "It is tried again by itself" + (", and you go on where you were." if self._was_there else ".")
            return " ".join(part for part in (f"{cut}{lasting}.", as_sentence(sentence), again) if part)
        if self._last_received() + STALE_AFTER <= now:
            return "There is no news of the robots just now. The game goes on as soon as there is."
        return None

    def next_change(self, now: float) -> float:
        """When `trouble` will say something else if nothing is heard until then."""
        if self._lost is not None:
            since = self._lost[1]
            return since + math.floor(now - since) + 1.0
        due = self._last_received() + STALE_AFTER
        return due if due > now else math.inf

    def _last_received(self) -> float:
        """When there was last news of the robots; a connection that never had any is not waited for."""
        return math.inf if self._heard is None else self._heard
