"""Columns of a message type: names, units, meanings, and functions that read their values from gathered rows.

A column's name is the path of its field (`pose.pose.position.x`) without wrappers such as `pose`, and with the unit:
`x_m`. If two names would be equal, both columns are named with the full path.
"""

from collections import Counter
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from itertools import groupby
from typing import assert_never

import numpy as np
from numpy.typing import NDArray

from sim.numerics import elementary_arrays
from thbridge.analysis.export import meanings as words
from thbridge.analysis.fields.layout import (
    BYTES,
    DURATION,
    TEXT,
    TIME,
    Array,
    FieldStep,
    FixedBlock,
    FixedValue,
    LayoutPart,
    MessageArray,
    MessageLayout,
    NumberArray,
    Path,
    StringArray,
    StringField,
)
from thbridge.analysis.fields.rows import GatheredRows
from thbridge.files.tables.table_files import Column, ListColumn, Values

WRAPPERS = frozenset(
    {"header", "pose", "position", "orientation", "twist", "transform", "translation", "rotation", "point", "vector"}
)
"""Fields that only wrap other fields, and are omitted from names."""
AXES = ("x", "y", "z", "roll", "pitch", "yaw")
"""Axes in the order of ROS's covariances."""
MOST_COLUMNS = 64
"""Length of the largest fixed-size array with a column for each element; longer arrays become one column of lists."""

_COVARIANCES = {"geometry_msgs/PoseWithCovariance": False, "geometry_msgs/TwistWithCovariance": True}
"""Types with a 6 x 6 covariance; the value is True if it is a covariance of speeds."""
_QUATERNION = "geometry_msgs/Quaternion"
_HEADER_FRAME = FieldStep("std_msgs/Header", "frame_id")
_CHILD_FRAME = FieldStep("nav_msgs/Odometry", "child_frame_id")
_SPATIAL = frozenset(
    {"geometry_msgs/Point", "geometry_msgs/Point32", "geometry_msgs/Vector3", "geometry_msgs/Pose2D", _QUATERNION}
    | set(_COVARIANCES)
)
_OF_CHILD = FieldStep("nav_msgs/Odometry", "twist")
"""The only field of common types with values in the child frame, not in the header's frame."""


@dataclass(frozen=True, slots=True, eq=False)
class ColumnReader:
    """Column, with the function that reads its values from rows."""

    column: Column
    values: Callable[[GatheredRows], Values]


@dataclass(frozen=True, slots=True, eq=False)
class _NewColumn:
    """Column whose name is not yet determined.

    Attributes:
        path: path of the value in the message.
        ending: words that replace the last word of the path in the name. If empty, the word is kept.
        kind: type of the values.
        unit: unit of the values.
        meaning: meaning of the values.
        values: function that reads the values from rows.
    """

    path: Path
    ending: tuple[str, ...]
    kind: str
    unit: str
    meaning: str
    values: Callable[[GatheredRows], Values]

    def name(self, whole: bool) -> str:
        """Return the name of the column; if `whole`, include the wrappers."""
        own = self.ending or (self.path[-1].field,)
        wraps = [step.field for step in self.path[:-1] if whole or step.field not in WRAPPERS]
        if self.ending and self.ending[0] in {"cov", "std"}:
            wraps = [step.field for step in self.path[:-1]]
        # A repeated word (status.status) is written once.
        parts = [word for word, _ in groupby([*wraps, own[0]])] + list(own[1:])
        suffix = words.suffix_of(self.unit)
        return "_".join([*parts, suffix] if suffix and self.ending[:1] != ("cov",) else parts)


def fields_of(record: MessageLayout, reserved: Iterable[str], outer_frame: str = "") -> tuple[ColumnReader, ...]:
    """Return the columns of a message type. Arrays of messages in it become separate tables.

    Args:
        record: layout of the type.
        reserved: names that are already used.
        outer_frame: column of the parent table that contains the frame.
    """
    drafts = [draft for index, part in enumerate(record.parts) for draft in _drafts(index, part)]
    count = Counter(draft.name(whole=False) for draft in drafts)
    taken = set(reserved)
    names = []
    for draft in drafts:
        name = draft.name(whole=False)
        if count[name] > 1 or name in taken:
            name = draft.name(whole=True)
        while name in taken:
            name += "_"
        taken.add(name)
        names.append(name)
    frames: dict[tuple[Path, bool], str] = {}
    for draft, name in zip(drafts, names, strict=True):
        if draft.path[-1:] == (_HEADER_FRAME,):
            frames[draft.path[:-2], False] = name
        elif draft.path[-1:] == (_CHILD_FRAME,):
            frames[draft.path[:-1], True] = name
    return tuple(
        ColumnReader(
            Column(name, draft.kind, draft.unit, draft.meaning, _frame_column(draft.path, frames, outer_frame)),
            draft.values,
        )
        for draft, name in zip(drafts, names, strict=True)
    )


def _frame_column(path: Path, frames: dict[tuple[Path, bool], str], outer: str) -> str:
    """Return the column with the frame of a value; "" for values that are not spatial."""
    if not any(step.msgtype in _SPATIAL for step in path):
        return ""
    of_child = _OF_CHILD in path
    for length in range(len(path) - 1, -1, -1):
        if name := frames.get((path[:length], of_child)):
            return name
    return outer


def _drafts(index: int, part: LayoutPart) -> Iterator[_NewColumn]:
    """Yield the columns of the part at an index."""
    match part:
        case FixedBlock(leaves):
            for position, leaf in enumerate(leaves):
                yield from _of_leaf(index, part, position, leaf)
                if leaf.path and leaf.path[-1] == FieldStep(_QUATERNION, "w"):
                    yield _yaw(index, part, position)
        case StringField(path):
            yield _plain(path, TEXT, lambda rows: rows.texts(index))
        case NumberArray(path, "uint8"):
            yield _plain(path, BYTES, lambda rows: rows.blobs(index))
        case NumberArray(path, kind):
            yield _plain(path, f"{kind}[]", lambda rows: ListColumn(rows.lengths(index), rows.numbers(index, part)))
        case StringArray(path, _):
            yield _plain(path, "string[]", lambda rows: ListColumn(rows.lengths(index), rows.texts(index)))
        case MessageArray():
            return
        case _:
            assert_never(part)


def _plain(path: Path, kind: str, values: Callable[[GatheredRows], Values], ending: tuple[str, ...] = ()) -> _NewColumn:
    return _NewColumn(path, ending, kind, words.unit_of(path), words.meaning_of(path), values)


def _of_leaf(index: int, run: FixedBlock, position: int, leaf: FixedValue) -> Iterator[_NewColumn]:
    name = str(position)

    def whole(rows: GatheredRows) -> Array:
        return np.ascontiguousarray(rows.run(index, run)[name])

    if leaf.kind in {TIME, DURATION}:
        meaning = words.meaning_of(leaf.path)
        yield _NewColumn(leaf.path, (), "int64", "ns", meaning, lambda rows: _nanoseconds(rows.run(index, run)[name]))
    elif leaf.count is None:
        axis = leaf.path[-1]
        ending = (f"q{axis.field}",) if axis.msgtype == _QUATERNION else ()
        yield _plain(leaf.path, leaf.kind, whole, ending)
    elif leaf.path[-1].msgtype in _COVARIANCES and leaf.path[-1].field == "covariance":
        yield from _covariance(leaf, whole)
    elif leaf.count <= MOST_COLUMNS:
        for element in range(leaf.count):
            yield _plain(leaf.path, leaf.kind, _element(whole, element), (leaf.path[-1].field, str(element)))
    else:
        size = leaf.count
        yield _plain(
            leaf.path,
            f"{leaf.kind}[]",
            lambda rows: ListColumn(np.full(rows.count, size, dtype=np.int64), whole(rows).reshape(-1)),
        )


def _element(whole: Callable[[GatheredRows], Array], element: int) -> Callable[[GatheredRows], Values]:
    return lambda rows: np.ascontiguousarray(whole(rows)[:, element])


def _covariance(leaf: FixedValue, whole: Callable[[GatheredRows], Array]) -> Iterator[_NewColumn]:
    """Yield columns with the standard deviations of x, y and yaw, then with all 36 covariances."""
    units = words.axis_units(_COVARIANCES[leaf.path[-1].msgtype])
    for axis in (0, 1, 5):
        meaning = f"standard deviation of {AXES[axis]}"
        yield _NewColumn(leaf.path, ("std", AXES[axis]), "float64", units[axis], meaning, _deviation(whole, axis))
    for row in range(6):
        for column in range(6):
            unit = f"{units[row]} {units[column]}" if row != column else _squared(units[row])
            meaning = f"covariance of {AXES[row]} and {AXES[column]}"
            ending = ("cov", AXES[row], AXES[column])
            yield _NewColumn(leaf.path, ending, "float64", unit, meaning, _element(whole, 6 * row + column))


def _squared(unit: str) -> str:
    return "/".join(f"{part}2" for part in unit.split("/"))


def _deviation(whole: Callable[[GatheredRows], Array], axis: int) -> Callable[[GatheredRows], Values]:
    def values(rows: GatheredRows) -> Values:
        variances = whole(rows)[:, 7 * axis].astype(np.float64)
        # Some drivers write -1 for an unknown variance.
        return np.sqrt(np.where(variances >= 0.0, variances, np.nan))

    return values


def _yaw(index: int, run: FixedBlock, position: int) -> _NewColumn:
    """Return the column with the yaw of a quaternion. `position` is the position of the quaternion's w in the block."""

    def values(rows: GatheredRows) -> Values:
        table = rows.run(index, run)
        x, y, z, w = (table[str(position - 3 + axis)] for axis in range(4))
        with np.errstate(over="ignore", invalid="ignore"):  # for invalid quaternions
            yaw: NDArray[np.float64] = elementary_arrays.atan2(2.0 * (w * z + x * y), 1.0 - 2.0 * (y * y + z * z))
        return yaw

    path = run.leaves[position].path
    meaning = ": ".join(filter(None, (words.meaning_of(path[:-1]), "heading, counterclockwise from x")))
    return _NewColumn(path, ("yaw",), "float64", "rad", meaning, values)


def _nanoseconds(times: NDArray[np.void]) -> NDArray[np.int64]:
    seconds: NDArray[np.int64] = times["sec"].astype(np.int64)
    nanoseconds: NDArray[np.int64] = times["nsec"].astype(np.int64)
    return seconds * 1_000_000_000 + nanoseconds
