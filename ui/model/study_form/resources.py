"""Maps, template sets and files that a study's field may name, each with a few words and a picture of it."""

from collections.abc import Callable, Iterator, Mapping
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

from sim.parameters import RobotParameters
from thbridge.files.errors import BadFile
from thbridge.files.map_files import read_map
from thbridge.files.map_times import MAP_TIMES
from thbridge.files.resources import Resources, shipped
from thbridge.files.ros.parameters import read_ros_parameters
from thbridge.files.template_files import read_template_set
from thbridge.files.treasure_files import PICTURES

_FAULTY = "it has faults"
_TEXTS = (".txt", ".md")
_YAML = (".yaml", ".yml")
_USUAL = RobotParameters()
_BEGINNING = 60
"""Characters of a text that are shown."""


@dataclass(frozen=True, slots=True)
class NamedResource:
    """Something that a field may name.

    Attributes:
        value: the name or path, as the study has it.
        words: what it is, in a few words.
        picture: an image file of it; None without one.
    """

    value: str
    words: str
    picture: Path | None = None


def resources_for(key: str, beside: Path) -> tuple[NamedResource, ...]:
    """Return what a field may name: what comes with the project first, then what lies beside the study.

    Args:
        key: of the field; there is nothing for most.
        beside: folder of the study.
    """
    found = _FINDERS.get(key)
    return () if found is None else tuple(found(shipped(), beside))


def is_named(key: str) -> bool:
    """Return True for a field that names a map, a template set or a file of a known kind."""
    return key in _FINDERS


def _maps(resources: Resources, beside: Path) -> Iterator[NamedResource]:
    for value, folder in _folders(resources.root / "maps", beside, "map.yaml"):
        images = sorted(path for path in folder.iterdir() if path.suffix in {".pgm", ".png"})
        yield NamedResource(value, _words_of_map(folder), images[0] if images else None)


def _words_of_map(folder: Path) -> str:
    try:
        place = read_map(folder, with_costs=False)
    except BadFile:
        return _FAULTY
    height, width = (cells * place.grid.resolution for cells in place.grid.cells.shape)
    return f"{len(place.rooms)} rooms, {width:.0f} m x {height:.0f} m, {len(place.starts)} start poses"


def _templates(resources: Resources, beside: Path) -> Iterator[NamedResource]:
    for value, folder in _folders(resources.root / "templates", beside, "DialogueText"):
        pictures = sorted((folder / PICTURES).glob("*"))
        yield NamedResource(value, _words_of_set(folder), pictures[0] if pictures else None)


def _words_of_set(folder: Path) -> str:
    try:
        templates = read_template_set(folder)
    except BadFile:
        return _FAULTY
    properties = ", ".join(each.label.lower() for each in templates.properties)
    return f"{len(templates.kinds)} treasures: {properties}"


def _costs(resources: Resources, beside: Path) -> Iterator[NamedResource]:
    for name in resources.names("templates"):
        if (resources.root / "templates" / name / MAP_TIMES).is_file():
            yield NamedResource(name, f"the {MAP_TIMES} of this template set")
    for path in sorted(beside.glob(f"*{MAP_TIMES}*")):
        yield NamedResource(path.name, "a file beside the study")


def _texts(_resources: Resources, beside: Path) -> Iterator[NamedResource]:
    for path in sorted(path for path in beside.iterdir() if path.suffix in _TEXTS and path.is_file()):
        try:
            beginning = " ".join(path.read_text(encoding="utf-8").split())[:_BEGINNING]
        except (OSError, UnicodeDecodeError):
            beginning = _FAULTY
        yield NamedResource(path.name, beginning)


def _ros_parameters(_resources: Resources, beside: Path) -> Iterator[NamedResource]:
    """Yield files that change robots' parameters; studies, which lie beside them, are none."""
    for path in sorted(path for path in beside.iterdir() if path.suffix in _YAML and path.is_file()):
        with suppress(BadFile):
            if read_ros_parameters((path,), _USUAL).value != _USUAL:
                yield NamedResource(f"[{path.name}]", "parameters of ROS nodes")


def _folders(shipped_in: Path, beside: Path, mark: str) -> Iterator[tuple[str, Path]]:
    """Yield the folders that have a file of this name, each with its name as a study has it."""
    yield from ((path.parent.name, path.parent) for path in sorted(shipped_in.glob(f"*/{mark}")))
    yield from ((f"./{path.parent.name}", path.parent) for path in sorted(beside.glob(f"*/{mark}")))


_FINDERS: Mapping[str, Callable[[Resources, Path], Iterator[NamedResource]]] = {
    "map": _maps,
    "templates": _templates,
    "game.costs": _costs,
    "participant.consent": _texts,
    "ros_parameters": _ros_parameters,
    "participant.farewell": _texts,
}
