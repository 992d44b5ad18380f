"""Measures of the participants in a game with several seats."""

import math
from collections import Counter
from dataclasses import dataclass

from thbridge.app.session.session import TickRecord
from thbridge.hunt.events import (
    DecisionOutcome,
    DecisionProposed,
    DecisionSettled,
    GameStarted,
    PersonSaid,
    TeamEntry,
    VoteCast,
)


@dataclass(frozen=True, slots=True)
class SeatStatistics:
    """Figures of the participant of one seat.

    Attributes:
        seat: name of the seat.
        decisions: number of events of the game that the participant caused, such as departures and names.
        utterances: number of replies to robots.
        proposed: number of decisions that the participant proposed for a vote.
        agreed: number of votes for decisions of others.
        disagreed: number of votes against decisions of others.
        texts: number of texts to other participants.
    """

    seat: str
    decisions: int
    utterances: int
    proposed: int
    agreed: int
    disagreed: int
    texts: int


class SeatObserver:
    """Counter of the participants' decisions, votes and texts in the latest game of a run."""

    def __init__(self) -> None:
        self._begin(())

    def _begin(self, seats: tuple[str, ...]) -> None:
        self._seats = seats
        self._counts = Counter[tuple[str, str]]()
        self._open: dict[int, float] = {}
        self._durations: list[float] = []
        self._carried = 0

    def record(self, record: TickRecord) -> None:
        """Count the events of one tick."""
        for event in record.events:
            if isinstance(event, GameStarted):
                self._begin(tuple(seat.name for seat in event.seats))
            else:
                self._counts["decisions", getattr(event, "seat", "")] += 1
        for utterance in record.utterances:
            self._counts["utterances", utterance.seat] += 1
        for entry in record.team:
            self._team(entry)

    def _team(self, entry: TeamEntry) -> None:
        match entry:
            case PersonSaid():
                self._counts["texts", entry.seat] += 1
            case DecisionProposed():
                self._counts["proposed", entry.seat] += 1
                self._open[entry.decision] = entry.at
            case VoteCast():
                self._counts["agreed" if entry.agrees else "disagreed", entry.seat] += 1
            case DecisionSettled(decision, outcome, at):
                self._durations.append(at - self._open.pop(decision, at))
                self._carried += outcome is DecisionOutcome.CARRIED
            case _:
                pass

    @property
    def votes(self) -> int:
        """Number of decisions on which participants voted, without votes that are still open."""
        return len(self._durations)

    @property
    def agreement(self) -> float | None:
        """Share of these decisions that the participants accepted; None if there were none."""
        return round(self._carried / self.votes, 6) if self.votes else None

    @property
    def seconds_to_decide(self) -> float | None:
        """Mean simulated time from the proposal of a decision to the end of its vote, s; None if there were none."""
        return round(math.fsum(self._durations) / self.votes, 6) if self.votes else None

    @property
    def each_seat(self) -> tuple[SeatStatistics, ...]:
        """Figures of each seat; empty in a game with one participant."""
        return tuple(
            SeatStatistics(
                seat=seat,
                decisions=self._counts["decisions", seat],
                utterances=self._counts["utterances", seat],
                proposed=self._counts["proposed", seat],
                agreed=self._counts["agreed", seat],
                disagreed=self._counts["disagreed", seat],
                texts=self._counts["texts", seat],
            )
            for seat in self._seats
        )
