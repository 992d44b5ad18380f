"""State of the connection to the game, in words."""

import math

from ui.model.playing.words import as_sentence

STALE_AFTER = 1.5
"""Seconds without telemetry of the robots after which the game counts as standing still; it comes 25 times a second."""


class ConnectionStatus:
    """Connection to the game, and the age of its telemetry; `now` is monotonic seconds."""

    def __init__(self) -> None:
        self._lost: tuple[str, float] | None = None
        self._was_there = False
        self._received_at: float | None = None

    @property
    def is_lost(self) -> bool:
        """True when it is cut off, or could not be made."""
        return self._lost is not None

    @property
    def is_there(self) -> bool:
        """True when the game is reached."""
        return self._was_there and self._lost is None

    def connected(self, now: float) -> None:
        """Note that the game is reached."""
        self._lost, self._was_there = None, True
        # A program that sends pose telemetry sends it again at once: a new connection is not stale yet.
        self._received_at = None if self._received_at is None else now

    def lose(self, sentence: str, now: float) -> None:
        """Note that the game is not reached, for the reason in this sentence; time counts from the first call."""
        self._lost = (sentence, self._lost[1] if self._lost else now)

    @property
    def why_lost(self) -> str:
        """The reason why the game is not reached, a sentence; empty where there is none to add, or it is reached."""
        return self._lost[0] if self._lost else ""

    def receive(self, now: float) -> None:
        """Note that telemetry of the robots came."""
        self._received_at = now

    def trouble(self, now: float) -> str | None:
        """A sentence for the participant, or None while all is well."""
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
        """Time at which `trouble` changes if nothing is received until then."""
        if self._lost is not None:
            since = self._lost[1]
            return since + math.floor(now - since) + 1.0
        due = self._last_received() + STALE_AFTER
        return due if due > now else math.inf

    def _last_received(self) -> float:
        """Time of the last telemetry; infinite for a connection that never had any, which is not waited for."""
        return math.inf if self._received_at is None else self._received_at
