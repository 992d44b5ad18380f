"""Reads template folders: the files of 2016 with the travel costs, treasures and dialogue of a game.

A folder has `mapTimes`, `treasures`, `DialogueText` and `pictures/`, and for the participant's machine, which must not
know which picture belongs to which treasure, `treasures.participant`: the same lines without their last field. All are
UTF-8 text; Windows line ends, a byte order mark and blank lines are accepted.
"""

import codecs
import difflib
import math
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from thbridge.dialogue.moves import Scenario
from thbridge.dialogue.templates import ScriptedQuestion, Template, word_fault
from thbridge.files.errors import BadFile
from thbridge.hunt.costs import NOT_A_MOVE, CostMatrix
from thbridge.hunt.treasures import TreasureKind, same_name

MAP_TIMES = "mapTimes"
TREASURES = "treasures"
PARTICIPANT_TREASURES = "treasures.participant"
DIALOGUE_TEXT = "DialogueText"
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
class TemplateSet:
    """The contents of a checked template folder: all files have the same rooms, and no picture is missing.

    Attributes:
        costs: energy of every move.
        kinds: treasures with their images.
        dialogue: the scripted questions.
        pictures: the treasures' image files, by name.
    """

    costs: CostMatrix
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
        raise BadFile(
            folder, None, None, "there is no such template folder", "name a folder that has DialogueText in it"
        )
    costs = read_map_times(folder / MAP_TIMES)
    path = folder / TREASURES
    treasures = read_treasures(path)
    if treasures.rooms != len(costs.rooms):
        raise BadFile(
            path,
            1,
            "number of rooms",
            f"{treasures.rooms} rooms, but {MAP_TIMES} has {len(costs.rooms) + 1} nodes, "
            f"the corridor and {len(costs.rooms)} rooms",
            "make both files tell of the same rooms",
        )
    pictures: dict[str, bytes] = {}
    for kind in treasures.kinds:
        if kind.image is None:
            raise BadFile(
                path,
                None,
                "ImageFile",
                "no treasure has an image, as in a participant's copy",
                f"write every treasure as {_TREASURE_FORM}; name the copy {PARTICIPANT_TREASURES}",
            )
        pictures[kind.image] = _picture(path, kind.name, folder / PICTURES / kind.image)
    copy = folder / PARTICIPANT_TREASURES
    if copy.exists():
        _check_copy(copy, treasures)
    return TemplateSet(costs, treasures.kinds, read_dialogue_text(folder / DIALOGUE_TEXT), pictures)


def _picture(treasures: Path, name: str, file: Path) -> bytes:
    """The image file of a treasure."""
    try:
        with file.open("rb") as opened:
            data = opened.read(LARGEST_PICTURE + 1)
    except FileNotFoundError:
        problem, remedy = f"there is no picture {file.name}", f"put it into {file.parent} or mend the file name"
        raise BadFile(treasures, None, name, problem, remedy) from None
    except OSError as error:
        raise BadFile(file, None, None, f"it cannot be read ({error.strerror})", "check that it is a file") from None
    if len(data) > LARGEST_PICTURE:
        problem = f"the picture is larger than {LARGEST_PICTURE // 1_000_000} MB, and participants would wait for it"
        raise BadFile(file, None, None, problem, "save it smaller; a photo of 1000 x 1000 pixels is enough")
    return data


def read_map_times(path: Path) -> CostMatrix:
    """Read a travel cost matrix: the number of nodes, then one row of costs per node; 99 means no move.

    Costs are whole or decimal numbers and may be above 99; see `CostMatrix.of_map_times`.

    Raises:
        BadFile: as the module promises.
    """
    lines = _lines(path)
    number, first = _first(path, lines, "number of nodes", "the number of nodes, the corridor and the rooms")
    nodes = _count(path, number, "number of nodes", first, least=2)
    rows = lines[1:]
    if len(rows) != nodes:
        raise BadFile(
            path,
            rows[nodes][0] if len(rows) > nodes else number,
            "number of nodes",
            f"{nodes} nodes need {nodes} rows, but {len(rows)} follow",
            "add or remove rows, or mend the first line",
        )
    return CostMatrix.of_map_times(tuple(_cost_row(path, number, row, nodes) for number, row in rows))


def map_times(seconds: Sequence[Sequence[float | None]]) -> str:
    """The text of a travel cost matrix in whole seconds, because the programs of 2016 read only whole numbers.

    Args:
        seconds: `seconds[start][goal]`, square, the corridor first; None means no move. A trip of 99 s is written as
            98, because 99 means no move in this format.
    """
    rows = [" ".join(_cost_word(cost) for cost in row) for row in seconds]
    return "\n".join([str(len(rows)), *rows]) + "\n"


def _cost_word(seconds: float | None) -> str:
    if seconds is None:
        return "99"
    whole = round(seconds)
    return str(98 if whole == NOT_A_MOVE else whole)


def read_treasures(path: Path) -> TreasureList:
    """Read a list of treasures: the number of rooms, then one treasure per line, with or without its image file.

    Raises:
        BadFile: as the module promises.
    """
    lines = _lines(path)
    number, first = _first(path, lines, "number of rooms", "the number of rooms")
    rooms = _count(path, number, "number of rooms", first, least=1)
    if not lines[1:]:
        raise BadFile(path, None, None, "there is no treasure in the list", f"add lines of the form {_TREASURE_FORM}")
    kinds: list[TreasureKind] = []
    for number, line in lines[1:]:
        kind = _treasure(path, number, line)
        if any(same_name(kind.name, other.name) for other in kinds):
            raise BadFile(path, number, "Name", f"{kind.name!r} is there twice", "give every treasure its own name")
        if kinds and (kind.image is None) != (kinds[0].image is None):
            raise BadFile(
                path,
                number,
                "ImageFile",
                "some treasures have an image and some have none",
                "give every treasure its image, or leave all out in the participant's copy",
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
    lines = _lines(path)
    number, name = _first(path, lines, "name", "a name for the template, for instance DontKnow:")
    if name in _SECTIONS:
        raise BadFile(
            path,
            number,
            name,
            "the first line is the template's name, not a section",
            "add a first line with a name, for instance DontKnow:",
        )
    questions: dict[Scenario, list[ScriptedQuestion]] = {Scenario.DONT_KNOW: []}
    scenario = Scenario.DONT_KNOW
    for number, line in lines[1:]:
        section = _section(path, number, line)
        if section is None:
            questions[scenario].append(_question(path, number, line, scenario))
            continue
        if section in questions:
            raise BadFile(path, number, line, "this section is there twice", "put its questions under one heading")
        questions[section] = []
        scenario = section
    if Scenario.SPECIFIC_ROOM not in questions:
        raise BadFile(
            path,
            None,
            "SpecificRoom:",
            "this line is missing",
            "add a line SpecificRoom: above the questions that are asked when the person chose the room",
        )
    return Template(name, {scenario: tuple(asked) for scenario, asked in questions.items()})


def _lines(path: Path) -> list[tuple[int, str]]:
    """The lines that are not empty, stripped, with their numbers from 1."""
    try:
        content = path.read_bytes()
    except FileNotFoundError:
        raise BadFile(path, None, None, "there is no such file", "add it, or check the name and the folder") from None
    except OSError as error:
        raise BadFile(
            path, None, None, f"cannot be read ({error.strerror})", "make it a file that you may read"
        ) from None
    try:
        text = content.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        encoding = "UTF-16" if content.startswith((codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE)) else "Latin-1"
        raise BadFile(
            path,
            content.count(b"\n", 0, error.start) + 1,
            None,
            f"not UTF-8 text; it was probably saved as {encoding}",
            "open it in an editor and save it with the encoding UTF-8, "
            f"or run: iconv -f {encoding} -t UTF-8 {path.name} > {path.name}.utf8",
        ) from None
    # Not splitlines(): it also splits at characters that editors show within a line, which makes line numbers wrong.
    numbered = enumerate(text.replace("\r\n", "\n").replace("\r", "\n").split("\n"), start=1)
    return [(number, line.strip()) for number, line in numbered if line.strip()]


def _first(path: Path, lines: list[tuple[int, str]], key: str, wanted: str) -> tuple[int, str]:
    if not lines:
        raise BadFile(path, 1, key, "the file is empty", f"begin it with {wanted}")
    return lines[0]


def _count(path: Path, number: int, key: str, text: str, least: int) -> int:
    # isdecimal() and isascii(): int() would also take signs, underscores and digits of other scripts.
    if not (text.isascii() and text.isdecimal()) or len(text) > 6 or int(text) < least:
        raise BadFile(path, number, key, f"{text!r} is not a number from {least}", f"write {key} alone on this line")
    return int(text)


def _cost_row(path: Path, number: int, line: str, nodes: int) -> tuple[float, ...]:
    words = line.split()
    if len(words) != nodes:
        raise BadFile(
            path,
            number,
            None,
            f"{len(words)} costs in a row that needs {nodes}",
            "give one cost for every node, with 99 where there is no move",
        )
    return tuple(_cost(path, number, column, word) for column, word in enumerate(words))


def _cost(path: Path, number: int, column: int, word: str) -> float:
    try:
        cost = float(word)
    except ValueError:
        cost = math.nan
    if not (math.isfinite(cost) and cost >= 0.0):
        raise BadFile(
            path,
            number,
            f"column {column + 1}",
            f"{word!r} is not a cost",
            "write a number that is not negative, and 99 where there is no move",
        )
    return cost


def _treasure(path: Path, number: int, line: str) -> TreasureKind:
    fields = [field.strip() for field in line.split(",")]
    if len(fields) not in (4, 5):
        raise BadFile(
            path,
            number,
            None,
            f"{len(fields)} fields in a line that needs 5, or 4 in a participant's copy",
            f"write it as {_TREASURE_FORM}, with commas only between the fields",
        )
    for key, field in zip(_TREASURE_FORM.split(","), fields, strict=False):
        if not field:
            raise BadFile(path, number, key, "nothing is written there", f"write the line as {_TREASURE_FORM}")
    colour, footprint, points, name = fields[:4]
    image = fields[4] if len(fields) == 5 else None
    if image is not None and ("/" in image or "\\" in image or image in (".", "..") or len(image.split()) > 1):
        raise BadFile(
            path,
            number,
            "ImageFile",
            f"{image!r} is not a plain file name",
            f"write the name alone, without folder and without blanks, and put the file into {PICTURES}/",
        )
    return TreasureKind(colour, footprint, _count(path, number, "Points", points, least=0), name, image)


def _section(path: Path, number: int, line: str) -> Scenario | None:
    if line in _SECTIONS:
        return _SECTIONS[line]
    if line.endswith(":") and len(line.split()) <= 2:
        folded = {heading.casefold(): heading for heading in _SECTIONS}
        near = difflib.get_close_matches(line.casefold(), folded, n=1, cutoff=0.75)
        if near:
            raise BadFile(path, number, line, "there is no such section", f"write {folded[near[0]]}")
    return None


def _question(path: Path, number: int, line: str, scenario: Scenario) -> ScriptedQuestion:
    wordings = tuple(wording.strip() for wording in _BETWEEN_WORDINGS.split(line))
    if not all(wordings):
        raise BadFile(
            path, number, None, "an empty wording", "write a wording on both sides of every bar, or remove the bar"
        )
    for wording in wordings:
        fault = word_fault(wording, scenario)
        if fault is not None:
            raise BadFile(path, number, None, fault.problem, fault.remedy)
    return ScriptedQuestion(wordings)


def _check_copy(path: Path, treasures: TreasureList) -> None:
    copy = read_treasures(path)
    wanted = TreasureList(treasures.rooms, tuple(replace(kind, image=None) for kind in treasures.kinds))
    if any(kind.image is not None for kind in copy.kinds):
        raise BadFile(
            path, None, "ImageFile", "the participant's copy tells the images", "leave the last field of every line out"
        )
    if copy != wanted:
        raise BadFile(
            path,
            None,
            None,
            f"does not say the same as {TREASURES}",
            f"copy {TREASURES} here again and leave the last field of every line out",
        )
