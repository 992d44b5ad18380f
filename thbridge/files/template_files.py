"""Reads template folders: the files of 2016 with the treasures and dialogue of a game, and perhaps its travel costs.

A folder has `treasures`, `DialogueText` and `pictures/`, and for the participant's machine, which must not know which
picture belongs to which treasure, `treasures.participant`: the same lines without their last field. It may have a
`mapTimes` for maps without one, and a `set.yaml` that names the one map whose moves `mapTimes` prices. All are UTF-8
text; Windows line ends, a byte order mark and blank lines are accepted.
"""

import difflib
import re
from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path

from thbridge.dialogue.moves import Scenario
from thbridge.dialogue.templates import ScriptedQuestion, Template, word_fault
from thbridge.files.errors import BadFile
from thbridge.files.map_times import MAP_TIMES, read_map_times
from thbridge.files.template_lines import count_in, first_line, numbered_lines
from thbridge.files.yaml.load import load
from thbridge.hunt.costs import CostMatrix
from thbridge.hunt.treasures import TreasureKind, same_name

TREASURES = "treasures"
PARTICIPANT_TREASURES = "treasures.participant"
DIALOGUE_TEXT = "DialogueText"
SET = "set.yaml"
PICTURES = "pictures"
LARGEST_PICTURE = 2_000_000
"""Largest size of an image file in bytes."""

_SECTIONS: Mapping[str, Scenario] = {
    "SpecificRoom:": Scenario.SPECIFIC_ROOM,
    "TakePicture:": Scenario.TAKE_PICTURE,
    "TakeTreasure:": Scenario.TAKE_TREASURE,
}
_BETWEEN_WORDINGS = re.compile(r"(?<!\S)\|(?!\S)")
_TREASURE_FORM = "Colour,Footprint,Points,Name,ImageFile"


@dataclass(frozen=True, slots=True)
class TreasureList:
    """The contents of a treasures file.

    Attributes:
        rooms: number of rooms.
        kinds: the treasures, at least one, in the order of the file; either all have an image or none has.
    """

    rooms: int
    kinds: tuple[TreasureKind, ...]


@dataclass(frozen=True, slots=True)
class _SetYaml:
    map: str


@dataclass(frozen=True, slots=True)
class TemplateSet:
    """The contents of a checked template folder: all files have the same rooms, and no picture is missing.

    Attributes:
        rooms: number of rooms that the list of treasures is for.
        costs: energy of every move on maps that have no costs of their own; None without a `mapTimes`.
        map: name of the map on which `costs` count although it has its own; None: no map.
        kinds: treasures with their images.
        dialogue: the scripted questions.
        pictures: the treasures' image files, by name.
    """

    rooms: int
    costs: CostMatrix | None
    map: str | None
    kinds: tuple[TreasureKind, ...]
    dialogue: Template
    pictures: Mapping[str, bytes]


def read_template_set(folder: Path) -> TemplateSet:
    """Read a template folder for the server.

    A `treasures.participant` in the folder must agree with `treasures`; else participants would be offered names that
    no treasure has.

    Raises:
        BadFile: a file is missing or wrong, or two files do not agree.
    """
    if not folder.is_dir():
        raise BadFile(folder, "there is no such template folder", "name a folder that has DialogueText in it")
    costs = read_map_times(folder / MAP_TIMES) if (folder / MAP_TIMES).exists() else None
    path = folder / TREASURES
    treasures = read_treasures(path)
    if costs is not None and treasures.rooms != len(costs.rooms):
        raise BadFile(
            path,
            f"{treasures.rooms} rooms, but {MAP_TIMES} has {len(costs.rooms) + 1} nodes, "
            f"the corridor and {len(costs.rooms)} rooms",
            "make both files tell of the same rooms",
            line=1,
            key="number of rooms",
        )
    pictures: dict[str, bytes] = {}
    for kind in treasures.kinds:
        if kind.image is None:
            raise BadFile(
                path,
                "no treasure has an image, as in a participant's copy",
                f"write every treasure as {_TREASURE_FORM}; name the copy {PARTICIPANT_TREASURES}",
                key="ImageFile",
            )
        pictures[kind.image] = _picture(path, kind.name, folder / PICTURES / kind.image)
    copy = folder / PARTICIPANT_TREASURES
    if copy.exists():
        _check_copy(copy, treasures)
    place = _priced_map(folder / SET, has_costs=costs is not None)
    dialogue = read_dialogue_text(folder / DIALOGUE_TEXT)
    return TemplateSet(treasures.rooms, costs, place, treasures.kinds, dialogue, pictures)


def _priced_map(path: Path, *, has_costs: bool) -> str | None:
    """The map that `set.yaml` names, if there is such a file."""
    if not path.exists():
        return None
    loaded = load(path, _SetYaml)
    if not has_costs:
        problem = f"it names the map of {MAP_TIMES}, which is not in this folder"
        raise loaded.fault("map", problem, f"put {MAP_TIMES} into the folder, or take {SET} away")
    return loaded.value.map


def _picture(treasures: Path, name: str, file: Path) -> bytes:
    """The image file of a treasure."""
    try:
        with file.open("rb") as opened:
            data = opened.read(LARGEST_PICTURE + 1)
    except FileNotFoundError:
        problem, remedy = f"there is no picture {file.name}", f"put it into {file.parent} or mend the file name"
        raise BadFile(treasures, problem, remedy, key=name) from None
    except OSError as error:
        raise BadFile(file, f"it cannot be read ({error.strerror})", "check that it is a file") from None
    if len(data) > LARGEST_PICTURE:
        problem = f"the picture is larger than {LARGEST_PICTURE // 1_000_000} MB, and participants would wait for it"
        raise BadFile(file, problem, "save it smaller; a photo of 1000 x 1000 pixels is enough")
    return data


def read_treasures(path: Path) -> TreasureList:
    """Read a list of treasures: the number of rooms, then one treasure per line, with or without its image file.

    Raises:
        BadFile: as the module promises.
    """
    lines = numbered_lines(path)
    number, first = first_line(path, lines, "number of rooms", "the number of rooms")
    rooms = count_in(path, number, "number of rooms", first, least=1)
    if not lines[1:]:
        raise BadFile(path, "there is no treasure in the list", f"add lines of the form {_TREASURE_FORM}")
    kinds: list[TreasureKind] = []
    for number, line in lines[1:]:
        kind = _treasure(path, number, line)
        if any(same_name(kind.name, other.name) for other in kinds):
            raise BadFile(
                path, f"{kind.name!r} is there twice", "give every treasure its own name", line=number, key="Name"
            )
        if kinds and (kind.image is None) != (kinds[0].image is None):
            raise BadFile(
                path,
                "some treasures have an image and some have none",
                "give every treasure its image, or leave all out in the participant's copy",
                line=number,
                key="ImageFile",
            )
        kinds.append(kind)
    return TreasureList(rooms, tuple(kinds))


def read_dialogue_text(path: Path) -> Template:
    """Read scripted questions: a name, the questions of *don't know*, `SpecificRoom:` and its questions.

    There may be two more sections, `TakePicture:` and `TakeTreasure:`. A line may have several wordings of one question
    with ` | ` between them.

    Raises:
        BadFile: as the module promises.
    """
    lines = numbered_lines(path)
    number, name = first_line(path, lines, "name", "a name for the template, for instance DontKnow:")
    if name in _SECTIONS:
        raise BadFile(
            path,
            "the first line is the template's name, not a section",
            "add a first line with a name, for instance DontKnow:",
            line=number,
            key=name,
        )
    questions: dict[Scenario, list[ScriptedQuestion]] = {Scenario.DONT_KNOW: []}
    scenario = Scenario.DONT_KNOW
    for number, line in lines[1:]:
        section = _section(path, number, line)
        if section is None:
            questions[scenario].append(_question(path, number, line, scenario))
            continue
        if section in questions:
            raise BadFile(
                path, "this section is there twice", "put its questions under one heading", line=number, key=line
            )
        questions[section] = []
        scenario = section
    if Scenario.SPECIFIC_ROOM not in questions:
        raise BadFile(
            path,
            "this line is missing",
            "add a line SpecificRoom: above the questions that are asked when the person chose the room",
            key="SpecificRoom:",
        )
    return Template(name, {scenario: tuple(asked) for scenario, asked in questions.items()})


def _treasure(path: Path, number: int, line: str) -> TreasureKind:
    fields = [field.strip() for field in line.split(",")]
    if len(fields) not in (4, 5):
        raise BadFile(
            path,
            f"{len(fields)} fields in a line that needs 5, or 4 in a participant's copy",
            f"write it as {_TREASURE_FORM}, with commas only between the fields",
            line=number,
        )
    for key, field in zip(_TREASURE_FORM.split(","), fields, strict=False):
        if not field:
            raise BadFile(path, "nothing is written there", f"write the line as {_TREASURE_FORM}", line=number, key=key)
    colour, footprint, points, name = fields[:4]
    image = fields[4] if len(fields) == 5 else None
    if image is not None and ("/" in image or "\\" in image or image in (".", "..") or len(image.split()) > 1):
        raise BadFile(
            path,
            f"{image!r} is not a plain file name",
            f"write the name alone, without folder and without blanks, and put the file into {PICTURES}/",
            line=number,
            key="ImageFile",
        )
    return TreasureKind(colour, footprint, count_in(path, number, "Points", points, least=0), name, image)


def _section(path: Path, number: int, line: str) -> Scenario | None:
    if line in _SECTIONS:
        return _SECTIONS[line]
    if line.endswith(":") and len(line.split()) <= 2:
        folded = {heading.casefold(): heading for heading in _SECTIONS}
        near = difflib.get_close_matches(line.casefold(), folded, n=1, cutoff=0.75)
        if near:
            raise BadFile(path, "there is no such section", f"write {folded[near[0]]}", line=number, key=line)
    return None


def _question(path: Path, number: int, line: str, scenario: Scenario) -> ScriptedQuestion:
    wordings = tuple(wording.strip() for wording in _BETWEEN_WORDINGS.split(line))
    if not all(wordings):
        raise BadFile(
            path, "an empty wording", "write a wording on both sides of every bar, or remove the bar", line=number
        )
    for wording in wordings:
        fault = word_fault(wording, scenario)
        if fault is not None:
            raise BadFile(path, fault.problem, fault.remedy, line=number)
    return ScriptedQuestion(wordings)


def _check_copy(path: Path, treasures: TreasureList) -> None:
    copy = read_treasures(path)
    wanted = TreasureList(treasures.rooms, tuple(replace(kind, image=None) for kind in treasures.kinds))
    if any(kind.image is not None for kind in copy.kinds):
        raise BadFile(
            path, "the participant's copy tells the images", "leave the last field of every line out", key="ImageFile"
        )
    if copy != wanted:
        raise BadFile(
            path,
            f"does not say the same as {TREASURES}",
            f"copy {TREASURES} here again and leave the last field of every line out",
        )
