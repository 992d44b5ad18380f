"""The discussion of an argument is won just where it is grounded."""

import random

from hypothesis import given

from tests.support.dialogue.random_frameworks import chain, frameworks, random_framework
from thbridge.dialogue.argumentation.discussion import (
    Discussion,
    DiscussionLocution,
    DiscussionMove,
    discuss,
    is_won,
    legal_moves,
)
from thbridge.dialogue.argumentation.framework import ArgumentationFramework
from thbridge.dialogue.argumentation.semantics import grounded


def can_be_won(framework: ArgumentationFramework, discussion: Discussion) -> bool:
    """Whether the proponent wins, whatever the opponent does: all discussions are tried."""
    moves = legal_moves(framework, discussion)
    if not moves:
        return is_won(discussion)
    wins = (can_be_won(framework, (*discussion, move)) for move in moves)
    return any(wins) if moves[0].locution is DiscussionLocution.HAS_TO_BE else all(wins)


@given(framework=frameworks(most=5))
def test_the_proponent_can_win_just_for_what_is_grounded(framework: ArgumentationFramework) -> None:
    for name in framework.arguments:
        opening = (DiscussionMove(DiscussionLocution.HAS_TO_BE, name),)
        assert can_be_won(framework, opening) == (name in grounded(framework))


def test_both_sides_play_as_well_as_they_can() -> None:
    rng = random.Random(4)
    for _ in range(150):
        framework = random_framework(rng, 1, 25)
        for name in framework.arguments:
            assert is_won(discuss(framework, name)) == (name in grounded(framework)), (framework, name)


def test_a_discussion_as_people_would_have_it() -> None:
    told = " ".join(map(str, discuss(chain(3), "a2")))
    assert told == "HTB(a2) CB(a1) HTB(a0) CONCEDE(a0) RETRACT(a1) CONCEDE(a2)"
    assert " ".join(map(str, discuss(chain(3), "a1"))) == "HTB(a1) CB(a0)"


def test_a_long_discussion_takes_no_longer_for_each_move() -> None:
    # Looking at all that was said before every move took minutes.
    assert len(discuss(chain(5001), "a5000")) == 2 * 5001
