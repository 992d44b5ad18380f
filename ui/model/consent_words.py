"""Words of the question whether somebody takes part, for people who type."""

QUESTION = "Do you agree to take part? Type yes or no."

THANKS = "Thank you. You do not take part."

_YES = frozenset({"yes", "y", "agree", "i agree"})
_NO = frozenset({"no", "n", "decline", "i do not agree"})


def answer_in(line: str) -> bool | None:
    """Return the answer in a typed line, True for yes; None when it is neither yes nor no."""
    words = " ".join(line.split()).casefold().rstrip(".!")
    if words in _YES:
        return True
    return False if words in _NO else None
