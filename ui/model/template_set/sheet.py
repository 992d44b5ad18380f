"""Tables that show the text of a file with treasures or properties, and change it."""

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
        title: heading of the column.
        path: key in an entry of the file, such as `values.colour`.
        meaning: meaning of the column, in words for people.
        choices: allowed values; empty if any text is allowed.
        is_list: True if a cell can have several values, separated by commas.
        is_number: True if a cell is a number.
        is_picture: True if a cell is the name of a picture of the set.
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
        columns: columns of the table.
    """

    columns: tuple[SheetColumn, ...] = ()

    @property
    @abstractmethod
    def rows(self) -> tuple[tuple[str, ...], ...]:
        """Displayed texts of the cells in each row."""

    @abstractmethod
    def put(self, row: int, column: int, typed: str) -> Changed:
        """Change a cell."""

    @abstractmethod
    def add(self, like: int | None = None) -> Changed:
        """Add a row at the end: a copy of row `like` with another name. If `like` is None, add a default row."""

    @abstractmethod
    def remove(self, row: int) -> Changed:
        """Remove a row."""

    @abstractmethod
    def cell_of(self, fault: BadFile) -> tuple[int, int] | None:
        """Return the row and column of the cell with this fault; None if no cell has this fault."""


def free_name(name: str, taken: Collection[str]) -> str:
    """Return `name`. If `name` is taken, add a number after an underscore or a space."""
    if name not in taken:
        return name
    joint = "_" if (name.islower() and "_" in name) or name == "property" else " "
    number = 2
    while f"{name}{joint}{number}" in taken:
        number += 1
    return f"{name}{joint}{number}"
