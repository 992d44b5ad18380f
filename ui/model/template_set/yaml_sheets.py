"""Tables of a file `treasures.yaml`: treasures, and declared properties.

A change of a cell changes only one value in the text of the file; comments and layout remain.
"""

import re
from collections.abc import Callable, Mapping, Sequence
from functools import partial
from pathlib import Path

from thbridge.files.errors import BadFile
from thbridge.files.set_words import WORDS
from thbridge.files.treasure_files import TREASURES_YAML
from thbridge.files.yaml.edit import with_value, without
from thbridge.files.yaml.places import node_at, steps_of
from thbridge.files.yaml.tree import Listing, Node, Scalar, Section, parse, quoted
from thbridge.hunt.properties import PropertyDrawing, Teller
from thbridge.hunt.refusals import RequestRefused
from thbridge.study.text import is_plain_word
from ui.model.template_set.sheet import Changed, Sheet, SheetColumn, Texts, free_name

_NUMBER = re.compile(r"[+-]?\d+(\.\d+)?")
_NAME = "name"
_TREASURES, _PROPERTIES = "treasures", "properties"


class _YamlSheet(Sheet):
    """Table for a list of mappings in a YAML file."""

    key: str

    def __init__(self, texts: Texts, tree: Node) -> None:
        self._texts, self._tree = texts, tree
        self._text = texts[TREASURES_YAML]
        items = node_at(tree, steps_of(self.key))
        self._count = len(items.items) if isinstance(items, Listing) else 0

    @property
    def rows(self) -> tuple[tuple[str, ...], ...]:
        """Displayed texts of the cells, row by row."""
        return tuple(
            tuple(self._cell(f"{self.key}[{row}].{column.path}") for column in self.columns)
            for row in range(self._count)
        )

    def put(self, row: int, column: int, typed: str) -> Changed:
        """Change a cell; an empty text removes the cell's key from the file."""
        path, typed = f"{self.key}[{row}].{self.columns[column].path}", typed.strip()
        if typed == self.rows[row][column]:
            return {}
        if not typed and self.columns[column].path != _NAME:
            return _in_yaml(without(self._text, path, self._tree))
        return _in_yaml(self._written(self._text, path, _as_yaml(typed, self.columns[column])))

    def add(self, like: int | None = None) -> Changed:
        """Add an entry at the end."""
        entry = self._new() if like is None else dict(zip(self._paths(), self.rows[like], strict=True))
        taken = {row[self._paths().index(_NAME)] for row in self.rows}
        entry[_NAME] = free_name(entry[_NAME], taken)
        item = _entry_as_yaml(entry, self.columns)
        # If a list has no items, its key can be missing or have the value `[]`.
        if self._count == 0:
            return _in_yaml(self._written(self._text, self.key, f"[{item}]"))
        return _in_yaml(self._written(self._text, f"{self.key}[{self._count}]", item))

    def remove(self, row: int) -> Changed:
        """Remove an entry."""
        return _in_yaml(without(self._text, f"{self.key}[{row}]", self._tree))

    def cell_of(self, fault: BadFile) -> tuple[int, int] | None:
        """Return the row and column of a fault; for a fault of a whole entry, return the first cell of the entry."""
        key = "" if fault.key is None else fault.key
        for row in range(self._count):
            for column, path in enumerate(self._paths()):
                if key == f"{self.key}[{row}].{path}" or key.startswith(f"{self.key}[{row}].{path}["):
                    return row, column
            if key.startswith(f"{self.key}[{row}]"):
                return row, 0
        return None

    def _new(self) -> dict[str, str]:
        raise NotImplementedError

    def _paths(self) -> list[str]:
        return [column.path for column in self.columns]

    def _cell(self, path: str) -> str:
        return _spoken(node_at(self._tree, steps_of(path)))

    def _written(self, text: str, path: str, value: str) -> str | RequestRefused:
        order = list(dict.fromkeys(each.partition(".")[0] for each in self._paths()))
        return with_value(text, path, value, lambda _: order)


class TreasureSheet(_YamlSheet):
    """Table of the treasures in a file `treasures.yaml`, with a column for each declared property."""

    key = _TREASURES

    def __init__(self, texts: Texts, tree: Node, pictures: Sequence[str]) -> None:
        super().__init__(texts, tree)
        declared = PropertySheet(texts, tree).declared
        self.columns = (
            SheetColumn("Name", _NAME, "name of the treasure, as people read it"),
            SheetColumn("Points", "points", "points for the right name", is_number=True),
            SheetColumn("Picture", "image", "a file in the folder pictures", tuple(pictures), is_picture=True),
            *(
                SheetColumn(label, f"values.{name}", " or ".join(values) or "any text", values)
                for name, label, values in declared
            ),
        )

    def _new(self) -> dict[str, str]:
        first = {column.path: next(iter(column.choices), "") for column in self.columns}
        return first | {_NAME: "treasure", "points": "10"}


class PropertySheet(_YamlSheet):
    """Table of the properties that a file `treasures.yaml` declares."""

    key = _PROPERTIES
    columns = (
        SheetColumn("Name", _NAME, "name in files and sentences: lower-case letters and underscores"),
        SheetColumn("Label", "label", "heading above the value; if empty, the name of the property"),
        SheetColumn("Values", "values", "allowed values, separated by commas; if empty, any value", is_list=True),
        SheetColumn("Reported by", "told_by", "who reports the property; if empty, the robot", tuple(Teller)),
        SheetColumn("Sensor", "sensor", "name of the robot's sensor, as people read it"),
        SheetColumn("Cost", "cost", "energy to sense the property; if empty, 0: sensed on arrival", is_number=True),
        SheetColumn("Drawn as", "drawn", "how windows show the value; if empty, as a word", tuple(PropertyDrawing)),
        SheetColumn("In sentences", "said", "text for the value, which is written £name£; if empty, only the value"),
    )

    @property
    def declared(self) -> list[tuple[str, str, tuple[str, ...]]]:
        """Name, label and values of each property."""
        told = []
        for index, row in enumerate(self.rows):
            listed = node_at(self._tree, steps_of(f"{self.key}[{index}].values"))
            values = listed.items if isinstance(listed, Listing) else []
            label = row[1] or row[0].replace("_", " ").capitalize()
            told.append((row[0], label, tuple(_spoken(value) for value in values)))
        return told

    def put(self, row: int, column: int, typed: str) -> Changed:
        """Change a cell.

        If the name of a property changes, it also changes in treasures and sentences. If a value of a property
        changes, it also changes in the treasures with this value.
        """
        done = super().put(row, column, typed)
        if isinstance(done, RequestRefused) or not done:
            return done
        name, path, typed = self.rows[row][0], self.columns[column].path, typed.strip()
        if path == _NAME and name and typed:
            return self._renamed(row, done[TREASURES_YAML], name, typed)
        if path == "values":
            return self._revalued(row, done[TREASURES_YAML], name)
        return done

    def add(self, like: int | None = None) -> Changed:
        """Add a property; every treasure gets the property's first value."""
        done = super().add(like)
        if isinstance(done, RequestRefused):
            return done
        text = done[TREASURES_YAML]
        name, _, values = PropertySheet({TREASURES_YAML: text}, _tree(text)).declared[-1]
        put = partial(self._with_value_of, name=name, value=_as_yaml(values[0] if values else ""))
        return _in_yaml(self._in_all_treasures(text, put))

    def remove(self, row: int) -> Changed:
        """Remove a property, and the value of this property from every treasure."""
        done = super().remove(row)
        if isinstance(done, RequestRefused):
            return done
        name = self.rows[row][0]
        return _in_yaml(
            self._in_all_treasures(
                done[TREASURES_YAML], lambda text, treasure: without(text, f"{treasure}.values.{name}")
            )
        )

    def _new(self) -> dict[str, str]:
        return {_NAME: "property", "values": "small, large"}

    def _renamed(self, row: int, text: str, name: str, new: str) -> Changed:
        def renamed(text: str, treasure: str) -> str | RequestRefused:
            value = node_at(_tree(text), steps_of(f"{treasure}.values.{name}"))
            if value is None:
                return text
            less = without(text, f"{treasure}.values.{name}")
            if isinstance(less, RequestRefused):
                return less
            return self._with_value_of(less, treasure, new, _as_yaml(_spoken(value)))

        said = self.rows[row][self._paths().index("said")]
        done: str | RequestRefused = text
        if f"£{name}£" in said:
            words = _as_yaml(said.replace(f"£{name}£", f"£{new}£"))
            done = with_value(text, f"{self.key}[{row}].said", words)
        done = done if isinstance(done, RequestRefused) else self._in_all_treasures(done, renamed)
        changed = _in_yaml(done)
        return changed if isinstance(changed, RequestRefused) else {**changed, **self._said_as(name, new)}

    def _said_as(self, name: str, new: str) -> Texts:
        """Return the sentences and words in all languages, with the new name of a property."""
        word = f"£{name}£"
        done = {path: text.replace(word, f"£{new}£") for path, text in self._texts.items() if word in text}
        for path in self._texts:
            if Path(path).name != WORDS:
                continue
            try:
                entries = node_at(_tree(self._texts[path]), steps_of(_PROPERTIES))
            except BadFile:
                continue
            for index in range(len(entries.items) if isinstance(entries, Listing) else 0):
                place = f"{_PROPERTIES}[{index}].{_NAME}"
                if _spoken(node_at(_tree(self._texts[path]), steps_of(place))) == name:
                    text = with_value(done.get(path, self._texts[path]), place, _as_yaml(new))
                    done |= {} if isinstance(text, RequestRefused) else {path: text}
        return {path: text for path, text in done.items() if path != TREASURES_YAML}

    def _revalued(self, row: int, text: str, name: str) -> Changed:
        was, now = self.declared[row][2], PropertySheet({TREASURES_YAML: text}, _tree(text)).declared[row][2]
        other = [(old, new) for old, new in zip(was, now, strict=False) if old != new]
        if len(was) != len(now) or len(other) != 1 or other[0][1] in was:
            return _in_yaml(text)
        ((old, new),) = other

        def revalued(text: str, treasure: str) -> str | RequestRefused:
            path = f"{treasure}.values.{name}"
            is_old = _spoken(node_at(_tree(text), steps_of(path))) == old
            return with_value(text, path, _as_yaml(new)) if is_old else text

        return _in_yaml(self._in_all_treasures(text, revalued))

    def _with_value_of(self, text: str, treasure: str, name: str, value: str) -> str | RequestRefused:
        order = [each for each, _, _ in PropertySheet({TREASURES_YAML: text}, _tree(text)).declared]
        return with_value(text, f"{treasure}.values.{name}", value, lambda _: order)

    def _in_all_treasures(self, text: str, change: Callable[[str, str], str | RequestRefused]) -> str | RequestRefused:
        treasures = node_at(self._tree, steps_of(_TREASURES))
        done: str | RequestRefused = text
        for index in range(len(treasures.items) if isinstance(treasures, Listing) else 0):
            done = done if isinstance(done, RequestRefused) else change(done, f"{_TREASURES}[{index}]")
        return done


def _tree(text: str) -> Node:
    return parse(Path(TREASURES_YAML), text)


def _in_yaml(text: str | RequestRefused) -> Changed:
    return text if isinstance(text, RequestRefused) else {TREASURES_YAML: text}


def _spoken(node: Node | None) -> str:
    """Return a value as people type it."""
    match node:
        case Scalar():
            return "" if node.absent else node.text
        case Listing():
            return ", ".join(_spoken(item) for item in node.items)
        case Section() | None:
            return ""


_TEXT = SheetColumn("", "")


def _as_yaml(typed: str, column: SheetColumn = _TEXT) -> str:
    """Return a value as YAML on one line."""
    if column.is_list:
        return f"[{', '.join(_as_yaml(part.strip()) for part in typed.split(',') if part.strip())}]"
    bare = is_plain_word(typed) or (column.is_number and _NUMBER.fullmatch(typed) is not None)
    return typed if bare else quoted(typed)


def _entry_as_yaml(entry: Mapping[str, str], columns: Sequence[SheetColumn]) -> str:
    """Return an entry as YAML in braces; keys with a dot belong to an inner mapping."""
    own, values = [], []
    for column in columns:
        typed = entry.get(column.path, "")
        section, dot, key = column.path.partition(".")
        written = f"{key or section}: {_as_yaml(typed, column)}"
        if dot:
            values.append(written)
        elif typed:
            own.append(written)
    within = [f"values: {{{', '.join(values)}}}"] if values else []
    return f"{{{', '.join([*own, *within])}}}"
