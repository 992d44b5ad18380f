"""Positions in the text of a YAML file: values by their paths, ends of values, lines."""

import re
from collections.abc import Sequence

from thbridge.files.yaml.tree import Listing, Node, Scalar, Section

Step = str | int
"""A key of a section, or the index of an item."""

_STEP = re.compile(r'\[(\d+)\]|"([^"]*)"|([^.\[\]]+)')
_APART = re.compile(r"[.\[\]]")
_COLON = re.compile(r"[ ]*:")
_CLOSING = re.compile(r"(?:[\s,]|#[^\n]*)*[\]}]")


def steps_of(key: str) -> tuple[Step, ...]:
    """Return the steps of a path such as `things[0].name`; keys with dots are quoted: `within."dialogue.condition"`."""
    return tuple(int(index) if index else quoted or name for index, quoted, name in _STEP.findall(key))


def node_at(tree: Node, steps: Sequence[Step]) -> Node | None:
    """Return the node at a path, or None."""
    node: Node | None = tree
    for step in steps:
        node = None if node is None else _child(node, step)
    return node


def source_of(text: str, tree: Node, key: str) -> str | None:
    """Return the text of the value at a path, without comments after it, or None if the key is not in the file."""
    node = node_at(tree, steps_of(key))
    if node is None:
        return None
    return "" if left_out(node) else text[node.start : end_of(text, node)]


def path_of(steps: Sequence[Step]) -> str:
    """Return the path of some steps: the inverse of `steps_of`."""
    path = ""
    for step in steps:
        if isinstance(step, int):
            path += f"[{step}]"
        else:
            path += ("." if path else "") + (f'"{step}"' if _APART.search(step) else step)
    return path


def _child(node: Node, step: Step) -> Node | None:
    if isinstance(node, Section):
        return next((child for name, child in node.entries if name.text == str(step)), None)
    if isinstance(node, Listing) and isinstance(step, int) and step < len(node.items):
        return node.items[step]
    return None


def left_out(node: Node) -> bool:
    """Return True if no value is written at all, not even `null`."""
    return isinstance(node, Scalar) and node.plain and not node.text


def is_empty(node: Node) -> bool:
    """Return True if there is no value, or an empty section or list."""
    match node:
        case Scalar():
            return node.absent
        case Listing(items=items):
            return not items
        case Section(entries=entries):
            return not entries


def end_of(text: str, node: Node) -> int:
    """Return the offset of a value's end: after its last character or bracket."""
    if isinstance(node, Scalar):
        # The parser includes the empty lines after a text of several lines (|); these are left out.
        return node.start + len(text[node.start : node.end].rstrip("\r\n")) if node.end > node.start else node.end
    last: int = node.start + 1
    if isinstance(node, Section) and node.entries:
        name, value = node.entries[-1]
        last = behind_key(text, name) if left_out(value) else end_of(text, value)
    elif isinstance(node, Listing) and node.items:
        last = end_of(text, node.items[-1])
    if not node.flow:
        return last
    closing = _CLOSING.match(text, last)
    return last if closing is None else closing.end()


def line_start(text: str, at: int) -> int:
    """Return the offset of the beginning of a line."""
    return text.rfind("\n", 0, at) + 1


def line_end(text: str, at: int) -> int:
    """Return the offset of the end of a line, before its line end characters."""
    end = text.find("\n", at)
    end = len(text) if end < 0 else end
    return end - 1 if end > at and text[end - 1] == "\r" else end


def column_of(text: str, at: int) -> int:
    """Return the column of an offset, from 0."""
    return at - line_start(text, at)


def behind_key(text: str, name: Scalar) -> int:
    """Return the offset of a key's end, after the colon if there is one."""
    colon = _COLON.match(text, name.end)
    return name.end if colon is None else colon.end()
