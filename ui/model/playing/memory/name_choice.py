"""Selection of a name from the list, by clicking or by typing."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace

from ui.model.playing.memory.popup_queue import TreasureItem

TYPING = 1.5
"""After this number of seconds, a typed letter begins another name and does not continue the previous letters."""


@dataclass(frozen=True, slots=True)
class NameChoice:
    """Name selected for a treasure in a pop-up that asks for a name.

    Attributes:
        item: pop-up of the treasure.
        name: the selected name; None if there is none.
        letters: typed letters, in lower case.
        until: time at which the typed letters are discarded.
    """

    item: TreasureItem
    name: str | None = None
    letters: str = ""
    until: float = -math.inf

    def typed(self, now: float) -> str:
        """Return the typed letters to which the next letter is appended."""
        return self.letters if now < self.until else ""

    def typing(self, letter: str, names: Mapping[str, str], now: float) -> "NameChoice":
        """Return the selection after another typed letter: the name that begins with the letters, or no name.

        If the same letter is typed repeatedly, the selection moves to the next name with this letter, as in Qt's lists.

        Args:
            letter: the typed letter.
            names: displayed form of each name.
            now: monotonic time, s.
        """
        letters = self.typed(now) + letter.casefold()
        again = letters == letters[0] * len(letters)
        begun = letters[0] if again else letters
        fitting = [name for name, words in names.items() if words.casefold().startswith(begun)]
        name: str | None = None
        if self.name in fitting:
            name = fitting[(fitting.index(self.name) + again) % len(fitting)]
        elif fitting:
            name = fitting[0]
        return replace(self, name=name, letters=letters, until=now + TYPING)
