"""Table of treasures or properties, on the text of their file, and what a change of it gives."""

from abc import ABC, abstractmethod
from collections.abc import Collection, Mapping
from dataclasses import dataclass

from thbridge.files.errors import BadFile
from thbridge.hunt.refusals import RequestRefused

Texts = Mapping[str, str]
"""Texts of files by name."""
Changed = Texts | RequestRefused
"""The files that a change changes, with their new texts."""


@dataclass(frozen=True, slots=True)
class SheetColumn:
    """A column of a sheet.

    Attributes:
        title: heading.
        path: the key in an entry, such as `values.colour`.
        meaning: what it is, for people.
        choices: what it may be; empty: anything.
        is_list: several values, with commas between them.
        is_number: a number.
        is_picture: the name of a picture of the set.
    """

    title: str
    path: str
    meaning: str = ""
    choices: tuple[str, ...] = ()
    is_list: bool = False
    is_number: bool = False
    is_picture: bool = False


class Sheet(ABC):
    """A table on the text of a file.

    Attributes:
        columns: its columns.
    """

    columns: tuple[SheetColumn, ...] = ()

    @property
    @abstractmethod
    def rows(self) -> tuple[tuple[str, ...], ...]:
        """Cells as people read and type them, row by row."""

    @abstractmethod
    def put(self, row: int, column: int, typed: str) -> Changed:
        """Change a cell."""

    @abstractmethod
    def add(self, like: int | None = None) -> Changed:
        """Add a row at the end, like another one but for its name; None: a new one."""

    @abstractmethod
    def remove(self, row: int) -> Changed:
        """Remove a row."""

    @abstractmethod
    def cell_of(self, fault: BadFile) -> tuple[int, int] | None:
        """Return row and column that a fault is about; None: it is about no cell."""


def free_name(name: str, taken: Collection[str]) -> str:
    """A name that is not taken; with an underscore where it could not have a blank."""
    if name not in taken:
        return name
    joint = "_" if (name.islower() and "_" in name) or name == "property" else " "
    number = 2
    while f"{name}{joint}{number}" in taken:
        number += 1
    return f"{name}{joint}{number}"
