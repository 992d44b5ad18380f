"""Where things lie in the text of a YAML file: values by their paths, their ends, the lines around them."""

import re
from collections.abc import Sequence

from thbridge.files.yaml.tree import Listing, Node, Scalar, Section

Step = str | int
"""A key of a section, or the index of an item."""

_STEP = re.compile(r"\[(\d+)\]|([^.\[\]]+)")
_COLON = re.compile(r"[ ]*:")
_CLOSING = re.compile(r"(?:[\s,]|#[^\n]*)*[\]}]")


def steps_of(key: str) -> tuple[Step, ...]:
    """A path such as `things[0].name`, taken apart."""
    return tuple(int(index) if index else name for index, name in _STEP.findall(key))


def node_at(tree: Node, steps: Sequence[Step]) -> Node | None:
    """What stands at a path; None where nothing does."""
    node: Node | None = tree
    for step in steps:
        node = None if node is None else _child(node, step)
    return node


def source_of(text: str, tree: Node, key: str) -> str | None:
    """The value at a path as it is written, without comments behind it; None where the key is not written."""
    node = node_at(tree, steps_of(key))
    if node is None:
        return None
    return "" if left_out(node) else text[node.start : end_of(text, node)]


def path_of(steps: Sequence[Step]) -> str:
    """A path written together, as `steps_of` takes it apart."""
    path = ""
    for step in steps:
        path += f"[{step}]" if isinstance(step, int) else f".{step}" if path else step
    return path


def _child(node: Node, step: Step) -> Node | None:
    if isinstance(node, Section):
        return next((child for name, child in node.entries if name.text == str(step)), None)
    if isinstance(node, Listing) and isinstance(step, int) and step < len(node.items):
        return node.items[step]
    return None


def left_out(node: Node) -> bool:
    """Whether nothing stands there at all, not even `null`."""
    return isinstance(node, Scalar) and node.plain and not node.text


def is_empty(node: Node) -> bool:
    """Whether there is no value, or an empty section or list."""
    match node:
        case Scalar():
            return node.absent
        case Listing(items=items):
            return not items
        case Section(entries=entries):
            return not entries


def end_of(text: str, node: Node) -> int:
    """Where a value ends: behind its last sign or bracket."""
    if isinstance(node, Scalar):
        # A text in several lines (|) takes the empty lines behind it along.
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
    """Where the line begins."""
    return text.rfind("\n", 0, at) + 1


def line_end(text: str, at: int) -> int:
    """Where the line ends, before the sign or signs that end it."""
    end = text.find("\n", at)
    end = len(text) if end < 0 else end
    return end - 1 if end > at and text[end - 1] == "\r" else end


def column_of(text: str, at: int) -> int:
    """How far from the beginning of its line a place is."""
    return at - line_start(text, at)


def behind_key(text: str, name: Scalar) -> int:
    """Where a key ends: behind its colon, if it has one."""
    colon = _COLON.match(text, name.end)
    return name.end if colon is None else colon.end()
