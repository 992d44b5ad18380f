"""Choice of a name from the list, by picking or by typing."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace

from ui.model.playing.memory.popup_queue import TreasureItem

TYPING = 1.5
"""Seconds after which a letter begins another name instead of going on with the letters before it."""


@dataclass(frozen=True, slots=True)
class NameChoice:
    """The name picked for a treasure while its pop-up asks for one; forgotten with the question.

    Attributes:
        item: the treasure's pop-up.
        name: name picked; None while there is none.
        letters: letters typed, in small letters.
        until: time at which they are forgotten.
    """

    item: TreasureItem
    name: str | None = None
    letters: str = ""
    until: float = -math.inf

    def typed(self, now: float) -> str:
        """The letters that the next one goes on with."""
        return self.letters if now < self.until else ""

    def typing(self, letter: str, names: Mapping[str, str], now: float) -> "NameChoice":
        """The choice after another letter: the name whose words begin with the letters, or none.

        One letter, once or again and again, goes from name to name, as in Qt's lists.

        Args:
            letter: typed.
            names: words of each name.
            now: time.
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
