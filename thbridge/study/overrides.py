"""Changes to a study, by files or single keys, for example to replay a recording with other parameters."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from thbridge.files.errors import BadFile
from thbridge.files.yaml.tree import Node, Scalar, Section, at_line, parse, read_text
from thbridge.study.study_file import Study, load_study_tree
from thbridge.study.text import resolved

CHANGE_SOURCE = Path("--with")
"""Name of the source in faults of a single change."""


@dataclass(frozen=True, slots=True)
class StudyChange:
    """One key of a study with another value, both as in a study file; `key` is a path such as `robot.amcl.kld_err`."""

    key: str
    value: str


def with_changes(study: Study, files: Sequence[Path], changes: Sequence[StudyChange]) -> Study:
    """Return the study with the keys of files, one after the other, and then with single changes.

    Other keys keep their values, except that another noise preset resets the numbers of the section `noise`.

    Raises:
        BadFile: a file cannot be read, or the result is not a valid study.
    """
    for path in files:
        study = _merged(study, path, parse(path, read_text(path)))
    tree: Node = Section(1, [])
    for number, change in enumerate(changes, 1):
        tree = _over(tree, at_line(_tree(change), number))
    return _merged(study, CHANGE_SOURCE, tree) if changes else study


def _merged(study: Study, path: Path, tree: Node) -> Study:
    if (ros := _at(tree, "ros_parameters")) is not None:
        problem = "files of ROS would change nothing, since a recorded study has every number"
        raise BadFile(
            path, problem, "write the numbers that shall change, under `robot`", line=ros.line, key="ros_parameters"
        )
    base = parse(path, resolved(study))
    if _at(tree, "noise", "preset") is not None:
        base = _without(base, "noise")
    return load_study_tree(path, _over(base, tree)).value


def _tree(change: StudyChange) -> Node:
    node = parse(CHANGE_SOURCE, change.value)
    # An empty text is an empty section to the parser; here it is a missing value.
    node = node if change.value.strip() else Scalar("", True, 1)
    for name in reversed(change.key.split(".")):
        node = Section(1, [(Scalar(name, True, 1), node)])
    return node


def _over(base: Node, top: Node) -> Node:
    """Return a tree merged with another on top: sections are merged, other values replaced."""
    if not (isinstance(base, Section) and isinstance(top, Section)):
        return top
    above = {key.text: (key, child) for key, child in top.entries}
    below = {key.text for key, _ in base.entries}
    entries = [
        (above[key.text][0], _over(child, above[key.text][1])) if key.text in above else (key, child)
        for key, child in base.entries
    ]
    return Section(top.line, entries + [entry for name, entry in above.items() if name not in below])


def _at(tree: Node, *names: str) -> Node | None:
    for name in names:
        if not isinstance(tree, Section):
            return None
        found = next((child for key, child in tree.entries if key.text == name), None)
        if found is None:
            return None
        tree = found
    return tree


def _without(tree: Node, name: str) -> Node:
    if not isinstance(tree, Section):
        return tree
    return Section(tree.line, [entry for entry in tree.entries if entry[0].text != name])
