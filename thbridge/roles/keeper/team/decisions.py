"""Decisions on which several participants vote."""

from collections import deque
from collections.abc import Collection, Mapping
from dataclasses import dataclass, field
from enum import StrEnum
from typing import TypeAlias

from thbridge.hunt.events import (
    DecisionKind,
    DecisionOutcome,
    DecisionProposed,
    DecisionSettled,
    VoteCast,
)
from thbridge.hunt.rooms import Room
from thbridge.roles.shared.team_notices import LONGEST_REASON, DecisionView, SettledView, VoteView
from thbridge.roles.shared.view import EndGame, IdentifyTreasure, SendRobot

KEPT = 8
"""Number of ended votes that views contain."""

VotedRequest: TypeAlias = SendRobot | IdentifyTreasure | EndGame
"""Request that may need the agreement of several participants."""

DecisionEntry: TypeAlias = DecisionProposed | VoteCast | DecisionSettled
"""Entry of the journal about a decision."""


class AgreementRule(StrEnum):
    """Participants who must agree on a decision: one, two, more than half of them, or all."""

    ONE = "one"
    TWO = "two"
    MAJORITY = "majority"
    ALL = "all"

    def needs(self, people: int) -> int:
        """Return the number of participants who must agree, of this number of present participants."""
        match self:
            case AgreementRule.ONE:
                return 1
            case AgreementRule.TWO:
                return min(2, people)
            case AgreementRule.MAJORITY:
                return people // 2 + 1
            case AgreementRule.ALL:
                return people


@dataclass(frozen=True, slots=True)
class VotingRules:
    """Rules by which decisions need a vote, and the time for a vote.

    Attributes:
        rules: rule of each kind of decision.
        timeout: simulated time after which an open vote ends without a decision, s.
    """

    rules: Mapping[DecisionKind, AgreementRule]
    timeout: float


@dataclass(slots=True)
class _OpenDecision:
    proposed: DecisionProposed
    votes: dict[str, VoteCast] = field(default_factory=dict)

    @property
    def agree(self) -> list[str]:
        return [self.proposed.seat, *(seat for seat, vote in self.votes.items() if vote.agrees)]


class TeamDecisions:
    """Open votes of a game.

    Args:
        rules: the rules of votes.
    """

    def __init__(self, rules: VotingRules) -> None:
        self._rules = rules
        self._open: dict[int, _OpenDecision] = {}
        self._settled: deque[SettledView] = deque(maxlen=KEPT)
        self._count = 0

    def needs_vote(self, request: VotedRequest, people: int) -> bool:
        """Return True if a request needs the agreement of more than one of the present participants."""
        return self._rules.rules[kind_of_decision(request)].needs(people) > 1

    def propose(self, seat: str, request: VotedRequest, people: int, now: float) -> tuple[DecisionEntry, ...]:
        """Return the event that opens the vote on a request. If the same vote is open, the request is a vote for it."""
        kind, (robot, room, name) = kind_of_decision(request), _about(request)
        for number, each in self._open.items():
            known = each.proposed
            if (known.kind, known.robot, known.room, known.name) == (kind, robot, room, name):
                return self.vote(seat, number, "", now, agrees=True)
        needs = self._rules.rules[kind].needs(people)
        return (DecisionProposed(self._count + 1, seat, kind, robot, room, name, needs, now),)

    def vote(self, seat: str, decision: int, reason: str, now: float, *, agrees: bool) -> tuple[VoteCast, ...]:
        """Return the event of a vote. Empty if the vote has ended, the seat proposed it, or it has voted the same."""
        known = self._open.get(decision)
        if known is None or known.proposed.seat == seat:
            return ()
        before = known.votes.get(seat)
        cast = VoteCast(decision, seat, agrees, reason.strip()[:LONGEST_REASON], now)
        if before is not None and (before.agrees, before.reason) == (cast.agrees, cast.reason):
            return ()
        return (cast,)

    def due(self, present: Collection[str], now: float) -> tuple[DecisionSettled, ...]:
        """Return the votes that end now.

        Args:
            present: seats whose participants are present.
            now: simulated time, s.
        """
        settled = []
        for number, each in self._open.items():
            against = sum(not vote.agrees for seat, vote in each.votes.items() if seat in present)  # of integers
            # People who have left cannot agree any more.
            needs = min(each.proposed.needs, max(len(present), 1))
            if len(each.agree) >= needs:
                settled.append(DecisionSettled(number, DecisionOutcome.CARRIED, now))
            elif len({*present} | {*each.agree}) - against < needs:
                settled.append(DecisionSettled(number, DecisionOutcome.REJECTED, now))
            elif now - each.proposed.at >= self._rules.timeout:
                settled.append(DecisionSettled(number, DecisionOutcome.EXPIRED, now))
        return tuple(settled)

    def proposed(self, decision: int) -> DecisionProposed | None:
        """Return the open decision with this number, or None."""
        known = self._open.get(decision)
        return None if known is None else known.proposed

    def void(self, impossible: Collection[int], now: float) -> tuple[DecisionSettled, ...]:
        """Return the events that end votes on decisions that have become impossible."""
        return tuple(DecisionSettled(number, DecisionOutcome.VOID, now) for number in impossible)

    def note(self, entry: DecisionEntry) -> None:
        """Process an event."""
        match entry:
            case DecisionProposed():
                self._count = entry.decision
                self._open[entry.decision] = _OpenDecision(entry)
            case VoteCast():
                if entry.decision in self._open:
                    self._open[entry.decision].votes[entry.seat] = entry
            case DecisionSettled():
                if entry.decision in self._open:
                    self._settled.append(SettledView(self._view(entry.decision), entry.outcome.value))
                    del self._open[entry.decision]

    @property
    def open(self) -> tuple[DecisionProposed, ...]:
        """The open decisions, oldest first."""
        return tuple(each.proposed for each in self._open.values())

    def views(self) -> tuple[DecisionView, ...]:
        """Return the open votes in the form for participants."""
        return tuple(map(self._view, self._open))

    @property
    def settled(self) -> tuple[SettledView, ...]:
        """The last votes that have ended, oldest first, in the form for participants."""
        return tuple(self._settled)

    def _view(self, number: int) -> DecisionView:
        known = self._open[number]
        proposed = known.proposed
        return DecisionView(
            decision=number,
            seat=proposed.seat,
            kind=proposed.kind.value,
            robot=proposed.robot,
            room=None if proposed.room is None else proposed.room.people,
            name=proposed.name,
            needs=proposed.needs,
            ends_at=proposed.at + self._rules.timeout,
            votes=tuple(VoteView(vote.seat, vote.agrees, vote.reason) for vote in known.votes.values()),
        )


def kind_of_decision(request: VotedRequest) -> DecisionKind:
    """Return the kind of a request's decision."""
    match request:
        case SendRobot():
            return DecisionKind.SEND
        case IdentifyTreasure():
            return DecisionKind.NAME
        case EndGame():
            return DecisionKind.END


def request_of(proposed: DecisionProposed, game: int) -> VotedRequest:
    """Return the request that carries out a decision in the game with this number."""
    room = 0 if proposed.room is None else proposed.room.people
    match proposed.kind:
        case DecisionKind.SEND:
            return SendRobot(proposed.robot or 0, room)
        case DecisionKind.NAME:
            return IdentifyTreasure(room, proposed.name)
        case DecisionKind.END:
            return EndGame(game)


def _about(request: VotedRequest) -> tuple[int | None, Room | None, str]:
    match request:
        case SendRobot(robot, room):
            return robot, Room(max(room, 0)), ""
        case IdentifyTreasure(room, name):
            return None, Room(max(room, 0)), name
        case EndGame():
            return None, None, ""
