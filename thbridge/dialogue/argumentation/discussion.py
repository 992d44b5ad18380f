"""Grounded discussion game: a dispute that shows why an argument is in the grounded extension or not.

Source: Caminada 2015, A Discussion Game for Grounded Semantics, TAFA.

A proponent states that an argument has to be the case (HTB). An opponent states that an attacker of this argument can
be the case (CB). The proponent then attacks the attacker. The opponent concedes arguments that have no attacker left,
and retracts arguments that a conceded argument attacks. No argument may be stated twice. The proponent can win for
an argument if and only if the argument is in the grounded extension.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from enum import StrEnum

from thbridge.dialogue.argumentation.framework import ArgumentationFramework
from thbridge.dialogue.argumentation.semantics import IN, OUT, UNDECIDED, grounded_labels, grounded_steps


class DiscussionLocution(StrEnum):
    """Kind of a move. The first kind belongs to the proponent, the others belong to the opponent."""

    HAS_TO_BE = "HTB"
    CAN_BE = "CB"
    CONCEDE = "CONCEDE"
    RETRACT = "RETRACT"


@dataclass(frozen=True, slots=True)
class DiscussionMove:
    """A move about an argument."""

    locution: DiscussionLocution
    argument: str

    def __str__(self) -> str:
        return f"{self.locution}({self.argument})"


Discussion = tuple[DiscussionMove, ...]

_OPENINGS = (DiscussionLocution.HAS_TO_BE, DiscussionLocution.CAN_BE)
"""Kinds of moves that introduce an argument; each argument may be introduced only once."""


def legal_moves(framework: ArgumentationFramework, discussion: Discussion) -> tuple[DiscussionMove, ...]:
    """Return the possible next moves; none after the end of the discussion.

    Args:
        framework: the framework under discussion.
        discussion: the moves so far; the first move is HTB of the argument in question.
    """
    position = _Position(framework)
    for move in discussion:
        position.take(move)
    return position.legal_moves()


def is_won(discussion: Discussion) -> bool:
    """Return True if the proponent has won: the argument in question is conceded."""
    return DiscussionMove(DiscussionLocution.CONCEDE, discussion[0].argument) in discussion


def discuss(framework: ArgumentationFramework, argument: str) -> Discussion:
    """Return a discussion of an argument with the best moves of both sides."""
    labels, steps = grounded_labels(framework), grounded_steps(framework)

    def rank(move: DiscussionMove) -> tuple[int, int]:
        # The best moves of both sides are about grounded arguments, then about undecided arguments. An argument does
        # not depend on arguments that were grounded after it, so no statement has to be repeated.
        place = framework.index[move.argument]
        return (IN, UNDECIDED, OUT).index(labels[place]), steps[place] or 0

    position, discussion = _Position(framework), [DiscussionMove(DiscussionLocution.HAS_TO_BE, argument)]
    position.take(discussion[0])
    while moves := position.legal_moves():
        discussion.append(min(moves, key=rank))
        position.take(discussion[-1])
    return tuple(discussion)


class _Position:
    """State of a discussion.

    Args:
        framework: the framework under discussion.
    """

    def __init__(self, framework: ArgumentationFramework) -> None:
        self._framework = framework
        self._said: dict[DiscussionLocution, set[str]] = {locution: set() for locution in DiscussionLocution}
        self._claims: list[str] = []
        # Only a move about an argument, or about one of its attackers, can settle this argument.
        self._may_be_settled: set[str] = set()
        self._last: DiscussionMove | None = None
        self._is_repeated = False

    def take(self, move: DiscussionMove) -> None:
        """Make a move."""
        name = move.argument
        if move.locution in _OPENINGS:
            self._is_repeated |= any(name in self._said[each] for each in _OPENINGS)
            self._may_be_settled.add(name)
        else:
            self._may_be_settled.update(self._names(self._framework.attacked, name))
        if move.locution is DiscussionLocution.HAS_TO_BE:
            self._claims.append(name)
        self._said[move.locution].add(name)
        self._last = move

    def legal_moves(self) -> tuple[DiscussionMove, ...]:
        """Return the possible next moves."""
        if self._is_repeated or self._last is None:
            return ()
        if settled := self._settled():
            return settled
        if self._last.locution is DiscussionLocution.CAN_BE:
            attackers = self._names(self._framework.attackers, self._last.argument)
            return tuple(DiscussionMove(DiscussionLocution.HAS_TO_BE, name) for name in attackers)
        while self._claims and self._claims[-1] in self._said[DiscussionLocution.CONCEDE]:
            self._claims.pop()
        if not self._claims:
            return ()
        attackers = self._names(self._framework.attackers, self._claims[-1])
        retracted = self._said[DiscussionLocution.RETRACT]
        return tuple(DiscussionMove(DiscussionLocution.CAN_BE, name) for name in attackers if name not in retracted)

    def _settled(self) -> tuple[DiscussionMove, ...]:
        """Return the moves with which the opponent gives in; these moves come before any other move."""
        moves = [self._settling(name) for name in sorted(self._may_be_settled, key=self._framework.index.__getitem__)]
        found = tuple(move for move in moves if move is not None)
        self._may_be_settled = {move.argument for move in found}
        return found

    def _settling(self, name: str) -> DiscussionMove | None:
        attackers = self._names(self._framework.attackers, name)
        claimed, opposed, conceded, retracted = (self._said[locution] for locution in DiscussionLocution)
        if name in claimed and name not in conceded and retracted.issuperset(attackers):
            return DiscussionMove(DiscussionLocution.CONCEDE, name)
        if name in opposed and name not in retracted and not conceded.isdisjoint(attackers):
            return DiscussionMove(DiscussionLocution.RETRACT, name)
        return None

    def _names(self, neighbours: Sequence[tuple[int, ...]], name: str) -> list[str]:
        return [self._framework.arguments[place] for place in neighbours[self._framework.index[name]]]
