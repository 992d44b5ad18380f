"""Tables with descriptions: each column has a unit, a meaning, and a function that computes its values."""

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from enum import StrEnum
from typing import Generic, TypeVar

import numpy as np

from thbridge.files.tables.table_files import Column, OptionalColumn, Values

CellValue = str | int | float | bool | None
"""Value in a table. None is a missing value."""
Row = dict[str, CellValue]
Subject_contra = TypeVar("Subject_contra", contravariant=True)
"""Object that a row describes."""


class FactorRole(StrEnum):
    """Role of a column in the design of an experiment."""

    NONE = ""
    BETWEEN = "between"
    WITHIN = "within"


@dataclass(frozen=True, slots=True)
class ColumnDescription:
    """Description of a column for the data dictionary.

    Attributes:
        name: name of the column, unique in its table.
        kind: "string", "time" (a date and time in UTC as ISO 8601), "float64", "int64" or "bool". Values of each kind
            may be missing.
        unit: "s", or empty.
        meaning: meaning of the column, as a phrase for people.
        least: least possible value, or None if unknown.
        greatest: greatest possible value, or None if unknown.
        role: role of the column in the design.
        levels: levels of a factor, in the order of the design.
    """

    name: str
    kind: str
    unit: str
    meaning: str
    least: float | None = None
    greatest: float | None = None
    role: FactorRole = FactorRole.NONE
    levels: tuple[str, ...] = ()

    @property
    def column(self) -> Column:
        """The column in the form for files."""
        return Column(self.name, "string" if self.kind == "time" else self.kind, self.unit, self.meaning)


@dataclass(frozen=True, slots=True)
class ValuedColumn(Generic[Subject_contra]):
    """A column and the function that computes its values."""

    described: ColumnDescription
    value: Callable[[Subject_contra], CellValue]


def text(name: str, meaning: str, value: Callable[[Subject_contra], str | None]) -> ValuedColumn[Subject_contra]:
    """Return a column of texts."""
    return ValuedColumn(ColumnDescription(name, "string", "", meaning), value)


def time(name: str, meaning: str, value: Callable[[Subject_contra], str | None]) -> ValuedColumn[Subject_contra]:
    """Return a column of dates and times."""
    return ValuedColumn(ColumnDescription(name, "time", "", meaning), value)


def flag(name: str, meaning: str, value: Callable[[Subject_contra], bool | None]) -> ValuedColumn[Subject_contra]:
    """Return a column of true and false."""
    return ValuedColumn(ColumnDescription(name, "bool", "", meaning), value)


def whole(
    name: str, meaning: str, value: Callable[[Subject_contra], int | None], unit: str = "", least: float | None = None
) -> ValuedColumn[Subject_contra]:
    """Return a column of whole numbers."""
    return ValuedColumn(ColumnDescription(name, "int64", unit, meaning, least), value)


def count(name: str, meaning: str, value: Callable[[Subject_contra], int | None]) -> ValuedColumn[Subject_contra]:
    """Return a column of whole numbers from 0."""
    return whole(name, meaning, value, least=0)


def number(
    name: str,
    unit: str,
    meaning: str,
    value: Callable[[Subject_contra], float | None],
    least: float | None = None,
    greatest: float | None = None,
) -> ValuedColumn[Subject_contra]:
    """Return a column of numbers."""
    return ValuedColumn(ColumnDescription(name, "float64", unit, meaning, least, greatest), value)


def seconds(name: str, meaning: str, value: Callable[[Subject_contra], float | None]) -> ValuedColumn[Subject_contra]:
    """Return a column of durations, s."""
    return number(name, "s", meaning, value, 0)


def share(name: str, meaning: str, value: Callable[[Subject_contra], float | None]) -> ValuedColumn[Subject_contra]:
    """Return a column of shares, 0 to 1."""
    return number(name, "", meaning, value, 0, 1)


@dataclass(frozen=True, slots=True)
class ExperimentTable:
    """A table of an experiment, or a part of such a table.

    Attributes:
        name: name of the table's file.
        meaning: meaning of a row, as a phrase.
        columns: descriptions of the columns.
        rows: rows with a value for each column.
    """

    name: str
    meaning: str
    columns: tuple[ColumnDescription, ...]
    rows: tuple[Row, ...]

    def values(self) -> list[Values]:
        """Return the values column by column."""
        return [_values(column.kind, [row[column.name] for row in self.rows]) for column in self.columns]


@dataclass(frozen=True, slots=True)
class TableOf(Generic[Subject_contra]):
    """Definition of a table with one row for each object of a kind.

    Attributes:
        name: name of the table's file.
        meaning: meaning of a row, as a phrase.
        columns: columns in order.
    """

    name: str
    meaning: str
    columns: tuple[ValuedColumn[Subject_contra], ...]

    def of(self, subjects: Iterable[Subject_contra]) -> ExperimentTable:
        """Return the table for these objects."""
        rows = tuple({each.described.name: each.value(subject) for each in self.columns} for subject in subjects)
        return ExperimentTable(self.name, self.meaning, tuple(each.described for each in self.columns), rows)


def _values(kind: str, cells: list[CellValue]) -> Values:
    if kind in {"string", "time"}:
        return [None if cell is None else str(cell) for cell in cells]
    known = np.array([cell is not None for cell in cells], dtype=np.bool_)
    return OptionalColumn(np.array([0 if cell is None else cell for cell in cells], dtype=kind), known)
