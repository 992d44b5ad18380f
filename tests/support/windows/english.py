"""English words where another language is expected: on screens, in pages, and in the names of a study."""

import re
from collections.abc import Iterable, Iterator
from dataclasses import fields, is_dataclass
from functools import cache

from thbridge.app.compose.setting import StudySetting
from thbridge.files.language_texts import shipped_texts
from thbridge.files.set_words import values_of
from thbridge.hunt.properties import properties_in_words, value_in_words
from thbridge.hunt.treasures import name_in_words
from thbridge.roles.shared.view import View
from ui.model.playing.screen import Screen

CODES = {"act", "key", "state", "drawn", "speaker", "kind", "phase", "sound", "names", "picked", "typed", "value"}
"""Fields of screens that are not shown to people.

`state` is a code in rooms; in cards it is shown, so it is tested there.
"""


def written(language: str) -> set[str]:
    """Return all words in the texts of a language."""
    texts = shipped_texts(language).entries.values()
    forms = (form for text in texts for form in ((text,) if isinstance(text, str) else text))
    return {word for form in forms for word in words_in(re.sub(r"£\w+£", " ", form))}


def words_in(text: str) -> list[str]:
    """Return the words with at least two letters; a single letter is the name of a key."""
    return re.findall(r"[^\W\d_]{2,}(?:'[a-z]+)?", text.casefold())


ENGLISH_ONLY = written("en") - written("de")
"""Words in the English texts that are in no German text."""


def shown(value: object, field: str = "") -> Iterator[str]:
    """Yield all texts that people read on a screen, or in a part of it."""
    if is_dataclass(value) and not isinstance(value, type):
        for each in fields(value):
            if each.name not in CODES or (each.name == "state" and hasattr(value, "energy")):
                yield from shown(getattr(value, each.name), each.name)
    elif isinstance(value, tuple):
        # The first part of a sentence is a code: its speaker.
        for each in value[1:] if field == "sentences" and value and isinstance(value[0], str) else value:
            yield from shown(each, field)
    elif isinstance(value, str):
        yield value


def said_by_others(view: View) -> set[str]:
    """Return the words in a view that come from the study: its sentences, names and properties."""
    talks = [*view.dialogues, *view.last_words]
    sentences = [sentence for talk in talks for sentence in (*talk.said, *getattr(talk, "choices", ()))]
    values = [value for room in view.rooms for value in room.known.values()]
    values += [value for each in view.properties for value in each.values]
    found = [properties_in_words(view.properties, room.known) for room in view.rooms if room.found]
    names = [name_in_words(name) for name in view.names]
    labels = [word for each in view.properties for word in (each.label, each.sensor)]
    words = {*values, *map(value_in_words, values), *found, *names, *labels}
    return {view.consent or "", *sentences, *words} - {""}


def english_on(screen: Screen, others: Iterable[str]) -> list[tuple[str, str]]:
    """Return the English words on a screen, each with its text; `others` are words that come from the study."""
    longest_first = sorted(map(re.escape, others), key=len, reverse=True)
    theirs = re.compile("|".join(longest_first) or "(?!)", re.IGNORECASE)
    return [(word, text) for text in shown(screen) for word in words_in(theirs.sub("", text)) if word in ENGLISH_ONLY]


_VALUE = re.compile("£\\w+£")


def english_in(words: Iterable[str], language: str = "de") -> list[tuple[str, str]]:
    """Return the English texts found in words of another language, each with the words that contain it."""
    whole = [each for each in words if each]
    return [(text, each) for each in whole for text, found in _english(language) if found.search(each)]


@cache
def _english(language: str) -> tuple[tuple[str, re.Pattern[str]], ...]:
    """Return the English texts that differ from those of the other language, each with a pattern that finds it."""
    other = {form for text in shipped_texts(language).entries.values() for form in _forms(text)}
    english = {form for text in shipped_texts().entries.values() for form in _forms(text)}
    return tuple((form, _pattern(form)) for form in sorted(english - other) if _has_words(form))


def _forms(text: str | tuple[str, ...]) -> tuple[str, ...]:
    return (text,) if isinstance(text, str) else text


def _has_words(form: str) -> bool:
    return sum(len(word) for word in re.findall(r"[^\W\d]+", _VALUE.sub("", form))) > 3


def _pattern(form: str) -> re.Pattern[str]:
    """Return a pattern that finds a text, but not within longer words."""
    parts = ".+".join(re.escape(part) for part in _VALUE.split(form.strip()))
    return re.compile(rf"(?<!\w){parts}(?!\w)", re.DOTALL)


def strings_in(value: object, without: frozenset[str] = frozenset()) -> Iterator[str]:
    """Yield all strings in lists and mappings, except those under the keys `without`."""
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


def english_names(setting: StudySetting) -> set[str]:
    """Return the English names in map and templates that differ in German."""
    templates, german = setting.templates, setting.set_words
    pairs = list(german.names.items())
    for own, said in zip(templates.properties, german.properties, strict=True):
        pairs += [(own.label, said.label), (own.sensor, said.sensor)]
        pairs += [(value, said.word(value)) for value in values_of(own, templates.kinds)]
    pairs += [(name, setting.room_names.name(room)) for room, name in setting.map.room_names.named.items()]
    return {own for own, said in pairs if own.casefold() != said.casefold()}
