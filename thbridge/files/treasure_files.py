"""Reading of lists of treasures: the lines of 2016, and `treasures.yaml`, which declares its own properties.

A list of 2016 has two properties and does not declare them (`OF_2016`). The copy of this list for the participant's
machine, `treasures.participant`, has the same lines without the pictures.
"""

import dataclasses
import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from pathlib import Path

from sim.parameters import param
from thbridge.dialogue.scripted.reserved_words import WORDS
from thbridge.files.disk.inside import fault_of_name
from thbridge.files.errors import BadFile, BadFiles, FaultCollection
from thbridge.files.template_lines import count_in, first_line, numbered_lines
from thbridge.files.yaml.load import Loaded, load
from thbridge.hunt.codec import TAKEN
from thbridge.hunt.properties import OF_2016, PropertyDrawing, Teller, TreasureProperty
from thbridge.hunt.treasures import TreasureKind, same_name

TREASURES = "treasures"
PARTICIPANT_TREASURES = "treasures.participant"
TREASURES_YAML = "treasures.yaml"
PICTURES = "pictures"

_TREASURE_FORM = "Colour,Footprint,Points,Name,ImageFile"
_NAME = re.compile(r"[a-z][a-z_]*")
_UNSAYABLE = (
    "brackets, colons, commas, quotation marks and pound signs cannot be sent in a line",
    "leave these characters out",
)
_ON_THE_WIRE = re.compile(r"[^()\":,£\n]+")


@dataclass(frozen=True, slots=True)
class TreasureList:
    """The contents of a list of treasures.

    Attributes:
        rooms: number of rooms.
        kinds: the treasures, at least one, in the order of the file; either all treasures have an image, or no treasure
            has one.
        properties: properties that each treasure has.
    """

    rooms: int
    kinds: tuple[TreasureKind, ...]
    properties: tuple[TreasureProperty, ...] = OF_2016


@dataclass(frozen=True, slots=True)
class _PropertyYaml:
    name: str
    label: str = param("", "heading of the property's values, for people")
    values: tuple[str, ...] = ()
    told_by: Teller = Teller.ROBOT
    sensor: str = param("", "name of the robot's sensor, for people")
    cost: float = param(0.0, "energy of sensing the property", minimum=0.0, maximum=1e6)
    drawn: PropertyDrawing = PropertyDrawing.NONE
    said: str = param("", "wording of a value within a sentence")


@dataclass(frozen=True, slots=True)
class _TreasureYaml:
    name: str
    image: str
    points: int = param(0, "points for naming the treasure correctly", minimum=0, maximum=999_999)
    values: Mapping[str, str] = dataclasses.field(default_factory=dict)


@dataclass(frozen=True, slots=True)
class _TreasuresYaml:
    treasures: tuple[_TreasureYaml, ...]
    properties: tuple[_PropertyYaml, ...] = ()
    rooms: int = param(8, "number of rooms to fill, for servers of other programs", minimum=1, maximum=1000)


def read_treasures(path: Path) -> TreasureList:
    """Read a list of treasures: the number of rooms, then one treasure per line, with or without its image file.

    Raises:
        BadFile: the file cannot be read or has faults; faults of several lines are raised together.
    """
    lines = numbered_lines(path)
    number, first = first_line(path, lines, "number of rooms", "the number of rooms")
    rooms = count_in(path, number, "number of rooms", first, least=1)
    if not lines[1:]:
        raise BadFile(path, "the list has no treasures", f"add lines of the form {_TREASURE_FORM}")
    kinds: list[TreasureKind] = []
    faults = FaultCollection()
    for number, line in lines[1:]:
        with faults.kept():
            kind = _treasure(path, number, line)
            _check_beside(path, number, kind, kinds)
            kinds.append(kind)
    if faults.found:
        raise faults.together()
    return TreasureList(rooms, tuple(kinds))


def read_treasures_yaml(path: Path) -> TreasureList:
    """Read a `treasures.yaml`: properties, and treasures with a value for each property.

    Raises:
        BadFile: the file cannot be read or has faults; all faults are raised together.
    """
    loaded = load(path, _TreasuresYaml)
    faults = (*_property_faults(loaded), *_treasure_faults(loaded))
    if faults:
        raise BadFiles(faults)
    written = loaded.value
    properties = tuple(
        TreasureProperty(
            each.name,
            each.label or each.name.replace("_", " ").capitalize(),
            each.values,
            each.told_by,
            each.sensor,
            each.cost,
            each.drawn,
            each.said,
        )
        for each in written.properties
    )
    kinds = (
        TreasureKind({each.name: kind.values[each.name] for each in properties}, kind.points, kind.name, kind.image)
        for kind in written.treasures
    )
    return TreasureList(written.rooms, tuple(kinds), properties)


def check_copy(path: Path, treasures: TreasureList) -> None:
    """Check the participant's copy of a list of 2016.

    Raises:
        BadFile: the copy contains the images, or differs in other fields.
    """
    copy = read_treasures(path)
    wanted = TreasureList(treasures.rooms, tuple(replace(kind, image=None) for kind in treasures.kinds))
    if any(kind.image is not None for kind in copy.kinds):
        raise BadFile(
            path, "the participant's copy names the images", "delete the last field of every line", key="ImageFile"
        )
    if copy != wanted:
        raise BadFile(
            path,
            f"this copy differs from {TREASURES}",
            f"copy {TREASURES} here again and delete the last field of every line",
        )


def _check_beside(path: Path, number: int, kind: TreasureKind, earlier: list[TreasureKind]) -> None:
    """Check a treasure of a list of 2016 against the treasures above it."""
    if any(same_name(kind.name, other.name) for other in earlier):
        raise BadFile(
            path, f"{kind.name!r} is there twice", "give every treasure its own name", line=number, key="Name"
        )
    if earlier and (kind.image is None) != (earlier[0].image is None):
        raise BadFile(
            path,
            "some treasures have an image and others do not",
            "give every treasure its image, or delete all images in the participant's copy",
            line=number,
            key="ImageFile",
        )


def _treasure(path: Path, number: int, line: str) -> TreasureKind:
    fields = [field.strip() for field in line.split(",")]
    if len(fields) not in (4, 5):
        raise BadFile(
            path,
            f"{len(fields)} fields in a line that needs 5, or 4 in a participant's copy",
            f"write the line as {_TREASURE_FORM}, with commas only between the fields",
            line=number,
        )
    for key, field in zip(_TREASURE_FORM.split(","), fields, strict=False):
        if not field:
            raise BadFile(path, "this field is empty", f"write the line as {_TREASURE_FORM}", line=number, key=key)
    colour, footprint, points, name = fields[:4]
    image = fields[4] if len(fields) == 5 else None
    if image is not None and not _is_plain_name(image):
        raise BadFile(
            path,
            f"{image!r} is not a plain file name",
            f"write only the name, without folder and blanks, and put the file into {PICTURES}/",
            line=number,
            key="ImageFile",
        )
    values = {each.name: value for each, value in zip(OF_2016, (colour, footprint), strict=True)}
    return TreasureKind(values, count_in(path, number, "Points", points, least=0), name, image)


def _property_faults(loaded: Loaded[_TreasuresYaml]) -> Iterator[BadFile]:
    """Yield faults of the declarations of properties."""
    words, earlier = {word.name for word in WORDS}, set[str]()
    for index, each in enumerate(loaded.value.properties):
        key = f"properties[{index}]"
        if not _NAME.fullmatch(each.name) or each.name in TAKEN or each.name in words:
            problem = f"{each.name!r} cannot be the name of a property"
            taken = ", ".join(sorted(TAKEN | words))
            yield loaded.fault(f"{key}.name", problem, f"write small letters and underscores, but none of {taken}")
        elif each.name in earlier:
            yield loaded.fault(f"{key}.name", f"{each.name!r} is there twice", "give every property its own name")
        earlier.add(each.name)
        if each.label and not _ON_THE_WIRE.fullmatch(each.label):
            yield loaded.fault(f"{key}.label", *_UNSAYABLE)
        if each.said and f"£{each.name}£" not in each.said:
            remedy = f"write £{each.name}£ in place of the value"
            yield loaded.fault(f"{key}.said", "this text does not contain the value", remedy)
        if each.told_by is Teller.PERSON and (each.cost or each.sensor):
            wrong = "cost" if each.cost else "sensor"
            problem, remedy = "a report by people has no cost and no sensor", "delete this key, or write told_by: robot"
            yield loaded.fault(f"{key}.{wrong}", problem, remedy)
        if each.told_by is Teller.PERSON and len(each.values) < 2:
            problem = "people choose among the values, so at least two are needed"
            yield loaded.fault(f"{key}.values", problem, "write all possible values: [wood, metal]")


def _treasure_faults(loaded: Loaded[_TreasuresYaml]) -> Iterator[BadFile]:
    """Yield faults of the treasures."""
    written = loaded.value
    if not written.treasures:
        yield loaded.fault("treasures", "the list has no treasures", "write a line '- name: ...' for each treasure")
    declared = {each.name: each for each in written.properties}
    for index, kind in enumerate(written.treasures):
        key = f"treasures[{index}]"
        if not kind.name.strip():
            yield loaded.fault(f"{key}.name", "the name is empty", "give the treasure a name")
        if any(same_name(kind.name, other.name) for other in written.treasures[:index]):
            yield loaded.fault(f"{key}.name", f"{kind.name!r} is there twice", "give every treasure its own name")
        if not _is_plain_name(kind.image):
            remedy = f"write only the name, without folder and blanks, and put the file into {PICTURES}/"
            yield loaded.fault(f"{key}.image", f"{kind.image!r} is not a plain file name", remedy)
        for name in declared.keys() - kind.values.keys():
            yield loaded.fault(f"{key}.values", f"{kind.name} has no {name}", f"add {name}: ... to its values")
        for name, value in kind.values.items():
            place, of = f"{key}.values.{name}", declared.get(name)
            if of is None:
                remedy = "declare the property under properties" + (
                    f", or write one of {', '.join(declared)}" if declared else ""
                )
                yield loaded.fault(place, f"no property has the name {name!r}", remedy)
            elif of.values and value not in of.values:
                remedy = f"write one of {', '.join(of.values)}, or add it to the values of {name}"
                yield loaded.fault(place, f"{value!r} is not a value of {name}", remedy)
            elif not _ON_THE_WIRE.fullmatch(value):
                yield loaded.fault(place, *_UNSAYABLE)


def _is_plain_name(image: str) -> bool:
    """Return True for the name of a file without folder and blanks."""
    return not fault_of_name(image) and len(image.split()) == 1
