"""Fields of a study's form, made from the schema and the file."""

import dataclasses
import re
import textwrap
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from enum import StrEnum
from pathlib import Path
from types import NoneType, UnionType
from typing import TYPE_CHECKING, Union, cast, get_args, get_origin, get_type_hints

from thbridge.files.errors import BadFile
from thbridge.files.yaml.declarations import (
    Metadata,
    allowed,
    bounds,
    choices_of,
    model_of,
    renamed_of,
    required,
    sections_named_in,
    with_plugins,
)
from thbridge.files.yaml.edit import in_brackets
from thbridge.files.yaml.places import node_at, path_of, source_of, steps_of
from thbridge.files.yaml.tree import Listing, Node, Scalar, Section, parse, quoted
from thbridge.study.noise import TARGET_PATHS
from thbridge.study.text import SHOWN_ELSEWHERE, as_yaml, is_plain_word

if TYPE_CHECKING:
    from _typeshed import DataclassInstance


_PLAIN = re.compile(r"[\w.+-]+")


class FieldKind(StrEnum):
    """Type of a field's value."""

    BOOLEAN = "truth"
    INTEGER = "whole number"
    NUMBER = "number"
    CHOICE = "choice"
    TEXT = "text"
    PATH = "path"
    LIST = "list"
    """List or other value that people type as YAML."""


class RepeatKind(StrEnum):
    """Kind of the items in a section that can have any number of items."""

    ITEMS = "items"
    ROBOTS = "robots"
    STEPS = "steps"
    """Items in a fixed order."""
    KEYS = "keys"
    """Values whose keys a person can choose."""


@dataclass(frozen=True, slots=True)
class FormField:
    """One value of a study.

    Attributes:
        key: path of the value in a study, such as `robot.amcl.kld_err`.
        label: name for people.
        help: meaning, in one sentence.
        kind: type of the value.
        unit: SI unit; empty for a pure number.
        minimum: smallest allowed number; infinite if there is no limit.
        maximum: largest allowed number.
        choices: allowed words; empty if any text is allowed.
        optional: True if the value may be null.
        default: the value that applies if the file has none, as YAML; presets and ROS files can change the default.
        written: the value in the file, as YAML; None if the file has none.
        place: path of the value in the file, possibly with an old name. If the file has no value, this is the path at
            which a value would be written.
        line: line of that path, counted from 1; None if the file has no value.
        places: all paths at which a file may have the value.
        own_key: True if a person chose the key, and can remove the field.
    """

    key: str
    label: str
    help: str
    kind: FieldKind
    unit: str
    minimum: float
    maximum: float
    choices: tuple[str, ...]
    optional: bool
    default: str
    written: str | None
    place: str
    line: int | None
    places: tuple[str, ...]
    own_key: bool = False

    @property
    def value(self) -> str:
        """Value from the file, or otherwise the default, as YAML."""
        return self.default if self.written is None else self.written

    @property
    def is_text(self) -> bool:
        """True if people type plain text into the field instead of YAML."""
        return self.kind in {FieldKind.TEXT, FieldKind.PATH}


@dataclass(frozen=True, slots=True)
class FormGroup:
    """Section of a study.

    Attributes:
        key: path of the section; empty for the whole study.
        label: name for people.
        help: meaning of the section.
        fields: values directly in this section.
        groups: sections inside this section.
        repeats: kind of the section's items if people can add and remove items; otherwise None.
        order: keys of the section, in the order of the schema.
    """

    key: str
    label: str
    help: str
    fields: tuple[FormField, ...]
    groups: tuple["FormGroup", ...]
    repeats: RepeatKind | None = None
    order: tuple[str, ...] = ()

    def all_fields(self) -> Iterator[FormField]:
        """Yield the fields of the section and of all sections inside."""
        yield from self.fields
        for group in self.groups:
            yield from group.all_fields()

    def all_groups(self) -> Iterator["FormGroup"]:
        """Yield the section and all sections inside."""
        yield self
        for group in self.groups:
            yield from group.all_groups()

    def written(self) -> int:
        """Number of the section's values that the file contains."""
        return sum(field.written is not None for field in self.all_fields())


_ORDERED = frozenset({"steps", "items"})
"""Lists of sections in a fixed order: steps of a study with people, items of a questionnaire."""

_NOISE_OF = {home: f"noise.{path}" for path, home in TARGET_PATHS.items()}
"""Second path, in the section `noise`, of each number that has two paths."""


_LABELS = {
    "server": "Text server",
    "mavlink": "Ground stations (MAVLink)",
    "fleet": "Real robots",
    "fleet.robot": "Names of topics and frames, all robots",
    "fleet.each": "Names of topics and frames, single robots",
    "robot": "Robots' software",
    "each": "Single robots",
    "ros_parameters": "ROS parameter files",
    "base": "Values for all games",
    "within": "Factors within people",
    "like": "Values for all items",
    "between": "Factors between people",
}


def form_of(text: str, tree: Node, start: "DataclassInstance", label: str = "Study") -> FormGroup:
    """Return the form of a study file or of another file that has a dataclass.

    Args:
        text: text of the file.
        tree: the same text, parsed.
        start: values of the keys that are missing in the file.
        label: name of the file for people.
    """
    return _Builder(text, tree).group(start, "", label, "all settings of this file")


def typed_as_yaml(field: FormField, typed: str) -> str:
    """Return a value that a person typed or selected, as YAML."""
    typed = typed.strip() if not field.is_text else typed
    if field.optional and typed == "null":
        return typed
    if field.kind in {FieldKind.TEXT, FieldKind.PATH, FieldKind.CHOICE}:
        return typed if is_plain_word(typed) else quoted(typed)
    if field.kind is FieldKind.LIST or all(sign.isalnum() or sign in "+-._" for sign in typed):
        return typed
    return quoted(typed)


def editable_text(field: FormField) -> str:
    """Return a field's value as a person would type it, without quotes around a text."""
    if _PLAIN.fullmatch(field.value):
        return field.value
    one_line = "\n" not in field.value
    if field.kind is FieldKind.LIST and one_line:
        return field.value
    try:
        node = parse(Path("value"), field.value if one_line else _outdented(field.value))
    except BadFile:
        return field.value
    return node.text if isinstance(node, Scalar) else field.value if one_line else in_brackets(node)


def hint_of(field: FormField) -> str:
    """Return the limits of a field in words: `0 to 20`, `at least 1`, `or null`."""
    limits = {"minimum": field.minimum, "maximum": field.maximum}
    words = [] if field.choices else [allowed(float, limits)]
    return ", ".join([*(word for word in words if word), *(["or null"] if field.optional else [])])


def _outdented(lines: str) -> str:
    """Return a value of several lines with equal indentation; its first line is behind the key in the file."""
    first, _, rest = lines.partition("\n")
    return f"{first}\n{textwrap.dedent(rest)}"


class _Builder:
    """Builder of the form from schema, defaults and file."""

    def __init__(self, text: str, tree: Node) -> None:
        self._text = text
        self._tree = tree
        self._made: dict[str, FormField] = {}

    def group(
        self,
        start: "DataclassInstance",
        key: str,
        label: str,
        help_text: str,
        handed: Mapping[str, str] | None = None,
        like: str = "",
    ) -> FormGroup:
        """Return the form of a section.

        Args:
            start: values of the keys that are missing in the file.
            key: path of the section.
            label: name of the section.
            help_text: meaning of the section.
            handed: keys of an outer section that set keys of this section, by the names of these keys.
            like: path of the section with the values that apply if this section has none.
        """
        section = type(start)
        hints = cast(Mapping[str, object], get_type_hints(section))
        fields: list[FormField] = []
        groups: list[FormGroup] = []
        # The section `noise` comes first, because its values are the defaults of the noise that robots assume.
        for field in sorted(dataclasses.fields(start), key=lambda field: field.name != "noise"):
            name, place = field.name, _joined(key, field.name)
            if place in SHOWN_ELSEWHERE:
                continue
            value, hint = cast(object, getattr(start, name)), hints[name]
            meaning = cast(str, field.metadata.get("help", ""))
            above = (handed or {}).get(name)
            model = model_of(field)
            if name == sections_named_in(section):
                names_at = above or place
                named = cast(tuple["DataclassInstance", ...], value)
                fields.append(self._names(place, meaning, named, above))
                groups += self._named_sections(named, names_at, _joined(like, name) if like else "")
            elif model is not None:
                item_model = cast("DataclassInstance", getattr(start, model))
                groups.append(self._robots(item_model, place, meaning, _joined(key, model)))
            elif _item_class(hint) is not None and not value:
                groups.append(self._items(cast("type[DataclassInstance]", _item_class(hint)), place, meaning))
            elif _is_mapping(hint) and model is None:
                groups.append(self._keys(place, meaning))
            elif dataclasses.is_dataclass(value) and not isinstance(value, type):
                passed_on = cast(Mapping[str, str], getattr(section, "passed_on", {}))
                below = {
                    path.partition(".")[2]: _joined(key, above_name)
                    for above_name, path in passed_on.items()
                    if path.partition(".")[0] == name
                }
                inner_like = _joined(like, name) if like else ""
                groups.append(self.group(value, place, _label(place), meaning, below, inner_like))
            else:
                old = [_joined(key, was) for was, now in renamed_of(section).items() if now == name]
                places = [*([above] if above else []), place, *old, *self._homes(place)]
                likened = _joined(like, name)
                inherited = self._made.get(_NOISE_OF.get(likened, likened)) if like else None
                default = as_yaml(value) if inherited is None else inherited.value
                fields.append(self._field(place, hint, field.metadata, default, places))
        order = tuple(field.name for field in dataclasses.fields(start))
        return FormGroup(key, label, help_text, tuple(fields), tuple(groups), None, order)

    def _field(self, key: str, hint: object, metadata: Metadata, default: str, places: list[str]) -> FormField:
        optional = get_origin(hint) in {Union, UnionType}
        if optional:
            (hint,) = (argument for argument in get_args(hint) if argument is not NoneType)
        written = [place for place in places if node_at(self._tree, steps_of(place)) is not None]
        place = written[0] if written else key
        node = node_at(self._tree, steps_of(place))
        minimum, maximum = bounds(metadata)
        choices = choices_of(hint, with_plugins(metadata))
        made = FormField(
            key=key,
            label=_label(key),
            help=cast(str, metadata.get("help", "")),
            kind=_kind(hint, choices),
            unit=cast(str, metadata.get("unit", "")),
            minimum=minimum,
            maximum=maximum,
            choices=choices,
            optional=optional,
            default=default,
            written=source_of(self._text, self._tree, place),
            place=place,
            line=None if node is None else node.line,
            places=tuple(places),
        )
        self._made[key] = made
        return made

    def _homes(self, place: str) -> list[str]:
        section, _, inner = place.partition(".")
        return [TARGET_PATHS[inner]] if section == "noise" and inner in TARGET_PATHS else []

    def _names(self, key: str, help_text: str, named: tuple["DataclassInstance", ...], above: str | None) -> FormField:
        default = as_yaml(" ".join(_name_of(section) for section in named))
        return self._field(key, str, {"help": help_text}, default, [*([above] if above else []), key])

    def _named_sections(self, named: tuple["DataclassInstance", ...], names_at: str, like: str) -> Iterator[FormGroup]:
        """Yield a section for each name that is listed at this path."""
        holder = names_at.rpartition(".")[0]
        node = node_at(self._tree, steps_of(names_at))
        by_default = {_name_of(section): section for section in named}
        names = node.text.split() if isinstance(node, Scalar) else list(by_default)
        for name in names:
            model = by_default.get(name)
            if model is None and not named:
                continue
            start = dataclasses.replace(model if model is not None else type(named[0])(), name=name)
            group = self.group(start, _joined(holder, name), name, "settings for one use of the laser", None, "")
            yield dataclasses.replace(group, fields=tuple(f for f in group.fields if not f.key.endswith(".name")))

    def _robots(self, model: "DataclassInstance", key: str, help_text: str, like: str) -> FormGroup:
        node = node_at(self._tree, steps_of(key))
        entries = node.entries if isinstance(node, Section) else []
        groups = [
            self.group(model, f"{key}.{name.text}", f"Robot {name.text}", "settings of this robot only", None, like)
            for name, _ in entries
        ]
        return FormGroup(key, _label(key), help_text, (), tuple(groups), RepeatKind.ROBOTS)

    def _items(self, into: "type[DataclassInstance]", key: str, help_text: str) -> FormGroup:
        node = node_at(self._tree, steps_of(key))
        count = len(node.items) if isinstance(node, Listing) else 0
        groups = [self._item(into, f"{key}[{index}]", index) for index in range(count)]
        repeats = RepeatKind.STEPS if key in _ORDERED else RepeatKind.ITEMS
        return FormGroup(key, _label(key), help_text, (), tuple(groups), repeats)

    def _keys(self, key: str, help_text: str) -> FormGroup:
        """Return the section of a mapping, with one field per entry; the values can be any YAML."""
        node = node_at(self._tree, steps_of(key))
        fields = []
        for name, _ in node.entries if isinstance(node, Section) else ():
            place = path_of((key, name.text))
            field = self._field(f"{key}.{name.text}", tuple[str, ...], {"help": ""}, "", [place])
            fields.append(dataclasses.replace(field, label=name.text, own_key=True))
        return FormGroup(key, _label(key), help_text, tuple(fields), (), RepeatKind.KEYS)

    def _item(self, into: "type[DataclassInstance]", key: str, index: int) -> FormGroup:
        hints = cast(Mapping[str, object], get_type_hints(into))
        fields = []
        for field in dataclasses.fields(into):
            place = f"{key}.{field.name}"
            default = "" if required(field) else _default_of(field)
            fields.append(self._field(place, hints[field.name], field.metadata, default, [place]))
        name = next((field.written for field in fields if field.key in {f"{key}.name", f"{key}.id"}), None)
        label = f"{index + 1}" if name is None else f"{index + 1}: {name.strip(chr(34))}"
        order = tuple(field.name for field in dataclasses.fields(into))
        return FormGroup(key, label, "", tuple(fields), (), None, order)


def _name_of(section: "DataclassInstance") -> str:
    return cast(str, getattr(section, "name"))  # noqa: B009 - any class of them


def _item_class(hint: object) -> type | None:
    """Return the class of a list's items if the items are of a dataclass; otherwise None."""
    item = cast(object, get_args(hint)[0]) if get_origin(hint) is tuple else None
    return item if isinstance(item, type) and dataclasses.is_dataclass(item) else None


def _default_of(field: "dataclasses.Field[object]") -> str:
    """Return the default of a field as YAML; mappings are in braces."""
    if field.default is not dataclasses.MISSING:
        return as_yaml(field.default)
    entries = cast(Mapping[str, str], field.default_factory()) if callable(field.default_factory) else {}
    return f"{{{', '.join(f'{name}: {text}' for name, text in entries.items())}}}"


def _is_mapping(hint: object) -> bool:
    """Return True if a type is a mapping whose keys are texts."""
    return get_origin(hint) is Mapping and get_args(hint)[0] is str


def _kind(hint: object, choices: tuple[str, ...]) -> FieldKind:
    if choices:
        return FieldKind.CHOICE
    kinds: Mapping[object, FieldKind] = {
        bool: FieldKind.BOOLEAN,
        int: FieldKind.INTEGER,
        float: FieldKind.NUMBER,
        Path: FieldKind.PATH,
    }
    return kinds.get(hint, FieldKind.LIST if get_origin(hint) is tuple or _is_mapping(hint) else FieldKind.TEXT)


def _joined(key: str, name: str) -> str:
    return f"{key}.{name}" if key else name


def _label(key: str) -> str:
    """Return the name of a key for people; names from ROS are unchanged."""
    name = key.rpartition(".")[2]
    if key in _LABELS:
        return _LABELS[key]
    if key.startswith(("robot.", "each.", "noise.believed.")):
        return name
    words = name.replace("_", " ")
    return words[:1].upper() + words[1:]
