"""Answers to the question whether somebody takes part, for people who type."""

from thbridge.dialogue.wording.texts import Texts

_YES = frozenset({"yes", "y"})
_NO = frozenset({"no", "n"})
"""Answers in each language beside its own."""


def answer_in(texts: Texts, line: str) -> bool | None:
    """Return the answer in a typed line, True for yes; None when it is neither yes nor no."""
    words = " ".join(line.split()).casefold().rstrip(".!")
    if words in _YES | _listed(texts.text("terminal.yes")):
        return True
    return False if words in _NO | _listed(texts.text("terminal.no")) else None


def _listed(words: str) -> frozenset[str]:
    return frozenset(word.strip().casefold() for word in words.split(","))
