"""Reading of YAML files into dataclasses; all faults of a file are reported together.

A file is read in two steps: `parse` turns its text into a tree with line numbers, `load` turns the tree into a
dataclass. The type of the dataclass's field decides how a plain word is read. YAML's guesses have no effect. So `no` is
text in a text field, and `1e3` is a number in a number field.
"""

import dataclasses
import difflib
import math
import re
import types
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Generic, Literal, TypeVar, Union, cast, get_args, get_origin, get_type_hints

from thbridge.files.disk.inside import fault_of_path
from thbridge.files.disk.text_files import read_text
from thbridge.files.errors import BadFile, BadFiles
from thbridge.files.yaml.angles import doubt_about, doubt_about_rate, radians_of
from thbridge.files.yaml.declarations import (
    Metadata,
    bounds,
    choices_of,
    keys_of,
    metadata_of_items,
    model_of,
    paths,
    renamed_of,
    required,
    ros_only_of,
    sections_named_in,
    wanted,
    with_plugins,
)
from thbridge.files.yaml.tree import Listing, Node, Scalar, Section, at_line, parse

if TYPE_CHECKING:
    from _typeshed import DataclassInstance

T = TypeVar("T")


@dataclass(frozen=True, slots=True)
class Loaded(Generic[T]):
    """The contents of a file, with the lines of its keys.

    Attributes:
        path: the file.
        value: the dataclass.
        lines: line of each key and item in the file, by its path (`robot.amcl.kld_err`, `rooms[2].goal`).
        notices: sentences about valid keys that have no effect here, and about doubts.
        doubts: values that are allowed, but look like mistakes.
    """

    path: Path
    value: T
    lines: Mapping[str, int]
    notices: tuple[str, ...] = ()
    doubts: tuple[BadFile, ...] = ()

    def fault(self, key: str, problem: str, remedy: str) -> BadFile:
        """Return a fault of the value at a key path that was found after loading, with the nearest line in the file."""
        written = key
        while written and written not in self.lines:
            written = written[: max(written.rfind("."), written.rfind("["), 0)]
        return BadFile(self.path, problem, remedy, line=self.lines.get(written), key=key)


def load(path: Path, into: type[T]) -> Loaded[T]:
    """Read a YAML file into a dataclass, with fields that are declared with `sim.parameters.param` or without it.

    If a field has a dataclass as its default, a section in the file changes only the values that it contains. The names
    in a class's `ros_only` are accepted, with a notice; a name in the class's `renamed` is read as its present name.

    Fields may be bool, int, float, str, Literal, StrEnum, Path, tuples, dataclasses, and any of these or None. A field
    without a default must be in the file. An empty section keeps its defaults. A field may also be a mapping from
    numbers (from 1) to dataclasses. If its metadata has `like`, omitted values come from the field of that name. A
    mapping from text to text accepts any names.

    Raises:
        BadFiles: all faults of the file; or one BadFile if the file cannot be read at all.
    """
    return load_text(path, read_text(path), into)


def load_text(path: Path, text: str, into: type[T]) -> Loaded[T]:
    """Load a text, as `load` does; `path` is named in faults."""
    return load_tree(path, parse(path, text), into)


def load_tree(path: Path, tree: Node, into: type[T], defaults: T | None = None) -> Loaded[T]:
    """Load a tree of `parse`, as `load` does; values that it leaves out come from `defaults`, if given."""
    reader = _Reader(path, into)
    value = reader.section(tree, into, "", cast("DataclassInstance | None", defaults))
    if reader.faults:
        raise BadFiles(tuple(sorted(reader.faults, key=lambda fault: fault.line or 0)))
    notices = (*reader.notices, *map(str, reader.doubts))
    return Loaded(path, cast(T, value), reader.lines, notices, tuple(reader.doubts))


class _Wrong:
    """Replacement of a value that could not be read; the reader's list contains the fault."""


_WRONG = _Wrong()
_WHOLE = re.compile(r"[-+]?\d{1,4000}")
_NUMBER = re.compile(r"[-+]?(\d+(\.\d*)?|\.\d+)([eE][-+]?\d{1,4})?")
_COMMA = re.compile(r"[-+]?\d*,\d+")
_LEADING_ZERO = re.compile(r"[-+]?0\d+")
_COUNTED = re.compile(r"[1-9]\d{0,8}")
_NOT_FINITE = re.compile(r"[-+]?\.?(inf|infinity|nan)", re.IGNORECASE)
_LAUNCHED = re.compile(r"\$\(.*\)|\$\{.*\}")
_WORDS_FOR_TRUTH = {"yes", "no", "on", "off", "y", "n"}


@cache
def _hints_of(into: type) -> Mapping[str, object]:
    return cast(Mapping[str, object], get_type_hints(into))


@dataclass(slots=True)
class _Reader:
    path: Path
    root: type
    faults: list[BadFile] = dataclasses.field(default_factory=list)
    lines: dict[str, int] = dataclasses.field(default_factory=dict)
    notices: list[str] = dataclasses.field(default_factory=list)
    doubts: list[BadFile] = dataclasses.field(default_factory=list)

    def wrong(self, line: int, key: str, problem: str, remedy: str) -> _Wrong:
        self.faults.append(BadFile(self.path, problem, remedy, line=line, key=key or None))
        return _WRONG

    def value(self, node: Node, hint: object, metadata: Metadata, key: str) -> object:
        origin, arguments = get_origin(hint), get_args(hint)
        if origin in {Union, types.UnionType}:
            if isinstance(node, Scalar) and node.absent:
                return None
            (hint,) = (argument for argument in arguments if argument is not types.NoneType)
            return self.value(node, hint, metadata, key)
        if origin is tuple:
            return self.listing(node, arguments, metadata, key)
        if isinstance(hint, type) and dataclasses.is_dataclass(hint):
            return self.section(node, hint, key)
        if not isinstance(node, Scalar):
            what = "a list" if isinstance(node, Listing) else "a section"
            return self.wrong(node.line, key, f"{what} is written where one value is needed", wanted(hint, metadata))
        if node.absent and hint is not bool:
            return self.wrong(node.line, key, "no value", f"{wanted(hint, metadata)}, or delete the line")
        if hint is bool:
            return self.truth(node, key)
        if hint is int or hint is float:
            return self.number(node, hint, metadata, key)
        choices = choices_of(hint, metadata)
        if choices and node.text not in choices:
            metadata = with_plugins(metadata)
            choices = choices_of(hint, metadata)
        if choices and node.text not in choices:
            return self.wrong(node.line, key, f"{node.text!r} is not a valid choice", wanted(hint, metadata))
        if isinstance(hint, type) and issubclass(hint, Path) and (problem := fault_of_path(node.text)):
            return self.wrong(node.line, key, problem, wanted(hint, metadata))
        if isinstance(hint, type) and issubclass(hint, (str, Path)):
            return hint(node.text)
        if get_origin(hint) is Literal:
            return node.text
        raise TypeError(f"{key}: files cannot hold a {hint!r}")

    def truth(self, node: Scalar, key: str) -> bool | _Wrong:
        word = node.text.lower()
        if word in {"true", "false"} and node.plain:
            return word == "true"
        if word in _WORDS_FOR_TRUTH:
            problem = f"{node.text!r} is a word, not a truth value"
        else:
            problem = f"{node.text!r} is neither true nor false" if node.text else "no value"
        return self.wrong(node.line, key, problem, "Write true or false, without quotes")

    def number(self, node: Scalar, kind: object, metadata: Metadata, key: str) -> float | _Wrong:
        text = node.text
        unit = metadata.get("unit") if kind is float else None
        is_angle = unit == "rad"
        angle = radians_of(text) if is_angle else None
        if _LAUNCHED.fullmatch(text):
            return self.wrong(node.line, key, f"{text} is a placeholder of a launch file", wanted(kind, metadata))
        if angle is None and not node.plain:
            return self.wrong(node.line, key, f"{text!r} in quotes is text, not a number", "Delete the quotes")
        if _NOT_FINITE.fullmatch(text):
            return self.wrong(node.line, key, f"{text} is not a finite number", wanted(kind, metadata))
        if _LEADING_ZERO.fullmatch(text):
            return self.wrong(node.line, key, f"{text} begins with 0, which can mean octal", "Delete the leading 0")
        if _COMMA.fullmatch(text):
            remedy = f"Write a point: {text.replace(',', '.')}" if kind is float else "Write the number without a comma"
            return self.wrong(node.line, key, f"{text!r} is not a number", remedy)
        if kind is int and not _WHOLE.fullmatch(text):
            what = "not a whole number" if _NUMBER.fullmatch(text) else "not a number"
            return self.wrong(node.line, key, f"{text!r} is {what}", wanted(kind, metadata))
        if angle is None and not _NUMBER.fullmatch(text):
            return self.wrong(node.line, key, f"{text!r} is not a number", wanted(kind, metadata))
        number = angle if angle is not None else int(text) if kind is int else float(text)
        minimum, maximum = bounds(metadata)
        if not minimum <= number <= maximum or not math.isfinite(number):
            return self.wrong(node.line, key, f"{text} is out of range", wanted(kind, metadata))
        in_doubt = doubt_about if is_angle and angle is None else doubt_about_rate if unit == "rad/s" else None
        if in_doubt is not None and (doubt := in_doubt(text, number)) is not None:
            self.doubts.append(BadFile(self.path, *doubt, line=node.line, key=key or None))
        return number

    def listing(self, node: Node, arguments: tuple[object, ...], metadata: Metadata, key: str) -> object:
        if isinstance(node, Scalar) and not node.plain and node.text.lstrip().startswith("["):
            # Parameters of ROS may have lists of lists as text.
            node = self.listing_in_text(node)
        if not isinstance(node, Listing):
            return self.wrong(node.line, key, "a list is needed", "Write [..., ...], or one line '- ...' for each item")
        if arguments[-1] is Ellipsis:
            hints = (arguments[0],) * len(node.items)
        elif len(node.items) == len(arguments):
            hints = arguments
        else:
            return self.wrong(
                node.line,
                key,
                f"{len(node.items)} values where {len(arguments)} are needed",
                f"Write {len(arguments)} values between [ and ]",
            )
        values = []
        each = metadata_of_items(metadata, hints)
        for index, (item, hint) in enumerate(zip(node.items, hints, strict=True)):
            place = f"{key}[{index}]"
            self.lines[place] = item.line
            values.append(self.value(item, hint, each[index], place))
        return _WRONG if _WRONG in values else tuple(values)

    def listing_in_text(self, node: Scalar) -> Node:
        try:
            return at_line(parse(self.path, node.text), node.line)
        except BadFile:
            return node

    def renamed(self, node: Section, into: type, key: str) -> Iterator[tuple[Scalar, Node]]:
        """Yield the entries of a section with present names. If both names are written, the old name is ignored."""
        written = {name.text for name, _ in node.entries}
        for name, child in node.entries:
            present = renamed_of(into).get(name.text)
            if present is None:
                yield name, child
            elif present not in written:
                yield dataclasses.replace(name, text=present), child
            else:
                place = f"{key}.{name.text}" if key else name.text
                notice = f"{place} has no effect here: it is an old name of {present}, which is also written"
                self.notices.append(f"{self.path}, line {name.line}: {notice}")

    def section(self, node: Node, into: type, key: str, defaults: "DataclassInstance | None" = None) -> object:
        if isinstance(node, Scalar) and node.absent:
            node = Section(node.line, [])
        if not isinstance(node, Section):
            return self.wrong(node.line, key, "a section of 'key: value' lines is needed", keys_of(into))
        node = _handed_down(node, into)
        hints = _hints_of(into)
        known = {field.name: field for field in dataclasses.fields(into)}
        listed = sections_named_in(into)
        named = _named(node, into, defaults)
        values: dict[str, object] = {}
        first_lines: dict[str, int] = {}
        # Fields that get their defaults from another field (`like`) are read after this other field.
        for name, child in sorted(
            self.renamed(node, into, key), key=lambda entry: model_of(known.get(entry[0].text)) is not None
        ):
            place = name.place or (f"{key}.{name.text}" if key else name.text)
            if name.text in first_lines:
                problem = f"this key is written twice, first in line {first_lines[name.text]}"
                self.wrong(name.line, place, problem, "Keep one of the two")
                continue
            first_lines[name.text] = name.line
            if name.text in ros_only_of(into):
                meaning = ros_only_of(into)[name.text]
                self.notices.append(f"{self.path}, line {name.line}: {place} has no effect here: {meaning}")
                continue
            if (listed and name.text == listed) or name.text in named:
                self.lines[place] = name.line
                continue
            if name.text not in known:
                if (decimals := _before_decimals(node, name, child)) is None:
                    self.unknown(name, child, place, into)
                else:
                    first, number = decimals
                    place = f"{key}.{first.text}" if key else first.text
                    problem = f"'{number.text},{name.text}' is not a number"
                    self.wrong(name.line, place, problem, f"Write a point: {number.text}.{name.text}")
                continue
            self.lines[place] = name.line
            field, hint = known[name.text], hints[name.text]
            if get_origin(hint) is Mapping and get_args(hint)[0] is str:
                values[name.text] = self.texts(child, place)
            elif get_origin(hint) is Mapping:
                model = model_of(field) or ""
                like = values.get(model, cast(object, getattr(defaults, model, None)))
                values[name.text] = self.numbered(child, get_args(hint)[1], place, like)
            else:
                own = field.default if defaults is None else cast(object, getattr(defaults, field.name))
                values[name.text] = self.field(child, hint, field, place, own)
        if listed and (listed in first_lines or any(name in first_lines for name in named)):
            values[listed] = self.named_sections(node, listed, named, get_args(hints[listed])[0], key)
        missing = [field for field in known.values() if required(field) and field.name not in first_lines]
        for field in missing:
            remedy = f"Add the line '{field.name}: ...'. {wanted(hints[field.name], field.metadata)} there"
            self.wrong(node.line, f"{key}.{field.name}" if key else field.name, "missing", remedy)
        if missing or _WRONG in values.values():
            return _WRONG
        return cast(object, into(**values) if defaults is None else dataclasses.replace(defaults, **values))

    def named_sections(
        self, node: Section, listed: str, named: Mapping[str, "DataclassInstance | None"], into: type, key: str
    ) -> object:
        """Return the sections that a text lists. If there is no text, return the default sections, as changed."""
        written = {name.text: child for name, child in node.entries}
        names = written.get(listed)
        place = f"{key}.{listed}" if key else listed
        if names is not None and not isinstance(names, Scalar):
            return self.wrong(names.line, place, "not a text", "Write names separated by blanks")
        values = []
        for name, default in named.items():
            child = written.get(name, Section(node.line, []))
            value = self.section(child, into, f"{key}.{name}" if key else name, default)
            values.append(
                value if value is _WRONG else dataclasses.replace(cast("DataclassInstance", value), name=name)
            )
        return _WRONG if _WRONG in values else tuple(values)

    def field(
        self, node: Node, hint: object, field: "dataclasses.Field[object]", place: str, default: object
    ) -> object:
        if dataclasses.is_dataclass(default) and not isinstance(default, type):
            return self.section(node, type(default), place, default)
        return self.value(node, hint, field.metadata, place)

    def numbered(self, node: Node, into: type, key: str, like: object) -> object:
        if isinstance(node, Scalar) and node.absent:
            return {}
        if not isinstance(node, Section):
            return self.wrong(node.line, key, "a section is needed", f"Write 'NUMBER: {{...}}' lines. {keys_of(into)}")
        values: dict[int, object] = {}
        for name, child in node.entries:
            place = f"{key}.{name.text}"
            if not _COUNTED.fullmatch(name.text):
                self.wrong(name.line, place, f"{name.text!r} is not a valid number", "Write a whole number, at least 1")
                values[0] = _WRONG
            elif int(name.text) in values:
                first = self.lines[place]
                self.wrong(name.line, place, f"this key is written twice, first in line {first}", "Keep one of the two")
            else:
                self.lines[place] = name.line
                # Faults of the section with the defaults were already reported; this section is read for its own
                # faults.
                defaults = cast("DataclassInstance", like) if isinstance(like, into) else None
                values[int(name.text)] = self.section(child, into, place, defaults)
        return _WRONG if _WRONG in values.values() else values

    def texts(self, node: Node, key: str) -> object:
        if isinstance(node, Scalar) and node.absent:
            return {}
        if not isinstance(node, Section):
            return self.wrong(node.line, key, "a section is needed", "Write 'NAME: TEXT' lines")
        values: dict[str, object] = {}
        for name, child in node.entries:
            place = f"{key}.{name.text}"
            if name.text in values:
                first = self.lines[place]
                self.wrong(name.line, place, f"this key is written twice, first in line {first}", "Keep one of the two")
            else:
                self.lines[place] = name.line
                values[name.text] = self.value(child, str, {}, place)
        return _WRONG if _WRONG in values.values() else values

    def unknown(self, name: Scalar, child: Node, place: str, into: type) -> None:
        names = [field.name for field in dataclasses.fields(into)]
        nearest = difflib.get_close_matches(name.text, names, n=1)
        elsewhere = [path for path in paths(self.root) if path.rpartition(".")[2] == name.text]
        if "." in name.text and not place.removesuffix(name.text) and name.text in paths(self.root):
            remedy = f"Write {_unfolded(name.text, child)}"
        elif nearest:
            remedy = f"The nearest name is {nearest[0]}"
        elif elsewhere:
            remedy = f"This key belongs at {' or '.join(elsewhere)}"
        else:
            remedy = keys_of(into)
        self.wrong(name.line, place, "unknown key", remedy)


def _before_decimals(node: Section, name: Scalar, child: Node) -> tuple[Scalar, Scalar] | None:
    """Return the entry before a key that is a decimal part, such as 2 in `{share: 0,2}`. Otherwise, return None."""
    if not (name.text.isdecimal() and isinstance(child, Scalar) and child.absent):
        return None
    at = next(index for index, entry in enumerate(node.entries) if entry[0] is name)
    key, value = node.entries[at - 1] if at else (name, child)
    return (key, value) if isinstance(value, Scalar) and _WHOLE.fullmatch(value.text) else None


def _unfolded(path: str, child: Node) -> str:
    """Return a path of keys as nested sections, with its value."""
    *sections, key = path.split(".")
    value = child.text if isinstance(child, Scalar) else "..."
    within = "".join(f"{{{name}: " for name in [*sections[1:], key])
    return f"{sections[0]}: {within}{value}{'}' * len(sections)}"


def words_in(node: Node) -> list[str]:
    """Return the words of a text, or of a list that is written instead of a text."""
    if isinstance(node, Listing):
        return [word for item in node.items for word in words_in(item)]
    return node.text.split() if isinstance(node, Scalar) else []


def _words(node: Section, key: str) -> list[str]:
    """Return the words in the text of a key of a section."""
    return [word for name, child in node.entries if name.text == key for word in words_in(child)]


def _named(node: Section, into: type, defaults: "DataclassInstance | None") -> Mapping[str, "DataclassInstance | None"]:
    """Return the names of the further sections listed in a section. Names of the default list have default sections."""
    listed = sections_named_in(into)
    if any(name.text == listed for name, _ in node.entries):
        return dict.fromkeys(_words(node, listed))
    sections = cast(tuple["DataclassInstance", ...], getattr(defaults, listed, ()))
    return {cast(str, getattr(section, "name")): section for section in sections}  # noqa: B009 - any class of them


def _handed_down(node: Section, into: type) -> Section:
    """Return the section with some entries moved to its parts, as in ROS. They replace the entries of the parts.

    If both the section and the part have a field of this name, and both values are written, the part's own value stays.
    A complete study in a recording has both values.
    """
    # costmap_2d does this with parameters of a costmap that its layers read (costmap_2d_ros.cpp, resetOldParameters).
    passed_on = cast(Mapping[str, str], getattr(into, "passed_on", {}))
    parts: dict[str, list[tuple[Scalar, Node]]] = {}
    gone: set[str] = set()
    for key, child in node.entries:
        if key.text not in passed_on:
            continue
        part, _, name = passed_on[key.text].partition(".")
        entries = parts.setdefault(part, [])
        entries.append((Scalar(name, plain=True, line=key.line), child))
        if name == sections_named_in(cast(type, _hints_of(into)[part])):
            named = _words(node, key.text)
            entries.extend(entry for entry in node.entries if entry[0].text in named)
            gone.update(named)
        if key.text not in {field.name for field in dataclasses.fields(into)}:
            gone.add(key.text)
    result = [entry for entry in node.entries if entry[0].text not in gone | set(parts)]
    for part, entries in parts.items():
        for key, own in [entry for entry in node.entries if entry[0].text == part]:
            if isinstance(own, Section):
                written = {entry[0].text for entry in own.entries}
                both = written & {field.name for field in dataclasses.fields(into)}
                entries[:] = [entry for entry in entries if entry[0].text not in both]
                handed = {entry[0].text for entry in entries}
                entries.extend(entry for entry in own.entries if entry[0].text not in handed)
            elif not (isinstance(own, Scalar) and own.absent):
                result.append((key, own))
        line = entries[0][0].line
        result.append((Scalar(part, plain=True, line=line), Section(line, entries)))
    return Section(node.line, result)
