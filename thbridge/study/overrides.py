"""Changes to a study, by files or single keys, for example to replay a recording with other parameters."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from thbridge.files.disk.text_files import read_text
from thbridge.files.errors import BadFile
from thbridge.files.yaml.load import Loaded
from thbridge.files.yaml.tree import Node, Scalar, Section, at_line, parse
from thbridge.study.noise import TARGET_PATHS
from thbridge.study.study_file import Study, load_study_tree
from thbridge.study.text import resolved

CHANGE_SOURCE = Path("--with")
"""Name of the source in faults of a single change."""


@dataclass(frozen=True, slots=True)
class StudyChange:
    """One key of a study with another value, both as in a study file; `key` is a path such as `robot.amcl.kld_err`."""

    key: str
    value: str


def with_changes(
    study: Study, files: Sequence[Path], changes: Sequence[StudyChange], source: Path = CHANGE_SOURCE
) -> Study:
    """Return the study with the keys of files, one after the other, and then with single changes.

    Other keys keep their values, except that another noise preset resets the numbers of the section `noise`. Faults of
    single changes name `source` as their file.

    Raises:
        BadFile: a file cannot be read, or the result is not a valid study.
    """
    for path in files:
        study = merged(resolved_tree(study), path, parse(path, read_text(path))).value
    tree: Node = Section(1, [])
    for number, change in enumerate(changes, 1):
        further = at_line(_tree(change, source), number)
        if (twice := set_by_both(tree, further)) is not None:
            raise BadFile(source, f"{twice} is given twice", "keep one of the two", key=twice)
        tree = over(tree, further)
    return merged(resolved_tree(study), source, tree).value if changes else study


def resolved_tree(study: Study) -> Node:
    """Return the tree of the whole study, defaults included."""
    return parse(Path(), resolved(study))


def merged(base: Node, path: Path, tree: Node) -> Loaded[Study]:
    """Return the study of a `resolved_tree` with what a tree of the file `path` changes; faults as `with_changes`."""
    if (ros := _at(tree, "ros_parameters")) is not None:
        problem = "files of ROS would change nothing, since a recorded study has every number"
        raise BadFile(
            path, problem, "write the numbers that shall change, under `robot`", line=ros.line, key="ros_parameters"
        )
    if _at(tree, "noise", "preset") is not None:
        base = _without(base, "noise")
    for named, home in TARGET_PATHS.items():
        # The study has this number in its section `noise`.
        if _at(tree, *home.split(".")) is not None:
            base = _without(base, "noise", *named.split("."))
    return load_study_tree(path, over(base, tree))


def _tree(change: StudyChange, source: Path) -> Node:
    node = parse(source, change.value)
    # An empty text is an empty section to the parser; here it is a missing value.
    return nested(change.key, node if change.value.strip() else Scalar("", True, 1), 1)


def nested(key: str, node: Node, line: int) -> Node:
    """Return the tree with a node at a path of keys, such as `robot.amcl.kld_err`."""
    for name in reversed(key.split(".")):
        node = Section(line, [(Scalar(name, True, line), node)])
    return node


def over(base: Node, top: Node) -> Node:
    """Return a tree merged with another on top: sections are merged, other values replaced."""
    if not (isinstance(base, Section) and isinstance(top, Section)):
        return top
    above = {key.text: (key, child) for key, child in top.entries}
    below = {key.text for key, _ in base.entries}
    entries = [
        (above[key.text][0], over(child, above[key.text][1])) if key.text in above else (key, child)
        for key, child in base.entries
    ]
    return Section(top.line, entries + [entry for name, entry in above.items() if name not in below])


def set_by_both(one: Node, other: Node) -> str | None:
    """Return the path of a key that two trees set, or None: a section in both is none."""
    if not (isinstance(one, Section) and isinstance(other, Section)):
        return ""
    known = {key.text: child for key, child in one.entries}
    for key, child in other.entries:
        if key.text in known and (inner := set_by_both(known[key.text], child)) is not None:
            return f"{key.text}.{inner}".rstrip(".")
    return None


def _at(tree: Node, *names: str) -> Node | None:
    for name in names:
        if not isinstance(tree, Section):
            return None
        found = next((child for key, child in tree.entries if key.text == name), None)
        if found is None:
            return None
        tree = found
    return tree


def _without(tree: Node, name: str, *inside: str) -> Node:
    """Return a tree without what stands at a path of names."""
    if not isinstance(tree, Section):
        return tree
    if not inside:
        return Section(tree.line, [entry for entry in tree.entries if entry[0].text != name])
    entries = [(key, _without(child, *inside) if key.text == name else child) for key, child in tree.entries]
    return Section(tree.line, entries)
