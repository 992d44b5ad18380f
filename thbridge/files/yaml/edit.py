"""Changes of single values in the text of a YAML file, without changing any other byte.

The file's tree gives the position of a change. New lines use the file's own indentation. Afterwards the new text
is parsed again. The new text must have the same values as the old text, except for the changed value. If a file is
written in a way that this module does not handle, the change is refused and nothing is lost.
"""

import re
from collections.abc import Callable, Sequence
from enum import StrEnum
from pathlib import Path

from thbridge.files.errors import BadFile
from thbridge.files.yaml.places import (
    Step,
    behind_key,
    column_of,
    end_of,
    is_empty,
    left_out,
    line_end,
    line_start,
    node_at,
    path_of,
    steps_of,
)
from thbridge.files.yaml.tree import Listing, Node, Scalar, Section, parse, quoted
from thbridge.hunt.refusals import RequestRefused

Names = Callable[[str], Sequence[str]]
"""Function that returns the keys of a section, given its path, in the order in which a file should have them."""

_COMMENT_BEHIND = re.compile(r"[ ]*(#[^\r\n]*)?")
_PLAIN_KEY = re.compile(r"[A-Za-z0-9_][A-Za-z0-9_/.-]*")
_SCRATCH = Path("text")
_INDENT = 2


class EditRefusalReason(StrEnum):
    """Reason for refusing a change."""

    NOT_YAML = "not-yaml"
    NOT_UNDERSTOOD = "not-understood"


def with_value(
    text: str, key: str, value: str, names: Names = lambda _: (), tree: Node | None = None
) -> str | RequestRefused:
    """Return the text with another value at a path; missing sections are added.

    Args:
        text: the text of the file.
        key: the path, such as `robot.amcl.kld_err` or `things[0].name`.
        value: the value as YAML on one line, such as `0.05`, `"two words"`, `[1, 2]`.
        names: the order of keys, for the position of a new key. By default, a new key is the last.
        tree: the result of `parse` for the text, if it is known.
    """
    tree = parse(_SCRATCH, text) if tree is None else tree
    steps = steps_of(key)
    try:
        wanted = _with_changed(tree, steps, parse(_SCRATCH, value))
    except BadFile as fault:
        return RequestRefused(EditRefusalReason.NOT_YAML, f"{value!r} cannot be read: {fault.problem}. {fault.remedy}.")
    return _verified(_Edit(text, tree, names).put(steps, value), wanted, steps)


def without(text: str, key: str, tree: Node | None = None) -> str | RequestRefused:
    """Return the text without a key or an item, and without sections that become empty.

    A comment after the value is kept on a separate line.
    """
    tree = parse(_SCRATCH, text) if tree is None else tree
    steps = steps_of(key)
    if node_at(tree, steps) is None:
        return text
    return _verified(_Edit(text, tree, lambda _: ()).drop(steps), _with_dropped(tree, steps), steps)


def moved(text: str, key: str, by: int, tree: Node | None = None) -> str | RequestRefused:
    """Return the text with an item of a list moved one position later (`by` is 1) or earlier (-1), with its comments.

    If there is no such position, nothing is changed.
    """
    tree = parse(_SCRATCH, text) if tree is None else tree
    *above, index = steps_of(key)
    listing = node_at(tree, above)
    if not isinstance(listing, Listing) or not isinstance(index, int) or not 0 <= index + by < len(listing.items):
        return text
    first = min(index, index + by)
    items = list(listing.items)
    items[first], items[first + 1] = items[first + 1], items[first]
    wanted = _with_changed(tree, tuple(above), Listing(listing.line, items))
    return _verified(_Edit(text, tree, lambda _: ()).swap(listing, first), wanted, tuple(above))


class _Edit:
    """One change to one text."""

    def __init__(self, text: str, tree: Node, names: Names) -> None:
        self._text = text
        self._tree = tree
        self._names = names
        self._newline = "\r\n" if "\r\n" in text else "\n"

    def put(self, steps: Sequence[Step], value: str) -> str:
        known = 0
        while known < len(steps) and node_at(self._tree, steps[: known + 1]) is not None:
            known += 1
        node = node_at(self._tree, steps[:known])
        if node is None:
            return self._text
        if known == len(steps):
            return self._replaced(steps, node, value)
        if is_empty(node) and not (known == 0 and isinstance(node, Section)):
            return self._filled(steps, known, node, value)
        return self._added(steps, known, node, value)

    def _replaced(self, steps: Sequence[Step], node: Node, value: str) -> str:
        text, end = self._text, end_of(self._text, node)
        if left_out(node) or (not isinstance(node, Scalar) and not node.flow):
            # The value goes after the colon, before a comment on this line.
            behind = self._behind_name(steps)
            between = "" if left_out(node) else text[behind : node.start].rstrip()
            return text[:behind] + " " + value + between + text[behind if left_out(node) else end :]
        return text[: node.start] + value + text[end:]

    def _filled(self, steps: Sequence[Step], known: int, node: Node, value: str) -> str:
        """Return the text with the value in an empty section or list: `game:`, `game: null` or `each: {}`."""
        text = self._text
        if self._inside_flow(steps[:known]) or not isinstance(steps[known - 1], str):
            return self._replaced(steps[:known], node, self._flow(steps[known:], value, bare=False))
        behind = self._behind_name(steps[:known])
        end = behind if left_out(node) else end_of(text, node)
        at = line_end(text, end)
        column = self._column_of_name(steps[:known]) + _INDENT
        added = self._newline.join(self._block(steps[known:], value, column))
        return text[:behind] + text[end:at] + self._newline + added + text[at:]

    def _added(self, steps: Sequence[Step], known: int, node: Node, value: str) -> str:
        """Return the text with the value inserted after the keys that must precede it."""
        text = self._text
        if isinstance(node, Scalar):
            return text
        neighbour = self._neighbour(node, steps, known)
        if not isinstance(node, Section):
            ends = [end_of(text, item) for item in node.items]
            end = ends[-1] if ends else node.start + 1
        else:
            end = self._end_of_entry(node.entries[neighbour]) if node.entries else 0
        if node.flow:
            # A comma directly after a colon would be part of the word.
            comma = " , " if text[end - 1] == ":" else ", "
            return text[:end] + comma + self._flow(steps[known:], value, bare=True) + text[end:]
        if not (node.entries if isinstance(node, Section) else node.items):
            # The file has no value yet.
            lines = self._newline.join(self._block(steps[known:], value, 0))
            gap = "" if not text or text.endswith("\n") else self._newline
            return text + gap + lines + self._newline
        at = line_end(text, end)
        added = self._newline.join(self._block(steps[known:], value, column_of(text, node.start)))
        return text[:at] + self._newline + added + text[at:]

    def _neighbour(self, node: Node, steps: Sequence[Step], known: int) -> int:
        """Return the index of the entry after which a new entry belongs in a section."""
        if not isinstance(node, Section):
            return -1
        names = list(self._names(path_of(steps[:known])))
        before = names[: names.index(str(steps[known]))] if str(steps[known]) in names else []
        found = [index for index, (name, _) in enumerate(node.entries) if name.text in before]
        return found[-1] if found else len(node.entries) - 1

    def _block(self, steps: Sequence[Step], value: str, column: int) -> list[str]:
        """Return lines of nested keys, with the value in the last line."""
        lines = []
        for depth, step in enumerate(steps):
            prefix = "-" if isinstance(step, int) else f"{_key(step)}:"
            last = f" {value}" if depth == len(steps) - 1 else ""
            lines.append(" " * (column + _INDENT * depth) + prefix + last)
        return lines

    def _flow(self, steps: Sequence[Step], value: str, bare: bool) -> str:
        """Return nested keys on one line; if `bare`, without the outermost brackets."""
        for depth, step in reversed(list(enumerate(steps))):
            inner = value if isinstance(step, int) else f"{_key(step)}: {value}"
            brackets = "[]" if isinstance(step, int) else "{}"
            value = inner if depth == 0 and bare else f"{brackets[0]}{inner}{brackets[1]}"
        return value

    def drop(self, steps: Sequence[Step]) -> str:
        depth = len(steps)
        while depth > 1 and _only_child(node_at(self._tree, steps[: depth - 1])):
            depth -= 1
        text = self._text
        # Values are removed from the innermost level outward. Text near the end is removed first, so that earlier
        # positions stay valid.
        if self._inside_flow(steps[:depth]):
            return self._dropped_from_flow(steps[:depth])
        if depth == len(steps):
            return self._dropped_from_block(steps)
        inner = node_at(self._tree, steps[:depth])
        if (
            inner is None
            or isinstance(inner, Scalar)
            or inner.flow
            or any(isinstance(s, int) for s in steps[depth - 1 :])
        ):
            return self._dropped_from_block(steps[:depth])
        for level in range(len(steps), depth - 1, -1):
            entry = self._entry(steps[:level])
            if entry is None or (level < len(steps) and self._inside_flow(steps[: level + 1])):
                return self._dropped_from_block(steps[:depth])
            name, _ = entry
            end = self._end_of_entry(entry) if level == len(steps) else self._behind_name(steps[:level])
            text = _without_lines(text, name.start, end)
        return text

    def _dropped_from_block(self, steps: Sequence[Step]) -> str:
        text, step = self._text, steps[-1]
        section = node_at(self._tree, steps[:-1])
        if isinstance(step, int):
            node = node_at(self._tree, steps)
            if node is None:
                return text
            dash = text.rfind("-", 0, node.start)
            return _without_lines(text, dash, end_of(text, node))
        if not isinstance(section, Section):
            return text
        index = [name.text for name, _ in section.entries].index(step)
        name, _ = section.entries[index]
        if not text[line_start(text, name.start) : name.start].strip():
            return _without_lines(text, name.start, self._end_of_entry(section.entries[index]))
        # The first key of an item comes after the item's dash.
        if index + 1 < len(section.entries):
            return text[: name.start] + text[section.entries[index + 1][0].start :]
        return text[: name.start] + "{}" + text[self._end_of_entry(section.entries[index]) :]

    def _dropped_from_flow(self, steps: Sequence[Step]) -> str:
        text, step = self._text, steps[-1]
        parent = node_at(self._tree, steps[:-1])
        spans: list[tuple[int, int]] = []
        index = 0
        if isinstance(parent, Section):
            index = [name.text for name, _ in parent.entries].index(str(step))
            spans = [(entry[0].start, self._end_of_entry(entry)) for entry in parent.entries]
        elif isinstance(parent, Listing) and isinstance(step, int):
            index, spans = step, [(item.start, end_of(text, item)) for item in parent.items]
        if index + 1 < len(spans):
            return text[: spans[index][0]] + text[spans[index + 1][0] :]
        start = spans[index - 1][1] if index else spans[index][0]
        return text[:start] + text[spans[index][1] :]

    def swap(self, listing: Listing, first: int) -> str:
        """Return the text in which an item of a list and the next item have changed places."""
        text = self._text
        one, other = listing.items[first], listing.items[first + 1]
        if listing.flow:
            end, start = end_of(text, one), other.start
            between, last = text[end:start], end_of(text, other)
            return text[: one.start] + text[start:last] + between + text[one.start : end] + text[last:]
        start = line_start(text, text.rfind("-", 0, one.start))
        if first:
            # Comments above an item belong to the item.
            start = self._next_line(end_of(text, listing.items[first - 1]))
        middle, last = (self._next_line(end_of(text, item)) for item in (one, other))
        gap = "" if text[middle:last].endswith("\n") else self._newline
        mine = text[start:middle]
        mine = mine.removesuffix("\n").removesuffix("\r") if gap else mine
        return text[:start] + text[middle:last] + gap + mine + text[last:]

    def _next_line(self, at: int) -> int:
        end = self._text.find("\n", at)
        return len(self._text) if end < 0 else end + 1

    def _entry(self, steps: Sequence[Step]) -> tuple[Scalar, Node] | None:
        parent = node_at(self._tree, steps[:-1])
        if not isinstance(parent, Section):
            return None
        return next((entry for entry in parent.entries if entry[0].text == str(steps[-1])), None)

    def _end_of_entry(self, entry: tuple[Scalar, Node]) -> int:
        name, node = entry
        return behind_key(self._text, name) if left_out(node) else end_of(self._text, node)

    def _behind_name(self, steps: Sequence[Step]) -> int:
        entry = self._entry(steps)
        return 0 if entry is None else behind_key(self._text, entry[0])

    def _column_of_name(self, steps: Sequence[Step]) -> int:
        entry = self._entry(steps)
        return 0 if entry is None else column_of(self._text, entry[0].start)

    def _inside_flow(self, steps: Sequence[Step]) -> bool:
        """Return True if the node at a path is within brackets."""
        parents = [node_at(self._tree, steps[:depth]) for depth in range(len(steps))]
        return any(isinstance(parent, Section | Listing) and parent.flow for parent in parents)


def _only_child(node: Node | None) -> bool:
    match node:
        case Listing(items=items):
            return len(items) == 1
        case Section(entries=entries):
            return len(entries) == 1
        case _:
            return False


def in_brackets(node: Node) -> str:
    """Return a value as YAML on one line."""
    match node:
        case Scalar(text, plain):
            return text if plain else quoted(text)
        case Listing(items=items):
            return f"[{', '.join(map(in_brackets, items))}]"
        case Section(entries=entries):
            return f"{{{', '.join(f'{_key(name.text)}: {in_brackets(child)}' for name, child in entries)}}}"


def _without_lines(text: str, start: int, end: int) -> str:
    """Return the text without the lines from `start` to `end`; a comment after these lines is kept, on its own line."""
    start = line_start(text, start)
    comment = _COMMENT_BEHIND.match(text, end)
    if comment is not None and comment.group(1):
        indent = text[start : len(text)]
        indent = indent[: len(indent) - len(indent.lstrip(" "))]
        return text[:start] + indent + text[comment.start(1) :]
    behind = text.find("\n", end)
    return text[:start] + ("" if behind < 0 else text[behind + 1 :])


def _key(name: str) -> str:
    return name if _PLAIN_KEY.fullmatch(name) else quoted(name)


Leaf = tuple[str, str, bool] | tuple[str, None, bool]
"""A path, its text (None if there is no value), and True if the text is not quoted."""


def _leaves(node: Node, steps: tuple[Step, ...] = ()) -> list[Leaf]:
    """Return the values of a tree by path, independent of how they are written."""
    children: list[tuple[Step, Node]] = []
    match node:
        case Listing(items=items):
            children = list(enumerate(items))
        case Section(entries=entries):
            children = [(name.text, child) for name, child in entries]
        case Scalar():
            pass
    if not children:
        path = path_of(steps)
        return [(path, node.text, node.plain) if isinstance(node, Scalar) and not node.absent else (path, None, True)]
    return [leaf for step, child in children for leaf in _leaves(child, (*steps, step))]


def _is_under(path: str, key: str) -> bool:
    return path == key or path.startswith((f"{key}.", f"{key}["))


def _with_changed(tree: Node, steps: tuple[Step, ...], value: Node) -> list[Leaf]:
    """Return the leaves of a tree after writing this value at a path."""
    key = path_of(steps)
    return [*(leaf for leaf in _leaves(tree) if not _is_under(leaf[0], key)), *_leaves(value, steps)]


def _with_dropped(tree: Node, steps: tuple[Step, ...]) -> list[Leaf]:
    """Return the leaves of a tree without the leaves at a path."""
    parent = node_at(tree, steps[:-1])
    if isinstance(parent, Listing):
        items = [item for index, item in enumerate(parent.items) if index != steps[-1]]
        return _with_changed(tree, steps[:-1], Listing(parent.line, items))
    return [leaf for leaf in _leaves(tree) if not _is_under(leaf[0], path_of(steps))]


def _verified(text: str, wanted: list[Leaf], steps: tuple[Step, ...]) -> str | RequestRefused:
    """Return the text if it has the wanted values, or else a refusal. An empty section counts as a missing section."""
    above = {path_of(steps[:depth]) for depth in range(len(steps))}

    def comparable(leaves: list[Leaf]) -> list[Leaf]:
        kept = (leaf for leaf in leaves if not (leaf[0] in above and leaf[1] is None))
        # Of two equal keys, one may have a value, and the other none.
        return sorted(kept, key=lambda leaf: (leaf[0], leaf[1] is not None, leaf[1] or "", leaf[2]))

    try:
        sound = comparable(_leaves(parse(_SCRATCH, text))) == comparable(wanted)
    except BadFile:
        sound = False
    if sound:
        return text
    sentence = f"{path_of(steps)} is written in a form that cannot be changed here. Change it in the text."
    return RequestRefused(EditRefusalReason.NOT_UNDERSTOOD, sentence)
