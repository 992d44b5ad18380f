"""Texts, votes and objections of the participants of one game."""

import math
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, field

from thbridge.hunt.events import (
    DecisionKind,
    DecisionProposed,
    DecisionSettled,
    ObjectionRaised,
    PersonRead,
    PersonSaid,
    SeatLeft,
    SeatTaken,
    TeamEntry,
    VoteCast,
)
from thbridge.hunt.seats import PlayedBy, Seat
from thbridge.roles.keeper.team.decisions import AgreementRule, TeamDecisions, VotingRules
from thbridge.roles.keeper.team.objections import TeamObjections
from thbridge.roles.keeper.team.people_talk import PeopleTalk, TalkRules

EMPTY_AFTER = 60.0
"""Simulated seconds without a participant after which the end of a game does not wait for a seat."""
_NO_VOTES = VotingRules(dict.fromkeys(DecisionKind, AgreementRule.ONE), math.inf)
_NO_TALK = TalkRules(math.inf, math.inf)


@dataclass(frozen=True, slots=True)
class TeamRules:
    """Rules for the participants of a game: when they may send texts, and which decisions need votes."""

    talk: TalkRules = _NO_TALK
    voting: VotingRules = field(default_factory=lambda: _NO_VOTES)


class GameTeam:
    """The participants of one game.

    Args:
        rules: the rules for them.

    Attributes:
        present: seats that are played, and by whom, as the journal has them.
        talk: their texts.
        decisions: their votes.
        objections: their objections.
    """

    def __init__(self, rules: TeamRules) -> None:
        self.present: dict[str, PlayedBy] = {}
        self._seen: dict[str, float] = {}
        self.talk = PeopleTalk(rules.talk)
        self.decisions = TeamDecisions(rules.voting)
        self.objections = TeamObjections()

    def changes(self, present: Mapping[str, PlayedBy], now: float) -> tuple[SeatTaken | SeatLeft, ...]:
        """Return the events of participants who have joined or left.

        Args:
            present: seats that are played now, and by whom.
            now: simulated time, s.
        """
        joined = (SeatTaken(seat, now, by) for seat, by in present.items() if self.present.get(seat) is not by)
        left = (SeatLeft(seat, now) for seat in sorted(self.present) if seat not in present)
        return (*joined, *left)

    def empty(self, seats: Sequence[Seat], present: Collection[str], now: float) -> frozenset[str]:
        """Return the seats that have been empty for `EMPTY_AFTER`. If all seats are empty, return none.

        Args:
            seats: all seats.
            present: seats whose participants are connected now.
            now: simulated time, s.
        """
        for seat in seats:
            if seat.name in present or seat.name not in self._seen:
                self._seen[seat.name] = now
        return frozenset(name for name, at in self._seen.items() if present and now - at >= EMPTY_AFTER)

    def leave(self, seat: str, now: float) -> tuple[SeatLeft, ...]:
        """Return the event that a participant has left, because another program takes the seat."""
        return (SeatLeft(seat, now),) if seat in self.present else ()

    def note(self, entry: TeamEntry) -> None:
        """Process an entry of the journal."""
        match entry:
            case SeatTaken(seat, by=by):
                self.present[seat] = by
            case SeatLeft(seat):
                self.present.pop(seat, None)
            case PersonSaid() | PersonRead():
                self.talk.note(entry)
            case DecisionProposed() | VoteCast() | DecisionSettled():
                self.decisions.note(entry)
            case ObjectionRaised():
                self.objections.note(entry)
