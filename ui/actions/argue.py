"""Words of `thbridge argue`."""

from thbridge.argumentation.discussion import DiscussionLocution, DiscussionMove

_WORDS = {
    DiscussionLocution.HAS_TO_BE: "Proponent: {} has to be so.",
    DiscussionLocution.CAN_BE: "Opponent:  but {} can be so.",
    DiscussionLocution.CONCEDE: "Opponent:  I concede {}.",
    DiscussionLocution.RETRACT: "Opponent:  I take {} back.",
}


def move_in_words(move: DiscussionMove) -> str:
    """Return a move of a discussion as people read it."""
    return _WORDS[move.locution].format(move.argument)
