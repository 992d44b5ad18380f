"""Table for a list of treasures in the format of 2016: one line per treasure, with commas between the fields."""

from collections.abc import Callable, Sequence

from thbridge.files.errors import BadFile
from thbridge.files.treasure_files import PARTICIPANT_TREASURES, TREASURES
from thbridge.hunt.properties import OF_2016
from thbridge.hunt.refusals import RequestRefused
from ui.model.template_set.sheet import Changed, Sheet, SheetColumn, Texts, free_name


class ListSheet(Sheet):
    """Table for a list in the format of 2016. The list's copy for the participant's machine gets the same changes."""

    def __init__(self, texts: Texts, pictures: Sequence[str]) -> None:
        self._texts = texts
        self.columns = (
            *(SheetColumn(each.label, each.name, "value, as people read it") for each in OF_2016),
            SheetColumn("Points", "points", "points for the right name", is_number=True),
            SheetColumn("Name", "name", "name of the treasure, as people read it"),
            SheetColumn("Picture", "image", "a file in the folder pictures", tuple(pictures), is_picture=True),
        )

    @property
    def rows(self) -> tuple[tuple[str, ...], ...]:
        """Displayed texts of the cells, row by row."""
        return tuple(_fields(self._texts[TREASURES].split("\n")[line], len(self.columns)) for line in self._lines())

    def put(self, row: int, column: int, typed: str) -> Changed:
        """Change a cell."""
        typed = typed.strip()
        if "," in typed:
            return RequestRefused("comma", "A field of this list must not contain a comma.")
        if typed == self.rows[row][column]:
            return {}

        def change(lines: list[str], at: list[int]) -> list[str]:
            fields = lines[at[row]].split(",")
            if column < len(fields):
                blank = fields[column][: len(fields[column]) - len(fields[column].lstrip())]
                fields[column] = f"{blank}{typed}"
            return [*lines[: at[row]], ",".join(fields), *lines[at[row] + 1 :]]

        return self._in_both(change)

    def add(self, like: int | None = None) -> Changed:
        """Add a line at the end."""
        names = {row[3] for row in self.rows}
        first = next(iter(self.columns[4].choices), "picture.jpg")
        new = ("Red", "Small", "10", "Treasure", first) if like is None else self.rows[like]
        new = (*new[:3], free_name(new[3], names), new[4])

        def change(lines: list[str], at: list[int]) -> list[str]:
            last = at[-1] if at else 0
            count = len(lines[last].split(",")) if at else len(self.columns)
            return [*lines[: last + 1], ",".join(new[:count]), *lines[last + 1 :]]

        return self._in_both(change)

    def remove(self, row: int) -> Changed:
        """Remove a line."""
        return self._in_both(lambda lines, at: [*lines[: at[row]], *lines[at[row] + 1 :]])

    def cell_of(self, fault: BadFile) -> tuple[int, int] | None:
        """Return the row and column of a fault."""
        lines = self._lines()
        if fault.path.name != TREASURES or fault.line is None or fault.line - 1 not in lines:
            return None
        keys = ["Colour", "Footprint", "Points", "Name", "ImageFile"]
        return lines.index(fault.line - 1), keys.index(fault.key) if fault.key in keys else 0

    def _in_both(self, change: Callable[[list[str], list[int]], list[str]]) -> Changed:
        done = {}
        for name in (TREASURES, PARTICIPANT_TREASURES):
            if name in self._texts:
                at = self._lines(name)
                if len(at) != len(self._lines()):
                    problem = f"{name} and {TREASURES} have different numbers of treasures. Correct one of the files."
                    return RequestRefused("not-alike", problem)
                text = "\n".join(change(self._texts[name].split("\n"), at))
                if text != self._texts[name]:
                    done[name] = text
        return done

    def _lines(self, name: str = TREASURES) -> list[int]:
        """Return the indices of the lines with treasures; the first nonempty line is the number of rooms."""
        return [index for index, line in enumerate(self._texts[name].split("\n")) if line.strip()][1:]


def _fields(line: str, count: int) -> tuple[str, ...]:
    fields = [field.strip() for field in line.split(",")][:count]
    return (*fields, *[""] * (count - len(fields)))
