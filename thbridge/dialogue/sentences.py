"""Sentences with reserved words between pound signs; each word is replaced by a value."""

import difflib
import re
from collections.abc import Collection, Mapping
from dataclasses import dataclass

UNNAMED = "…"
"""Text in place of a value that a person may not see."""

_RESERVED = re.compile(r"£(\w+)£")
_SENTENCE_START = re.compile(r"(^|[.?!…])\s*$")
_SENTENCE_END = re.compile(r"(?<=[.?!…])\s+")
_NUMBER = re.compile(r"\d+(?:[.,]\d+)?")
_STRAY = re.compile(r"£[^\W\d]|[^\W\d]£")


@dataclass(frozen=True, slots=True)
class WordFault:
    """Fault of a reserved word in a wording, and its remedy."""

    problem: str
    remedy: str


def spelling_fault(wording: str, allowed: Collection[str]) -> WordFault | None:
    """Return the first fault of a wording: a word that is not allowed, or a single pound sign; None if there is none.

    Args:
        wording: a sentence.
        allowed: reserved words, in the order in which a remedy lists them.
    """
    for name in reserved_in(wording):
        if name not in allowed:
            near = difflib.get_close_matches(name.casefold(), allowed, n=1)
            choices = "use one of " + ", ".join(f"£{word}£" for word in allowed) if allowed else "write it without"
            return WordFault(f"unknown reserved word £{name}£", f"write £{near[0]}£" if near else choices)
    stray = _STRAY.search(_RESERVED.sub("", wording))
    if stray:
        return WordFault(
            "a pound sign without its partner", "write reserved words between two pound signs, as in £room£"
        )
    return None


def is_filled(wording: str, words: Mapping[str, str]) -> bool:
    """Return True if each reserved word of a wording has a value."""
    return all(name in words for name in reserved_in(wording))


def reserved_in(wording: str) -> tuple[str, ...]:
    """Return the reserved words of a wording, without their pound signs, in order."""
    return tuple(found.group(1) for found in _RESERVED.finditer(wording))


def without_sentences_about(wording: str, hidden: Collection[str]) -> str:
    """Return a wording without the sentences that contain hidden reserved words.

    If all its sentences do, return the wording with `UNNAMED` in place of these words.
    """
    kept = [each for each in _SENTENCE_END.split(wording) if not set(hidden) & {*reserved_in(each)}]
    return " ".join(kept) or fill(wording, dict.fromkeys(hidden, UNNAMED))


def numbers_in(sentence: str) -> set[str]:
    """Return the numbers that a sentence contains in figures."""
    return {*_NUMBER.findall(sentence)}


def fill(wording: str, words: Mapping[str, str], beginning: re.Pattern[str] = _SENTENCE_START) -> str:
    """Return the wording with its reserved words replaced, and with a capital letter at the beginning of each sentence.

    A word without a value stays unchanged.

    Args:
        wording: a sentence.
        words: values of the reserved words.
        beginning: pattern that matches, at the end of the text before a word, if a sentence begins there.
    """

    def value(found: re.Match[str]) -> str:
        word = words.get(found.group(1), found.group())
        return word[:1].upper() + word[1:] if beginning.search(wording[: found.start()]) else word

    return _RESERVED.sub(value, wording)
