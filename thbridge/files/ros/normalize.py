"""Normalization of YAML trees as in ROS's own loader: booleans, angles, merged anchors, duplicate keys."""

import dataclasses
import math
import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from thbridge.files.errors import BadFile
from thbridge.files.yaml.angles import product
from thbridge.files.yaml.tree import Listing, Node, Scalar, Section

Entry = tuple[Scalar, Node]

_TRUE = {"yes", "Yes", "YES", "on", "On", "ON", "True", "TRUE"}
_FALSE = {"no", "No", "NO", "off", "Off", "OFF", "False", "FALSE"}
_WHOLE_REAL = re.compile(r"([-+]?\d+)\.0*")
_ANGLE = re.compile(r"(deg|rad)\((.*)\)")
_OTHER_BASE = re.compile(r"[-+]?0(x[\da-fA-F]+|b[01]+|[0-7]+)")
"""Numbers in base 16, 2 and 8, as in YAML 1.1, which ROS uses."""
_GROUPED = re.compile(r"[-+]?\d+(_+\d+)+(\.\d*)?")
"""Numbers with underscores between digits, as in YAML 1.1."""
_TEXT_TAGS = {f"tag:yaml.org,2002:{kind}" for kind in ("str", "binary")}
_PLAIN_TAGS = {*(f"tag:yaml.org,2002:{kind}" for kind in ("float", "int", "bool", "null")), *_TEXT_TAGS}


@dataclass(slots=True)
class RosYamlNormalizer:
    """Normalizer of a tree: plain words, each key once, no merge keys, no slashes.

    Attributes:
        path: the file, for faults.
        notices: receives a sentence for each duplicate key.
    """

    path: Path
    notices: list[str]

    def section(self, node: Node) -> Section:
        """Return the normalized tree of a file. Raises BadFile if the file is not a section, or a value is invalid."""
        if not isinstance(node, Section):
            problem = "this file is not a section with lines 'name: value'"
            raise BadFile(self.path, problem, "name a YAML file of ROS parameters", line=node.line)
        cleaned = self.node(node)
        return cleaned if isinstance(cleaned, Section) else Section(node.line, [])

    def node(self, node: Node) -> Node:
        """Return the normalized tree of a node."""
        match node:
            case Scalar():
                return self.scalar(node)
            case Listing(line, items):
                return Listing(line, [self.node(item) for item in items])
            case Section(line, entries):
                written: dict[str, Entry] = {}
                for key, child in _below_root(self.merged(entries)):
                    name, inner = self.unfolded(key, self.node(child))
                    before, known = written.get(name.text, (name, None))
                    if isinstance(inner, Section) and isinstance(known, Section) and "/" in key.text.strip("/"):
                        written[name.text] = before, Section(known.line, [*known.entries, *inner.entries])
                        continue
                    if known is not None:
                        notice = (
                            f"{name.text} appears twice, first in line {before.line}; ROS also uses the later value"
                        )
                        self.notices.append(f"{self.path}, line {name.line}: {notice}")
                    written[name.text] = name, inner
                return Section(line, list(written.values()))

    def merged(self, entries: Sequence[Entry]) -> list[Entry]:
        """Return the entries, and all entries of merge keys (`<<: *common`) that they do not override."""
        own = [entry for entry in entries if entry[0].text != "<<"]
        names = {key.text for key, _ in own}
        for key, child in entries:
            if key.text != "<<":
                continue
            for part in child.items if isinstance(child, Listing) else [child]:
                if not isinstance(part, Section):
                    problem = "not a section that can be merged"
                    raise BadFile(self.path, problem, "write the name of a section's anchor", line=key.line, key="<<")
                own.extend(entry for entry in part.entries if entry[0].text not in names)
                names |= {entry[0].text for entry in part.entries}
        return own

    def unfolded(self, key: Scalar, child: Node) -> Entry:
        """Return an entry without slashes in its key: `a/b: 1` becomes `a: {b: 1}`; leading slashes are removed."""
        first, *rest = key.text.strip("/").split("/")
        for name in reversed(rest):
            child = Section(key.line, [(Scalar(name, plain=True, line=key.line), child)])
        return Scalar(first, plain=key.plain, line=key.line), child

    def scalar(self, node: Scalar) -> Scalar:
        """Return a normalized value: `yes` becomes true, `5.0` becomes 5; `!degrees 90`, `deg(90)` become radians."""
        called = _ANGLE.fullmatch(node.text) if node.plain else None
        if node.tag in {"!degrees", "!radians"} or called:
            text = called[2] if called else node.text
            degrees = called[1] == "deg" if called else node.tag == "!degrees"
            return Scalar(repr(self.angle(text, node.line, degrees)), plain=True, line=node.line)
        if node.tag in _PLAIN_TAGS:
            return self.scalar(dataclasses.replace(node, tag=None, plain=node.tag not in _TEXT_TAGS))
        if node.tag is not None:
            remedy = "Write the plain value; only !degrees and !radians are known"
            raise BadFile(self.path, "this tag (!) is unknown", remedy, line=node.line, key=node.tag)
        if not node.plain:
            return node
        if _GROUPED.fullmatch(node.text):
            return self.scalar(dataclasses.replace(node, text=node.text.replace("_", "")))
        if _OTHER_BASE.fullmatch(node.text):
            return dataclasses.replace(node, text=str(_in_ten(node.text)))
        whole = _WHOLE_REAL.fullmatch(node.text)
        if node.text in _TRUE | _FALSE:
            return dataclasses.replace(node, text="true" if node.text in _TRUE else "false")
        # ROS accepts 5.0 where it needs a whole number.
        return dataclasses.replace(node, text=whole[1]) if whole else node

    def angle(self, text: str, line: int, degrees: bool) -> float:
        """Return the value in radians of a product of numbers and pi."""
        value = product(text)
        if value is None:
            raise BadFile(self.path, f"{text!r} is not an angle", "Write a number, or for example pi/2", line=line)
        return math.radians(value) if degrees else value


def _below_root(entries: Sequence[Entry]) -> Iterator[Entry]:
    """Yield the entries; the root namespace `/` is replaced by the entries in it."""
    for key, child in entries:
        if key.text == "/" and isinstance(child, Section):
            yield from child.entries
        else:
            yield key, child


def _in_ten(text: str) -> int:
    """Return the value of a number in another base; a number that begins with only a 0 has base 8."""
    sign = -1 if text[0] == "-" else 1
    digits = text.lstrip("+-")
    return sign * int(digits, 0 if digits[1] in "xb" else 8)
