"""Typed answers to the question of whether a person takes part."""

from thbridge.dialogue.wording.texts import Texts

_YES = frozenset({"yes", "y"})
_NO = frozenset({"no", "n"})
"""Answers that mean no in every language; each language adds its own answers."""


def answer_in(texts: Texts, line: str) -> bool | None:
    """Return the meaning of a typed line: True for yes, False for no, None for all other lines."""
    words = " ".join(line.split()).casefold().rstrip(".!")
    if words in _YES | _listed(texts.text("terminal.yes")):
        return True
    return False if words in _NO | _listed(texts.text("terminal.no")) else None


def _listed(words: str) -> frozenset[str]:
    return frozenset(word.strip().casefold() for word in words.split(","))
