"""Texts that the participants of a game send to each other."""

from dataclasses import dataclass

from thbridge.hunt.events import PersonRead, PersonSaid
from thbridge.hunt.refusals import RequestRefused
from thbridge.hunt.seats import Seat
from thbridge.roles.shared.participant_rules import KeeperReason
from thbridge.roles.shared.team_notices import LONGEST_TEXT, SayToPeople, TalkLine

MOST_LINES = 2000
"""Greatest number of texts in a game."""
BURST, BURST_SECONDS = 10, 5.0
"""A participant may send this number of texts within this time, s."""


@dataclass(frozen=True, slots=True)
class TalkRules:
    """When participants may send texts to each other.

    Attributes:
        opens: simulated time from which they may, s; infinite for never.
        closes: simulated time from which they no longer may, s.
    """

    opens: float
    closes: float


class PeopleTalk:
    """The texts of a game.

    Args:
        rules: when participants may send texts.
    """

    def __init__(self, rules: TalkRules) -> None:
        self._rules = rules
        self._said: list[PersonSaid] = []
        self._read: dict[str, int] = {}
        # Author, number, addressee and words of each text with a number.
        self._numbered: set[tuple[str, int, str, str]] = set()

    def is_open(self, now: float) -> bool:
        """Return True if participants may send texts at a simulated time, s."""
        return self._rules.opens <= now < self._rules.closes

    def say(
        self, seat: Seat, request: SayToPeople, seats: tuple[Seat, ...], now: float
    ) -> tuple[PersonSaid, ...] | RequestRefused:
        """Return the event of a participant's text, or a refusal. A repeated text has no event.

        Args:
            seat: seat of the author.
            request: the text.
            seats: all seats.
            now: simulated time, s.
        """
        text = request.text.strip()
        if request.number and (seat.name, request.number, request.to, text) in self._numbered:
            return ()
        if not self.is_open(now):
            return RequestRefused(KeeperReason.TALK_IS_OFF, "Messages between people are switched off now.")
        if request.to and request.to not in {each.name for each in seats if each != seat}:
            return RequestRefused(KeeperReason.NOT_READY, "There is no person with this name.")
        if not text or len(text) > LONGEST_TEXT:
            return RequestRefused(KeeperReason.TOO_LONG, f"A message has 1 to {LONGEST_TEXT} characters.")
        recent = sum(
            each.seat == seat.name and each.at > now - BURST_SECONDS for each in self._said[-MOST_LINES:]
        )  # of integers
        if recent >= BURST or len(self._said) >= MOST_LINES:
            return RequestRefused(KeeperReason.TOO_MANY, "These are too many messages. Wait a little.")
        typing = min(max(request.typing, 0.0), now)
        return (PersonSaid(len(self._said) + 1, seat.name, request.to, text, now, typing, request.number),)

    def read_until(self, seat: str) -> int:
        """Return the number of the last text that the program of a seat has shown; 0 before the first."""
        return self._read.get(seat, 0)

    def read(self, seat: str, line: int, now: float) -> tuple[PersonRead, ...]:
        """Return the event that a participant has seen all texts up to a line. Empty if this is known already."""
        if not 0 < line <= len(self._said) or line <= self.read_until(seat):
            return ()
        return (PersonRead(line, seat, now),)

    def note(self, entry: PersonSaid | PersonRead) -> None:
        """Process an event."""
        if isinstance(entry, PersonSaid):
            self._said.append(entry)
            self._numbered.add((entry.seat, entry.number, entry.to, entry.text))
        else:
            self._read[entry.seat] = entry.line

    def lines_for(self, seat: str) -> tuple[TalkLine, ...]:
        """Return the texts that the participant of a seat may see: their own, those for them, and those for all."""
        return tuple(
            TalkLine(each.line, each.seat, each.to, each.text, each.at, each.number)
            for each in self._said
            if each.to in {"", seat} or each.seat == seat
        )
