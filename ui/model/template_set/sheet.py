"""Tables of treasures or properties in the text of their file, and the texts after changes."""

from abc import ABC, abstractmethod
from collections.abc import Collection, Mapping
from dataclasses import dataclass

from thbridge.files.errors import BadFile
from thbridge.hunt.refusals import RequestRefused

Texts = Mapping[str, str]
"""Texts of files by name."""
Changed = Texts | RequestRefused
"""Changed files, with their new texts."""


@dataclass(frozen=True, slots=True)
class SheetColumn:
    """Column of a sheet.

    Attributes:
        title: heading.
        path: the key in an entry, such as `values.colour`.
        meaning: meaning, for people.
        choices: allowed values; empty if any text is allowed.
        is_list: True for several values, with commas between them.
        is_number: True for a number.
        is_picture: True for the name of a picture of the set.
    """

    title: str
    path: str
    meaning: str = ""
    choices: tuple[str, ...] = ()
    is_list: bool = False
    is_number: bool = False
    is_picture: bool = False


class Sheet(ABC):
    """Table that shows the text of a file.

    Attributes:
        columns: its columns.
    """

    columns: tuple[SheetColumn, ...] = ()

    @property
    @abstractmethod
    def rows(self) -> tuple[tuple[str, ...], ...]:
        """Displayed texts of the cells, row by row."""

    @abstractmethod
    def put(self, row: int, column: int, typed: str) -> Changed:
        """Change a cell."""

    @abstractmethod
    def add(self, like: int | None = None) -> Changed:
        """Add a row at the end: a copy of row `like` with another name. If None, add a new row."""

    @abstractmethod
    def remove(self, row: int) -> Changed:
        """Remove a row."""

    @abstractmethod
    def cell_of(self, fault: BadFile) -> tuple[int, int] | None:
        """Return the row and column of a fault; None if the fault concerns no cell."""


def free_name(name: str, taken: Collection[str]) -> str:
    """Return a name that is not taken; an underscore replaces the space if `name` has no spaces."""
    if name not in taken:
        return name
    joint = "_" if (name.islower() and "_" in name) or name == "property" else " "
    number = 2
    while f"{name}{joint}{number}" in taken:
        number += 1
    return f"{name}{joint}{number}"
