"""Reading of the participants' texts that are not dialogues: YAML files in `texts/`, in the folder of each language.

English has all texts. Texts that another language lacks are shown in English, and `missing_texts` lists them.
"""

import difflib
import gettext
from collections.abc import Iterable, Iterator, Sequence
from functools import cache
from pathlib import Path

from thbridge.dialogue.sentences import reserved_in, spelling_fault
from thbridge.dialogue.wording.texts import COUNT, Text, TextForms, Texts, value_of, words_for
from thbridge.files.disk.inside import path_inside
from thbridge.files.disk.text_files import read_text
from thbridge.files.errors import BadFile, FaultCollection
from thbridge.files.word_files import SHIPPED_LANGUAGES, languages_in, read_head
from thbridge.files.yaml.tree import Listing, Node, Scalar, Section, parse

ENGLISH = "en"
"""Language that has all texts."""
TEXTS = "texts"
"""Name of the folder of texts in the folder of a language."""
LONGEST_TEXT = 4000
"""Largest length of a text, in characters."""
LAST = "words.last"
"""Key of the word before the last item of a list."""


@cache
def shipped_texts(language: str = ENGLISH) -> Texts:
    """Return the texts of a built-in language."""
    return read_texts((SHIPPED_LANGUAGES,), language)


def shipped_languages() -> dict[str, str]:
    """Return the titles of the built-in languages, by the language's name."""
    names = languages_in(SHIPPED_LANGUAGES)
    return {name: read_head((SHIPPED_LANGUAGES,), name).title for name in names}


def read_texts(folders: Iterable[Path], language: str) -> Texts:
    """Read the texts of a language.

    Args:
        folders: folders with a subfolder for each language; a text of a later folder replaces an earlier text.
        language: name of the language's folder.

    Raises:
        BadFile: a fault of a file, or all faults together; or the language does not exist.
    """
    folders = tuple(folders)
    entries = dict(_english()) if language != ENGLISH else {}
    faults = FaultCollection()
    for folder in folders:
        for path in _files(folder, language):
            with faults.kept():
                entries |= _read(path, {} if folder == SHIPPED_LANGUAGES and language == ENGLISH else _english())
    if faults.found:
        raise faults.together()
    head = read_head(folders, language)
    try:
        gettext.c2py(head.plural)
    except ValueError as error:
        remedy = 'Write it as in Plural-Forms of gettext, such as "n != 1"'
        raise BadFile(
            head.path, f"{head.plural!r} is not a rule for plurals: {error}", remedy, key="language.plural"
        ) from None
    grammar = head.grammar
    last = entries[LAST]
    forms = TextForms(
        grammar.rooms,
        grammar.corridor,
        grammar.robot,
        grammar.between,
        last if isinstance(last, str) else last[0],
        grammar.decimal,
        head.plural,
        grammar.capital_nouns,
    )
    return Texts(language, head.title, entries, forms)


def missing_texts(folders: Sequence[Path], language: str) -> tuple[str, ...]:
    """Return the keys of the texts that a language lacks, in the order of the English files."""
    own = {key for folder in folders for path in _files(folder, language) for key in _read(path, _english())}
    return tuple(key for key in _english() if key not in own)


def advice_on_texts(folders: Sequence[Path], language: str) -> str | None:
    """Return a sentence about the texts that a language lacks, with the file to write; None if no text is missing.

    Raises:
        BadFile: a fault of a file, or all faults together.
    """
    missing = () if language in languages_in(SHIPPED_LANGUAGES) else missing_texts(folders, language)
    if not missing:
        return None
    path = path_inside(folders[-1], language) / TEXTS / f"{missing[0].partition('.')[0]}.yaml"
    return (
        f"language {language}: {len(missing)} of {len(_english())} texts are missing and are shown in English, "
        f"first {missing[0]}. Write them in {path}, or choose another language"
    )


@cache
def _english() -> dict[str, Text]:
    """Return the built-in English texts."""
    return {key: text for path in _files(SHIPPED_LANGUAGES, ENGLISH) for key, text in _read(path, {}).items()}


def _files(folder: Path, language: str) -> list[Path]:
    return sorted(path_inside(path_inside(folder, language), TEXTS).glob("*.yaml"))


def _read(path: Path, english: dict[str, Text]) -> dict[str, Text]:
    """Read a file. If English texts are given, each text must have the same values as the English text."""
    tree = parse(path, read_text(path))
    if not isinstance(tree, Section):
        raise BadFile(path, "the file has no texts", "Write one NAME: TEXT in each line")
    entries: dict[str, Text] = {}
    faults = FaultCollection()
    for name, node in tree.entries:
        key = f"{path.stem}.{name.text}"
        with faults.kept():
            if key in entries:
                problem = "this name is already used above"
                raise BadFile(path, problem, "Keep one of the two", line=name.line, key=name.text)
            if english and key not in english:
                raise BadFile(path, f"text {key} does not exist", _nearest(key, english), line=name.line, key=name.text)
            entries[key] = _text(path, name, node)
            for problem, remedy in _wrong_in(entries[key], english.get(key)):
                raise BadFile(path, problem, remedy, line=name.line, key=name.text)
    if faults.found:
        raise faults.together()
    return entries


def _text(path: Path, name: Scalar, node: Node) -> Text:
    match node:
        case Scalar():
            return node.text
        case Listing(items=items) if items and all(isinstance(item, Scalar) for item in items):
            return tuple(item.text for item in items if isinstance(item, Scalar))
        case _:
            remedy = "Write one text, or its plural forms between [ and ]"
            raise BadFile(path, "neither a text nor a list of texts", remedy, line=name.line, key=name.text)


def _wrong_in(text: Text, english: Text | None) -> Iterator[tuple[str, str]]:
    """Yield problems of a text, with their remedies."""
    forms = _forms(text)
    for form in forms:
        if not form.strip() and form == "":
            yield "the text is empty", "Write a text"
        if len(form) > LONGEST_TEXT:
            yield f"{len(form)} characters are too many", f"Write at most {LONGEST_TEXT} characters"
        if english is None:
            continue
        if not isinstance(text, str) and isinstance(english, str):
            yield "this text has no plural forms in English", "Write one text"
        values = _values(english)
        fault = spelling_fault(form, [word for value in sorted(values) for word in words_for(value)])
        if fault is not None:
            yield fault.problem, fault.remedy
        missing = sorted(values - {value_of(word) for word in reserved_in(form)} - {COUNT})
        if missing:
            words = " and ".join(f"£{value}£" for value in missing)
            yield f"this text must contain {words}, as the English text does", f"Add {words} to it"


def _values(text: Text) -> set[str]:
    return {value_of(word) for form in _forms(text) for word in reserved_in(form)}


def _forms(text: Text) -> tuple[str, ...]:
    return (text,) if isinstance(text, str) else text


def _nearest(key: str, known: Iterable[str]) -> str:
    near = difflib.get_close_matches(key, known, n=1)
    return f"The nearest name is {near[0]}" if near else "Compare with the English files"
