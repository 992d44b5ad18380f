"""Changes to a study by files or single keys, for example to replay a recording with other parameters."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from thbridge.files.disk.text_files import read_text
from thbridge.files.errors import BadFile
from thbridge.files.yaml.load import Loaded
from thbridge.files.yaml.merge import nested, over, set_by_both, without
from thbridge.files.yaml.places import node_at
from thbridge.files.yaml.tree import Node, Scalar, Section, at_line, parse
from thbridge.study.noise import resolve_noise
from thbridge.study.study_file import Study, load_study_tree
from thbridge.study.text import resolved

CHANGE_SOURCE = Path("--with")
"""File name in error messages about single changes."""


@dataclass(frozen=True, slots=True)
class StudyChange:
    """A key of a study, as a path such as `robot.amcl.kld_err`, and its new value, as written in a study file."""

    key: str
    value: str


def with_changes(
    study: Study, files: Sequence[Path], changes: Sequence[StudyChange], source: Path = CHANGE_SOURCE
) -> Study:
    """Return the study after applying the keys of each file in order, and then the single changes.

    All other keys keep their values. But a new noise preset also resets the numbers of the section `noise`. Error
    messages about single changes name `source` as their file.

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
    """Return the tree of the whole study, including defaults."""
    return parse(Path(), resolved(study))


def merged(base: Node, path: Path, tree: Node) -> Loaded[Study]:
    """Return the study of a `resolved_tree` after applying the tree of the file `path`.

    Raises:
    BadFile: the result is not a valid study.
    """
    if (ros := node_at(tree, ("ros_parameters",))) is not None:
        problem = "ROS files have no effect here, because a recorded study already contains a value for every parameter"
        raise BadFile(path, problem, "write the numbers to change under `robot`", line=ros.line, key="ros_parameters")
    if node_at(tree, ("noise", "preset")) is not None:
        base = without(base, ("noise",))
    return load_study_tree(path, over(resolve_noise(base), resolve_noise(tree)))


def _tree(change: StudyChange, source: Path) -> Node:
    node = parse(source, change.value)
    # The parser turns an empty text into an empty section. Here, however, an empty text is a missing value.
    return nested(change.key, node if change.value.strip() else Scalar("", True, 1), 1)
