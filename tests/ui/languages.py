"""Finds English in what participants read in another language."""

import re
from collections.abc import Iterable, Iterator
from functools import cache

from thbridge.files.language_texts import shipped_texts

_VALUE = re.compile("£\\w+£")


def english_in(words: Iterable[str], language: str = "de") -> list[tuple[str, str]]:
    """English texts among words that are to be of another language: each with the words that have it."""
    whole = [each for each in words if each]
    return [(text, each) for each in whole for text, found in _english(language) if found.search(each)]


@cache
def _english(language: str) -> tuple[tuple[str, re.Pattern[str]], ...]:
    """English texts that are not the same in the other language, and how each is found."""
    other = {form for text in shipped_texts(language).entries.values() for form in _forms(text)}
    english = {form for text in shipped_texts().entries.values() for form in _forms(text)}
    return tuple((form, _pattern(form)) for form in sorted(english - other) if _has_words(form))


def _forms(text: str | tuple[str, ...]) -> tuple[str, ...]:
    return (text,) if isinstance(text, str) else text


def _has_words(form: str) -> bool:
    return sum(len(word) for word in re.findall(r"[^\W\d]+", _VALUE.sub("", form))) > 3


def _pattern(form: str) -> re.Pattern[str]:
    """It as a whole: no part of longer words."""
    parts = ".+".join(re.escape(part) for part in _VALUE.split(form.strip()))
    return re.compile(rf"(?<!\w){parts}(?!\w)", re.DOTALL)


def strings_in(value: object, without: frozenset[str] = frozenset()) -> Iterator[str]:
    """All strings in lists and mappings, save those under some keys."""
    match value:
        case str():
            yield value
        case dict():
            for key, each in value.items():
                if key not in without:
                    yield from strings_in(each, without)
        case list() | tuple():
            for each in value:
                yield from strings_in(each, without)
