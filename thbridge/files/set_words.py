"""Words of a template set in further languages: a folder for each language, with a `words.yaml` and a `DialogueText`.

`words.yaml` has the names of treasures, and texts about properties: labels, values, and the answers to questions.
"""

import difflib
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, fields, replace
from pathlib import Path
from typing import TypeVar

from thbridge.dialogue.moves import Scenario
from thbridge.dialogue.scripted.templates import Template
from thbridge.files.errors import BadFile, BadFiles
from thbridge.files.treasure_files import TreasureList
from thbridge.files.yaml.load import Loaded, load
from thbridge.hunt.properties import TreasureProperty
from thbridge.hunt.treasures import TreasureKind

T = TypeVar("T")

WORDS = "words.yaml"
"""Name of the file of words in a language's folder."""


@dataclass(frozen=True, slots=True)
class AnswersYaml:
    """Texts of the buttons below a question: first agree, then refuse. If None, the language's own texts are used."""

    room: tuple[str, str] | None = None
    picture: tuple[str, str] | None = None
    treasure: tuple[str, str] | None = None

    def by_scenario(self) -> dict[Scenario, tuple[str, str]]:
        """Return the answers to questions, for the scenarios that have answers."""
        answers = {
            Scenario.SPECIFIC_ROOM: self.room,
            Scenario.DONT_KNOW: self.room,
            Scenario.TAKE_PICTURE: self.picture,
            Scenario.TAKE_TREASURE: self.treasure,
        }
        return {scenario: texts for scenario, texts in answers.items() if texts is not None}

    def faults(self, loaded: Loaded[T]) -> Iterator[BadFile]:
        """Yield faults of answers that people cannot distinguish."""
        for each in fields(self):
            texts: tuple[str, str] | None = getattr(self, each.name)
            if texts is not None and (not all(text.strip() for text in texts) or len({*map(str.casefold, texts)}) < 2):
                remedy = "write two different answers, such as [Go, Not there]"
                yield loaded.fault(f"answers.{each.name}", "people cannot distinguish these answers", remedy)


@dataclass(frozen=True, slots=True)
class SetWords:
    """Words and questions of a set in one language, as participants read them.

    Attributes:
        names: words for the names of treasures; a name without a word is not translated.
        properties: properties of the treasures, with their words.
        dialogue: the scripted questions.
    """

    names: Mapping[str, str]
    properties: tuple[TreasureProperty, ...]
    dialogue: Template


@dataclass(frozen=True, slots=True)
class _PropertyWords:
    name: str
    label: str = ""
    sensor: str = ""
    said: str = ""
    values: Mapping[str, str] = field(default_factory=dict)


@dataclass(frozen=True, slots=True)
class _WordsYaml:
    treasures: Mapping[str, str] = field(default_factory=dict)
    properties: tuple[_PropertyWords, ...] = ()
    answers: AnswersYaml = AnswersYaml()


def read_set_words(path: Path, treasures: TreasureList, own: Template, spoken: Template | None) -> SetWords:
    """Read the words of a set in a language.

    Args:
        path: path of the file of words, which may not exist.
        treasures: treasures of the set.
        own: the set's own scripted questions.
        spoken: the scripted questions in this language, or None if there are none.

    Raises:
        BadFile: the file cannot be read or has faults; all faults are raised together.
    """
    written = _WordsYaml()
    if path.exists():
        loaded = load(path, _WordsYaml)
        faults = tuple(_faults(loaded, treasures))
        if faults:
            raise BadFiles(faults)
        written = loaded.value
    said = {each.name: each for each in written.properties}
    properties = (
        replace(
            each,
            label=said[each.name].label or each.label,
            sensor=said[each.name].sensor,
            said=said[each.name].said,
            words=said[each.name].values,
        )
        if each.name in said
        else each
        for each in treasures.properties
    )
    # If the questions are in this language, missing answers are the language's own texts, not the set's.
    answers = written.answers.by_scenario() if spoken else {**own.answers, **written.answers.by_scenario()}
    dialogue = replace(spoken or own, answers=answers)
    return SetWords(written.treasures, tuple(properties), dialogue)


def values_of(declared: TreasureProperty, kinds: Sequence[TreasureKind]) -> tuple[str, ...]:
    """Return all values of a property that treasures have, or may have, in the order of the declaration."""
    return tuple(dict.fromkeys((*declared.values, *(kind.properties[declared.name] for kind in kinds))))


def _faults(loaded: Loaded[_WordsYaml], treasures: TreasureList) -> Iterator[BadFile]:
    """Yield faults of empty words, and of words for names, properties or values that are not in the set."""
    written = loaded.value
    kinds = [kind.name for kind in treasures.kinds]
    declared = {each.name: each for each in treasures.properties}
    for name, said in written.treasures.items():
        if name not in kinds:
            yield loaded.fault(f"treasures.{name}", f"no treasure has the name {name!r}", nearest(name, kinds))
        elif not said.strip():
            yield loaded.fault(f"treasures.{name}", "the name is empty", "write the name in this language")
    for index, each in enumerate(written.properties):
        key, of = f"properties[{index}]", declared.get(each.name)
        if of is None:
            yield loaded.fault(f"{key}.name", f"no property has the name {each.name!r}", nearest(each.name, declared))
            continue
        if each.name in [other.name for other in written.properties[:index]]:
            yield loaded.fault(f"{key}.name", f"{each.name!r} has two entries", "write all its words in one entry")
        if each.said and f"£{each.name}£" not in each.said:
            remedy = f"write £{each.name}£ in place of the value"
            yield loaded.fault(f"{key}.said", "this text does not contain the value", remedy)
        known = values_of(of, treasures.kinds)
        for value, said in each.values.items():
            if value not in known:
                problem = f"{value!r} is not a value of {each.name}"
                yield loaded.fault(f"{key}.values.{value}", problem, nearest(value, known))
            elif not said.strip():
                yield loaded.fault(f"{key}.values.{value}", "the word is empty", "write the word in this language")
    yield from written.answers.faults(loaded)


def languages_beside(folder: Path, names: Collection[str]) -> tuple[str, ...]:
    """Return the languages of a map's or set's words: the subfolders that have a file of one of these names."""
    return tuple(sorted({path.parent.name for name in names for path in folder.glob(f"*/{name}")}))


def nearest(name: str, known: Collection[str]) -> str:
    """Return the remedy for a name that is not known."""
    near = difflib.get_close_matches(name, known, n=1)
    return f"the nearest name is {near[0]}" if near else f"write one of {', '.join(known)}"
