"""Maps, template sets, files and programs that a study's field can name, with descriptions and pictures."""

import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, fields, replace
from pathlib import Path

from sim.parameters import RobotParameters
from thbridge.dialogue.games.tables import Rulebook
from thbridge.experiment.folder import EXPERIMENT
from thbridge.experiment.questionnaires.form import SHIPPED, read_form
from thbridge.files.disk.text_files import read_text
from thbridge.files.errors import BadFile
from thbridge.files.game_files import SHIPPED_GAMES, read_rulebook
from thbridge.files.map_files import read_map
from thbridge.files.map_times import MAP_TIMES
from thbridge.files.plugins import STRATEGIES, WORDINGS, PluginKind
from thbridge.files.resources import shipped
from thbridge.files.ros.parameters import parse_ros_files
from thbridge.files.template_files import read_template_set
from thbridge.files.treasure_files import PICTURES
from thbridge.files.word_files import SHIPPED_LANGUAGES, check_words, languages_in, read_language
from thbridge.files.yaml.tree import Section, parse
from thbridge.study.study_file import OWN_STRATEGY, StudyFile
from ui.model.study_form.draft import StudyDraft
from ui.model.study_form.form import editable_text

_FAULTY = "has faults"
_TEXTS = (".txt", ".md")
_YAML = (".yaml", ".yml")
_USUAL = RobotParameters()
_BEGINNING = 60
"""Number of characters at the beginning of a text that are shown."""


@dataclass(frozen=True, slots=True)
class NamedResource:
    """Map, file, folder of words or program that a field can name.

    Attributes:
        value: the name or path to write in the study.
        words: short description.
        picture: an image file of the resource; None if there is none.
    """

    value: str
    words: str
    picture: Path | None = None


def resources_for(key: str, draft: StudyDraft) -> tuple[NamedResource, ...]:
    """Return the resources that a field can name: first those of the program, then those in the study's folder.

    Args:
        key: key of the field; most fields name no resources.
        draft: draft of the study.
    """
    found = _FINDERS.get(_shared(key))
    return () if found is None else tuple(found(draft))


def is_named(key: str) -> bool:
    """Return True for a field that names a resource: a map, a template set, a file, a folder of words or a
    program."""
    return _shared(key) in _FINDERS


def names_form(key: str) -> bool:
    """Return True for the field of a step that names a questionnaire."""
    return re.fullmatch(r"steps\[\d+\]\.form", key) is not None


def is_path(key: str) -> bool:
    """Return True for a field whose value can be the path of any file or folder of the right kind."""
    return is_named(key) and _shared(key) not in _NAMES


def _shared(key: str) -> str:
    """Return the general form of a key that belongs to a single robot or step."""
    return re.sub(r"^steps\[\d+\]\.", "steps.", re.sub(r"^dialogue\.each\.\d+\.", "dialogue.manner.", key))


def _maps(draft: StudyDraft) -> Iterator[NamedResource]:
    for value, folder in _folders(shipped().root / "maps", draft.path.parent, "map.yaml"):
        images = sorted(path for path in folder.iterdir() if path.suffix in {".pgm", ".png"})
        yield NamedResource(value, _words_of_map(folder), images[0] if images else None)


def _words_of_map(folder: Path) -> str:
    try:
        place = read_map(folder, with_costs=False)
    except BadFile:
        return _FAULTY
    height, width = (cells * place.grid.resolution for cells in place.grid.cells.shape)
    return f"{len(place.rooms)} rooms, {width:.0f} m x {height:.0f} m, {len(place.starts)} start poses"


def _templates(draft: StudyDraft) -> Iterator[NamedResource]:
    for value, folder in _folders(shipped().root / "templates", draft.path.parent, "DialogueText"):
        pictures = sorted((folder / PICTURES).glob("*"))
        yield NamedResource(value, _words_of_set(folder), pictures[0] if pictures else None)


def _words_of_set(folder: Path) -> str:
    try:
        templates = read_template_set(folder)
    except BadFile:
        return _FAULTY
    properties = ", ".join(each.label.lower() for each in templates.properties)
    return f"{len(templates.kinds)} treasures: {properties}"


def _costs(draft: StudyDraft) -> Iterator[NamedResource]:
    resources = shipped()
    for name in resources.names("templates"):
        if (resources.root / "templates" / name / MAP_TIMES).is_file():
            yield NamedResource(name, f"the file {MAP_TIMES} of this template set")
    for path in sorted(draft.path.parent.glob(f"*{MAP_TIMES}*")):
        yield NamedResource(path.name, "a file in the study's folder")


def _texts(draft: StudyDraft) -> Iterator[NamedResource]:
    return _texts_in(draft.path.parent)


def _texts_in(folder: Path) -> Iterator[NamedResource]:
    for path in sorted(path for path in folder.iterdir() if path.suffix in _TEXTS and path.is_file()):
        try:
            beginning = " ".join(read_text(path).split())[:_BEGINNING]
        except BadFile:
            beginning = _FAULTY
        yield NamedResource(path.name, beginning)


def _ros_parameters(draft: StudyDraft) -> Iterator[NamedResource]:
    """Yield the files that set parameters of robots; studies in the same folder are omitted."""
    for path in sorted(path for path in draft.path.parent.iterdir() if path.suffix in _YAML and path.is_file()):
        with suppress(BadFile):
            if parse_ros_files((path,)).over(_USUAL).value != _USUAL:
                yield NamedResource(f"[{path.name}]", "parameters of ROS nodes")


def _folders(shipped_in: Path, beside: Path, mark: str) -> Iterator[tuple[str, Path]]:
    """Yield the folders that contain a file of this name, each with the text by which a study names the folder."""
    yield from ((path.parent.name, path.parent) for path in sorted(shipped_in.glob(f"*/{mark}")))
    yield from ((f"./{path.parent.name}", path.parent) for path in sorted(beside.glob(f"*/{mark}")))


def _games(draft: StudyDraft) -> Iterator[NamedResource]:
    ours = read_rulebook()
    for folder in _holding(draft.path.parent, "*.yaml", lambda keys: "stages" in keys or "locutions" in keys):
        try:
            games = read_rulebook((SHIPPED_GAMES, folder)).games
        except BadFile:
            words = _FAULTY
        else:
            own = [name for name, game in games.items() if ours.games.get(name) != game]
            words = f"dialogue games: {', '.join(own)}" if own else "locutions of dialogue games"
        yield NamedResource(f"./{folder.name}", words)


def _words(draft: StudyDraft) -> Iterator[NamedResource]:
    locutions = _rulebook(draft).locutions
    for folder in _holding(draft.path.parent, "*/*.yaml", lambda keys: keys and keys <= _KEYS_OF_WORDS):
        try:
            words = ", ".join(f"{each.name}: {each.title}" for each in check_words(folder, locutions=locutions))
        except BadFile:
            words = _FAULTY
        yield NamedResource(f"./{folder.name}", words)


def _languages(draft: StudyDraft) -> Iterator[NamedResource]:
    locutions, words = _rulebook(draft).locutions, _named_folder(draft, "dialogue.words")
    folders = [SHIPPED_LANGUAGES] if words is None else [SHIPPED_LANGUAGES, words]
    # Built-in languages come first, in a fixed order.
    for name in dict.fromkeys(name for folder in folders for name in languages_in(folder)):
        own = f", with words from the folder {words.name}" if words is not None and name in languages_in(words) else ""
        try:
            yield NamedResource(name, read_language(folders, name, locutions=locutions).title + own)
        except BadFile:
            yield NamedResource(name, _FAULTY)


def _studies(draft: StudyDraft) -> Iterator[NamedResource]:
    for path in _yaml_beside(draft):
        if path.name != EXPERIMENT and not _keys_of(path) - {field.name for field in fields(StudyFile)}:
            yield NamedResource(path.name, "a study file")


def _forms(draft: StudyDraft) -> Iterator[NamedResource]:
    for path in sorted(SHIPPED.glob("*.yaml")):
        yield NamedResource(path.stem, f"{_title_of(path)} (built in)")
    for path in _yaml_beside(draft):
        if "items" in _keys_of(path):
            yield NamedResource(path.relative_to(draft.path.parent).as_posix(), _title_of(path))


def _title_of(path: Path) -> str:
    try:
        return read_form(path).value.title
    except BadFile:
        return _FAULTY


def _texts_of_steps(draft: StudyDraft) -> Iterator[NamedResource]:
    for folder in (draft.path.parent, *sorted(path for path in draft.path.parent.iterdir() if path.is_dir())):
        for each in _texts_in(folder):
            yield replace(each, value=(folder / each.value).relative_to(draft.path.parent).as_posix())


def _yaml_beside(draft: StudyDraft) -> Iterator[Path]:
    """Yield the YAML files in the folder and in its subfolders."""
    for pattern in ("*", "*/*"):
        yield from sorted(path for path in draft.path.parent.glob(pattern) if path.suffix in _YAML and path.is_file())


def _strategies(_draft: StudyDraft) -> Iterator[NamedResource]:
    yield NamedResource(OWN_STRATEGY, "the built-in strategy of robots, according to their manner")
    yield from _installed(STRATEGIES)


def _authors(_draft: StudyDraft) -> Iterator[NamedResource]:
    return _installed(WORDINGS)


def _installed(kind: PluginKind) -> Iterator[NamedResource]:
    """Yield the installed plug-ins without loading them."""
    for name in kind.names():
        yield NamedResource(name, kind.describe(name))


def _rulebook(draft: StudyDraft) -> Rulebook:
    """Return the study's dialogue games; if they have faults, return the built-in games."""
    games = _named_folder(draft, "dialogue.games")
    with suppress(BadFile):
        return read_rulebook((SHIPPED_GAMES,) if games is None else (SHIPPED_GAMES, games))
    return read_rulebook()


def _named_folder(draft: StudyDraft, key: str) -> Path | None:
    """Return the folder that another field names."""
    field = draft.fields()[key]
    return None if field.value == "null" else draft.path.parent / editable_text(field)


def _holding(beside: Path, files: str, wanted: Callable[[set[str]], object]) -> Sequence[Path]:
    """Return the folders next to a study that contain a YAML file with the wanted keys."""
    folders = sorted(path for path in beside.iterdir() if path.is_dir())
    return [folder for folder in folders if any(wanted(_keys_of(path)) for path in sorted(folder.glob(files)))]


def _keys_of(path: Path) -> set[str]:
    """Return the top-level keys of a YAML file; empty if the file cannot be read."""
    try:
        tree = parse(path, read_text(path))
    except BadFile:
        return set()
    return {key.text for key, _ in tree.entries} if isinstance(tree, Section) else set()


_KEYS_OF_WORDS = {"language", "grammar", "phrases", "moves", "lines"}

_FINDERS: Mapping[str, Callable[[StudyDraft], Iterator[NamedResource]]] = {
    "map": _maps,
    "templates": _templates,
    "game.costs": _costs,
    "participant.consent": _texts,
    "ros_parameters": _ros_parameters,
    "participant.farewell": _texts,
    "dialogue.games": _games,
    "dialogue.words": _words,
    "dialogue.language": _languages,
    "dialogue.author": _authors,
    "dialogue.strategy": _strategies,
    "dialogue.manner.strategy": _strategies,
    "study": _studies,
    "steps.form": _forms,
    "steps.text": _texts_of_steps,
}
_NAMES = frozenset({"dialogue.language", "dialogue.author", "dialogue.strategy", "dialogue.manner.strategy"})
"""Fields whose values are names, not paths of files."""
