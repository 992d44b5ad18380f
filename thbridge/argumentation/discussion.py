"""Grounded discussion game: why an argument stands, or not, as a dispute (Caminada 2015, A Discussion Game for Grounded
Semantics, TAFA).

A proponent says of an argument that it has to be so (HTB), an opponent that an attacker of it can be so (CB); the
proponent attacks that in turn. The opponent concedes what has no attacker left, and retracts what is attacked by
something conceded. Nobody may say the same argument twice. The proponent can win just for what is in the grounded
extension.
"""

from dataclasses import dataclass
from enum import StrEnum

from thbridge.argumentation.framework import ArgumentationFramework
from thbridge.argumentation.semantics import IN, OUT, grounded_labels, grounded_steps


class DiscussionLocution(StrEnum):
    """Kind of a move: the first is the proponent's, the others are the opponent's."""

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


def legal_moves(framework: ArgumentationFramework, discussion: Discussion) -> tuple[DiscussionMove, ...]:
    """Return the moves that may come next; none once the discussion has ended.

    Args:
        framework: what is discussed.
        discussion: the moves so far, the first of which is HTB of the argument in question.
    """
    said, last = set(discussion), discussion[-1]
    if _is_repeated(discussion):
        return ()
    settled = [
        move
        for name in framework.arguments
        for move in (_concede(framework, said, name), _retract(framework, said, name))
        if move is not None
    ]
    if settled:
        return tuple(settled)
    if last.locution is DiscussionLocution.CAN_BE:
        return tuple(
            DiscussionMove(DiscussionLocution.HAS_TO_BE, name) for name in _attackers(framework, last.argument)
        )
    claims = [move for move in discussion if move.locution is DiscussionLocution.HAS_TO_BE]
    open_ones = [move for move in claims if DiscussionMove(DiscussionLocution.CONCEDE, move.argument) not in said]
    if not open_ones:
        return ()
    return tuple(
        DiscussionMove(DiscussionLocution.CAN_BE, name)
        for name in _attackers(framework, open_ones[-1].argument)
        if DiscussionMove(DiscussionLocution.RETRACT, name) not in said
    )


def is_won(discussion: Discussion) -> bool:
    """Return True when the proponent has won: what was in question is conceded."""
    return DiscussionMove(DiscussionLocution.CONCEDE, discussion[0].argument) in discussion


def discuss(framework: ArgumentationFramework, argument: str) -> Discussion:
    """Return a discussion of an argument in which both sides play as well as they can."""
    labels, steps = grounded_labels(framework), grounded_steps(framework)

    def rank(move: DiscussionMove) -> tuple[bool, int]:
        place = framework.index[move.argument]
        if move.locution is DiscussionLocution.HAS_TO_BE:
            # What became grounded first rests on nothing that came later, so that nothing has to be said twice.
            return labels[place] != IN, steps[place] or 0
        return labels[place] == OUT, 0

    discussion: Discussion = (DiscussionMove(DiscussionLocution.HAS_TO_BE, argument),)
    while moves := legal_moves(framework, discussion):
        discussion = (*discussion, min(moves, key=rank))
    return discussion


def _is_repeated(discussion: Discussion) -> bool:
    openings = (DiscussionLocution.HAS_TO_BE, DiscussionLocution.CAN_BE)
    said = [move.argument for move in discussion if move.locution in openings]
    return len(set(said)) < len(said)


def _attackers(framework: ArgumentationFramework, name: str) -> list[str]:
    return [framework.arguments[place] for place in framework.attackers[framework.index[name]]]


def _concede(framework: ArgumentationFramework, said: set[DiscussionMove], name: str) -> DiscussionMove | None:
    done = DiscussionMove(DiscussionLocution.CONCEDE, name)
    if done in said or DiscussionMove(DiscussionLocution.HAS_TO_BE, name) not in said:
        return None
    retracted = (DiscussionMove(DiscussionLocution.RETRACT, each) in said for each in _attackers(framework, name))
    return done if all(retracted) else None


def _retract(framework: ArgumentationFramework, said: set[DiscussionMove], name: str) -> DiscussionMove | None:
    done = DiscussionMove(DiscussionLocution.RETRACT, name)
    if done in said or DiscussionMove(DiscussionLocution.CAN_BE, name) not in said:
        return None
    conceded = (DiscussionMove(DiscussionLocution.CONCEDE, each) in said for each in _attackers(framework, name))
    return done if any(conceded) else None
