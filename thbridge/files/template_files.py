"""Reading of template folders: the treasures and the dialogue of a game, and optionally its travel costs.

A folder has `treasures` as in 2016 or `treasures.yaml`, `DialogueText` and `pictures/`. It may have
`treasures.participant` for the participant's machine, which must not know which picture belongs to which treasure. It
may have a `mapTimes` for maps without travel costs. It may have a `set.yaml` with the language of the set, the answers
to questions, and the name of the only map on which `mapTimes` replaces the map's own costs. A subfolder for each
further language has its words; see `thbridge.files.set_words`. All files are UTF-8 text; Windows line ends, a byte
order mark and blank lines are accepted.
"""

import difflib
import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from types import MappingProxyType

from thbridge.dialogue.moves import Scenario
from thbridge.dialogue.scripted.reserved_words import word_fault
from thbridge.dialogue.scripted.templates import ScriptedQuestion, Template
from thbridge.files.disk.inside import path_inside
from thbridge.files.disk.regular_files import as_on_disk, open_regular
from thbridge.files.errors import BadFile, FaultCollection
from thbridge.files.map_times import MAP_TIMES, read_map_times
from thbridge.files.set_words import WORDS, AnswersYaml, SetWords, languages_beside, read_set_words, values_of
from thbridge.files.template_lines import first_line, numbered_lines
from thbridge.files.treasure_files import (
    PARTICIPANT_TREASURES,
    PICTURES,
    TREASURES,
    TREASURES_YAML,
    TreasureList,
    check_copy,
    read_treasures,
    read_treasures_yaml,
)
from thbridge.files.yaml.load import load
from thbridge.hunt.costs import CostMatrix
from thbridge.hunt.properties import OF_2016, TreasureProperty
from thbridge.hunt.treasures import TreasureKind, same_name

DIALOGUE_TEXT = "DialogueText"
SET = "set.yaml"
LARGEST_PICTURE = 2_000_000
"""Largest size of an image file in bytes."""
_IMAGE_BEGINNINGS = (b"\x89PNG", b"\xff\xd8\xff", b"GIF8", b"BM", b"RIFF", b"<")
"""First bytes of images that windows can show: PNG, JPEG, GIF, BMP, WebP, SVG.

The suffix is not enough, because phones may save HEIC images with any suffix.
"""

_SECTIONS: Mapping[str, Scenario] = {
    "SpecificRoom:": Scenario.SPECIFIC_ROOM,
    "TakePicture:": Scenario.TAKE_PICTURE,
    "TakeTreasure:": Scenario.TAKE_TREASURE,
}
_BETWEEN_WORDINGS = re.compile(r"(?<!\S)\|(?!\S)")


@dataclass(frozen=True, slots=True)
class _SetYaml:
    language: str | None = None
    map: str | None = None
    answers: AnswersYaml = field(default_factory=AnswersYaml)


@dataclass(frozen=True, slots=True)
class TemplateSet:
    """The contents of a checked template folder: its files agree on the number of rooms, and no picture is missing.

    Attributes:
        rooms: number of rooms in the list of treasures.
        costs: energy of every move on maps that have no costs of their own, or None without a `mapTimes`.
        map: name of the map on which `costs` replace the map's own costs, or None.
        properties: properties of the treasures.
        kinds: treasures with their images.
        dialogue: the scripted questions.
        pictures: the treasures' image files, by name.
        language: language of its names and questions. If None, these are used in every language.
        words: words in further languages, by the name of the language.
        warnings: contents that are allowed, but look like a mistake.
    """

    rooms: int
    costs: CostMatrix | None
    map: str | None
    properties: tuple[TreasureProperty, ...]
    kinds: tuple[TreasureKind, ...]
    dialogue: Template
    pictures: Mapping[str, bytes]
    language: str | None = None
    words: Mapping[str, SetWords] = field(default_factory=dict)
    warnings: tuple[BadFile, ...] = ()

    def in_language(self, language: str) -> SetWords:
        """Return the words that participants read in a language; words without a translation are unchanged."""
        spoken = None if language == self.language else self.words.get(language)
        return SetWords({}, self.properties, self.dialogue) if spoken is None else spoken

    def answering_as(self, other: "TemplateSet") -> "TemplateSet":
        """Return this set, but with the other set's answers to questions, in each language."""

        def answering(dialogue: Template, others: Template) -> Template:
            return replace(dialogue, answers=others.answers)

        words = {
            language: replace(said, dialogue=answering(said.dialogue, other.in_language(language).dialogue))
            for language, said in self.words.items()
        }
        return replace(self, dialogue=answering(self.dialogue, other.dialogue), words=words)


def read_template_set(folder: Path, replaced: Mapping[str, bytes] = MappingProxyType({})) -> TemplateSet:
    """Read a template folder for the server.

    A `treasures.participant` in the folder must agree with `treasures`; otherwise participants would be offered names
    that no treasure has.

    Args:
        folder: the folder.
        replaced: image files by name that are used instead of those in the folder.

    Raises:
        BadFiles: all faults of the files, missing files, and contradictions between files.
    """
    if not folder.is_dir():
        raise BadFile(folder, "the template folder does not exist", "name a folder that contains DialogueText")
    faults = FaultCollection()
    costs: CostMatrix | None = None
    treasures: TreasureList | None = None
    dialogue: Template | None = None
    own = _SetYaml()
    pictures: dict[str, bytes] = {}
    declaring = (folder / TREASURES_YAML).exists()
    path = folder / (TREASURES_YAML if declaring else TREASURES)
    if not path.exists():
        problem = f"it has neither a {TREASURES_YAML} nor a {TREASURES}"
        faults.found.append(BadFile(folder, problem, f"write the treasures to a {TREASURES_YAML}"))
    with faults.kept():
        costs = read_map_times(folder / MAP_TIMES) if (folder / MAP_TIMES).exists() else None
    with faults.kept():
        if path.exists():
            treasures = read_treasures_yaml(path) if declaring else _treasures_with_images(path)
    with faults.kept():
        own = _set_yaml(folder / SET)
    if treasures is not None:
        with faults.kept():
            dialogue = read_dialogue_text(folder / DIALOGUE_TEXT, treasures.properties)
        with faults.kept():
            _check_together(folder, path, treasures, costs)
        for kind in treasures.kinds:
            with faults.kept():
                image = kind.image or ""
                pictures[image] = _picture(path, kind.name, folder / PICTURES, image, replaced.get(image))
    if faults.found or treasures is None or dialogue is None:
        raise faults.together()
    dialogue = replace(dialogue, answers=own.answers.by_scenario())
    words: dict[str, SetWords] = {}
    for language in languages_beside(folder, (WORDS, DIALOGUE_TEXT)):
        with faults.kept():
            questions = folder / language / DIALOGUE_TEXT
            spoken = read_dialogue_text(questions, treasures.properties) if questions.exists() else None
            words[language] = read_set_words(folder / language / WORDS, treasures, dialogue, spoken)
    faults.raise_any()
    return TemplateSet(
        treasures.rooms,
        costs,
        own.map,
        treasures.properties,
        treasures.kinds,
        dialogue,
        pictures,
        own.language,
        words,
        tuple(_alike(path, treasures.kinds)),
    )


def _alike(path: Path, kinds: Sequence[TreasureKind]) -> Iterator[BadFile]:
    """Yield a warning for each treasure that has the same properties or the same picture as another treasure."""
    for index, kind in enumerate(kinds):
        found = next((confusion for other in kinds[:index] if (confusion := _confusion(other, kind)) is not None), None)
        if found is not None:
            yield BadFile(path, *found)


def _confusion(one: TreasureKind, other: TreasureKind) -> tuple[str, str] | None:
    """Return the reason why people can mistake one treasure for another, and the remedy; None if they cannot."""
    both, same_picture = f"{one.name!r} and {other.name!r}", one.image == other.image is not None
    if all(same_name(value, other.properties[name]) for name, value in one.properties.items()):
        rest = "nothing distinguishes" if same_picture else "only their pictures distinguish"
        problem = f"{both} have the same properties, so {rest} them"
        return problem, "change a property of one of the two, if this is not intended"
    if same_picture:
        return f"{both} have the same picture", "give one of them another picture, if this is not intended"
    return None


def missing_words(templates: TemplateSet, folder: Path, language: str) -> Iterator[BadFile]:
    """Yield faults about words that a set in another language lacks in this language; each names the file to write.

    Args:
        templates: the set.
        folder: folder of the set.
        language: name of the language.
    """
    if templates.language in {None, language}:
        return
    words, path = templates.in_language(language), folder / language / WORDS

    def missing(key: str, names: Sequence[str]) -> BadFile:
        entries = ", ".join(names)
        problem = f"the set is in {templates.language}, but these entries have no words in {language}: {entries}"
        return BadFile(path, problem, f"Write the words into {key}", key=key)

    if unnamed := [kind.name for kind in templates.kinds if kind.name not in words.names]:
        yield missing("treasures", unnamed)
    if unlabelled := [each.name for each in words.properties if each in templates.properties and each not in OF_2016]:
        yield missing("properties", unlabelled)
    for each in words.properties:
        if unsaid := [value for value in values_of(each, templates.kinds) if value not in each.words]:
            yield missing(f"values of {each.name}", unsaid)
    questions = folder / language / DIALOGUE_TEXT
    if any(templates.dialogue.questions.values()) and not questions.exists():
        problem = f"the set is in {templates.language}, but it has no questions in {language}"
        yield BadFile(questions, problem, f"Translate {folder / DIALOGUE_TEXT} into this file")


def _treasures_with_images(path: Path) -> TreasureList:
    """Return a list of 2016 in which all treasures have images."""
    treasures = read_treasures(path)
    if any(kind.image is None for kind in treasures.kinds):
        raise BadFile(
            path,
            "no treasure has an image, as in a participant's copy",
            f"write every treasure with its image; name the copy {PARTICIPANT_TREASURES}",
            key="ImageFile",
        )
    return treasures


def _check_together(folder: Path, path: Path, treasures: TreasureList, costs: CostMatrix | None) -> None:
    """Check that the files of a folder agree."""
    if costs is not None and treasures.rooms != len(costs.rooms):
        raise BadFile(
            path,
            f"the list is for {treasures.rooms} rooms, but {MAP_TIMES} has {len(costs.rooms) + 1} nodes, "
            f"the corridor and {len(costs.rooms)} rooms",
            f"make both files agree on the rooms, or delete {MAP_TIMES} if the map has its own costs",
            line=1 if path.name == TREASURES else None,
            key="number of rooms" if path.name == TREASURES else "rooms",
        )
    if path.name == TREASURES_YAML and (folder / TREASURES).exists():
        raise BadFile(folder / TREASURES, f"a {TREASURES_YAML} also exists", "keep one of the two files")
    copy = folder / PARTICIPANT_TREASURES
    if path.name == TREASURES and copy.exists():
        check_copy(copy, treasures)


def _set_yaml(path: Path) -> _SetYaml:
    """Return the contents of a `set.yaml`, or defaults if the file does not exist."""
    if not path.exists():
        return _SetYaml()
    loaded = load(path, _SetYaml)
    if not loaded.lines:
        raise BadFile(path, "the file is empty", "write `language:`, `map:` or `answers:`, or delete the file")
    for fault in loaded.value.answers.faults(loaded):
        raise fault
    return loaded.value


def _picture(treasures: Path, name: str, folder: Path, image: str, data: bytes | None) -> bytes:
    """Return the image file of a treasure: `data`, or the contents of the file if `data` is None."""
    file = path_inside(folder, as_on_disk(path_inside(folder, image)).name)
    try:
        if data is None:
            with open_regular(file) as opened:
                data = opened.read(LARGEST_PICTURE + 1)
    except FileNotFoundError:
        problem, remedy = f"picture {file.name} does not exist", f"put it into {file.parent}, or correct the name"
        raise BadFile(treasures, problem, remedy, key=name) from None
    except OSError as error:
        raise BadFile(file, f"it cannot be read ({error.strerror})", "check that it is a file") from None
    if len(data) > LARGEST_PICTURE:
        problem = f"the picture is larger than {LARGEST_PICTURE // 1_000_000} MB, and participants would wait for it"
        raise BadFile(file, problem, "save a smaller picture; 1000 x 1000 pixels are enough")
    if not data.startswith(_IMAGE_BEGINNINGS):
        raise BadFile(file, "windows cannot show this picture", "save it as PNG or JPEG")
    return data


def read_dialogue_text(path: Path, properties: Sequence[TreasureProperty] = OF_2016) -> Template:
    """Read scripted questions: a name, the questions of *don't know*, `SpecificRoom:` and its questions.

    Questions about a treasure may name its properties. Two more sections are optional, `TakePicture:` and
    `TakeTreasure:`. A line may have several wordings of the same question, separated by ` | `.

    Raises:
        BadFile: the file cannot be read or has faults; all faults are raised together.
    """
    faults = FaultCollection()
    lines = numbered_lines(path)
    number, name = first_line(path, lines, "name", "a name for the template, for instance DontKnow:")
    if name in _SECTIONS or "£" in name:
        meant = "a section" if name in _SECTIONS else "a question"
        raise BadFile(
            path,
            f"the first line must be the template's name, not {meant}",
            "add a first line with a name, for instance DontKnow:",
            line=number,
            key=name,
        )
    questions: dict[Scenario, list[ScriptedQuestion]] = {Scenario.DONT_KNOW: []}
    scenario = Scenario.DONT_KNOW
    for number, line in lines[1:]:
        heading = _heading_meant(line)
        if heading is None:
            with faults.kept():
                questions[scenario].append(_question(path, number, line, scenario, properties))
            continue
        scenario = _SECTIONS[heading]
        if heading != line:
            faults.found.append(BadFile(path, "this section is unknown", f"write {heading}", line=number, key=line))
        elif scenario in questions:
            remedy = "put all questions of this section under one heading"
            faults.found.append(BadFile(path, "this section appears twice", remedy, line=number, key=line))
        questions.setdefault(scenario, [])
    if Scenario.SPECIFIC_ROOM not in questions:
        remedy = "add a line SpecificRoom: above the questions that are asked when the person chose the room"
        faults.found.append(BadFile(path, "this line is missing", remedy, key="SpecificRoom:"))
    if faults.found:
        raise faults.together()
    return Template(name, {scenario: tuple(asked) for scenario, asked in questions.items()})


def scenario_on(text: str, number: int) -> Scenario | None:
    """Return the scenario of the questions on a line of a dialogue text, or None for its name and headings.

    Args:
        text: the whole text, with line feeds as line ends.
        number: number of the line, from 1.
    """
    lines = [line.strip() for line in text.split("\n")]
    above = [line for line in lines[: number - 1] if line]
    if not above or _heading_meant(lines[number - 1]) is not None:
        return None
    headings = [heading for heading in map(_heading_meant, above[1:]) if heading is not None]
    return _SECTIONS[headings[-1]] if headings else Scenario.DONT_KNOW


def _heading_meant(line: str) -> str | None:
    """Return the section heading that a line probably means, even if misspelled, or None."""
    if line in _SECTIONS:
        return line
    if line.endswith(":") and len(line.split()) <= 2:
        folded = {heading.casefold(): heading for heading in _SECTIONS}
        near = difflib.get_close_matches(line.casefold(), folded, n=1, cutoff=0.75)
        return folded[near[0]] if near else None
    return None


def _question(
    path: Path, number: int, line: str, scenario: Scenario, properties: Sequence[TreasureProperty]
) -> ScriptedQuestion:
    wordings = tuple(wording.strip() for wording in _BETWEEN_WORDINGS.split(line))
    if not all(wordings):
        raise BadFile(
            path, "an empty wording", "write a wording on both sides of every bar, or delete the bar", line=number
        )
    for wording in wordings:
        fault = word_fault(wording, scenario, properties)
        if fault is not None:
            raise BadFile(path, fault.problem, fault.remedy, line=number)
    return ScriptedQuestion(wordings)
