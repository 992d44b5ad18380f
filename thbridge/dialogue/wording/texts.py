"""Texts: everything that participants read or hear except dialogues, in one language."""

import gettext
import re
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, replace
from functools import cache

from sim.common.robot_numbers import number_of
from thbridge.dialogue.sentences import fill
from thbridge.hunt.costs import energy_text
from thbridge.hunt.rooms import CORRIDOR, Room

Text = str | tuple[str, ...]
"""A text, or its plural forms."""

COUNT = "count"
"""Name of the value that chooses a plural form."""
ROBOT_VALUES = frozenset({"robot", "other"})
"""Names of values that are robots, given by their index in the team."""
ROOM_VALUES = frozenset({"room", "place"})
"""Names of values that are rooms, or the corridor, given by their number for people."""
_WITHIN = re.compile(r"[.?!…]\s*$")
PREPOSITIONS = ("", "to", "from", "in")
"""Each room has a form for each: `£room£`, `£to_room£`, `£from_room£`, `£in_room£`."""


@dataclass(frozen=True, slots=True)
class NamedRoom:
    """A room or the corridor: number for people, and name; the name is empty if there is none."""

    number: int
    name: str


@dataclass(frozen=True, slots=True)
class TextForms:
    """Forms of values in texts, from a language's grammar.

    Attributes:
        rooms: a room with `£number£`, by the preposition before it.
        corridor: the corridor, by the preposition before it.
        robot: a robot with `£number£`.
        between: text between two items of a list.
        last: text before the last item.
        decimal: sign before the decimals of a number.
        plural: C expression for the index of the plural form of a number n, as in gettext's files: `n != 1`.
        capital_nouns: True if nouns have a capital letter within sentences.
    """

    rooms: Mapping[str, str]
    corridor: Mapping[str, str]
    robot: str
    between: str
    last: str
    decimal: str
    plural: str
    capital_nouns: bool = False


@dataclass(frozen=True, slots=True)
class Texts:
    """All texts of a language, by key. A key has the name of the file, a dot, and the name of the text in the file.

    In a text, reserved words between pound signs stand for values; at the beginning of a sentence they get a capital
    letter. The name of a value determines its form: see `ROBOT_VALUES`, `ROOM_VALUES` and `COUNT`. Any other text is
    inserted unchanged, and any other number in the format of the language.

    Attributes:
        language: name of the language's folder: `en`.
        title: name of the language in itself: `English`.
        entries: the texts.
        forms: forms of values.
    """

    language: str
    title: str
    entries: Mapping[str, Text]
    forms: TextForms

    def text(self, key: str, /, *, count: int | None = None, **values: str | float | Room | NamedRoom) -> str:
        """Return a text with its values.

        Args:
            key: key of the text.
            count: number that chooses the plural form and replaces `£count£`.
            **values: values of its reserved words.

        Raises:
            KeyError: there is no such text; a checked language has all texts that English has.
        """
        return fill(self._form(key, count), self._words(values, count))

    def clause(self, key: str, *, count: int | None = None, **values: str | float | Room | NamedRoom) -> str:
        """Return a text for use within a sentence: a value at the beginning gets no capital letter.

        Otherwise this method is like `text`.
        """
        return fill(self._form(key, count), self._words(values, count), _WITHIN)

    def in_browser(self) -> "Texts":
        """Return the texts for people in a browser: texts of the file `browser` replace the texts that they name."""
        return replace(
            self, entries={key: self.entries.get(f"browser.{key}", text) for key, text in self.entries.items()}
        )

    def has(self, key: str) -> bool:
        """Return True if there is a text with this key."""
        return key in self.entries

    def robot(self, robot: int) -> str:
        """Return a robot's name for use within a sentence."""
        return fill(self.forms.robot, {"number": str(number_of(robot))})

    def room(self, room: Room | int, preposition: str = "", *, name: str = "") -> str:
        """Return a room for use within a sentence, with the given preposition, and with its name if there is one."""
        number = room.people if isinstance(room, Room) else room
        if number == CORRIDOR.people:
            return self.forms.corridor[preposition]
        return fill(self.forms.rooms[preposition], {"number": f"{number} ({name})" if name else str(number)})

    def number(self, number: float) -> str:
        """Return a number with at most two decimals: `13`, `12.5`."""
        return energy_text(number).replace(".", self.forms.decimal)

    def noun(self, label: str) -> str:
        """Return a label, such as `Weight`, as a noun for use within a sentence."""
        return label if self.forms.capital_nouns else label.lower()

    def listed(self, things: Iterable[str]) -> str:
        """Return a list of things: `a`, `a and b`, `a, b and c`."""
        *first, last = things
        return f"{self.forms.between.join(first)}{self.forms.last}{last}" if first else last

    def _room(self, room: float | Room | NamedRoom, preposition: str) -> str:
        match room:
            case Room():
                return self.room(room, preposition)
            case NamedRoom(number, name):
                return self.room(number, preposition, name=name)
            case _:
                return self.room(int(room), preposition)

    def _form(self, key: str, count: int | None) -> str:
        text = self.entries[key]
        if isinstance(text, str):
            return text
        form = 0 if count is None else _plural_form(self.forms.plural)(abs(count))
        return text[min(form, len(text) - 1)]

    def _words(self, values: Mapping[str, str | float | Room | NamedRoom], count: int | None) -> dict[str, str]:
        words: dict[str, str] = {} if count is None else {COUNT: str(count)}
        for name, value in values.items():
            if name in ROOM_VALUES and not isinstance(value, str):
                words |= {_with(preposition, name): self._room(value, preposition) for preposition in PREPOSITIONS}
            elif name in ROBOT_VALUES and isinstance(value, int):
                words[name] = self.robot(value)
            elif isinstance(value, str | Room | NamedRoom):
                words[name] = str(value)
            else:
                words[name] = self.number(value)
        return words


def counted(number: float) -> int:
    """Return a whole number with the same plural form as a number. Fractions have the plural form of 2."""
    return round(number) if round(number, 2).is_integer() else 2


def words_for(value: str) -> tuple[str, ...]:
    """Return the reserved words that a text may contain for a value with this name."""
    return tuple(_with(preposition, value) for preposition in PREPOSITIONS) if value in ROOM_VALUES else (value,)


def value_of(word: str) -> str:
    """Return the name of the value that a reserved word of a text stands for."""
    return next((room for room in ROOM_VALUES if word in words_for(room)), word)


def _with(preposition: str, name: str) -> str:
    return f"{preposition}_{name}" if preposition else name


@cache
def _plural_form(expression: str) -> Callable[[int], int]:
    return gettext.c2py(expression)
