"""YAML files that people write, read into dataclasses, with every fault of a file told at once.

A file is read twice over: `parse` turns its text into a tree in which each node knows its line, `load` turns that
tree into a dataclass. Plain words are read by the type that the dataclass wants at that place, not by YAML's guesses:
`no` is text where text is wanted, `1e3` is a number where a number is wanted, and neither is ever the other.
"""

import dataclasses
import difflib
import math
import re
import types
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Generic, Literal, TypeVar, Union, cast, get_args, get_origin, get_type_hints

from ruamel.yaml import YAML
from ruamel.yaml.error import MarkedYAMLError, YAMLError
from ruamel.yaml.events import (
    AliasEvent,
    DocumentStartEvent,
    MappingEndEvent,
    MappingStartEvent,
    NodeEvent,
    ScalarEvent,
    SequenceEndEvent,
    SequenceStartEvent,
)
from ruamel.yaml.reader import ReaderError

from thbridge.adapters.errors import BadFile, BadFiles

if TYPE_CHECKING:
    from _typeshed import DataclassInstance

T = TypeVar("T")

LARGEST_FILE = 1 << 20
"""Bytes; a file that people write is some thousand."""
DEEPEST = 32
"""Levels of nesting."""
LARGEST_TREE = 100_000
"""Values that a file may have once its aliases are followed."""

Metadata = Mapping[str, object]
NO_METADATA: Metadata = {}


@dataclass(frozen=True, slots=True)
class Scalar:
    """A word, number or text; `plain` when it stands without quotes, `tag` what stands before it (`!degrees`)."""

    text: str
    plain: bool
    line: int
    tag: str | None = None

    @property
    def absent(self) -> bool:
        """Whether nothing was written, or a word for nothing."""
        return self.plain and self.text in {"", "~", "null", "Null", "NULL"}


@dataclass(frozen=True, slots=True)
class Listing:
    """A sequence."""

    line: int
    items: list["Node"]


@dataclass(frozen=True, slots=True)
class Section:
    """A mapping, as written: a key may stand twice."""

    line: int
    entries: list[tuple[Scalar, "Node"]]


Node = Scalar | Listing | Section


@dataclass(frozen=True, slots=True)
class Loaded(Generic[T]):
    """What a file said, and where it said it.

    Attributes:
        path: the file.
        value: the dataclass.
        lines: line of each key and item that stands in the file, by its path (`robot.amcl.kld_err`, `rooms[2].goal`).
        notices: sentences about keys that are right but change nothing here.
    """

    path: Path
    value: T
    lines: Mapping[str, int]
    notices: tuple[str, ...] = ()

    def fault(self, key: str, problem: str, remedy: str) -> BadFile:
        """A fault of the value at this key path, found after loading; told at the nearest line that was written."""
        written = key
        while written and written not in self.lines:
            written = written[: max(written.rfind("."), written.rfind("["), 0)]
        return BadFile(self.path, self.lines.get(written), key, problem, remedy)


def read_text(path: Path, largest: int = LARGEST_FILE) -> str:
    """The text of a file that people write.

    Raises:
        BadFile: it is missing, not a file, larger than `largest` bytes, or not UTF-8.
    """
    try:
        with path.open("rb") as file:
            data = file.read(largest + 1)
    except FileNotFoundError:
        raise BadFile(path, None, None, "there is no such file", "Check the name and the folder") from None
    except OSError as error:
        raise BadFile(path, None, None, f"it cannot be read ({error.strerror})", "Check that it is a file") from None
    if len(data) > largest:
        raise BadFile(path, None, None, f"larger than {largest} bytes", "Check that it is the right file")
    try:
        return data.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        line = data.count(b"\n", 0, error.start) + 1
        problem = f"byte 0x{data[error.start]:02x} is not UTF-8"
        raise BadFile(path, line, None, problem, "Save the file with the encoding UTF-8") from None


def parse(path: Path, text: str, ros: bool = False) -> Node:
    """The tree of one YAML document; an empty text is an empty section.

    Args:
        path: the file, for faults.
        text: what it says.
        ros: accept what files written for ROS may have: aliases, each as the tree of its anchor, and tags of scalars.

    Raises:
        BadFile: it is not YAML, or uses what a plain list of settings does not need: anchors, tags, several documents.
    """
    _refuse_tabs(path, text)
    root: list[Node] = []
    stack: list[Listing | Section] = []
    pending_keys: list[Scalar | None] = []
    anchors = _Anchors(path)
    documents = 0
    try:
        for event in YAML(typ="safe", pure=True).parse(text):
            if isinstance(event, DocumentStartEvent):
                documents += 1
                if documents > 1:
                    line = event.start_mark.line + 1
                    raise BadFile(path, line, "---", "a second document begins", "Keep one document in a file")
            elif isinstance(event, (MappingEndEvent, SequenceEndEvent)):
                anchors.close(stack.pop())
                pending_keys.pop()
            elif isinstance(event, NodeEvent):
                alias = ros and isinstance(event, AliasEvent)
                node = anchors.node_of(event) if alias else _node(path, event, ros)
                if not alias:
                    anchors.open(event, node)
                if not stack:
                    root.append(node)
                elif isinstance(stack[-1], Listing):
                    stack[-1].items.append(node)
                elif (key := pending_keys[-1]) is not None:
                    # A value that was left out is marked where the next key begins, which is not where to mend it.
                    if isinstance(node, Scalar) and node.absent:
                        node = dataclasses.replace(node, line=key.line)
                    stack[-1].entries.append((key, node))
                    pending_keys[-1] = None
                elif isinstance(node, Scalar):
                    pending_keys[-1] = node
                else:
                    raise BadFile(path, node.line, None, "a list or section stands as a key", "Write a word as the key")
                if not isinstance(node, Scalar) and not alias:
                    stack.append(node)
                    pending_keys.append(None)
                if len(stack) > DEEPEST:
                    raise BadFile(path, node.line, None, f"nested deeper than {DEEPEST}", "Take brackets away")
    except MarkedYAMLError as error:
        mark = error.problem_mark or error.context_mark
        told = " ".join(part for part in (error.context, error.problem) if part)
        remedy = "Check the indentation, the colons and the brackets here and in the line before"
        raise BadFile(path, None if mark is None else mark.line + 1, None, f"not YAML: {told}", remedy) from None
    except ReaderError as error:
        line = text.count("\n", 0, error.position) + 1
        raise BadFile(path, line, None, "an invisible control character", "Delete it") from None
    except YAMLError as error:
        raise BadFile(path, None, None, f"not YAML: {error}", "Check the file") from None
    return root[0] if root else Section(1, [])


def _at_line(node: Node, line: int) -> Node:
    """The same tree, all of it at one line."""
    match node:
        case Listing(_, items):
            return Listing(line, [_at_line(item, line) for item in items])
        case Section(_, entries):
            return Section(line, [(_moved(key, line), _at_line(child, line)) for key, child in entries])
        case Scalar():
            return _moved(node, line)


def _moved(scalar: Scalar, line: int) -> Scalar:
    return dataclasses.replace(scalar, line=line)


def _refuse_tabs(path: Path, text: str) -> None:
    for number, line in enumerate(text.split("\n"), start=1):
        if "\t" in line[: len(line) - len(line.lstrip())]:
            raise BadFile(path, number, None, "a tab in the indentation", "Indent with blanks")


class _Anchors:
    """The anchors of a document, and how large it has become by their aliases."""

    def __init__(self, path: Path) -> None:
        self._path = path
        self._nodes: dict[str, tuple[Node, int]] = {}
        self._open: list[tuple[Node, str | None, int]] = []
        self._count = 0

    def open(self, event: NodeEvent, node: Node) -> None:
        """A node begins; a scalar is also complete."""
        self._count += 1
        self._open.append((node, None if event.anchor is None else str(event.anchor), self._count))
        if isinstance(node, Scalar):
            self.close(node)

    def close(self, node: Node) -> None:
        """The node that was opened last is complete."""
        _, anchor, before = self._open.pop()
        if anchor is not None:
            self._nodes[anchor] = node, self._count - before + 1

    def node_of(self, event: NodeEvent) -> Node:
        """The node that an alias stands for. Raises BadFile: there is none, or too many of them."""
        line, name = event.start_mark.line + 1, str(event.anchor)
        if name not in self._nodes:
            raise BadFile(self._path, line, name, "an alias (*) of nothing before it", "Write the value out")
        node, size = self._nodes[name]
        self._count += size
        if self._count > LARGEST_TREE:
            raise BadFile(self._path, line, name, f"more than {LARGEST_TREE} values by aliases (*)", "Write less")
        return node


def _node(path: Path, event: NodeEvent, ros: bool) -> Node:
    line = event.start_mark.line + 1
    if not ros and (isinstance(event, AliasEvent) or event.anchor is not None):
        raise BadFile(path, line, str(event.anchor), "an anchor or alias (& or *)", "Write the value out, or quote it")
    if not isinstance(event, (ScalarEvent, MappingStartEvent, SequenceStartEvent)):
        raise TypeError(f"an event of YAML that is no node: {event!r}")
    if event.tag is not None and not (ros and isinstance(event, ScalarEvent)):
        raise BadFile(path, line, str(event.tag), "a tag (!)", "Write the plain value, or quote it")
    if isinstance(event, ScalarEvent):
        return Scalar(event.value, event.style is None, line, None if event.tag is None else str(event.tag))
    return Section(line, []) if isinstance(event, MappingStartEvent) else Listing(line, [])


def load(path: Path, into: type[T]) -> Loaded[T]:
    """Read a YAML file into a dataclass whose fields are declared with `sim.parameters.knob` or plain.

    A section whose field has a section for its default takes what the file leaves out from there. The names in a
    class's `ros_only` are accepted, with a notice; those in its `renamed` stand for their present names.

    Fields may be bool, int, float, str, Literal, StrEnum, Path, tuples, dataclasses, and any of these or None. A field
    without a default must be in the file. A section that stands empty keeps its defaults. A field may also be a mapping
    from numbers counted from 1 to dataclasses; where its metadata have `like`, each of them takes what it leaves out
    from the field of that name.

    Raises:
        BadFiles: with every fault of the file; or one BadFile when it cannot be read at all.
    """
    return load_text(path, read_text(path), into)


def load_text(path: Path, text: str, into: type[T]) -> Loaded[T]:
    """As `load`, of a text that is at hand; `path` is what faults are told under."""
    return load_tree(path, parse(path, text), into)


def load_tree(path: Path, tree: Node, into: type[T], defaults: T | None = None) -> Loaded[T]:
    """As `load`, of what `parse` gave; what the file leaves out is taken from `defaults`, if there are any."""
    reader = _Reader(path, into)
    value = reader.section(tree, into, "", cast("DataclassInstance | None", defaults))
    if reader.faults:
        raise BadFiles(tuple(sorted(reader.faults, key=lambda fault: fault.line or 0)))
    return Loaded(path, cast(T, value), reader.lines, tuple(reader.notices))


def quoted(text: str) -> str:
    """A text in double quotes, so that it is read back as it is."""
    escaped = text.replace("\\", "\\\\").replace('"', '\\"')
    return '"' + "".join(sign if sign.isprintable() else f"\\U{ord(sign):08x}" for sign in escaped) + '"'


class _Wrong:
    """Stands for a value that could not be read; the fault is in the reader's list."""


_WRONG = _Wrong()
_WHOLE = re.compile(r"[-+]?\d{1,4000}")
_NUMBER = re.compile(r"[-+]?(\d+(\.\d*)?|\.\d+)([eE][-+]?\d{1,4})?")
_LEADING_ZERO = re.compile(r"[-+]?0\d+")
_COUNTED = re.compile(r"[1-9]\d{0,8}")
_NOT_FINITE = re.compile(r"[-+]?\.?(inf|infinity|nan)", re.IGNORECASE)
_WORDS_FOR_TRUTH = {"yes", "no", "on", "off", "y", "n"}


@dataclass(slots=True)
class _Reader:
    path: Path
    root: type
    faults: list[BadFile] = dataclasses.field(default_factory=list)
    lines: dict[str, int] = dataclasses.field(default_factory=dict)
    notices: list[str] = dataclasses.field(default_factory=list)

    def wrong(self, line: int, key: str, problem: str, remedy: str) -> _Wrong:
        self.faults.append(BadFile(self.path, line, key or None, problem, remedy))
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
            return self.wrong(node.line, key, f"{what} stands where one value is needed", _wanted(hint, metadata))
        if node.absent and hint is not bool:
            return self.wrong(node.line, key, "no value", f"{_wanted(hint, metadata)}, or delete the line")
        if hint is bool:
            return self.truth(node, key)
        if hint is int or hint is float:
            return self.number(node, hint, metadata, key)
        choices = choices_of(hint, metadata)
        if choices and node.text not in choices:
            return self.wrong(node.line, key, f"{node.text!r} is no choice here", _wanted(hint, metadata))
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
        text, wanted = node.text, _wanted(kind, metadata)
        if not node.plain:
            return self.wrong(node.line, key, f"{text!r} in quotes is text, not a number", "Take the quotes away")
        if _NOT_FINITE.fullmatch(text):
            return self.wrong(node.line, key, f"{text} is not a finite number", wanted)
        if _LEADING_ZERO.fullmatch(text):
            return self.wrong(
                node.line, key, f"{text} begins with 0 and reads as octal to some", "Take the leading 0 away"
            )
        if kind is int and not _WHOLE.fullmatch(text):
            what = "not a whole number" if _NUMBER.fullmatch(text) else "not a number"
            return self.wrong(node.line, key, f"{text!r} is {what}", wanted)
        if not _NUMBER.fullmatch(text):
            return self.wrong(node.line, key, f"{text!r} is not a number", wanted)
        number = int(text) if kind is int else float(text)
        minimum, maximum = _bounds(metadata)
        if not minimum <= number <= maximum or not math.isfinite(number):
            return self.wrong(node.line, key, f"{text} is out of range", wanted)
        return number

    def listing(self, node: Node, arguments: tuple[object, ...], metadata: Metadata, key: str) -> object:
        if isinstance(node, Scalar) and not node.plain and node.text.lstrip().startswith("["):
            # ROS's parameters hold lists of lists as text.
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
        for index, (item, hint) in enumerate(zip(node.items, hints, strict=True)):
            place = f"{key}[{index}]"
            self.lines[place] = item.line
            values.append(self.value(item, hint, metadata, place))
        return _WRONG if _WRONG in values else tuple(values)

    def listing_in_text(self, node: Scalar) -> Node:
        try:
            return _at_line(parse(self.path, node.text), node.line)
        except BadFile:
            return node

    def renamed(self, node: Section, into: type, key: str) -> Iterator[tuple[Scalar, Node]]:
        """The entries of a section under their present names; an old name beside the present one is left out."""
        written = {name.text for name, _ in node.entries}
        for name, child in node.entries:
            present = renamed_of(into).get(name.text)
            if present is None:
                yield name, child
            elif present not in written:
                yield dataclasses.replace(name, text=present), child
            else:
                place = f"{key}.{name.text}" if key else name.text
                told = f"{place} has no effect here: it is an old name of {present}, which stands there, too"
                self.notices.append(f"{self.path}, line {name.line}: {told}")

    def section(self, node: Node, into: type, key: str, defaults: "DataclassInstance | None" = None) -> object:
        if isinstance(node, Scalar) and node.absent:
            node = Section(node.line, [])
        if not isinstance(node, Section):
            return self.wrong(node.line, key, "a section of 'key: value' lines is needed", _keys_of(into))
        node = _handed_down(node, into)
        hints = cast(Mapping[str, object], get_type_hints(into))
        known = {knob.name: knob for knob in dataclasses.fields(into)}
        listed = sections_named_in(into)
        named = _named(node, into, defaults)
        values: dict[str, object] = {}
        first_lines: dict[str, int] = {}
        # What is like another field can only be read after it.
        for name, child in sorted(
            self.renamed(node, into, key), key=lambda entry: _model(known.get(entry[0].text)) is not None
        ):
            place = f"{key}.{name.text}" if key else name.text
            if name.text in first_lines:
                self.wrong(
                    name.line, place, f"stands twice, first in line {first_lines[name.text]}", "Keep one of the two"
                )
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
                self.unknown(name, place, into)
                continue
            self.lines[place] = name.line
            knob, hint = known[name.text], hints[name.text]
            if get_origin(hint) is Mapping:
                model = _model(knob) or ""
                like = values.get(model, cast(object, getattr(defaults, model, None)))
                values[name.text] = self.numbered(child, get_args(hint)[1], place, like)
            else:
                own = knob.default if defaults is None else cast(object, getattr(defaults, knob.name))
                values[name.text] = self.field(child, hint, knob, place, own)
        if listed and (listed in first_lines or any(name in first_lines for name in named)):
            values[listed] = self.named_sections(node, listed, named, get_args(hints[listed])[0], key)
        missing = [knob for knob in known.values() if _required(knob) and knob.name not in first_lines]
        for knob in missing:
            remedy = f"Add the line '{knob.name}: ...'. {_wanted(hints[knob.name], knob.metadata)} there"
            self.wrong(node.line, f"{key}.{knob.name}" if key else knob.name, "missing", remedy)
        if missing or _WRONG in values.values():
            return _WRONG
        return cast(object, into(**values) if defaults is None else dataclasses.replace(defaults, **values))

    def named_sections(
        self, node: Section, listed: str, named: Mapping[str, "DataclassInstance | None"], into: type, key: str
    ) -> object:
        """The sections whose names a text lists, or that are there by default; one that is not written is as it was."""
        written = {name.text: child for name, child in node.entries}
        names = written.get(listed)
        place = f"{key}.{listed}" if key else listed
        if names is not None and not isinstance(names, Scalar):
            return self.wrong(names.line, place, "no text", "Write names with blanks between")
        values = []
        for name, default in named.items():
            child = written.get(name, Section(node.line, []))
            value = self.section(child, into, f"{key}.{name}" if key else name, default)
            values.append(
                value if value is _WRONG else dataclasses.replace(cast("DataclassInstance", value), name=name)
            )
        return _WRONG if _WRONG in values else tuple(values)

    def field(self, node: Node, hint: object, knob: "dataclasses.Field[object]", place: str, default: object) -> object:
        if dataclasses.is_dataclass(default) and not isinstance(default, type):
            return self.section(node, type(default), place, default)
        return self.value(node, hint, knob.metadata, place)

    def numbered(self, node: Node, into: type, key: str, like: object) -> object:
        if isinstance(node, Scalar) and node.absent:
            return {}
        if not isinstance(node, Section):
            return self.wrong(node.line, key, "a section is needed", f"Write 'NUMBER: {{...}}' lines. {_keys_of(into)}")
        values: dict[int, object] = {}
        for name, child in node.entries:
            place = f"{key}.{name.text}"
            if not _COUNTED.fullmatch(name.text):
                self.wrong(name.line, place, f"{name.text!r} is no number here", "Write a whole number, at least 1")
                values[0] = _WRONG
            elif int(name.text) in values:
                first = self.lines[place]
                self.wrong(name.line, place, f"stands twice, first in line {first}", "Keep one of the two")
            else:
                self.lines[place] = name.line
                # Where the section it is like is wrong, that has been told; this one is read for its own faults.
                defaults = cast("DataclassInstance", like) if isinstance(like, into) else None
                values[int(name.text)] = self.section(child, into, place, defaults)
        return _WRONG if _WRONG in values.values() else values

    def unknown(self, name: Scalar, place: str, into: type) -> None:
        names = [knob.name for knob in dataclasses.fields(into)]
        nearest = difflib.get_close_matches(name.text, names, n=1)
        elsewhere = [path for path in _paths(self.root) if path.rpartition(".")[2] == name.text]
        if nearest:
            remedy = f"The nearest right name is {nearest[0]}"
        elif elsewhere:
            remedy = f"It belongs at {' or '.join(elsewhere)}"
        else:
            remedy = _keys_of(into)
        self.wrong(name.line, place, "unknown key", remedy)


def renamed_of(section: type) -> Mapping[str, str]:
    """The old names of parameters that a class still accepts, each with its present one."""
    return cast(Mapping[str, str], getattr(section, "renamed", {}))


def ros_only_of(section: type) -> Mapping[str, str]:
    """The names that a class of parameters accepts because ROS knows them, each with what it does there."""
    return cast(Mapping[str, str], getattr(section, "ros_only", {}))


def _model(knob: "dataclasses.Field[object] | None") -> str | None:
    """The name of the field that this one's entries take their defaults from."""
    return None if knob is None else cast("str | None", knob.metadata.get("like"))


def sections_named_in(section: type) -> str:
    """The field of a class of parameters in which files name further sections; empty when it has none."""
    return cast(str, getattr(section, "sections_named_in", ""))


def _words(node: Section, key: str) -> list[str]:
    """The words of the text that a section has under this key."""
    texts = [child.text for name, child in node.entries if name.text == key and isinstance(child, Scalar)]
    return [word for text in texts for word in text.split()]


def _named(node: Section, into: type, defaults: "DataclassInstance | None") -> Mapping[str, "DataclassInstance | None"]:
    """The names of a section's further sections, with their defaults where the names themselves are by default."""
    listed = sections_named_in(into)
    if any(name.text == listed for name, _ in node.entries):
        return dict.fromkeys(_words(node, listed))
    sections = cast(tuple["DataclassInstance", ...], getattr(defaults, listed, ()))
    return {cast(str, getattr(section, "name")): section for section in sections}  # noqa: B009 - any class of them


def _handed_down(node: Section, into: type) -> Section:
    """The section with those entries standing in its parts that ROS hands down to them, in place of the parts' own."""
    passed_on = cast(Mapping[str, str], getattr(into, "passed_on", {}))
    parts: dict[str, list[tuple[Scalar, Node]]] = {}
    gone: set[str] = set()
    for key, child in node.entries:
        if key.text not in passed_on:
            continue
        part, _, name = passed_on[key.text].partition(".")
        entries = parts.setdefault(part, [])
        entries.append((Scalar(name, plain=True, line=key.line), child))
        if name == sections_named_in(cast(type, get_type_hints(into)[part])):
            named = _words(node, key.text)
            entries.extend(entry for entry in node.entries if entry[0].text in named)
            gone.update(named)
        if key.text not in {knob.name for knob in dataclasses.fields(into)}:
            gone.add(key.text)
    result = [entry for entry in node.entries if entry[0].text not in gone | set(parts)]
    for part, entries in parts.items():
        for key, own in [entry for entry in node.entries if entry[0].text == part]:
            handed = {entry[0].text for entry in entries}
            if isinstance(own, Section):
                entries.extend(entry for entry in own.entries if entry[0].text not in handed)
            elif not (isinstance(own, Scalar) and own.absent):
                result.append((key, own))
        line = entries[0][0].line
        result.append((Scalar(part, plain=True, line=line), Section(line, entries)))
    return Section(node.line, result)


def _required(knob: "dataclasses.Field[object]") -> bool:
    return knob.default is dataclasses.MISSING and knob.default_factory is dataclasses.MISSING


def _bounds(metadata: Metadata) -> tuple[float, float]:
    minimum = cast("float | None", metadata.get("minimum"))
    maximum = cast("float | None", metadata.get("maximum"))
    return (-math.inf if minimum is None else minimum), (math.inf if maximum is None else maximum)


def choices_of(hint: object, metadata: Metadata) -> tuple[str, ...]:
    """The words a field may hold; empty when free."""
    if get_origin(hint) is Literal:
        return cast(tuple[str, ...], get_args(hint))
    if isinstance(hint, type) and issubclass(hint, StrEnum):
        return tuple(member.value for member in hint)
    return cast(tuple[str, ...], metadata.get("choices", ()))


def allowed(hint: object, metadata: Metadata) -> str:
    """A field's choices, or its range and unit: `amcl, ekf or truth`, `0 to 20 m/s`, `at least 1`; empty when free."""
    choices = choices_of(hint, metadata)
    if choices:
        return " or ".join([", ".join(choices[:-1]), choices[-1]] if choices[1:] else choices)
    minimum, maximum = _bounds(metadata)
    if math.isfinite(minimum) and math.isfinite(maximum):
        words = f"{minimum:.10g} to {maximum:.10g}"
    elif math.isfinite(minimum):
        words = f"at least {minimum:.10g}"
    elif math.isfinite(maximum):
        words = f"at most {maximum:.10g}"
    else:
        words = ""
    return f"{words} {metadata.get('unit', '')}".strip()


_KINDS: Mapping[object, str] = {
    bool: "true or false",
    int: "a whole number",
    float: "a number",
    str: "text",
    Path: "a path",
}


def _wanted(hint: object, metadata: Metadata) -> str:
    words = allowed(hint, metadata)
    if choices_of(hint, metadata):
        return f"Write {words}"
    kind = _KINDS.get(hint, "a list" if get_origin(hint) is tuple else "a section")
    return f"Write {kind}, {words}" if words else f"Write {kind}"


def _keys_of(into: type) -> str:
    return f"Its keys are {', '.join(knob.name for knob in dataclasses.fields(into))}"


def _paths(into: type, key: str = "") -> Iterator[str]:
    """Key paths of a dataclass and of those inside it."""
    for name, hint in get_type_hints(into).items():
        place = f"{key}.{name}" if key else name
        yield place
        if isinstance(hint, type) and dataclasses.is_dataclass(hint):
            yield from _paths(hint, place)
