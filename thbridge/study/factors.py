"""Factors of a design: keys of the study that differ between conditions, and the levels of each factor."""

import itertools
import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import ClassVar

from sim.parameters import param
from thbridge.files.errors import BadFile
from thbridge.files.yaml.load import load_tree
from thbridge.files.yaml.merge import nested, over, set_by_both
from thbridge.files.yaml.tree import Listing, Node, Scalar, Section, quoted
from thbridge.study.text import is_plain_word


@dataclass(frozen=True, slots=True)
class LevelRange:
    """Equally spaced levels of a factor."""

    renamed: ClassVar[Mapping[str, str]] = {"from": "first", "to": "last"}

    first: float = param(math.nan, "first level")
    last: float = param(math.nan, "last level")
    steps: int = param(2, "number of levels", "", 2, 1000)


@dataclass(frozen=True, slots=True)
class Level:
    """A level of a factor: its label, the tree of the keys that it sets, and its line in the file."""

    label: str
    tree: Node
    line: int


def levels_of(path: Path, section: str, factor: Scalar, node: Node) -> list[Level]:
    """Return the levels of a factor.

    The file gives them as a list of values, as a range, or as a section of named levels that set several keys.

    Args:
        path: the file.
        section: name of the section that contains the factor.
        factor: name of the factor.
        node: levels of the factor.

    Raises:
        BadFile: `node` does not describe levels.
    """
    key, line = f"{section}.{factor.text}", factor.line
    found: list[Level] = []
    if isinstance(node, Listing):
        found = [Level(written(item), nested(factor.text, item, item.line), item.line) for item in node.items]
    elif isinstance(node, Section) and {name.text for name, _ in node.entries} <= _RANGE_KEYS:
        found = [
            Level(text, nested(factor.text, Scalar(text, True, line), line), line)
            for text in _steps(path, key, factor, node)
        ]
    elif isinstance(node, Section):
        found = [Level(name.text, spread(path, child), name.line) for name, child in node.entries]
    if not found:
        remedy = "Write [LEVEL, ...] or {from: A, to: B, steps: N}, or write 'NAME: {KEY: VALUE, ...}' for each level"
        raise BadFile(path, "the factor has no levels", remedy, line=line, key=key)
    named = isinstance(node, Section)
    values = [level.label if named else _value(level.label) for level in found]
    if twice := next((level.label for level, value in zip(found, values, strict=True) if values.count(value) > 1), ""):
        raise BadFile(path, f"the level {twice} is listed twice", "Keep one of the two", line=line, key=key)
    return found


_RANGE_KEYS = {"from", "to", "steps", "first", "last"}


def _steps(path: Path, key: str, factor: Scalar, node: Section) -> list[str]:
    written = {name.text for name, _ in node.entries}
    if not ({"from", "first"} & written and {"to", "last"} & written):
        remedy = "Write {from: A, to: B, steps: N}"
        raise BadFile(path, "the range needs a first and a last value", remedy, line=factor.line, key=key)
    ends = load_tree(path, node, LevelRange).value
    width = ends.last - ends.first
    return [f"{ends.first + width * step / (ends.steps - 1):.12g}" for step in range(ends.steps)]


def factorial(factors: Mapping[str, Sequence[Level]]) -> Iterator[dict[str, Level]]:
    """Yield all combinations of levels; the last factor changes fastest. Without factors, yield one empty condition."""
    for levels in itertools.product(*factors.values()):
        yield dict(zip(factors, levels, strict=True))


def _value(label: str) -> float | str:
    """Return a label as a number, so that 20 and 20.0 are the same level. A label that is not a number is unchanged."""
    try:
        return float(label)
    except ValueError:
        return label


def spread(path: Path, node: Node) -> Node:
    """Return the nested tree for a section whose keys are dotted paths."""
    if not isinstance(node, Section):
        if isinstance(node, Scalar) and node.absent:
            return Section(node.line, [])
        raise BadFile(path, "this value must be a section", "Write {KEY: VALUE, ...}", line=node.line)
    tree: Node = Section(node.line, [])
    for key, child in node.entries:
        further = nested(key.text, child, key.line)
        if (twice := set_by_both(tree, further)) is not None:
            raise BadFile(path, "written twice", "Keep one of the two", line=key.line, key=twice)
        tree = over(tree, further)
    return tree


def check_keys_set_once(path: Path, base: Node | None, factors: Mapping[str, Sequence[Level]]) -> None:
    """Check that each key is set only once, by `base` or by one factor.

    Raises:
        BadFile: a key is set twice.
    """
    setters = [] if base is None else [("base", spread(path, base))]
    for name, levels in factors.items():
        for level in levels:
            for setter, tree in setters:
                if (twice := set_by_both(tree, level.tree)) is not None:
                    problem = f"{setter} and {name} both set this key"
                    raise BadFile(path, problem, "Delete the key in one of the two", line=level.line, key=twice)
        setters += [(name, level.tree) for level in levels]


def entries_of(node: Node | None) -> Sequence[tuple[Scalar, Node]]:
    """Return the keys and values of a section. For any other node, return an empty sequence."""
    return node.entries if isinstance(node, Section) else []


def written(node: Node) -> str:
    """Return a value as YAML text on one line."""
    match node:
        case Scalar():
            return node.text or '""'
        case Listing():
            return f"[{', '.join(_quoted(item) for item in node.items)}]"
        case Section():
            return f"{{{', '.join(f'{key.text}: {_quoted(child)}' for key, child in node.entries)}}}"


def _quoted(node: Node) -> str:
    if isinstance(node, Scalar) and not node.plain and not is_plain_word(node.text):
        return quoted(node.text)
    return written(node)
