"""The tree of a YAML file as it is written: nodes have line numbers, and words are not interpreted."""

import dataclasses
import re
from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import lru_cache
from pathlib import Path
from typing import cast

import yaml
from yaml import (
    AliasEvent,
    DocumentStartEvent,
    MappingEndEvent,
    MappingStartEvent,
    NodeEvent,
    ScalarEvent,
    SequenceEndEvent,
    SequenceStartEvent,
)
from yaml.error import MarkedYAMLError, YAMLError
from yaml.reader import ReaderError

from thbridge.files.errors import BadFile

DEEPEST = 32
"""Largest depth of nesting."""
LARGEST_TREE = 100_000
"""Maximum number of values of a file, with its aliases expanded."""
_BREAK = re.compile("[\\x85\\u2028\\u2029]")
KEPT_TREES, KEPT_LETTERS = 256, 20_000
"""Number of trees that are kept, and length of the longest text of a kept tree. Our own files are short, and each study
reads them."""


@dataclass(frozen=True, slots=True)
class Scalar:
    """A word, number or text. `plain` is True if it has no quotes; `tag` is a word before it, such as `!degrees`.

    `start` and `end` are its offsets in the text, including quotes. For a value that was left out, both are equal.
    If a key was moved within the tree, `place` is the path that people wrote, for messages.
    """

    text: str
    plain: bool
    line: int
    tag: str | None = None
    start: int = field(default=0, compare=False)
    end: int = field(default=0, compare=False)
    place: str = field(default="", compare=False)

    @property
    def absent(self) -> bool:
        """True if no value is written, or if the value is a word for null."""
        return self.plain and self.text in {"", "~", "null", "Null", "NULL"}


@dataclass(frozen=True, slots=True)
class Listing:
    """A sequence; `start` is its offset in the text, `flow` is True if it is written in brackets."""

    line: int
    items: Sequence["Node"]
    start: int = field(default=0, compare=False)
    flow: bool = field(default=False, compare=False)


@dataclass(frozen=True, slots=True)
class Section:
    """A mapping as it is written, with duplicate keys. `start` and `flow` are as for a Listing."""

    line: int
    entries: Sequence[tuple[Scalar, "Node"]]
    start: int = field(default=0, compare=False)
    flow: bool = field(default=False, compare=False)


Node = Scalar | Listing | Section


def parse(path: Path, text: str, ros: bool = False) -> Node:
    """Return the tree of one YAML document; an empty text gives an empty section.

    A study with many conditions reads the same texts many times, so trees are kept.

    Args:
        path: the file, for faults.
        text: the text of the file.
        ros: True to accept aliases, each as the tree of its anchor, and tags of scalars, as in files for ROS.

    Raises:
        BadFile: the text is not YAML, or has anchors, tags or several documents, which settings do not need.
    """
    source = _Source(text, ros, path)
    return _kept_tree(source) if len(text) <= KEPT_LETTERS else _tree_of(source)


@dataclass(frozen=True, slots=True)
class _Source:
    """Text of a tree, with the file that faults name."""

    text: str
    ros: bool
    path: Path = field(compare=False)


@lru_cache(KEPT_TREES)
def _kept_tree(source: _Source) -> Node:
    return _tree_of(source)


def _tree_of(source: _Source) -> Node:
    path, text, ros = source.path, source.text, source.ros
    _refuse_breaks(path, text)
    _refuse_odd_blanks(path, text)
    root: list[Node] = []
    # These lists are only extended here, while a tree is built.
    stack: list[Listing | Section] = []
    pending_keys: list[Scalar | None] = []
    anchors = _Anchors(path)
    documents = 0
    try:
        for event in yaml.parse(text, Loader=yaml.CBaseLoader):
            if isinstance(event, DocumentStartEvent):
                documents += 1
                if documents > 1:
                    line = event.start_mark.line + 1
                    raise BadFile(path, "a second document begins", "Keep one document in a file", line=line, key="---")
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
                    cast("list[Node]", stack[-1].items).append(node)
                elif (key := pending_keys[-1]) is not None:
                    # The parser gives a left-out value the line of the next key; the line of its own key is better.
                    if isinstance(node, Scalar) and node.absent:
                        node = dataclasses.replace(node, line=key.line)
                    cast("list[tuple[Scalar, Node]]", stack[-1].entries).append((key, node))
                    pending_keys[-1] = None
                elif isinstance(node, Scalar):
                    pending_keys[-1] = node
                else:
                    raise BadFile(path, "a list or section is used as a key", "Write a word as the key", line=node.line)
                if not isinstance(node, Scalar) and not alias:
                    stack.append(node)
                    pending_keys.append(None)
                if len(stack) > DEEPEST:
                    raise BadFile(path, f"nested deeper than {DEEPEST} levels", "Remove brackets", line=node.line)
    except MarkedYAMLError as error:
        mark = error.problem_mark or error.context_mark
        problem = " ".join(part for part in (error.context, error.problem) if part)
        remedy = "Check the indentation, the colons and the brackets here and in the line before"
        # The parser reports an unclosed bracket or quote after the last line.
        line = None if mark is None else min(mark.line, text.rstrip().count("\n")) + 1
        raise BadFile(path, f"not YAML: {problem}", remedy, line=line) from None
    except ReaderError as error:
        # The position is counted in bytes of UTF-8.
        line = text.encode()[: error.position].count(b"\n") + 1
        raise BadFile(path, "this line has an invisible control character", "Delete it", line=line) from None
    except YAMLError as error:
        raise BadFile(path, f"not YAML: {error}", "Check the file") from None
    return root[0] if root else Section(1, [])


def at_line(node: Node, line: int) -> Node:
    """Return the same tree, but with this line number for all nodes."""
    match node:
        case Listing(_, items):
            return Listing(line, [at_line(item, line) for item in items])
        case Section(_, entries):
            return Section(line, [(_moved(key, line), at_line(child, line)) for key, child in entries])
        case Scalar():
            return _moved(node, line)


def _moved(scalar: Scalar, line: int) -> Scalar:
    return dataclasses.replace(scalar, line=line)


def _refuse_breaks(path: Path, text: str) -> None:
    """Refuse characters that end a line in YAML 1.1, but not in editors and in YAML 1.2."""
    if found := _BREAK.search(text):
        line = text.count("\n", 0, found.start()) + 1
        raise BadFile(path, "this line has an invisible line separator", "Delete it", line=line)


def _refuse_odd_blanks(path: Path, text: str) -> None:
    """Refuse indentation that only looks like blanks: tabs, and no-break spaces copied from web pages."""
    for number, line in enumerate(text.split("\n"), start=1):
        indent = line[: len(line) - len(line.lstrip())]
        what = "a tab" if "\t" in indent else "a no-break space" if indent.strip(" \r\ufeff") else ""
        if what:
            raise BadFile(path, f"{what} in the indentation", "Indent with blanks", line=number)


class _Anchors:
    """Anchors of a document, and its number of values with aliases expanded."""

    def __init__(self, path: Path) -> None:
        self._path = path
        self._nodes: dict[str, tuple[Node, int]] = {}
        self._open: list[tuple[Node, str | None, int]] = []
        self._count = 0

    def open(self, event: NodeEvent, node: Node) -> None:
        """Process the beginning of a node. For a scalar, this is also the end."""
        self._count += 1
        self._open.append((node, None if event.anchor is None else str(event.anchor), self._count))
        if isinstance(node, Scalar):
            self.close(node)

    def close(self, node: Node) -> None:
        """Process the end of the node that was opened last."""
        _, anchor, before = self._open.pop()
        if anchor is not None:
            self._nodes[anchor] = node, self._count - before + 1

    def node_of(self, event: NodeEvent) -> Node:
        """Return the node of an alias. Raises BadFile if the anchor does not exist, or the document gets too large."""
        line, name = event.start_mark.line + 1, str(event.anchor)
        if name not in self._nodes:
            raise BadFile(self._path, "this alias (*) has no anchor", "Write the value itself", line=line, key=name)
        node, size = self._nodes[name]
        self._count += size
        if self._count > LARGEST_TREE:
            raise BadFile(
                self._path,
                f"more than {LARGEST_TREE} values through aliases (*)",
                "Use fewer aliases",
                line=line,
                key=name,
            )
        return node


def _node(path: Path, event: NodeEvent, ros: bool) -> Node:
    line = event.start_mark.line + 1
    if not ros and (isinstance(event, AliasEvent) or event.anchor is not None):
        problem = "anchors and aliases (& and *) are not allowed here"
        raise BadFile(path, problem, "Write the value itself, or quote it", line=line, key=str(event.anchor))
    if not isinstance(event, (ScalarEvent, MappingStartEvent, SequenceStartEvent)):
        raise TypeError(f"an event of YAML that is not a node: {event!r}")
    if event.tag is not None and not (ros and isinstance(event, ScalarEvent)):
        problem = "tags (!) are not allowed here"
        raise BadFile(path, problem, "Write the plain value, or quote it", line=line, key=str(event.tag))
    start = event.start_mark.index
    if isinstance(event, ScalarEvent):
        tag = None if event.tag is None else str(event.tag)
        return Scalar(event.value, not event.style, line, tag, start, event.end_mark.index)
    flow = bool(event.flow_style)
    return Section(line, [], start, flow) if isinstance(event, MappingStartEvent) else Listing(line, [], start, flow)


def quoted(text: str) -> str:
    """Return a text in double quotes, with escapes, so that it is read back unchanged."""
    escaped = text.replace("\\", "\\\\").replace('"', '\\"')
    return '"' + "".join(sign if sign.isprintable() else f"\\U{ord(sign):08x}" for sign in escaped) + '"'
